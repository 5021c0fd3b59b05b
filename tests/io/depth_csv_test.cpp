#include <gmock/gmock.h>
#include <isobath/io/formats/depth_csv.hpp>
#include <isobath/io/open_source.hpp>
#include <sstream>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/io/survey_events.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using test::drain;
using test::only;
using test::soundings;
using testing::HasSubstr;

InputConfig declared(const std::string& columns) {
  InputConfig config;
  config.survey.csv_columns = columns;
  return config;
}

std::unique_ptr<Source> table(const std::string& text, const InputConfig& config) {
  return open_depth_csv(std::make_unique<std::istringstream>(text), "table.csv", config);
}

std::string error_of(const std::string& text, const InputConfig& config) {
  try {
    table(text, config);
  } catch (const Error& e) {
    return e.what();
  }
  return "opened";
}

const std::string kColumns = "time=T,latitude=Lat,longitude=Lon,depth=D,heading=H";

TEST(DepthCsv, ARowIsAFixAndAReading) {
  const auto source = table("Lon,\"Lat\",T,D,H,more\n11.5,48,2024-03-13T15:50:16.25Z,7.5,90,x\n", declared(kColumns));
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 2u);
  const auto found = soundings(events);
  EXPECT_EQ(to_text(found.at(0).fix.time), "2024-03-13T15:50:16.250Z");
  EXPECT_EQ(found[0].reading.time, found[0].fix.time);
  EXPECT_TRUE(found[0].bottom.isApprox(Eigen::Vector3d(0, 0, 7.5), 1e-12));
  EXPECT_NEAR(found[0].fix.X_WB.rotation.heading().degrees(), 90, 1e-9);
  EXPECT_EQ(*source->report().origin, (GeoPoint{48, 11.5}));
}

TEST(DepthCsv, UnitsAndSensesAreAsDeclared) {
  const auto depth = [](DepthUnit unit, DepthSign sign, const std::string& value) {
    InputConfig config = declared("latitude=Lat,longitude=Lon,depth=D");
    config.survey.csv_depth_unit = unit;
    config.survey.csv_depth_sign = sign;
    const auto found = soundings(drain(*table("Lat,Lon,D\n48,11," + value + "\n", config)));
    return found.size() == 1 ? found[0].bottom.z() : -1;
  };
  EXPECT_NEAR(depth(DepthUnit::kMetre, DepthSign::kDown, "10"), 10, 1e-12);
  EXPECT_NEAR(depth(DepthUnit::kFoot, DepthSign::kDown, "10"), 3.048, 1e-12);
  EXPECT_NEAR(depth(DepthUnit::kFathom, DepthSign::kDown, "10"), 18.288, 1e-12);
  EXPECT_NEAR(depth(DepthUnit::kMetre, DepthSign::kUp, "-11.07"), 11.07, 1e-12);
  EXPECT_EQ(depth(DepthUnit::kMetre, DepthSign::kUp, "11.07"), -1) << "above the water: no bottom";
}

TEST(DepthCsv, DepthsStayBelowTheWaterWhereverTheTransducerIs) {
  InputConfig config = declared("latitude=Lat,longitude=Lon,depth=D");
  config.survey.transducer_depth_m = 0.5;
  const auto found = soundings(drain(*table("Lat,Lon,D\n48,11,2\n", config)));
  EXPECT_NEAR(found.at(0).bottom.z(), 2, 1e-12);
  EXPECT_NEAR(*found[0].reading.range_m, 1.5, 1e-12);
}

// A tower whose place is published both ways.
TEST(DepthCsv, UtmZonesAreReadAsDeclared) {
  InputConfig config = declared("northing=N,easting=E,depth=D");
  config.survey.csv_position = "utm 17N";
  const auto source = table("N,E,D\n4833438,630084,3\n", config);
  EXPECT_EQ(drain(*source).size(), 2u);
  EXPECT_NEAR(source->report().origin->latitude_deg, 43 + 38 / 60.0 + 33.24 / 3600, 2e-5);
  EXPECT_NEAR(source->report().origin->longitude_deg, -(79 + 23 / 60.0 + 13.7 / 3600), 2e-5);
  const auto outside = table("N,E,D\n-1e9,630084,3\n", config);
  EXPECT_TRUE(drain(*outside).empty());
  EXPECT_EQ(outside->report().rejected.at("row with a missing or impossible position"), 1u);
}

TEST(DepthCsv, TimesAreIsoSecondsOrMadeUp) {
  InputConfig config = declared("time=T,latitude=Lat,longitude=Lon,depth=D");
  config.survey.csv_time = CsvTime::kSeconds;
  config.survey.utc_offset_h = 1;
  const auto seconds_of = only<Navigation>(drain(*table("T,Lat,Lon,D\n7200.5,48,11,2\nx,48,11,2\n", config)));
  ASSERT_EQ(seconds_of.size(), 1u);
  EXPECT_EQ(seconds_of[0].time, Time{seconds(3600.5)});
  const auto made = only<Navigation>(
      drain(*table("Lat,Lon,D\n48,11,2\n48,11,2\nx,11,2\n48,11,2\n", declared("latitude=Lat,longitude=Lon,depth=D"))));
  ASSERT_EQ(made.size(), 3u);
  EXPECT_EQ(made[2].time, Time{std::chrono::seconds(2)}) << "one second a row that can be used";
}

TEST(DepthCsv, WithoutAHeadingItIsTheCourse) {
  const auto fixes =
      only<Navigation>(drain(*table("Lat,Lon,D\n48,11,2\n48,11.0001,2\n48,11.0001,2\n48.0001,11.0001,2\n",
                                    declared("latitude=Lat,longitude=Lon,depth=D"))));
  ASSERT_EQ(fixes.size(), 4u);
  EXPECT_NEAR(fixes[1].X_WB.rotation.heading().degrees(), 90, 1e-3);
  EXPECT_NEAR(fixes[2].X_WB.rotation.heading().degrees(), 90, 1e-3) << "a repeated position says nothing";
  EXPECT_NEAR(fixes[3].X_WB.rotation.heading().degrees(), 0, 1e-3);
}

// ledger: S1-64
TEST(DepthCsv, RowsThatSayNothingAreCounted) {
  const auto source = table("Lat,Lon,D\n48,11,0\n48,11,\n48,11,nan\n95,11,3\n48,,3\n48\n0,0,3\n48,11,3\n48,11,1e9\n",
                            declared("latitude=Lat,longitude=Lon,depth=D"));
  const auto events = drain(*source);
  EXPECT_EQ(only<Navigation>(events).size(), 5u);
  EXPECT_EQ(only<RangeReading>(events).size(), 1u);
  EXPECT_EQ(source->report().rejected.at("no bottom"), 4u);
  EXPECT_EQ(source->report().rejected.at("row with a missing or impossible position"), 4u);
}

TEST(DepthCsv, WrongDeclarationsAreErrors) {
  const std::string names = "Lat,Lon,D\n";
  EXPECT_THAT(error_of(names, declared("latitude=Lat,longitude=Long,depth=D")),
              HasSubstr("table.csv:1: no column \"Long\", which input.csv_columns names; allowed: Lat, Lon, D"));
  EXPECT_THAT(error_of(names, declared("latitude=Lat,depth=D")),
              HasSubstr("input.csv_columns must declare the columns of latitude, longitude and depth"));
  EXPECT_THAT(error_of(names, declared("latitude=Lat,longitude=Lon")), HasSubstr("must declare"));
  EXPECT_THAT(error_of(names, declared("lat=Lat")), HasSubstr("\"lat=Lat\" declares no column; allowed: time, "));
  EXPECT_THAT(error_of(names, declared("depth")), HasSubstr("\"depth\" declares no column"));
  for (const char* bad : {"utm 61N", "utm N", "utm 0N", "utm 17", "UTM 17N", "metres", ""}) {
    InputConfig config = declared("latitude=Lat,longitude=Lon,depth=D");
    config.survey.csv_position = bad;
    EXPECT_THAT(error_of(names, config), HasSubstr("unknown kind of positions")) << bad;
  }
}

// Nothing is guessed, however plain the names are.
TEST(DepthCsv, UndeclaredTablesAreRefusedWithTheirColumns) {
  ISOBATH_NEEDS_DATA(folder, "bay-boat-pr");
  try {
    open_source(folder / "Aug-24-2022.csv", {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::AllOf(HasSubstr("columns are not declared: Latitude, Longitude, Depth_in_Feet;"),
                                         HasSubstr("--set input.csv_columns="), testing::Not(HasSubstr("\n"))));
  }
}

TEST(DepthCsv, RealBaysInFeet) {
  ISOBATH_NEEDS_DATA(folder, "bay-boat-pr");
  InputConfig config = declared("latitude=Latitude,longitude=Longitude,depth=Depth_in_Feet");
  config.survey.csv_depth_unit = DepthUnit::kFoot;
  const auto source = open_source(folder / "Aug-24-2022.csv", config);
  const auto found = soundings(drain(*source));
  ASSERT_EQ(found.size(), 1297u);
  EXPECT_NEAR(found[0].bottom.z(), 1.47 * 0.3048, 1e-12);
  for (const auto& s : found) ASSERT_TRUE(s.bottom.z() > 0.3 && s.bottom.z() < 5.8);
}

TEST(DepthCsv, RealLakeWithHeightsAndOutliers) {
  ISOBATH_NEEDS_DATA(folder, "lake227-ela");
  InputConfig config = declared("latitude=y,longitude=x,depth=z");
  config.survey.csv_depth_sign = DepthSign::kUp;
  const auto found = soundings(drain(*open_source(folder / "227_LA.csv", config)));
  ASSERT_EQ(found.size(), 1039u);
  int near_first = 0;  // the first of the points that lie kilometres from the lake is the origin
  for (const auto& s : found) {
    ASSERT_TRUE(s.bottom.z() >= 0.48 - 1e-9 && s.bottom.z() <= 11.07 + 1e-9);
    near_first += s.bottom.head<2>().norm() < 1000;
  }
  EXPECT_EQ(near_first, 6);
}

}  // namespace
}  // namespace isobath
