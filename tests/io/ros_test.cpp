// Logs of ROS: definitions, both encodings against messages that other readers wrote, bags of ROS 1 and ROS 2 and MCAP,
// damage, and what their messages become.
#include <algorithm>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/io/open_source.hpp>
#include <isobath/io/ros/ros1_bag.hpp>
#include <sstream>
#include <tests/io/ros_messages.hpp>
#include <tests/support/data.hpp>

namespace isobath::ros_logs {
namespace {

using test::drain;
using test::hex;
using test::RosBytes;
using test::RosLog;
using testing::ElementsAre;
using testing::HasSubstr;

class Ros : public test::RosLogTest {};

std::unique_ptr<Source> in_memory_bag(const std::string& bytes) {
  return ros_events(open_ros1_recording(std::make_unique<std::istringstream>(bytes), "bag in memory"), {});
}

TEST(RosDefinitions, FieldsConstantsArraysAndNestedTypesAreRead) {
  const auto d =
      RosDefinition::parse("a_msgs/msg/Root",
                           "# a comment\nuint8 CONSTANT=3 # of no size\nstring NAME=a=b\nHeader header\nInner[] "
                           "list\nfloat64[36] fixed\nuint8[<=5] bounded\nstring<=10 word 'x'\nint32 n 5\n" +
                               test::kRosRule + "a_msgs/Inner\nfloat32 x\n" + test::kRosHeader1);
  ASSERT_TRUE(d);
  const RosType& root = d->types()[0];
  std::vector<std::string> names;
  for (const RosField& f : root.fields) names.push_back(f.name);
  EXPECT_THAT(names, ElementsAre("header", "list", "fixed", "bounded", "word", "n"));
  EXPECT_EQ(root.fields[2].count, 36u);
  EXPECT_EQ(root.fields[3].array, RosField::Array::kSequence);
  EXPECT_EQ(root.min_bytes, (4u + 8 + 4) + 4 + 36 * 8 + 4 + 4 + 4);
}

TEST(RosDefinitions, WhatIsNoDefinitionIsRefused) {
  for (const char* text : {"Unknown x", "float32", "Root again", "float32[-1] x", "float32[99999999999] x", "wstring x",
                           "float32[ x", "a/b/c x"}) {
    EXPECT_FALSE(RosDefinition::parse("a_msgs/Root", text)) << text;
  }
  EXPECT_TRUE(RosDefinition::parse("std_msgs/Empty", ""));
}

TEST(RosDefinitions, EmptyTypesNestedDeepTakeNoTime) {
  std::string text = "T0[1000000] a\nT0 b\nuint8 x\n";
  for (int i = 0; i < 60; ++i) {
    text += test::kRosRule + "a_msgs/T" + std::to_string(i) + "\n";
    text += "T" + std::to_string(i + 1) + "[9999] a\nT" + std::to_string(i + 1) + " b\n";
  }
  text += test::kRosRule + "a_msgs/T60\n";
  const auto d = RosDefinition::parse("a_msgs/Root", text);
  ASSERT_TRUE(d);
  const std::string data = "\x07";
  const RosMessage message(*d, bytes_of(data), RosEncoding::kRos1);
  EXPECT_EQ(message["x"].number(), 7);
  EXPECT_TRUE(message.ok());
}

// A range and a pressure that librosbag and @foxglove/rosmsg2-serialization read as these values.
TEST(RosMessages, BothEncodingsReadMessagesThatOthersWrote) {
  const std::string range =
      hex("07 00 00 00 00 10 5E 5F 00 65 CD 1D 05 00 00 00 73 6F 6E 61 72 00 00 00 00 3F 9A 99 99 3E "
          "00 00 48 42 7B 14 16 40");
  const auto ranges = RosDefinition::parse("sensor_msgs/Range", test::kRangeTopic.definition + test::kRosHeader1);
  const RosMessage one(*ranges, bytes_of(range), RosEncoding::kRos1);
  EXPECT_EQ(to_seconds(*one["header"]["stamp"].time()), 1600000000.5);
  EXPECT_EQ(one["header"]["frame_id"].text(), "sonar");
  EXPECT_EQ(one["range"].number(), 2.345f);
  EXPECT_TRUE(one.ok());
  const std::string pressure =
      hex("00 01 00 00 00 10 5E 5F 00 65 CD 1D 05 00 00 00 62 61 72 6F 00 00x7 00 00 00 00 E8 78 02 "
          "41 00 00 00 00 00 00 10 40");
  const auto pressures = RosDefinition::parse("sensor_msgs/FluidPressure",
                                              known_ros_definition("sensor_msgs/FluidPressure", RosEncoding::kCdr));
  const RosMessage two(*pressures, bytes_of(pressure), RosEncoding::kCdr);
  EXPECT_EQ(two["fluid_pressure"].number(), 151325.0);
  EXPECT_EQ(two["variance"].number(), 4);
  EXPECT_EQ(two["header"]["frame_id"].text(), "baro");
  EXPECT_TRUE(two.ok());
}

TEST(RosMessages, FieldsThatAreMissingOrCutOffMakeAMessageBad) {
  const auto d = RosDefinition::parse("sensor_msgs/Range", test::kRangeTopic.definition + test::kRosHeader1);
  const std::string whole = test::range_message(false, 5, 2);
  const RosMessage lacks(*d, bytes_of(whole), RosEncoding::kRos1);
  (void)lacks["variance"].number();
  EXPECT_EQ(lacks.missing(), "variance");
  for (std::size_t cut = 0; cut < whole.size(); ++cut) {
    const std::string part = whole.substr(0, cut);
    const RosMessage message(*d, bytes_of(part), RosEncoding::kRos1);
    (void)message["range"].number();
    EXPECT_FALSE(message.ok()) << cut;
  }
  const std::string parameters("\0\2\0\0", 4);
  EXPECT_FALSE(RosMessage(*d, bytes_of(parameters), RosEncoding::kCdr).ok());
}

TEST(RosMessages, EveryTypeThatIsKnownWithoutItsDefinitionCanBeParsed) {
  for (const char* type : {"sensor_msgs/LaserScan", "sensor_msgs/PointCloud2", "sensor_msgs/Range", "sensor_msgs/Image",
                           "sensor_msgs/Imu", "sensor_msgs/NavSatFix", "sensor_msgs/FluidPressure", "nav_msgs/Odometry",
                           "geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped", "tf2_msgs/TFMessage",
                           "marine_acoustic_msgs/ProjectedSonarImage", "marine_acoustic_msgs/RawSonarImage",
                           "marine_acoustic_msgs/SonarRanges", "marine_acoustic_msgs/SonarDetections"}) {
    EXPECT_TRUE(RosDefinition::parse(type, known_ros_definition(type, RosEncoding::kCdr))) << type;
  }
}

TEST_F(Ros, BagsOfEveryCompressionGiveFansAndPosesInOurFrames) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const auto source = opened(ros1_bag(test::small_dive(false), compression));
    EXPECT_EQ(source->report().format, "ROS 1 bag");
    const auto events = drain(*source);
    ASSERT_EQ(events.size(), 10u) << compression;
    const auto& fix = std::get<Navigation>(events[2]);
    EXPECT_EQ(to_seconds(fix.time), 101);
    EXPECT_TRUE(fix.X_WB.translation.isApprox(Eigen::Vector3d(2, 1, 3))) << "north, east, down of east, north, up";
    EXPECT_NEAR(fix.X_WB.rotation.heading().degrees(), 0, 1e-9) << "90 degrees from east to port is north";
    EXPECT_TRUE(fix.v_WB->isApprox(Eigen::Vector3d(1, 0, 0)));
    EXPECT_NEAR((*fix.covariance)(0, 0), 0.08, 1e-12) << "north is the second of east, north, up";
    EXPECT_NEAR((*fix.covariance)(5, 5), 0.03, 1e-12);
    const auto& ping = std::get<Ping>(events[3]);
    EXPECT_NEAR(to_seconds(ping.time), 101.1, 1e-6) << "of the header, not of the recording";
    EXPECT_NEAR(ping.fan->azimuth[2].degrees(), 20, 1e-9);
    EXPECT_NEAR(ping.fan->width[0].radians(), 0.02, 1e-7);
    EXPECT_NEAR(ping.fan->height.radians(), 0.35, 1e-7);
    EXPECT_EQ(ping.window.start_m, 2);
    EXPECT_EQ(ping.window.bin_m, 1);
    EXPECT_EQ(ping.sound_speed, 1480);
    EXPECT_THAT(test::beam(ping, 0), ElementsAre(1, 4)) << "the samples of a range stand together";
    EXPECT_THAT(test::beam(ping, 2), ElementsAre(3, 6));
  }
}

TEST_F(Ros, SamplesOfABeamMayStandTogetherAndAFanMayBeMirrored) {
  InputConfig config;
  config.beam_major = true;
  config.clockwise = false;
  const auto events = events_of(test::kProjectedImageTopic, {test::projected_image(false, 100)}, config);
  ASSERT_EQ(events.size(), 1u);
  const auto& ping = std::get<Ping>(events[0]);
  EXPECT_NEAR(ping.fan->azimuth[0].degrees(), -20, 1e-9);
  EXPECT_THAT(test::beam(ping, 0), ElementsAre(5, 6));
  EXPECT_THAT(test::beam(ping, 2), ElementsAre(1, 2));
}

TEST_F(Ros, Ros2GivesTheSameEventsInEachFile) {
  const auto expected = drain(*opened(ros1_bag(test::small_dive(false))));
  const RosLog two = test::small_dive(true);
  write_ros2_database(folder_ / "iron.db3", two, true);
  write_ros2_database(folder_ / "humble.db3", two, false);
  write_ros_mcap(folder_ / "two.mcap", two, true);
  write_ros_mcap(folder_ / "one.mcap", test::small_dive(false), false);
  const std::vector<std::pair<std::string, std::string>> files{{"iron.db3", "ROS 2 bag (SQLite)"},
                                                               {"humble.db3", "ROS 2 bag (SQLite)"},
                                                               {"two.mcap", "ROS messages in MCAP"},
                                                               {"one.mcap", "ROS messages in MCAP"}};
  for (const auto& [name, format] : files) {
    const auto source = open_source(folder_ / name, {});
    EXPECT_EQ(source->report().format, format);
    EXPECT_EQ(source->report().details.at("/odometry"), "nav_msgs/Odometry, 5 messages, used as poses");
    const auto events = drain(*source);
    ASSERT_EQ(events.size(), expected.size()) << name;
    for (std::size_t i = 0; i < events.size(); ++i)
      EXPECT_TRUE(test::same_samples(events[i], expected[i])) << name << i;
    EXPECT_TRUE(source->report().rejected.empty()) << name;
  }
}

TEST_F(Ros, McapThatWasCutOffIsReadAsFarAsItGoes) {
  write_ros_mcap(folder_ / "whole.mcap", test::small_dive(true, 2000), true);
  std::ifstream whole(folder_ / "whole.mcap", std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(whole)), {});
  const auto source = open_source(write(bytes.substr(0, bytes.size() - 400), "cut.mcap"), {});
  EXPECT_THAT(source->report().details.at("/odometry"), HasSubstr("used as poses"));
  EXPECT_GT(drain(*source).size(), 1000u);
}

TEST_F(Ros, FolderOfARos2BagIsReadAsOneLog) {
  RosLog later = test::small_dive(true);
  for (test::RosMessageBytes& m : later.messages) m.time_s += 10;
  for (std::size_t i = 0; i < later.messages.size(); ++i) {
    const double t = 110.0 + static_cast<double>(i / 2);
    later.messages[i].data = i % 2 == 0 ? test::odometry(true, t, {}) : test::projected_image(true, t + 0.1);
  }
  write_ros2_database(folder_ / "dive_0.db3", test::small_dive(true), true);
  write_ros2_database(folder_ / "dive_1.db3", later, true);
  write("rosbag2_bagfile_information:\n  version: 5\n", "metadata.yaml");
  const auto source = open_source(folder_, {});
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 20u);
  EXPECT_TRUE(std::ranges::is_sorted(events, {}, time_of));
}

TEST_F(Ros, DatabaseThatWasCutOffGivesWhatSqliteCanReadAndSaysSo) {
  write_ros2_database(folder_ / "whole.db3", test::small_dive(true, 300), false);
  std::ifstream whole(folder_ / "whole.db3", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(whole)), {});
  try {
    const auto source = open_source(write(bytes.substr(0, bytes.size() / 2 / 4096 * 4096), "cut.db3"), {});
    EXPECT_LT(drain(*source).size(), 600u);
    EXPECT_FALSE(source->report().rejected.empty());
  } catch (const Error& e) {
    EXPECT_THAT(std::string(e.what()), HasSubstr("is a ROS 2 bag that SQLite cannot read"));
  }
}

TEST_F(Ros, BagThatWasNotClosedIsReadWhole) {
  const auto source = opened(ros1_bag(test::small_dive(false), "lz4", 4, false));
  EXPECT_THAT(source->report().details.at("index"), HasSubstr("was not closed"));
  EXPECT_EQ(source->report().details.at("/sonar/image"),
            "marine_acoustic_msgs/ProjectedSonarImage, 5 messages, used as sonar images");
  EXPECT_EQ(drain(*source).size(), 10u);
}

TEST_F(Ros, BagIsReadUpToTheCut) {
  const RosLog log = test::small_dive(false, 2);
  for (const char* compression : {"none", "bz2"}) {
    const std::string bag = ros1_bag(log, compression, 2);
    std::size_t before = 0;
    for (std::size_t cut = 4117; cut < bag.size(); cut += compression[0] == 'n' ? 17 : 5) {
      const auto source = in_memory_bag(bag.substr(0, cut));
      const std::size_t count = drain(*source).size();
      EXPECT_GE(count + 1, before) << cut;  // an index that is cut counts nothing
      before = count;
      EXPECT_LE(source->report().bytes_skipped, cut);
    }
    EXPECT_EQ(before, 4u);
  }
}

TEST_F(Ros, DamageCostsTheChunkThatItIsIn) {
  const std::string bag = ros1_bag(test::small_dive(false, 6), "lz4", 2);
  std::size_t chunk = bag.find("compression=lz4");
  chunk = bag.find("compression=lz4", chunk + 1);  // the second of six
  for (const std::size_t at : {chunk + 100, chunk - 8}) {
    std::string damaged = bag;
    for (std::size_t i = 0; i < 8; ++i) damaged[at + i] = static_cast<char>(0xEE + i);
    const auto source = in_memory_bag(damaged);
    EXPECT_EQ(drain(*source).size(), 10u);
    EXPECT_EQ(source->report().damages.size(), 1u);
  }
}

TEST_F(Ros, SizesThatLieAreRefused) {
  const std::string bag = ros1_bag(test::small_dive(false, 2), "bz2", 4);
  const std::size_t size = bag.find("size=") + 5;
  for (const char first : {'\1', '\xff'}) {
    std::string lies = bag;
    lies[size + (first == '\1' ? 0 : 3)] = first;
    const auto source = in_memory_bag(lies);
    EXPECT_TRUE(drain(*source).empty());
    EXPECT_EQ(source->report().damages.size(), 1u);
  }
}

TEST_F(Ros, BagsThatCannotBeReadAreRefusedInOneLine) {
  const auto problem = [&](const std::string& bytes) -> std::string {
    try {
      opened(bytes);
    } catch (const Error& e) {
      return e.what();
    }
    return "opened";
  };
  EXPECT_THAT(problem("#ROSBAG V1.2\n" + std::string(100, ' ')), HasSubstr("format 1"));
  EXPECT_THAT(problem("#ROSBAG V2.0\n" + std::string(100, '\xff')), HasSubstr("impossible"));
  const std::string fields = test::bag_field("op", "\x03") +
                             test::bag_field("index_pos", test::little(std::uint64_t{0})) +
                             test::bag_field("encryptor", "rosbag/AesCbcEncryptor");
  EXPECT_THAT(problem("#ROSBAG V2.0\n" + test::bag_record(fields, std::string(1000, ' '))), HasSubstr("encrypted"));
  EXPECT_THAT(problem("SQLite format 3" + std::string(200, '\0') + "CREATE TABLE topics(id)CREATE TABLE messages(id)"),
              HasSubstr("is a ROS 2 bag that SQLite cannot read"));
}

TEST_F(Ros, OfTwoTopicsOfAKindTheOneWithMoreMessagesIsReadUnlessOneIsNamed) {
  RosLog log = test::small_dive(false);
  test::RosTopicText other = test::kProjectedImageTopic;
  other.topic = "/a/image";
  log.topics.push_back(other);
  log.topics.push_back({"/rosout", "rosgraph_msgs/Log", "string msg\n"});
  log.messages.push_back({2, 105, test::projected_image(false, 105)});
  const auto source = opened(ros1_bag(log));
  EXPECT_EQ(source->report().details.at("/a/image"),
            "marine_acoustic_msgs/ProjectedSonarImage, 1 message, not used: name it in input.topics to use it");
  EXPECT_EQ(source->report().details.at("/rosout"), "rosgraph_msgs/Log, 0 messages, not used: no reader for this type");
  EXPECT_EQ(drain(*source).size(), 10u);
  InputConfig config;
  config.topics = "/a/*";
  EXPECT_EQ(drain(*opened(ros1_bag(log), config)).size(), 6u) << "poses as before";
  config.topics = "/a/*, /sonar/*";
  EXPECT_EQ(drain(*opened(ros1_bag(log), config)).size(), 11u);
}

}  // namespace
}  // namespace isobath::ros_logs
