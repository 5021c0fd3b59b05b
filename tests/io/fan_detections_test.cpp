// Folders of fan detections: what they are recognised by, where their detections and tracks lie, what is refused.
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/io/formats/fan_detections.hpp>
#include <isobath/io/input/pose_track.hpp>
#include <isobath/io/open_source.hpp>
#include <sstream>
#include <tests/support/data.hpp>
#include <tests/support/fan_folder.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using test::FanRecording;
using testing::HasSubstr;

constexpr const char* kColumns = "keyframe,time_s,range_m,bearing_deg\n";

std::unique_ptr<std::istream> text_stream(const std::string& text) {
  return std::make_unique<std::istringstream>(text);
}

std::unique_ptr<Source> detections(const std::string& rows, const InputConfig& config = {}) {
  return open_fan_detections(text_stream(kColumns + rows), "detections.csv", config);
}

struct FanEvents {
  std::vector<Swath> swaths;
  std::vector<Navigation> fixes;
};

FanEvents events_of(Source& source) {
  FanEvents events;
  while (const auto event = source.next()) {
    if (const auto* swath = std::get_if<Swath>(&*event)) events.swaths.push_back(*swath);
    if (const auto* fix = std::get_if<Navigation>(&*event)) events.fixes.push_back(*fix);
  }
  return events;
}

void write_table(const std::filesystem::path& file, const std::string& text) { std::ofstream(file) << text; }

std::string error_of_folder(const std::filesystem::path& folder, const InputConfig& config = {}) {
  try {
    open_source(folder, config);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(FanDetections, RowsOfOneTimeAreOneSwathWithBearingsToStarboard) {
  const auto source = detections("10,100.5,2,0\n10,100.5,4,90\n11,104.25,3,-90\n");
  const auto swaths = events_of(*source).swaths;
  ASSERT_EQ(swaths.size(), 2u);
  EXPECT_EQ(swaths[0].time, Time{std::chrono::milliseconds(100'500)});
  EXPECT_EQ(swaths[0].frame, Swath::Frame::kBody);
  EXPECT_TRUE(swaths[0].is_flat()) << "a fan does not resolve elevation";
  ASSERT_EQ(swaths[0].soundings.size(), 2u);
  EXPECT_LT((swaths[0].soundings[0].point.cast<double>() - Vector3d(2, 0, 0)).norm(), 1e-6);
  EXPECT_LT((swaths[0].soundings[1].point.cast<double>() - Vector3d(0, 4, 0)).norm(), 1e-6) << "starboard";
  EXPECT_EQ(swaths[0].soundings[1].kind, Sounding::Kind::kWater);
  EXPECT_EQ(swaths[1].time, Time{std::chrono::milliseconds(104'250)});
  EXPECT_LT((swaths[1].soundings[0].point.cast<double>() - Vector3d(0, -3, 0)).norm(), 1e-6) << "port";
}

TEST(FanDetections, TheMountTurnsThem) {
  InputConfig config;
  config.mount_heading = Angle::degrees(90);
  const auto swaths = events_of(*detections("1,1,2,0\n", config)).swaths;
  EXPECT_LT((swaths.at(0).soundings[0].point.cast<double>() - Vector3d(0, 2, 0)).norm(), 1e-6);
}

TEST(FanDetections, CountsRowsThatHoldNoDetection) {
  const auto source = detections(
      "1,1,2,0\n1,1,,0\n1,1,nan,0\n1,1,-2,0\n1,1,0,0\n1,1,2e9,0\n1,1,2,181\n1,x,2,0\n1,1e300,2,0\n1,1\n2,2,5,1\n");
  const auto swaths = events_of(*source).swaths;
  ASSERT_EQ(swaths.size(), 2u);
  EXPECT_EQ(swaths[0].soundings.size(), 1u);
  EXPECT_EQ(source->report().rejected.at(kBadDetection), 9u);
}

TEST(FanDetections, MoreThanASwathHoldsBeginsAnother) {
  std::string rows;
  for (std::size_t i = 0; i < Swath::kMaxSoundings + 3; ++i) rows += "1,1,2,0\n";
  const auto swaths = events_of(*detections(rows)).swaths;
  ASSERT_EQ(swaths.size(), 2u);
  EXPECT_EQ(check(swaths[0]), SwathFault::kNone);
  EXPECT_EQ(swaths[1].soundings.size(), 3u);
}

TEST(FanDetections, ACutTableGivesWhatStandsBeforeTheCut) {
  const std::string rows = "1,1,2,0\n2,2,5,1\n";
  for (std::size_t length = 0; length <= rows.size(); ++length) {
    const auto swaths = events_of(*detections(rows.substr(0, length))).swaths;
    EXPECT_LE(swaths.size(), 2u);
    EXPECT_GE(swaths.size(), length >= 8 ? 1u : 0u) << length;
  }
}

TEST(FanTrack, ThetaIsTheHeadingOfTheCompassAndYIsNorth) {
  const auto track = open_satellite_track(
      text_stream("time,x,y,theta\n1,3,4,1.5707963268\n2,,4,0\n0.5,3,4,0\n3,3,5,0\n"), "track.csv", {});
  const auto fixes = events_of(*track).fixes;
  ASSERT_EQ(fixes.size(), 2u);
  EXPECT_EQ(fixes[0].X_WB.translation, Vector3d(4, 3, 0));
  EXPECT_NEAR(fixes[0].X_WB.rotation.heading().degrees(), 90, 1e-6) << "east";
  EXPECT_DOUBLE_EQ((*fixes[0].covariance)(0, 0), 1) << "input.position_sigma_m";
  EXPECT_EQ(track->report().rejected.at(kBadPose), 1u);
  EXPECT_EQ(track->report().rejected.at(kPoseBackwards), 1u);
}

/// The frame of the dead reckoning is turned by 25 degrees and shifted; after the reader it is not.
TEST(FanTrack, DeadReckoningIsTurnedOntoTheCompassAndStartsAtTheFirstFix) {
  FanRecording recording{.reckoned_share = 1};
  const auto folder = test::scratch_folder() / "basin";
  recording.write(folder);
  InputConfig config;
  config.track = LogTrack::kDeadReckoning;
  const auto source = open_source(folder, config);
  const auto fixes = events_of(*source).fixes;
  const auto places = FanRecording::track();
  ASSERT_EQ(fixes.size(), places.size());
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    EXPECT_LT((fixes[i].X_WB.translation - Vector3d(places[i].north, places[i].east, 0)).norm(), 0.01) << i;
    EXPECT_FALSE(fixes[i].covariance) << "dead reckoning states no accuracy";
  }
  EXPECT_THAT(source->report().details.at("frame of the dead reckoning"), HasSubstr("turned by 25.0 degrees"));
  const auto reference = open_reference(folder, config);
  ASSERT_TRUE(reference) << "the satellite track is left to compare with";
  EXPECT_EQ(events_of(*reference).fixes.size(), places.size());
}

TEST(FanTrack, DeadReckoningNeedsACompassAtItsTime) {
  const auto track = open_dead_reckoning(
      text_stream("time,x,y\n0,0,0\n1,0,0\n2,0,1\n7,0,2\n21,0,3\n"), "reckoned.csv",
      open_satellite_track(text_stream("time,x,y,theta\n1,7,8,0\n3,7,8,0\n20,7,8,0\n"), "track.csv", {}));
  const auto fixes = events_of(*track).fixes;
  ASSERT_EQ(fixes.size(), 2u) << "before the compass, in a gap of 17 s and after it there is no heading";
  EXPECT_LT((fixes[1].X_WB.translation - Vector3d(9, 7, 0)).norm(), 1e-9);
  EXPECT_EQ(track->report().rejected.at(kNoHeading), 3u);
}

TEST(FanFolder, IsRecognisedByWhatItHolds) {
  const auto folder = test::scratch_folder() / "basin";
  FanRecording().write(folder);
  write_table(folder / "README.md", "A basin.\n");
  write_table(folder / "slam.csv", "keyframe_id,time,x,y,theta\n0,1,2,3,4\n");
  const auto source = open_source(folder);
  const FanEvents events = events_of(*source);
  const SourceReport& report = source->report();
  EXPECT_EQ(report.format, "folder of fan detections");
  EXPECT_EQ(events.fixes.size(), FanRecording::track().size());
  EXPECT_EQ(events.swaths.size(), (FanRecording::track().size() + 3) / 4);
  EXPECT_EQ(report.details.at("left out"), "README.md, slam.csv");
  EXPECT_THAT(report.details.at("track"), HasSubstr("where.csv"));
  EXPECT_FALSE(open_reference(folder, {})) << "the satellite track is in use";
  EXPECT_EQ(open_source(folder / "seen.csv")->report().format, "fan detections (CSV)");
}

TEST(FanFolder, SaysWhatItLacks) {
  const auto folder = test::scratch_folder() / "basin";
  FanRecording().write(folder);
  InputConfig reckoned;
  reckoned.track = LogTrack::kDeadReckoning;
  std::filesystem::remove(folder / "reckoned.csv");
  EXPECT_THAT(error_of_folder(folder, reckoned), HasSubstr("holds no dead reckoning"));
  EXPECT_EQ(error_of_folder(folder), "no error");
  write_table(folder / "again.csv", "time,x,y,theta\n");
  EXPECT_THAT(error_of_folder(folder), HasSubstr("two tables of satellite fixes: again.csv and where.csv"));
  std::filesystem::remove(folder / "again.csv");
  std::filesystem::remove(folder / "where.csv");
  EXPECT_THAT(error_of_folder(folder), HasSubstr("input.navigation"));
  InputConfig posed;
  posed.navigation = folder / "poses.csv";
  write_table(posed.navigation, "t_s,north_m,east_m,depth_m,heading_deg\n0,1,2,3,4\n");
  EXPECT_EQ(events_of(*open_source(folder, posed)).fixes.size(), 1u);
}

TEST(FanFolder, OfAracati2017) {
  ISOBATH_NEEDS_DATA(folder, "aracati2017-detections");
  const auto source = open_source(folder);
  const FanEvents events = events_of(*source);
  std::size_t points = 0;
  for (const Swath& swath : events.swaths) points += swath.soundings.size();
  EXPECT_EQ(events.swaths.size(), 382u);
  EXPECT_EQ(points, 42'055u);
  EXPECT_EQ(events.fixes.size(), 10'390u);
  EXPECT_TRUE(source->report().rejected.empty());
}

}  // namespace
}  // namespace isobath
