// RosLogWriter: the events of a source as a log of ROS.
//
// - Ping: marine_acoustic_msgs/ProjectedSonarImage in /sonar/image.
// - RangeReading: sensor_msgs/Range in /range.
// - Swath: sensor_msgs/PointCloud2 (x, y, z, range, beam, kind) in /soundings.
// - Navigation: nav_msgs/Odometry in /odometry and tf2_msgs/TFMessage in /tf. Of the same fix, for programs that look
// for
//   them: TwistWithCovarianceStamped in /velocity (if it has a velocity), sensor_msgs/Imu in /imu (orientation only),
//   FluidPressure in /pressure, NavSatFix in /fix (if the origin is known).
// - Health: diagnostic_msgs/DiagnosticArray in /diagnostics.
// - Origin on the globe: geographic_msgs/GeoPointStamped in /origin.
// Mountings of sensors are in /tf_static. Frames (REP 103): "map" is east-north-up, "base_link" forward-port-up;
// "sonar", "sonar_2", ... x up, y starboard, z forward, as ProjectedSonarImage defines it; "range", "range_2", ...
// x along the beam; "level" forward-port-up at the water surface, for soundings that the recorder corrected for motion.
//
// Records. The messages of ROS hold ranges, beam widths and angles as float32 or in other axes, and have no place for
// much of an event. So each event is also written as a record of the native log, bit for bit, in /isobath/* (types
// isobath_msgs/*; a ping without its samples, which stand in /sonar/image). Isobath reads these, and takes the
// messages of ROS where they are missing. OperatorFrame and PassiveBearing have no message of ROS, so that they are
// records only. RosLogOptions::records = false leaves all records out.
//
// Not written, and counted by reason in left_out(): times that a header of ROS cannot state, pings without samples,
// values that are not finite; without records also the events that have no message of ROS.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/ros/ros_decoding.hpp>
#include <isobath/io/ros/ros_recorder.hpp>
#include <isobath/io/ros/ros_writer.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

struct RosLogOptions {
  bool records = true;
  double surface_pressure_pa = 101325;  ///< at the surface, for FluidPressure
  double water_density = 1025;          ///< kg/m3
};

class RosLogWriter {
 public:
  RosLogWriter(RosRecorder& recorder, const RosLogOptions& options);

  /// At any time; written with the next event.
  void set_origin(const GeoOrigin& origin);
  /// False, and nothing is written: it is counted in left_out.
  bool write(const Event& event);

  /// Events that are written as a record only, since no message of ROS fits, by kind.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& records_only() const { return records_only_; }
  /// Events that are not written, by reason.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& left_out() const { return left_out_; }

 private:
  struct Topic {
    std::size_t index;
    RosWriter writer;
  };
  struct Mounting {
    std::string parent, child;
    Pose X;  ///< of the child in its parent
  };

  RosWriter& message(std::string_view topic, std::string_view type, bool latched = false);
  void send(std::string_view topic);
  Time time_of_recording();
  void write_record(const Event& event);
  void write_origin();
  // Each writes the messages of ROS of an event, and returns null, or what has none: for counting.
  const char* put(const Ping& ping);
  const char* put(const RangeReading& reading);
  const char* put(const Navigation& fix);
  const char* put(const Health& health);
  const char* put(const Swath& swath);
  const char* put(const OperatorFrame&) { return "frames of an operator's link"; }
  const char* put(const PassiveBearing&) { return "passive bearings"; }
  void put_odometry(const Navigation& fix);
  void put_fix_parts(const Navigation& fix);
  void put_transform(std::string_view topic, const std::vector<Mounting>& transforms, bool latched);
  /// The frame of a sensor with this mounting, made where it is new.
  std::string frame_of(const std::string& sensor, const Pose& X_BS, RosAxes axes);

  RosRecorder& recorder_;
  const RosLogOptions options_;
  std::map<std::string, Topic, std::less<>> topics_;
  std::vector<Mounting> mountings_;
  std::optional<GeoOrigin> origin_;
  bool origin_written_ = true;
  std::optional<Pose> X_WB_;  ///< of the newest fix
  Time time_;                 ///< of the event at hand
  Time recorded_{};           ///< time of recording of the newest message
  std::vector<std::uint8_t> record_;
  std::map<std::string, std::uint64_t> records_only_, left_out_;
};

}  // namespace isobath
