// Logs of ROS that Isobath writes: each event comes back bit for bit from each kind of file, and without the records of
// the native log as exactly as the messages of ROS are. The readers here are our own; tests/io/ros_conformance has
// those of others.
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/io/open_source.hpp>
#include <isobath/io/ros/ros1_bag.hpp>
#include <isobath/io/ros/ros2_database.hpp>
#include <isobath/io/ros/ros_log_writer.hpp>
#include <isobath/io/ros/ros_mcap.hpp>
#include <tests/io/ros_messages.hpp>
#include <tests/io/sample_events.hpp>
#include <tests/support/data.hpp>

namespace isobath::ros_log_writer {
namespace {

using test::drain;
using testing::HasSubstr;

struct Kind {
  const char* file;
  std::unique_ptr<RosRecorder> (*record)(const std::filesystem::path&);
};
constexpr Kind kKinds[] = {
    {"dive.bag", record_ros1_bag}, {"dive.db3", record_ros2_database}, {"dive.mcap", record_ros2_mcap}};

/// Events of every kind, 20 ms apart, from `first` on.
std::vector<Event> events_in_time(int count, Time first) {
  std::vector<Event> events = test::sample_events(count, 7);
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Time time = first + std::chrono::milliseconds(20 * i) + std::chrono::nanoseconds(i);
    std::visit([&](auto& e) { e.time = time; }, events[i]);
  }
  return events;
}

class RosLogs : public testing::Test {
 protected:
  void written(const Kind& kind, const std::vector<Event>& events, bool records = true) {
    const std::filesystem::path file = folder_ / kind.file;
    const auto bag = kind.record(file);
    RosLogOptions options;
    options.records = records;
    RosLogWriter writer(*bag, options);
    writer.set_origin({60.25, 10.5});
    for (const Event& event : events) writer.write(event);
    bag->close();
    left_out_ = writer.left_out();
    records_only_ = writer.records_only();
    topics_ = bag->topics();
  }
  /// Writes events, and returns what our reader makes of them.
  std::vector<Event> there_and_back(const Kind& kind, const std::vector<Event>& events, bool records = true) {
    written(kind, events, records);
    source_ = open_source(folder_ / kind.file, {});
    return drain(*source_);
  }
  [[nodiscard]] std::uint64_t messages_of(const std::string& topic) const {
    for (const RecordedTopic& t : topics_) {
      if (t.name == topic) return t.messages;
    }
    return 0;
  }

  std::filesystem::path folder_ = test::scratch_folder();
  std::map<std::string, std::uint64_t> left_out_, records_only_;
  std::vector<RecordedTopic> topics_;
  std::unique_ptr<Source> source_;
};

TEST_F(RosLogs, EveryEventComesBackBitForBitFromEachKindOfFile) {
  const std::vector<Event> events = events_in_time(400, Time{std::chrono::seconds(1'700'000'000)});
  for (const Kind& kind : kKinds) {
    const std::vector<Event> back = there_and_back(kind, events);
    ASSERT_EQ(back.size(), events.size()) << kind.file;
    for (std::size_t i = 0; i < events.size(); ++i)
      ASSERT_TRUE(test::same(events[i], back[i])) << kind.file << " " << i;
    EXPECT_TRUE(source_->report().rejected.empty()) << kind.file;
    EXPECT_EQ(source_->report().bytes_skipped, 0u) << kind.file;
    ASSERT_TRUE(source_->report().origin.has_value()) << kind.file;
    EXPECT_EQ(*source_->report().origin, (GeoOrigin{60.25, 10.5})) << kind.file;
  }
}

// Headers of ROS take the time 0 for "not set".
TEST_F(RosLogs, TimesFromZeroOnComeBack) {
  const std::vector<Event> events = events_in_time(20, Time{});
  for (const Kind& kind : kKinds) {
    const std::vector<Event> back = there_and_back(kind, events);
    ASSERT_EQ(back.size(), events.size()) << kind.file;
    for (std::size_t i = 0; i < events.size(); ++i)
      ASSERT_TRUE(test::same(events[i], back[i])) << kind.file << " " << i;
  }
}

TEST_F(RosLogs, WhatRosHasNoMessageForIsNamedAndWithoutRecordsLeftOut) {
  const Time time{std::chrono::seconds(100)};
  const std::vector<Event> events{OperatorFrame{time, {1}}, PassiveBearing{.time = time, .bearing = {}, .sigma = {}}};
  for (const Kind& kind : kKinds) {
    written(kind, events);
    EXPECT_EQ(records_only_["frames of an operator's link"], 1u);
    EXPECT_EQ(records_only_["passive bearings"], 1u);
    EXPECT_TRUE(left_out_.empty());
    written(kind, events, false);
    EXPECT_EQ(left_out_["frames of an operator's link"], 1u);
    EXPECT_EQ(left_out_["passive bearings"], 1u);
    EXPECT_TRUE(records_only_.empty());
  }
}

TEST_F(RosLogs, TimesThatAHeaderCannotStateAreLeftOut) {
  for (const Kind& kind : kKinds) {
    const bool bag = kind.record == record_ros1_bag;
    const Health before{Time{std::chrono::seconds(-1)}, "sonar"};
    const Health in_2039{Time{std::chrono::seconds(2'180'000'000)}, "sonar"};
    written(kind, {before, in_2039});
    EXPECT_EQ(left_out_["time that the headers of ROS cannot state"], bag ? 1u : 2u) << kind.file;
  }
}

/// A fan that looks ahead from under the bow, an altimeter, soundings, and a vehicle that turns.
std::vector<Event> dive() {
  std::vector<Event> events;
  const Rotation down = Rotation::from_heading_pitch_roll({}, Angle::degrees(-90), {});
  for (int i = 0; i < 20; ++i) {
    const Time time{std::chrono::milliseconds(100'000 + 100 * i)};
    Navigation fix;
    fix.time = time;
    fix.X_WB = {Rotation::from_heading_pitch_roll(Angle::degrees(10.0 * i), Angle::degrees(3), Angle::degrees(-2)),
                Eigen::Vector3d(1.25 * i, -0.3, 4.5)};
    fix.v_WB = fix.X_WB.rotation * Eigen::Vector3d(1, 0.1, -0.05);
    fix.covariance = Eigen::Matrix<double, 6, 6>::Identity() * 0.04;
    (*fix.covariance)(0, 1) = (*fix.covariance)(1, 0) = 0.01;
    (*fix.covariance)(5, 0) = (*fix.covariance)(0, 5) = 0.002;
    events.emplace_back(fix);
    std::vector<std::uint8_t> samples(5 * 30);
    for (std::size_t k = 0; k < samples.size(); ++k) samples[k] = static_cast<std::uint8_t>(k + i);
    const auto fan = even_fan(5, Angle::degrees(40), Angle::degrees(8), Angle::degrees(15));
    Ping ping = make_ping(time, fan, {0.5, 0.1, 30}, samples);
    ping.X_BS = {Rotation::from_heading_pitch_roll(Angle::degrees(5), Angle::degrees(-10), {}), {1.5, 0.2, 0.3}};
    ping.sound_speed = 1487.25;
    events.emplace_back(ping);
    RangeReading altitude{time, 3.25 + i, 50, Angle::degrees(6), {down, {-0.5, 0, 0.2}}, 1};
    if (i == 7) altitude.range_m.reset();
    events.emplace_back(altitude);
  }
  return events;
}

TEST_F(RosLogs, WithoutRecordsTheMessagesOfRosGiveTheSameEventsAsFarAsTheyHoldThem) {
  const std::vector<Event> events = dive();
  for (const Kind& kind : kKinds) {
    const std::vector<Event> back = there_and_back(kind, events, false);
    ASSERT_EQ(back.size(), events.size()) << kind.file;
    for (std::size_t i = 0; i < events.size(); ++i) {
      ASSERT_EQ(back[i].index(), events[i].index()) << kind.file << i;
      EXPECT_EQ(time_of(back[i]), time_of(events[i]));
      if (const auto* fix = std::get_if<Navigation>(&events[i])) {
        const auto& is = std::get<Navigation>(back[i]);
        EXPECT_TRUE(is.X_WB.translation.isApprox(fix->X_WB.translation, 1e-15));
        EXPECT_LT((is.X_WB.rotation.inverse() * fix->X_WB.rotation).log().norm(), 1e-14);
        EXPECT_LT((*is.v_WB - *fix->v_WB).norm(), 1e-14);
        EXPECT_LT((*is.covariance - *fix->covariance).norm(), 1e-14);
      } else if (const auto* ping = std::get_if<Ping>(&events[i])) {
        const auto& is = std::get<Ping>(back[i]);
        EXPECT_NEAR(is.window.start_m, ping->window.start_m, 1e-6);
        EXPECT_NEAR(is.window.bin_m, ping->window.bin_m, 1e-7);
        EXPECT_LT((is.X_BS.translation - ping->X_BS.translation).norm(), 1e-14);
        EXPECT_LT((is.X_BS.rotation.inverse() * ping->X_BS.rotation).log().norm(), 1e-14);
        EXPECT_EQ(is.sound_speed, ping->sound_speed);
        for (int b = 0; b < 5; ++b) {
          EXPECT_NEAR(is.fan->azimuth[b].radians(), ping->fan->azimuth[b].radians(), 1e-15);
          EXPECT_NEAR(is.fan->width[b].radians(), ping->fan->width[b].radians(), 1e-8);
          EXPECT_EQ(test::beam(is, b), test::beam(*ping, b));
        }
      } else {
        const auto &is = std::get<RangeReading>(back[i]), &was = std::get<RangeReading>(events[i]);
        EXPECT_EQ(is.range_m, was.range_m);
        EXPECT_EQ(is.max_range_m, was.max_range_m);
        EXPECT_LT((is.X_BS.rotation.inverse() * was.X_BS.rotation).log().norm(), 1e-14);
      }
    }
  }
}

TEST_F(RosLogs, SoundingsAreACloudInTheFrameOfTheVehicle) {
  Swath swath;
  swath.time = Time{std::chrono::seconds(100)};
  swath.soundings = {{{4, -3, 8}, 9.5F, 0, 3, Sounding::Kind::kBottom}, {{4, 3, 8.5F}, 9.6F, 0, 4}};
  const auto back = std::get<Swath>(there_and_back(kKinds[0], {swath}, false).at(0));
  ASSERT_EQ(back.soundings.size(), 2u);
  EXPECT_EQ(back.soundings[0].point, swath.soundings[0].point);
  EXPECT_EQ(back.soundings[1].point, swath.soundings[1].point);
  EXPECT_EQ(back.soundings[0].kind, Sounding::Kind::kBottom);  // it lies below
}

TEST_F(RosLogs, FixAlsoGivesTheMessagesThatOtherProgramsLookFor) {
  written(kKinds[1], dive());
  for (const char* topic : {"/odometry", "/tf", "/velocity", "/imu", "/pressure", "/fix", "/isobath/navigation"}) {
    EXPECT_EQ(messages_of(topic), 20u) << topic;
  }
  EXPECT_EQ(messages_of("/tf_static"), 2u);  // once for each sensor that appears
  EXPECT_EQ(messages_of("/origin"), 1u);
}

// librosbag_storage gives messages of one time by the order of their topics: an image would come before its record.
TEST_F(RosLogs, TimesOfRecordingRiseSoThatToolsThatSortKeepTheOrder) {
  written(kKinds[0], dive());
  const auto bag = open_ros1_recording(std::make_unique<std::ifstream>(folder_ / kKinds[0].file, std::ios::binary), "");
  Time last{};
  std::size_t messages = 0;
  for (auto record = bag->next(); record; record = bag->next(), ++messages) {
    EXPECT_GT(record->time, last);
    last = record->time;
  }
  EXPECT_GT(messages, 200u);
  EXPECT_LT(last - time_of(dive().back()), std::chrono::microseconds(1));
}

// A bag that was filtered by a tool of ROS may lack the records, or the images that they belong to.
TEST_F(RosLogs, ImageWithoutItsRecordIsReadAsAnImageOfRos) {
  const auto bag = record_ros1_bag(folder_ / "cut.bag");
  RosLogWriter writer(*bag, {});
  const std::vector<Event> events = dive();
  writer.write(events[0]);
  writer.write(events[1]);
  const std::vector<std::uint8_t> record = {1, 2, 3};
  const auto other = bag->add_topic({"/isobath/ping", "isobath_msgs/Ping", false, 0});
  bag->write(other, time_of(events[3]), record);
  bag->close();
  source_ = open_source(folder_ / "cut.bag", {});
  EXPECT_EQ(drain(*source_).size(), 2u);
  EXPECT_EQ(source_->report().rejected.size(), 1u);
}

// wiki.ros.org and the headers of Debian's message packages give these.
TEST(RosChecksums, AreThoseOfRos) {
  EXPECT_EQ(ros1_checksum("std_msgs/Header"), "2176decaecbce78abc3b96ef049fabed");
  EXPECT_EQ(ros1_checksum("sensor_msgs/Range"), "c005c34273dc426c67a020a87bc24148");
  EXPECT_EQ(ros1_checksum("sensor_msgs/PointCloud2"), "1158d486dd51d683ce2f1be655c3c181");
  EXPECT_EQ(ros1_checksum("sensor_msgs/Imu"), "6a62c6daae103f4ff57a132d6f95cec2");
  EXPECT_EQ(ros1_checksum("sensor_msgs/NavSatFix"), "2d3a8cd499b9b4a0249fb98fd05cfa48");
  EXPECT_EQ(ros1_checksum("sensor_msgs/FluidPressure"), "804dc5cea1c5306d6a2eb80b9833befe");
  EXPECT_EQ(ros1_checksum("nav_msgs/Odometry"), "cd5e73d190d741a2f92e81eda573aca7");
  EXPECT_EQ(ros1_checksum("tf2_msgs/TFMessage"), "94810edda583a504dfda3829e70d7eec");
  EXPECT_EQ(ros1_checksum("diagnostic_msgs/DiagnosticArray"), "60810da900de1dd6ddd437c3503511da");
  EXPECT_EQ(ros1_checksum("geometry_msgs/TwistWithCovarianceStamped"), "8927a1a12fb2607ceea095b2dc440a96");
  EXPECT_EQ(ros1_checksum("marine_acoustic_msgs/ProjectedSonarImage"), "c72fc8e29ab227a547720a36666022fd");
}

TEST(RosWriting, OneSequenceOfCallsGivesBothEncodings) {
  for (const bool cdr : {false, true}) {
    const RosEncoding encoding = cdr ? RosEncoding::kCdr : RosEncoding::kRos1;
    RosWriter writer(*RosDefinition::parse("sensor_msgs/Range", known_ros_definition("sensor_msgs/Range", encoding)),
                     encoding);
    std::span<const std::uint8_t> bytes;
    for (int i = 0; i < 8; ++i) {  // the hand-made header has the number 7
      writer.begin().header(Time{std::chrono::milliseconds(12'500)}, "sonar").numbers({0, 0.5, 0.3, 50, 2.345});
      bytes = writer.done();
    }
    test::RosBytes by_hand(cdr);
    by_hand.header(12.5, "sonar").number(std::uint8_t{0}).number(0.5F).number(0.3F).number(50.0F).number(2.345F);
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), by_hand.done());
  }
}

TEST(RosWriting, RecodedMessagesAreTheSameInBothDirectionsAndCutOnesAreRefused) {
  const std::string type = "nav_msgs/Odometry";
  const auto definition = *RosDefinition::parse(type, known_ros_definition(type, RosEncoding::kCdr));
  const std::string cdr = test::odometry(true, 12.5, {.x = 1, .y = 2, .z = 3, .yaw_deg = 4});
  const auto packed = recoded(definition, bytes_of(cdr), RosEncoding::kCdr);
  ASSERT_TRUE(packed.has_value());
  const std::string_view ros1(reinterpret_cast<const char*>(packed->data()), packed->size());
  const RosMessage message(definition, bytes_of(ros1), RosEncoding::kRos1);
  EXPECT_EQ(message["pose"]["pose"]["position"]["z"].number(), 3);
  EXPECT_EQ(message["child_frame_id"].text(), "base_link");
  const auto again = recoded(definition, bytes_of(ros1), RosEncoding::kRos1);
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(std::string(again->begin(), again->end()), cdr);
  for (std::size_t cut = 0; cut < ros1.size(); ++cut) {
    EXPECT_FALSE(recoded(definition, bytes_of(ros1.substr(0, cut)), RosEncoding::kRos1).has_value()) << cut;
  }
  for (std::size_t cut = 0; cut < cdr.size(); ++cut) {
    EXPECT_FALSE(recoded(definition, bytes_of(cdr.substr(0, cut)), RosEncoding::kCdr).has_value()) << cut;
  }
}

}  // namespace
}  // namespace isobath::ros_log_writer
