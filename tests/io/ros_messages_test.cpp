// What messages of ROS become: fans, echoes, scans, points, ranges, poses, and the mounting of sensors.
#include <gmock/gmock.h>
#include <isobath/io/frames/gray_image.hpp>
#include <isobath/io/open_source.hpp>
#include <limits>
#include <tests/io/ros_messages.hpp>
#include <tests/support/data.hpp>

namespace isobath::ros_messages {
namespace {

using test::drain;
using test::hex;
using test::RosBytes;
using test::RosLog;
using testing::ElementsAre;
using testing::HasSubstr;

class RosEvents : public test::RosLogTest {};

TEST_F(RosEvents, MountingComesFromTheTransformsUnlessASettingStatesIt) {
  RosLog log{{test::kTransformTopic, test::kRangeTopic}, {}};
  // 1 m ahead, 0.5 m to port, 0.2 m up; pitched by 90 degrees about the port axis: x looks down.
  const double h = std::sqrt(0.5);
  log.messages.push_back({0, 1, test::transform(false, "sonar", {1, 0.5, 0.2, 0, h, 0, h})});
  log.messages.push_back({1, 100, test::range_message(false, 100, 2)});
  const auto events = drain(*opened(ros1_bag(log)));
  ASSERT_EQ(events.size(), 1u);
  const auto& reading = std::get<RangeReading>(events[0]);
  EXPECT_TRUE(reading.X_BS.translation.isApprox(Eigen::Vector3d(1, -0.5, -0.2)));
  EXPECT_TRUE((reading.X_BS.rotation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
  EXPECT_EQ(*reading.range_m, 2);
  EXPECT_NEAR(reading.width.radians(), 0.5, 1e-7);
  InputConfig config;
  config.mount_heading = Angle::degrees(90);
  const auto declared = std::get<RangeReading>(drain(*opened(ros1_bag(log), config)).at(0));
  EXPECT_TRUE((declared.X_BS.rotation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-9));
}

TEST_F(RosEvents, RangeOfInfinityIsNoEchoAndMinusInfinityTouches) {
  const float infinity = std::numeric_limits<float>::infinity();
  const auto events = events_of(test::kRangeTopic,
                                {test::range_message(false, 100, infinity), test::range_message(false, 101, -infinity),
                                 test::range_message(false, 102, std::nanf(""))});
  ASSERT_EQ(events.size(), 2u);
  EXPECT_FALSE(std::get<RangeReading>(events[0]).range_m);
  EXPECT_NEAR(*std::get<RangeReading>(events[1]).range_m, 0.3, 1e-6);
  EXPECT_EQ(source_->report().rejected.at("range that is not a number or has no limit"), 1u);
}

TEST_F(RosEvents, OlderSonarImagesAreReadWithFallingBearingsAndWideSamples) {
  const test::RosTopicText topic{"/image", "imaging_sonar_msgs/SonarImage",
                                 "Header header\nfloat32 frequency\nfloat32 azimuth_beamwidth\nfloat32 "
                                 "elevation_beamwidth\nfloat32[] azimuth_angles\nfloat32[] elevation_angles\nfloat32[] "
                                 "ranges\nbool is_bigendian\nuint8 data_size\nuint8[] intensities\n"};
  const auto image = [&](std::uint8_t big, const std::string& samples) {
    RosBytes m(false);
    m.header(100, "sonar").number(1e6f).number(0.01f).number(0.3f).numbers(std::vector<float>{0.2f, 0.0f});
    m.numbers(std::vector<float>{}).numbers(std::vector<float>{0.25f, 0.75f}).number(big).number(std::uint8_t{2});
    return m.bytes(samples).done();
  };
  const auto events = events_of(topic, {image(0, hex("01 00 02 00 03 00 04 01")),
                                        image(1, hex("00 01 00 02 00 03 01 04")), image(0, hex("01 00"))});
  ASSERT_EQ(events.size(), 2u);
  for (const Event& event : events) {
    const auto& ping = std::get<Ping>(event);
    EXPECT_EQ(ping.fan->azimuth[0].radians(), 0);
    EXPECT_THAT(test::beam(ping, 0), ElementsAre(2, 260)) << "the last column looks to port";
    EXPECT_THAT(test::beam(ping, 1), ElementsAre(1, 3));
    EXPECT_EQ(ping.full_scale, 65535);
  }
  EXPECT_EQ(source_->report().rejected.at("sonar image whose size disagrees with its samples"), 1u);
}

TEST_F(RosEvents, EchoesOfAPing360ArePingsOfOneBeam) {
  const test::RosTopicText topic{"/echo", "ping360_sonar_msgs/SonarEcho",
                                 "Header header\nfloat32 angle\nuint8 gain\nuint16 number_of_samples\nuint16 "
                                 "transmit_frequency\nuint16 speed_of_sound\nuint8 range\nuint8[] intensities\n"};
  RosBytes m(false);
  m.header(100, "sonar").number(0.5f).number(std::uint8_t{1}).number(std::uint16_t{4}).number(std::uint16_t{740});
  m.number(std::uint16_t{1490}).number(std::uint8_t{2}).bytes("\5\6\7\x08");
  const auto events = events_of(topic, {m.done()});
  ASSERT_EQ(events.size(), 1u);
  const auto& ping = std::get<Ping>(events[0]);
  EXPECT_NEAR(ping.fan->azimuth[0].radians(), 0.5, 1e-6);
  EXPECT_EQ(ping.window.bin_m, 0.5);
  EXPECT_EQ(ping.sound_speed, 1490);
  EXPECT_THAT(test::beam(ping), ElementsAre(5, 6, 7, 8));
}

TEST_F(RosEvents, LaserScanCountsToPort) {
  const test::RosTopicText topic{
      "/scan", "sensor_msgs/LaserScan",
      "Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\nfloat32 "
      "time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] "
      "ranges\nfloat32[] intensities\n"};
  RosBytes m(false);
  m.header(100, "sonar");
  for (const float v : {0.0f, 3.14159265f, 1.57079633f, 0.0f, 0.0f, 0.1f, 40.0f}) m.number(v);
  m.numbers(std::vector<float>{3, 4, std::nanf("")}).numbers(std::vector<float>{});
  const auto events = events_of(topic, {m.done()});
  ASSERT_EQ(events.size(), 1u);
  const auto& swath = std::get<Swath>(events[0]);
  EXPECT_TRUE(swath.is_flat());
  ASSERT_EQ(swath.soundings.size(), 2u);
  EXPECT_TRUE(swath.soundings[0].point.isApprox(Eigen::Vector3f(3, 0, 0), 1e-6f));
  EXPECT_LT((swath.soundings[1].point - Eigen::Vector3f(0, -4, 0)).norm(), 1e-5f);
}

std::string cloud(const std::vector<float>& xyz, std::uint32_t step = 16) {
  RosBytes m(false);
  const auto points = static_cast<std::uint32_t>(xyz.size() / 3);
  m.header(100, "sonar").number(std::uint32_t{1}).number(points).number(std::uint32_t{3});
  for (std::uint32_t k = 0; k < 3; ++k) {
    m.text(std::string(1, static_cast<char>('x' + k))).number(4 * k).number(std::uint8_t{7}).number(std::uint32_t{1});
  }
  std::string data;
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    data += std::string(reinterpret_cast<const char*>(&xyz[i]), 12) + "pad!";
  }
  return m.number(std::uint8_t{0}).number(step).number(step * points).bytes(data).number(std::uint8_t{0}).done();
}
const test::RosTopicText kCloudTopic{
    "/points", "sensor_msgs/PointCloud2",
    "Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\nuint32 point_step\nuint32 "
    "row_step\nuint8[] data\nbool is_dense\n" +
        test::kRosRule + "sensor_msgs/PointField\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n"};

TEST_F(RosEvents, PointCloudBelowIsTheBottomAndAheadAreObstacles) {
  const auto events = events_of(
      kCloudTopic, {cloud({1, 2, -10, 1, -2, -10, NAN, 0, 0}), cloud({5, 1, 0, 6, 0, 1}), cloud({1, 2, 3}, 200)});
  ASSERT_EQ(events.size(), 2u);
  const auto& bottom = std::get<Swath>(events[0]);
  ASSERT_EQ(bottom.soundings.size(), 2u);
  EXPECT_TRUE(bottom.soundings[0].point.isApprox(Eigen::Vector3f(1, -2, 10)));
  EXPECT_EQ(bottom.soundings[0].kind, Sounding::Kind::kBottom);
  EXPECT_EQ(std::get<Swath>(events[1]).soundings[0].kind, Sounding::Kind::kWater);
  EXPECT_EQ(source_->report().rejected.at("point cloud whose size disagrees with its points"), 1u);
}

TEST_F(RosEvents, RangesOfAMultibeamLeaveOutBeamsWithAFlag) {
  const test::RosTopicText topic{
      "/ranges", "marine_acoustic_msgs/SonarRanges",
      "Header header\nPingInfo ping_info\nDetectionFlag[] flags\nfloat32[] "
      "transmit_delays\nfloat32[] intensities\ngeometry_msgs/Vector3[] beam_unit_vec\nfloat32[] "
      "ranges\n" +
          test::kVector3Text + test::kPingInfoText};
  RosBytes m(false);
  m.header(100, "sonar").number(4e5f).number(1500.0f).numbers(std::vector<float>{}).numbers(std::vector<float>{});
  m.number(std::uint32_t{2}).number(std::uint8_t{0}).number(std::uint8_t{1});
  m.numbers(std::vector<float>{}).numbers(std::vector<float>{}).number(std::uint32_t{2});
  for (int i = 0; i < 2; ++i) m.number(0.0).number(0.6).number(0.8);
  m.numbers(std::vector<float>{10, 20});
  const auto events = events_of(topic, {m.done()});
  ASSERT_EQ(events.size(), 1u);
  const auto& swath = std::get<Swath>(events[0]);
  ASSERT_EQ(swath.soundings.size(), 1u);
  EXPECT_TRUE(swath.soundings[0].point.isApprox(Eigen::Vector3f(8, 6, 0))) << "x ahead, y to starboard";
}

TEST_F(RosEvents, DetectionsOfAMultibeamAreTravelTimesAndAngles) {
  const test::RosTopicText topic{"/detections", "marine_acoustic_msgs/SonarDetections",
                                 "Header header\nPingInfo ping_info\nDetectionFlag[] flags\nfloat32[] "
                                 "two_way_travel_times\nfloat32[] tx_delays\nfloat32[] intensities\nfloat32[] "
                                 "tx_angles\nfloat32[] rx_angles\n" +
                                     test::kPingInfoText};
  RosBytes m(false);
  m.header(100, "sonar").number(4e5f).number(1500.0f).numbers(std::vector<float>{}).numbers(std::vector<float>{});
  m.number(std::uint32_t{0}).numbers(std::vector<float>{0.02f}).numbers(std::vector<float>{});
  m.numbers(std::vector<float>{}).numbers(std::vector<float>{0}).numbers(std::vector<float>{0.5f});
  InputConfig down;
  down.mount_pitch = Angle::degrees(-90);
  const auto events = events_of(topic, {m.done()}, down);
  ASSERT_EQ(events.size(), 1u);
  const auto& sounding = std::get<Swath>(events[0]).soundings.at(0);
  EXPECT_NEAR(sounding.range_m, 15, 1e-5);
  EXPECT_LT((sounding.point - 15 * Eigen::Vector3f(0, std::sin(0.5f), std::cos(0.5f))).norm(), 1e-4f);
  EXPECT_EQ(sounding.kind, Sounding::Kind::kBottom);
}

TEST_F(RosEvents, ImagesNeedADeclaredGeometry) {
  const test::RosTopicText topic{"/image", "sensor_msgs/Image",
                                 "Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 "
                                 "is_bigendian\nuint32 step\nuint8[] data\n"};
  RosBytes m(false);
  m.header(100, "sonar").number(std::uint32_t{2}).number(std::uint32_t{3}).text("mono8").number(std::uint8_t{0});
  m.number(std::uint32_t{4}).bytes("abc.def.");
  EXPECT_TRUE(events_of(topic, {m.done()}).empty());
  EXPECT_THAT(source_->report().details.at("/image"), HasSubstr("input.frame_geometry does not declare"));
  InputConfig config;
  config.frame_geometry = write(R"({"beams": 3, "bins": 2, "range_min_m": 1, "range_max_m": 3, "fov_deg": 30,
                                    "height_deg": 14})",
                                "geometry.json")
                              .string();
  const auto events = events_of(topic, {m.done()}, config);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_THAT(test::beam(std::get<Ping>(events[0]), 1), ElementsAre('b', 'e'));
}

// The same picture, as PNG: rows are bins.
TEST_F(RosEvents, CompressedImagesAreReadAsTheirPictures) {
  const test::RosTopicText topic{"/image/compressed", "sensor_msgs/CompressedImage",
                                 "Header header\nstring format\nuint8[] data\n"};
  const std::string samples = "abcdef";
  const std::vector<std::uint8_t> grey(samples.begin(), samples.end());
  const std::vector<std::uint8_t> png = gray_png_bytes({3, 2, 1, grey});
  const auto message = [&](const std::string& data) {
    return RosBytes(false).header(100, "sonar").text("png").bytes(data).done();
  };
  InputConfig config;
  config.frame_geometry = write(R"({"beams": 3, "bins": 2, "range_min_m": 1, "range_max_m": 3, "fov_deg": 30,
                                    "height_deg": 14})",
                                "geometry.json")
                              .string();
  const std::string whole(png.begin(), png.end());
  const auto events = events_of(topic, {message(whole), message(whole.substr(0, 40)), message("")}, config);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_THAT(test::beam(std::get<Ping>(events[0]), 1), ElementsAre('b', 'e'));
  EXPECT_EQ(source_->report().rejected.at("compressed image that cannot be read"), 2u);
  EXPECT_TRUE(events_of(topic, {message(whole)}).empty());
  EXPECT_THAT(source_->report().details.at("/image/compressed"), HasSubstr("input.frame_geometry does not declare"));
}

/// One transform of /tf.
std::string moved(const std::string& parent, const std::string& child, double time_s, double x, double y, double z) {
  RosBytes m(false);
  m.number(std::uint32_t{1}).header(time_s, parent).text(child).number(x).number(y).number(z);
  return m.number(0.0).number(0.0).number(0.0).number(1.0).done();
}

// A vehicle that sails east: its frame moves in "odom", which is corrected in "map" now and then.
TEST_F(RosEvents, TransformsAreThePosesOfALogThatStatesNoOthers) {
  test::RosTopicText tf = test::kTransformTopic;
  tf.topic = "/tf";
  RosLog log{{tf, test::kTransformTopic}, {}};
  log.messages.push_back({1, 99, moved("base_link", "sonar", 99, 1, 0, 0)});
  for (int i = 0; i < 5; ++i) {
    const double t = 100 + i;
    if (i % 2 == 0) log.messages.push_back({0, t, moved("map", "odom", t, 0, 10, 0)});
    log.messages.push_back({0, t, moved("odom", "base_link", t, i, 0, -3)});
  }
  const auto source = opened(ros1_bag(log));
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 4u);  // the first only tells that the frame is there
  const auto fix = std::get<Navigation>(events.back());
  EXPECT_EQ(to_seconds(fix.time), 104);
  EXPECT_TRUE(fix.X_WB.translation.isApprox(Eigen::Vector3d(10, 4, 3)));
  EXPECT_NEAR(fix.X_WB.rotation.heading().degrees(), 90, 1e-9);  // no rotation in ROS looks east
  EXPECT_THAT(source->report().details.at("/tf"), HasSubstr("poses of the vehicle"));
  EXPECT_EQ(source->report().details.count("poses"), 0u);
  // With an odometry in the log they only mount sensors.
  log.topics.push_back(test::kOdometryTopic);
  log.messages.push_back({2, 105, test::odometry(false, 105, {.x = 1})});
  EXPECT_EQ(drain(*opened(ros1_bag(log))).size(), 1u);
}

TEST_F(RosEvents, AttitudePositionAndPressureOfSensorsMakeFixes) {
  const test::RosTopicText imu{"/imu", "sensor_msgs/Imu",
                               "Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] "
                               "orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\nfloat64[9] "
                               "angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\nfloat64[9] "
                               "linear_acceleration_covariance\n" +
                                   test::kVector3Text + test::kPoseText};
  const test::RosTopicText gnss{"/fix", "sensor_msgs/NavSatFix",
                                "Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 "
                                "altitude\nfloat64[9] position_covariance\nuint8 position_covariance_type\n" +
                                    test::kRosRule + "sensor_msgs/NavSatStatus\nint8 status\nuint16 service\n"};
  const test::RosTopicText pressure{"/pressure", "sensor_msgs/FluidPressure",
                                    "Header header\nfloat64 fluid_pressure\nfloat64 variance\n"};
  const auto position = [](double t, double latitude, std::int8_t status) {
    return RosBytes(false)
        .header(t, "gps")
        .number(status)
        .number(std::uint16_t{1})
        .number(latitude)
        .number(10.0)
        .number(40.0)
        .numbers(std::vector<double>{4, 0, 0, 0, 1, 0, 0, 0, 9}, false)
        .number(std::uint8_t{2})
        .done();
  };
  const double h = std::sqrt(0.5);  // 90 degrees to port of east: north
  RosBytes attitude(false);
  attitude.header(100.5, "imu").number(0.0).number(0.0).number(h).number(h);
  attitude.numbers(std::vector<double>(9 + 3 + 9 + 3 + 9), false);
  RosLog log{{imu, gnss, pressure}, {}};
  log.messages = {
      {1, 99, position(99, 50, -1)},
      {1, 100, position(100, 50, 0)},
      {2, 100.2, RosBytes(false).header(100.2, "baro").number(101325 + 1025 * 9.80665 * 4).number(0.0).done()},
      {0, 100.5, attitude.done()}};
  const auto source = opened(ros1_bag(log));
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 2u);
  const auto& fix = std::get<Navigation>(events[1]);
  EXPECT_NEAR(fix.X_WB.rotation.heading().degrees(), 0, 1e-9);
  EXPECT_NEAR(fix.X_WB.translation.z(), 4, 1e-9);
  EXPECT_NEAR(*sigma_m_of(fix), 2, 1e-9);
  EXPECT_EQ(source->report().origin->latitude_deg, 50);
  EXPECT_EQ(source->report().rejected.at("position without a fix"), 1u);
  EXPECT_THAT(source->report().details.at("sonar"), HasSubstr("none"));
}

TEST_F(RosEvents, FixesOfABagCanBeThoseOfAnotherLog) {
  const auto poses = write(ros1_bag(test::small_dive(false)), "poses.bag");
  RosLog images{{test::kProjectedImageTopic}, {{0, 101.5, test::projected_image(false, 101.5)}}};
  InputConfig config;
  config.navigation = poses.string();
  const auto events = drain(*opened(ros1_bag(images), config));
  EXPECT_EQ(std::ranges::count_if(events, [](const Event& e) { return std::holds_alternative<Navigation>(e); }), 5);
  EXPECT_EQ(std::ranges::count_if(events, [](const Event& e) { return std::holds_alternative<Ping>(e); }), 1);
}

TEST_F(RosEvents, NedFramesAreNotTurned) {
  RosLog log{{test::kOdometryTopic}, {}};
  log.messages.push_back(
      {0, 100, test::odometry(false, 100, {.x = 1, .y = 2, .z = 3, .yaw_deg = 30, .frame = "world_ned"})});
  const auto fix = std::get<Navigation>(drain(*opened(ros1_bag(log))).at(0));
  EXPECT_TRUE(fix.X_WB.translation.isApprox(Eigen::Vector3d(1, 2, 3)));
  EXPECT_NEAR(fix.X_WB.rotation.heading().degrees(), 30, 1e-9);
  InputConfig enu;
  enu.axes = LogAxes::kEnu;
  EXPECT_TRUE(std::get<Navigation>(drain(*opened(ros1_bag(log), enu)).at(0))
                  .X_WB.translation.isApprox(Eigen::Vector3d(2, 1, -3)));
}

}  // namespace
}  // namespace isobath::ros_messages
