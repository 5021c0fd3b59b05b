// Logs of robots, autopilots and fish finders as a user meets them: `info` says what they hold and what of it is used,
// `run` makes a map, or says in one sentence why not.
#include <cmath>
#include <tests/app/program.hpp>
#include <tests/io/ros_messages.hpp>
#include <tests/support/data.hpp>

namespace isobath::field_logs {
namespace {

namespace fs = std::filesystem;
using namespace test;
using testing::AllOf;
using testing::HasSubstr;

/// A vehicle 2 m deep that sails north at 1 m/s over a bottom 5 m below it, with a fan that sees a wall 8 m ahead.
RosLog survey(bool cdr, bool with_poses = true) {
  RosLog log{{kProjectedImageTopic, kOdometryTopic, kRangeTopic, kTransformTopic}, {}};
  const double h = std::sqrt(0.5);
  log.messages.push_back({3, 99, transform(cdr, "altimeter", {0, 0, 0, 0, h, 0, h})});
  for (int i = 0; i < 40; ++i) {
    const double t = 100 + 0.5 * i;
    if (with_poses)
      log.messages.push_back({1, t, odometry(cdr, t, {.y = 0.5 * i, .z = -2, .yaw_deg = 90, .speed = 1})});
    log.messages.push_back({0, t, projected_image(cdr, t)});
    RosBytes range(cdr);
    range.header(t, "altimeter").number(std::uint8_t{0}).number(0.2f).number(0.3f).number(50.0f).number(5.0f);
    log.messages.push_back({2, t, range.done()});
  }
  return log;
}

TEST(FieldLogs, InfoNamesTheTopicsOfABagAndTheirUse) {
  const fs::path bag = write(scratch_folder() / "dive.bag", ros1_bag(survey(false), "bz2"));
  const ProgramResult result = isobath({"info", bag.string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("dive.bag: ROS 1 bag"),
                    HasSubstr("marine_acoustic_msgs/ProjectedSonarImage, 40 messages, used as sonar images"),
                    HasSubstr("sensor_msgs/Range, 40 messages, used as ranges"),
                    HasSubstr("nav_msgs/Odometry, 40 messages, used as poses")));
}

TEST(FieldLogs, RunMapsEachKindOfBagAlike) {
  const fs::path folder = scratch_folder();
  write(folder / "one.bag", ros1_bag(survey(false), "lz4"));
  write_ros2_database(folder / "two.db3", survey(true), false);
  write_ros_mcap(folder / "two.mcap", survey(true), true);
  for (const char* name : {"one.bag", "two.db3", "two.mcap"}) {
    const fs::path out = folder / (std::string(name) + ".out");
    const ProgramResult result = isobath_run(folder / name, out);
    ASSERT_EQ(result.exit_code, 0) << name << result.err;
    const auto manifest = json_of(out / "manifest.json");
    EXPECT_EQ(manifest["counts"]["pings"], 40) << name;
    EXPECT_EQ(manifest["counts"]["ranges"], 40) << name;
    EXPECT_EQ(manifest["counts"]["navigation"], 40) << name;
    EXPECT_TRUE(fs::exists(out / "depth.tif")) << name;
  }
  EXPECT_EQ(content_of(folder / "one.bag.out" / "depth.tif"), content_of(folder / "two.mcap.out" / "depth.tif"));
}

TEST(FieldLogs, LogWithoutSonarIsRefusedInOneSentence) {
  RosLog log{{kOdometryTopic}, {}};
  for (int i = 0; i < 5; ++i) log.messages.push_back({0, 100.0 + i, odometry(false, 100.0 + i, {})});
  const fs::path folder = scratch_folder();
  const ProgramResult result =
      isobath({"run", write(folder / "poses.bag", ros1_bag(log)).string(), "--out", (folder / "out").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("poses.bag: no ping, range or sounding of the input could be used"));
}

TEST(FieldLogs, RiverOfAFishFinderBecomesADepthMap) {
  ISOBATH_NEEDS_DATA(data, "humminbird-river");
  const fs::path out = scratch_folder() / "river";
  const ProgramResult result = isobath_run(data / "B000.SON", out);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(json_of(out / "manifest.json")["counts"]["ranges"], 1726);
  EXPECT_TRUE(fs::exists(out / "depth.tif"));
}

TEST(FieldLogs, TelemetryWithoutASonarIsRefusedAndGivesPosesToAnotherLog) {
  ISOBATH_NEEDS_DATA(data, "bluerov2-logs");
  const fs::path folder = scratch_folder(), tlog = data / "2023-05-04-small.tlog";
  const ProgramResult alone = isobath({"run", tlog.string(), "--out", (folder / "alone").string()});
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.err, HasSubstr("no ping, range or sounding of the input could be used"));
  RosLog images{{kProjectedImageTopic}, {}};
  const double begin = 1683220560;  // 2023-05-04T17:16:00Z, within the telemetry
  for (int i = 0; i < 10; ++i) images.messages.push_back({0, begin + i, projected_image(false, begin + i)});
  const ProgramResult both = isobath_run(write(folder / "images.bag", ros1_bag(images)), folder / "both",
                                         {"--set", "input.navigation=" + tlog.string()});
  ASSERT_EQ(both.exit_code, 0) << both.err;
  const auto manifest = json_of(folder / "both" / "manifest.json");
  EXPECT_EQ(manifest["counts"]["pings"], 10);
  EXPECT_GT(manifest["counts"]["navigation"], 5000);
}

}  // namespace
}  // namespace isobath::field_logs
