// Messages of a small dive in both encodings of ROS: a fan sonar that looks ahead, and its vehicle.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <isobath/io/open_source.hpp>
#include <tests/io/ros_logs.hpp>
#include <tests/support/data.hpp>

namespace isobath::test {

inline const std::string kVector3Text = kRosRule + "geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
inline const std::string kPoseText = kRosRule + "geometry_msgs/Pose\nPoint position\nQuaternion orientation\n" +
                                     kRosRule + "geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" + kRosRule +
                                     "geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
inline const std::string kPingInfoText =
    kRosRule +
    "marine_acoustic_msgs/PingInfo\nfloat32 frequency\nfloat32 sound_speed\nfloat32[] tx_beamwidths\nfloat32[] "
    "rx_beamwidths\n" +
    kRosRule +
    "marine_acoustic_msgs/SonarImageData\nuint32 DTYPE_UINT8=0\nbool is_bigendian\nuint32 dtype\nuint32 "
    "beam_count\nuint8[] data\n" +
    kRosRule + "marine_acoustic_msgs/DetectionFlag\nuint8 DETECT_OK=0 # \"good\"\nuint8 flag\n";

inline const RosTopicText kProjectedImageTopic{
    "/sonar/image", "marine_acoustic_msgs/ProjectedSonarImage",
    "std_msgs/Header header\nPingInfo ping_info\ngeometry_msgs/Vector3[] beam_directions\nfloat32[] "
    "ranges\nSonarImageData image\n" +
        kVector3Text + kPingInfoText};
inline const RosTopicText kOdometryTopic{
    "/odometry", "nav_msgs/Odometry",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance "
    "pose\ngeometry_msgs/TwistWithCovariance twist\n" +
        kVector3Text + kPoseText + kRosRule + "geometry_msgs/PoseWithCovariance\nPose pose\nfloat64[36] covariance\n" +
        kRosRule + "geometry_msgs/TwistWithCovariance\nTwist twist\nfloat64[36] covariance\n" + kRosRule +
        "geometry_msgs/Twist\nVector3 linear\nVector3 angular\n"};
inline const RosTopicText kTransformTopic{
    "/tf_static", "tf2_msgs/TFMessage",
    "geometry_msgs/TransformStamped[] transforms\n" + kVector3Text + kPoseText + kRosRule +
        "geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\nTransform transform\n" +
        kRosRule + "geometry_msgs/Transform\nVector3 translation\nQuaternion rotation\n"};
inline const RosTopicText kRangeTopic{"/altimeter", "sensor_msgs/Range",
                                      "Header header\nuint8 ULTRASOUND=0\nuint8 INFRARED=1\nuint8 "
                                      "radiation_type\nfloat32 field_of_view\nfloat32 min_range\nfloat32 "
                                      "max_range\nfloat32 range\n"};

/// Beams at -10, 0 and 20 degrees to starboard (z ahead, y starboard, x up); two ranges of 1 m from 2 m on.
inline std::string projected_image(bool cdr, double time_s, const std::string& samples = {"\1\2\3\4\5\6", 6}) {
  RosBytes m(cdr);
  m.header(time_s, "sonar").number(1.2e6f).number(1480.0f);
  m.numbers(std::vector<float>{0.35f}).numbers(std::vector<float>{0.02f});
  m.number(std::uint32_t{3});
  for (const double degrees : {-10.0, 0.0, 20.0}) {
    const double a = degrees * M_PI / 180;
    m.number(0.0).number(std::sin(a)).number(std::cos(a));
  }
  m.numbers(std::vector<float>{2.5f, 3.5f});
  return m.number(std::uint8_t{0}).number(std::uint32_t{0}).number(std::uint32_t{3}).bytes(samples).done();
}

struct OdometryValues {
  double x = 0, y = 0, z = 0, yaw_deg = 0, speed = 0;
  std::string frame = "odom", body = "base_link";
};
/// x east, y north, z up; yaw counter-clockwise from east, as REP 103 has it.
inline std::string odometry(bool cdr, double time_s, const OdometryValues& v) {
  RosBytes m(cdr);
  m.header(time_s, v.frame).text(v.body).number(v.x).number(v.y).number(v.z);
  const double half = v.yaw_deg * M_PI / 360;
  m.number(0.0).number(0.0).number(std::sin(half)).number(std::cos(half));
  std::vector<double> covariance(36);
  for (int i = 0; i < 6; ++i) covariance[7 * i] = i < 3 ? 0.04 * (i + 1) : 0.01 * (i - 2);
  m.numbers(covariance, false).number(v.speed).number(0.0).number(0.0).number(0.0).number(0.0).number(0.0);
  return m.numbers(std::vector<double>(36), false).done();
}

/// A sensor frame in that of the vehicle: translation, and the quaternion x, y, z, w.
inline std::string transform(bool cdr, const std::string& child, const std::vector<double>& values) {
  return RosBytes(cdr).number(std::uint32_t{1}).header(1, "base_link").text(child).numbers(values, false).done();
}

inline std::string range_message(bool cdr, double time_s, float range) {
  return RosBytes(cdr)
      .header(time_s, "sonar")
      .number(std::uint8_t{0})
      .number(0.5f)
      .number(0.3f)
      .number(50.0f)
      .number(range)
      .done();
}

/// Odometry each second from 100 s on, and an image a tenth of a second after each.
inline RosLog small_dive(bool cdr, int seconds = 5) {
  RosLog log{{kProjectedImageTopic, kOdometryTopic}, {}};
  for (int i = 0; i < seconds; ++i) {
    const double t = 100 + i;
    log.messages.push_back({1, t, odometry(cdr, t, {.x = 1.0 * i, .y = 2.0 * i, .z = -3, .yaw_deg = 90, .speed = 1})});
    log.messages.push_back({0, t + 0.2, projected_image(cdr, t + 0.1)});
  }
  return log;
}

/// Opens logs that it writes.
class RosLogTest : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& bytes, const std::string& name = "dive.bag") {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  std::unique_ptr<Source> opened(const std::string& bytes, const InputConfig& config = {}) {
    return open_source(write(bytes), config);
  }
  /// The events of one topic.
  std::vector<Event> events_of(const RosTopicText& topic, const std::vector<std::string>& data,
                               const InputConfig& config = {}) {
    RosLog log{{topic}, {}};
    for (const std::string& d : data) log.messages.push_back({0, 100, d});
    source_ = opened(ros1_bag(log), config);
    return drain(*source_);
  }
  std::filesystem::path folder_ = scratch_folder();
  std::unique_ptr<Source> source_;
};

}  // namespace isobath::test
