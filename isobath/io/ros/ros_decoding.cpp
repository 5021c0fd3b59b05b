#include <algorithm>
#include <array>
#include <isobath/base/text_file.hpp>
#include <isobath/io/ros/ros_decoding.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMaxFansKept = 64;

constexpr std::array kDecoders{
    RosDecoder{"marine_acoustic_msgs/ProjectedSonarImage", RosUse::kImage, 0, decode_projected_image},
    RosDecoder{"marine_acoustic_msgs/RawSonarImage", RosUse::kImage, 1, decode_raw_image},
    RosDecoder{"marine_acoustic_msgs/SonarImage", RosUse::kImage, 0, decode_sonar_image},
    RosDecoder{"ping360_sonar_msgs/SonarEcho", RosUse::kImage, 0, decode_sonar_echo},
    RosDecoder{"sensor_msgs/Image", RosUse::kImage, 2, decode_image},
    RosDecoder{"sensor_msgs/CompressedImage", RosUse::kImage, 3, decode_compressed_image},
    RosDecoder{"marine_acoustic_msgs/SonarRanges", RosUse::kSoundings, 0, decode_sonar_ranges},
    RosDecoder{"marine_acoustic_msgs/SonarDetections", RosUse::kSoundings, 1, decode_sonar_detections},
    RosDecoder{"sensor_msgs/PointCloud2", RosUse::kSoundings, 2, decode_point_cloud},
    RosDecoder{"sensor_msgs/LaserScan", RosUse::kSoundings, 3, decode_laser_scan},
    RosDecoder{"sensor_msgs/Range", RosUse::kRange, 0, decode_range},
    RosDecoder{"nav_msgs/Odometry", RosUse::kPose, 0, decode_odometry},
    RosDecoder{"geometry_msgs/PoseWithCovarianceStamped", RosUse::kPose, 1, decode_pose_with_covariance},
    RosDecoder{"geometry_msgs/PoseStamped", RosUse::kPose, 2, decode_pose},
    RosDecoder{"sensor_msgs/Imu", RosUse::kAttitude, 0, decode_imu},
    RosDecoder{"sensor_msgs/NavSatFix", RosUse::kPosition, 0, decode_position},
    RosDecoder{"sensor_msgs/FluidPressure", RosUse::kDepth, 0, decode_pressure},
    RosDecoder{"isobath_msgs/Ping", RosUse::kPingGeometry, 0, decode_record},
    RosDecoder{"isobath_msgs/RangeReading", RosUse::kRange, -1, decode_record},
    RosDecoder{"isobath_msgs/Navigation", RosUse::kPose, -1, decode_record},
    RosDecoder{"isobath_msgs/Health", RosUse::kHealth, 0, decode_record},
    RosDecoder{"isobath_msgs/Swath", RosUse::kSoundings, -1, decode_record},
    RosDecoder{"isobath_msgs/OperatorFrame", RosUse::kOperatorFrames, 0, decode_record},
    RosDecoder{"isobath_msgs/PassiveBearing", RosUse::kBearings, 0, decode_record},
    RosDecoder{"geographic_msgs/GeoPointStamped", RosUse::kOrigin, 0, decode_origin},
    RosDecoder{"tf2_msgs/TFMessage", RosUse::kTransforms, 0, decode_transforms},
    RosDecoder{"tf/tfMessage", RosUse::kTransforms, 0, decode_transforms},
};

Rotation turn(std::initializer_list<double> rows) {
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = rows.begin()[i];
  return Rotation::from_matrix(matrix);
}

std::optional<FrameGeometry> geometry_of_images(const InputConfig& config) {
  if (config.frame_geometry.empty()) return {};
  return with_overrides(parse_frame_geometry(text_of_file(config.frame_geometry), config.frame_geometry), config);
}

/// The pose of a frame in the one below `body` that it hangs on; empty: it does not.
std::optional<Pose> in_body(const RosContext& context, std::string frame) {
  constexpr int kMaxDepth = 32;
  Pose X;  // of the first frame in `frame`
  for (int i = 0; i < kMaxDepth; ++i) {
    if (context.body.empty() ? frame.ends_with("base_link") : frame == context.body) return X;
    const auto above = context.parents.find(frame);
    if (above == context.parents.end()) return {};
    X = above->second.X * X;
    frame = above->second.parent;
  }
  return {};
}

}  // namespace

Rotation from_starboard_down(RosAxes axes) {
  switch (axes) {
    case RosAxes::kForwardPortUp: return turn({1, 0, 0, 0, -1, 0, 0, 0, -1});
    case RosAxes::kUpStarboardForward: return turn({0, 0, -1, 0, 1, 0, 1, 0, 0});
    case RosAxes::kForwardStarboardDown: break;
  }
  return {};
}

const char* to_text(RosUse use) {
  switch (use) {
    case RosUse::kImage: return "sonar images";
    case RosUse::kSoundings: return "soundings";
    case RosUse::kRange: return "ranges";
    case RosUse::kPose: return "poses";
    case RosUse::kAttitude: return "attitudes";
    case RosUse::kPosition: return "positions";
    case RosUse::kDepth: return "depths";
    case RosUse::kTransforms: return "mounting of sensors";
    case RosUse::kPingGeometry: return "geometry of sonar images";
    case RosUse::kOrigin: return "origin on the globe";
    case RosUse::kHealth: return "health of the vehicle";
    case RosUse::kOperatorFrames: return "frames of the operator's link";
    case RosUse::kBearings: return "passive bearings";
  }
  return "unknown";
}

RosContext::RosContext(const InputConfig& settings, SourceReport& its_report)
    : config(settings),
      report(its_report),
      parts(config.survey, its_report),
      head(config, {Angle::degrees(2), Angle::degrees(25)}),  // of a Ping360
      images(geometry_of_images(settings)) {}

Pose RosContext::mount(std::string_view frame, RosAxes axes) {
  const auto is_set = [&](double value) { return value != 0; };
  const bool declared = is_set(config.mount_heading.radians()) || is_set(config.mount_pitch.radians()) ||
                        is_set(config.mount_roll.radians()) || std::ranges::any_of(config.mount_m, is_set);
  if (!declared) {
    while (frame.starts_with('/')) frame.remove_prefix(1);
    if (const auto X = in_body(*this, std::string(frame))) {
      if (axes == RosAxes::kForwardPortUp && is_ned(frame)) axes = RosAxes::kForwardStarboardDown;
      const Rotation F = from_starboard_down(is_ned(body) ? RosAxes::kForwardStarboardDown : RosAxes::kForwardPortUp);
      if (parents.contains(std::string(frame)))
        report.note_setting("mounting of " + std::string(frame), "as the transforms of the log state");
      return Pose{F.inverse(), Eigen::Vector3d::Zero()} * *X * Pose{from_starboard_down(axes), Eigen::Vector3d::Zero()};
    }
  }
  return {Rotation::from_heading_pitch_roll(config.mount_heading, config.mount_pitch, config.mount_roll),
          Eigen::Vector3d(config.mount_m[0], config.mount_m[1], config.mount_m[2])};
}

std::optional<Time> time_of_header(const RosValue& header, Time recorded) {
  const auto stamp = header["stamp"].time();
  if (!stamp || *stamp - recorded > kMaxStampOffset || recorded - *stamp > kMaxStampOffset) return {};
  return stamp;
}

bool RosContext::is_ned(std::string_view frame) const {
  return config.axes == LogAxes::kNed || (config.axes == LogAxes::kByName && frame.ends_with("ned"));
}

Pose RosContext::in_world(const Pose& pose, std::string_view frame) const {
  if (is_ned(frame)) return pose;
  const Pose to_ned{turn({0, 1, 0, 1, 0, 0, 0, 0, -1}), Eigen::Vector3d::Zero()};
  return to_ned * pose * Pose{from_starboard_down(RosAxes::kForwardPortUp), Eigen::Vector3d::Zero()};
}

std::shared_ptr<const BeamFan> RosContext::shared(BeamFan fan) {
  for (const auto& known : fans) {
    if (known->azimuth == fan.azimuth && known->width == fan.width && known->height == fan.height) return known;
  }
  if (fans.size() >= kMaxFansKept) fans.erase(fans.begin());
  fans.push_back(std::make_shared<const BeamFan>(std::move(fan)));
  return fans.back();
}

const RosDecoder* ros_decoder_of(std::string_view type) {
  // Older names of the same packages.
  std::string name(type);
  for (const std::string_view before : {"acoustic_msgs/", "imaging_sonar_msgs/"}) {
    if (type.starts_with(before)) name = "marine_acoustic_msgs/" + name.substr(before.size());
  }
  if (type == "ping360_sonar/SonarEcho") name = "ping360_sonar_msgs/SonarEcho";
  const auto* const found = std::ranges::find(kDecoders, name, &RosDecoder::type);
  return found == kDecoders.end() ? nullptr : found;
}

}  // namespace isobath
