// How messages of ROS become events: what the decoders share, and the table of types that have one.
//
// World and body. Poses in east-north-up with a forward-port-up body (REP 103) become north-east-down with a
// forward-starboard-down body; InputConfig::axes, or a frame whose name ends in "ned", says that they are so already.
// Mounting. X_BS of a sensor is what the transforms of /tf_static and /tf say between its frame and the vehicle's
// (child_frame_id of the odometry, else a frame that is called base_link), unless a mount_* setting is not 0. Axes of a
// sensor frame: forward-port-up; of a SonarImage forward-starboard-down; of the messages of marine_acoustic_msgs
// z forward, y starboard, x up, as their definitions state.
// Records of isobath_msgs are events of the native log as they are, whatever the settings of mounting and axes.
#pragma once

#include <deque>
#include <isobath/event/event.hpp>
#include <isobath/io/bytes/sample_arena.hpp>
#include <isobath/io/frames/frame_geometry.hpp>
#include <isobath/io/input/navigation_parts.hpp>
#include <isobath/io/input/scanning_head.hpp>
#include <isobath/io/mcap/native_log_decoding.hpp>
#include <isobath/io/ros/ros_recording.hpp>
#include <map>
#include <optional>

namespace isobath {

constexpr double kStandardGravity = 9.80665;  ///< m/s2, between pressures and depths

/// What a message is used as. Of each kind one topic is read, unless the settings name others.
enum class RosUse : std::uint8_t {
  kImage,
  kSoundings,
  kRange,
  kPose,
  kAttitude,
  kPosition,
  kDepth,
  kTransforms,
  kPingGeometry,  ///< of the sonar images of the same time
  kOrigin,
  kHealth,
  kOperatorFrames,
  kBearings
};
const char* to_text(RosUse use);

enum class RosAxes : std::uint8_t { kForwardPortUp, kForwardStarboardDown, kUpStarboardForward };
/// R from forward-starboard-down axes to those of a frame.
Rotation from_starboard_down(RosAxes axes);

struct RosTransform {
  std::string parent;
  Pose X;                  ///< of the frame in its parent
  bool is_moving = false;  ///< it was stated before
};

struct RosContext {
  RosContext(const InputConfig& settings, SourceReport& its_report);

  /// X_BS of a sensor whose messages name this frame.
  Pose mount(std::string_view frame, RosAxes axes);
  /// A pose in a frame of the world as X_WB.
  [[nodiscard]] Pose in_world(const Pose& pose, std::string_view frame) const;
  [[nodiscard]] bool is_ned(std::string_view frame) const;
  /// The same pointer for the same fan.
  std::shared_ptr<const BeamFan> shared(BeamFan fan);

  /// The geometry that a record states for the sonar image of this time; each is given once.
  std::optional<Ping> take_ping_record(Time time);

  const InputConfig config;
  SourceReport& report;
  NavigationParts parts;
  ScanningHead head;
  SampleArena arena;
  std::optional<FrameGeometry> images;               ///< InputConfig::frame_geometry
  std::string body;                                  ///< the vehicle's frame; empty: not stated yet
  std::map<std::string, RosTransform> parents;       ///< by frame
  bool poses_from_transforms = false;                ///< nothing else states poses
  std::vector<std::shared_ptr<const BeamFan>> fans;  ///< newest last
  native::FanStore record_fans;
  std::deque<std::pair<Time, Ping>> ping_records;  ///< newest last
  double float_scale = 0;                          ///< full scale of samples that are real numbers
};

struct RosInput {
  const RosMessage& message;
  Time time;  ///< of the header, or of the recording
  std::string_view frame;
  std::shared_ptr<const void> owner;  ///< keeps the bytes of the message alive
};

constexpr Duration kMaxStampOffset = std::chrono::seconds(60);
/// The time that a std_msgs/Header states; empty: none, or one over kMaxStampOffset from that of recording.
std::optional<Time> time_of_header(const RosValue& header, Time recorded);

/// Adds events; returns why the message is refused, null if it is not.
using RosDecode = const char* (*)(const RosInput& input, RosContext& context, std::vector<Event>& events);

struct RosDecoder {
  std::string_view type;
  RosUse use;
  int rank;  ///< of two topics of one use the one with the lower rank is read
  RosDecode decode;
};
/// Null: there is none for this type.
const RosDecoder* ros_decoder_of(std::string_view type);

// Sonar images: ros_images.cpp
const char* decode_projected_image(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_raw_image(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_sonar_image(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_sonar_echo(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_compressed_image(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_image(const RosInput& input, RosContext& context, std::vector<Event>& events);
// Ranges and points: ros_soundings.cpp
const char* decode_laser_scan(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_point_cloud(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_sonar_ranges(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_sonar_detections(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_range(const RosInput& input, RosContext& context, std::vector<Event>& events);
// The vehicle: ros_poses.cpp
const char* decode_odometry(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_pose(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_pose_with_covariance(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_imu(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_position(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_pressure(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_transforms(const RosInput& input, RosContext& context, std::vector<Event>& events);

// Records of Isobath (isobath_msgs), and the origin of its plane: ros_records.cpp
const char* decode_record(const RosInput& input, RosContext& context, std::vector<Event>& events);
const char* decode_origin(const RosInput& input, RosContext& context, std::vector<Event>& events);

}  // namespace isobath
