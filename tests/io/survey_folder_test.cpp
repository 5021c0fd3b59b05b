#include <fstream>
#include <gmock/gmock.h>
#include <isobath/io/bytes/name_patterns.hpp>
#include <isobath/io/open_source.hpp>
#include <isobath/io/survey_folder.hpp>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/io/survey_events.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;

using test::drain;
using test::only;
using test::soundings;
using testing::ElementsAre;
using testing::HasSubstr;

class SurveyFolders : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  /// A table of depths: rows of seconds, latitude, longitude and depth.
  void log(const std::string& name, const std::string& rows) { write(name, "T,Lat,Lon,D\n" + rows); }
  std::unique_ptr<Source> open() { return open_source(folder_, config_); }

  static InputConfig declared() {
    InputConfig config;
    config.survey.csv_columns = "time=T,latitude=Lat,longitude=Lon,depth=D";
    config.survey.csv_time = CsvTime::kSeconds;
    return config;
  }
  fs::path folder_ = test::scratch_folder();
  InputConfig config_ = declared();
};

std::vector<double> times(const std::vector<Event>& events) {
  std::vector<double> t;
  for (const auto& fix : only<Navigation>(events)) t.push_back(to_seconds(fix.time));
  return t;
}

TEST_F(SurveyFolders, FilesAreReadInTheOrderOfTheirFirstTimes) {
  log("a.csv", "1e9,48,11,5\n");
  log("b.csv", "8e8,48,11,6\n8.00000001e8,48,11,6\n");
  log("c.csv", "9e8,48,11,7\nbad\n");
  write("README.md", "A survey.\n");
  const auto source = open();
  EXPECT_THAT(times(drain(*source)), ElementsAre(8e8, 8e8 + 1, 9e8, 1e9));
  const SourceReport& report = source->report();
  EXPECT_EQ(report.format, "folder of depth CSV");
  EXPECT_EQ(report.details.at("files"), "3 of 3 read");
  EXPECT_EQ(report.details.at("left out"), "not a known log: README.md");
  EXPECT_EQ(report.rejected.at("row with a missing or impossible time"), 1u);
  EXPECT_EQ(report.bytes_read, report.bytes_total);
  EXPECT_EQ(report.details.count("overlap"), 0u);
}

TEST_F(SurveyFolders, AllFixesAreOnThePlaneOfTheFirstFile) {
  log("first.csv", "8e8,60,10,5\n");
  log("second.csv", "9e8,60,10.4,6\n9.00000001e8,60.01,10.4,6\n");
  const auto source = open();
  const auto fixes = only<Navigation>(drain(*source));
  ASSERT_EQ(fixes.size(), 3u);
  EXPECT_EQ(*source->report().origin, (GeoPoint{60, 10}));
  const LocalPlane plane({60, 10});
  EXPECT_LT((fixes[1].X_WB.translation.head<2>() - plane.to_plane({60, 10.4})).norm(), 1e-6);
  EXPECT_LT((fixes[2].X_WB.translation.head<2>() - plane.to_plane({60.01, 10.4})).norm(), 1e-6);
  // Meridians meet in the north: to the east they lean west, by 0.4 degrees of longitude times the sine of latitude.
  EXPECT_NEAR(fixes[2].X_WB.rotation.heading().degrees(), -0.4 * std::sin(60.01 * std::numbers::pi / 180), 1e-3);
}

TEST(InPlane, ThereAndBackIsTheSameFix) {
  const LocalPlane a({52.34, 12.99}), b({52.6, 13.7});
  Navigation fix;
  fix.X_WB = {Rotation::from_heading_pitch_roll(Angle::degrees(100), Angle::degrees(5), Angle::degrees(-3)),
              {1234, -567, 0.5}};
  fix.v_WB = Eigen::Vector3d(1, 0.5, 0.1);
  Eigen::Matrix<double, 6, 1> variances;
  variances << 4, 1, 0.25, 0.1, 0.2, 0.3;
  fix.covariance = variances.asDiagonal().toDenseMatrix();
  const Navigation there = in_plane(fix, a, b), back = in_plane(there, b, a);
  EXPECT_GT((there.X_WB.translation - fix.X_WB.translation).norm(), 1e4);
  EXPECT_LT((back.X_WB.translation - fix.X_WB.translation).norm(), 1e-6);
  // Planes 57 km apart see each other foreshortened by 4e-5 in one direction: a turn alone cannot undo that.
  EXPECT_LT((back.X_WB.rotation.inverse() * fix.X_WB.rotation).log().norm(), 1e-6);
  EXPECT_LT((*back.v_WB - *fix.v_WB).norm(), 1e-6);
  EXPECT_TRUE(back.covariance->isApprox(*fix.covariance, 1e-6));
  EXPECT_FALSE(there.covariance->isApprox(*fix.covariance, 1e-3)) << "its axes turn with north";
}

TEST_F(SurveyFolders, OneFormatIsReadAndTheRestIsNamed) {
  log("a.csv", "1e9,48,11,5\n");
  log("b.csv", "8e8,48,11,6\n");
  log("empty.csv", "");
  write("scan.txt", "# t_s,head_deg,bin_m,nbins,i0,i1,...\n1,2,0.1,2,3,4\n");
  write("cut.sum", "Sample #,Date/Time,VB Depth (m)\r");
  fs::create_directory(folder_ / "more");
  const auto source = open();
  EXPECT_THAT(times(drain(*source)), ElementsAre(8e8, 1e9));
  EXPECT_EQ(source->report().details.at("left out"),
            "SonTek .sum: cut.sum; contains no event: empty.csv; scan CSV: scan.txt");
}

TEST_F(SurveyFolders, FilesAreChosenByName) {
  for (int day = 17; day <= 19; ++day) {
    log("202501" + std::to_string(day) + ".csv", std::to_string(day) + "e8,48,11,5\n");
  }
  config_.survey.only = "20250117*";
  EXPECT_THAT(times(drain(*open())), ElementsAre(17e8));
  config_.survey.only = "";
  config_.survey.without = "*18.csv, *19*";
  EXPECT_THAT(times(drain(*open())), ElementsAre(17e8));
  config_.survey.only = "2026*";
  try {
    open();
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("input.only and input.without leave no log; left out: not chosen: "));
  }
}

TEST_F(SurveyFolders, DamagesCarryTheNameOfTheirFile) {
  const std::string heading = "# t_s,head_deg,bin_m,nbins,i0,i1,...\n";
  write("a.txt", heading + "1,2,0.1,2,3,4\nbroken\n");
  write("b.txt", heading + "1,2,0.1,2,3,4\n");
  const auto source = open();
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 2u);
  ASSERT_EQ(source->report().damages.size(), 1u);
  EXPECT_THAT(source->report().damages[0].reason, testing::StartsWith("a.txt: line without time"));
  EXPECT_EQ(source->report().bytes_skipped, 7u);
  EXPECT_EQ(time_of(events[1]) - time_of(events[0]), std::chrono::seconds(10))
      << "logs without a date follow each other";
}

TEST_F(SurveyFolders, OverlapIsReadAndSaid) {
  log("a.csv", "8e8,48,11,5\n9e8,48,11,5\n");
  log("b.csv", "8.5e8,48,11,6\n");
  const auto source = open();
  EXPECT_THAT(times(drain(*source)), ElementsAre(8e8, 9e8, 8.5e8));
  EXPECT_EQ(source->report().details.at("overlap"), "1 files begin before the previous one ends");
}

TEST(Patterns, StarsAndQuestionMarks) {
  EXPECT_TRUE(fits("20250117160335.sum", "20250117*"));
  EXPECT_TRUE(fits("20250117160335.sum", "x, *.sum"));
  EXPECT_TRUE(fits("a.sum", "?.sum"));
  EXPECT_TRUE(fits("aXbXc", "a*b*c"));
  EXPECT_TRUE(fits("abc", "abc*"));
  EXPECT_FALSE(fits("abc", "abcd*"));
  EXPECT_FALSE(fits("ab.sum", "?.sum"));
  EXPECT_FALSE(fits("a.sum", ""));
  EXPECT_FALSE(fits("a.summary", "*.sum"));
  EXPECT_FALSE(fits(std::string(2000, 'a'), "*a*a*a*a*a*a*a*a*a*a*b"));
}

// Real: sixteen runs on four days, as one survey.
TEST(SurveyOfALake, HasAllItsSamplesInOrderOnOnePlane) {
  ISOBATH_NEEDS_DATA(folder, "lake-caputh-m9");
  const auto source = open_source(folder, {});
  std::uint64_t fixes = 0, readings = 0;
  Time last{};
  double farthest = 0;
  while (const auto event = source->next()) {
    ASSERT_GE(time_of(*event), last);
    last = time_of(*event);
    if (const auto* fix = std::get_if<Navigation>(&*event)) {
      ++fixes;
      farthest = std::max(farthest, fix->X_WB.translation.norm());
    }
    readings += std::holds_alternative<RangeReading>(*event);
  }
  EXPECT_EQ(fixes, 30983u);
  EXPECT_EQ(readings, 5u * 30983 - 4);
  EXPECT_EQ(source->report().details.at("files"), "16 of 16 read");
  EXPECT_EQ(source->report().rejected.at("no lock of the vertical beam"), 2u);
  EXPECT_EQ(source->report().rejected.at("no lock of a slant beam"), 2u);
  EXPECT_EQ(source->report().rejected.size(), 2u);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_LT(farthest, 1200);
  EXPECT_EQ(to_text(last), "2025-01-30T13:52:56.000Z");
}

TEST(SurveyOfALake, OneDayCanBeLeftOut) {
  ISOBATH_NEEDS_DATA(folder, "lake-caputh-m9");
  InputConfig config;
  config.survey.without = "20250122*, 20250123*, 20250130*";
  const auto source = open_source(folder, config);
  std::uint64_t fixes = 0;
  while (const auto event = source->next()) fixes += std::holds_alternative<Navigation>(*event);
  EXPECT_EQ(fixes, 408u + 1261 + 537 + 34 + 592);
}

}  // namespace
}  // namespace isobath
