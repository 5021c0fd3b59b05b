// Poses, attitudes, positions, depths and transforms.
#include <cmath>
#include <isobath/io/ros/ros_decoding.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMaxFrames = 10'000;

Eigen::Vector3d vector_of(const RosValue& v) { return {v["x"].number(), v["y"].number(), v["z"].number()}; }

/// Empty: not a rotation, such as all zeros.
std::optional<Rotation> rotation_of(const RosValue& q) {
  const Eigen::Quaterniond value(q["w"].number(), q["x"].number(), q["y"].number(), q["z"].number());
  const double norm = value.norm();
  if (!(std::abs(norm - 1) < 0.1)) return {};
  return Rotation::from_quaternion(value.normalized());
}

std::optional<Pose> pose_of(const RosValue& pose) {
  const auto rotation = rotation_of(pose["orientation"]);
  const Eigen::Vector3d position = vector_of(pose["position"]);
  if (!rotation || !position.allFinite()) return {};
  return Pose{*rotation, position};
}

/// Covariance of position and rotation about the axes of the frame, as that of position in W and rotation in B; empty:
/// it is not stated.
std::optional<Eigen::Matrix<double, 6, 6>> covariance_of(const std::vector<double>& values, const Pose& X_WB,
                                                         bool ned) {
  if (values.size() != 36) return {};
  Eigen::Matrix<double, 6, 6> C;
  for (int i = 0; i < 36; ++i) C(i / 6, i % 6) = values[static_cast<std::size_t>(i)];
  if (!C.allFinite() || !(C.diagonal().minCoeff() >= 0) || !(C.diagonal().head<2>().minCoeff() > 0)) return {};
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
  if (!ned) M << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Zero();
  J.topLeftCorner<3, 3>() = M;
  J.bottomRightCorner<3, 3>() = X_WB.rotation.matrix().transpose() * M;
  const Eigen::Matrix<double, 6, 6> turned = J * C * J.transpose();
  return turned.allFinite() ? std::optional(turned) : std::nullopt;
}

/// The pose of the vehicle by the transforms that lead to it, if `moved` is the frame nearest to it that moves; the
/// frames above, such as a correction of "odom" in "map", only change the poses that follow.
std::optional<Navigation> fix_of_transforms(const RosContext& context, const std::string& moved, Time time) {
  constexpr int kMaxDepth = 32;
  std::string frame = context.body;
  for (auto i = context.parents.begin(); frame.empty() && i != context.parents.end(); ++i) {
    if (i->first.ends_with("base_link")) frame = i->first;
  }
  Pose X;  // of the vehicle in `frame`
  bool found = false;
  for (int depth = 0; depth < kMaxDepth; ++depth) {
    const auto above = context.parents.find(frame);
    if (above == context.parents.end()) break;
    if (above->second.is_moving && !found) {
      if (frame != moved) return {};
      found = true;
    }
    X = above->second.X * X;
    frame = above->second.parent;
  }
  if (!found) return {};
  Navigation fix;
  fix.time = time;
  fix.X_WB = context.in_world(X, frame);
  return fix;
}

const char* add_fix(const RosInput& input, const RosValue& pose, const std::vector<double>& covariance,
                    const std::optional<Eigen::Vector3d>& v_B, RosContext& context, std::vector<Event>& events) {
  const auto stated = pose_of(pose);
  if (!input.message.ok()) return nullptr;
  if (!stated) return "pose without an orientation or with an impossible value";
  Navigation fix;
  fix.time = input.time;
  fix.X_WB = context.in_world(*stated, input.frame);
  fix.covariance = covariance_of(covariance, fix.X_WB, context.is_ned(input.frame));
  if (v_B && v_B->allFinite()) fix.v_WB = fix.X_WB.rotation * *v_B;
  events.emplace_back(std::move(fix));
  return nullptr;
}

}  // namespace

const char* decode_odometry(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const RosMessage& message = input.message;
  std::string_view body = message["child_frame_id"].text();
  while (body.starts_with('/')) body.remove_prefix(1);
  context.body = body;
  Eigen::Vector3d v = vector_of(message["twist"]["twist"]["linear"]);
  if (!context.is_ned(input.frame)) v = {v.x(), -v.y(), -v.z()};
  return add_fix(input, message["pose"]["pose"], message["pose"]["covariance"].numbers(), v, context, events);
}

const char* decode_pose(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  return add_fix(input, input.message["pose"], {}, {}, context, events);
}

const char* decode_pose_with_covariance(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const RosValue pose = input.message["pose"];
  return add_fix(input, pose["pose"], pose["covariance"].numbers(), {}, context, events);
}

const char* decode_imu(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const auto rotation = rotation_of(input.message["orientation"]);
  const std::vector<double> covariance = input.message["orientation_covariance"].numbers();
  if (!input.message.ok()) return nullptr;
  if (!rotation || (!covariance.empty() && covariance[0] == -1)) return "motion without an orientation";
  const Pose X = context.in_world({*rotation, Eigen::Vector3d::Zero()}, input.frame);
  if (auto fix = context.parts.on_attitude(input.time, X.rotation)) events.emplace_back(*std::move(fix));
  return nullptr;
}

const char* decode_position(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const RosMessage& message = input.message;
  const double status = message["status"]["status"].number();
  const GeoPoint point{message["latitude"].number(), message["longitude"].number()};
  const std::vector<double> covariance = message["position_covariance"].numbers();
  if (!message.ok()) return nullptr;
  if (status < 0 || !valid(point) || point == GeoPoint{}) return "position without a fix";
  const double variance = covariance.size() == 9 ? std::max(covariance[0], covariance[4]) : 0;
  const double sigma = variance > 0 ? std::sqrt(variance) : context.config.survey.position_sigma_m;
  if (auto fix = context.parts.on_position(input.time, point, {}, sigma)) events.emplace_back(*std::move(fix));
  return nullptr;
}

const char* decode_pressure(const RosInput& input, RosContext& context, std::vector<Event>&) {
  const double pressure = input.message["fluid_pressure"].number() * context.config.pressure_unit_pa;
  if (!input.message.ok()) return nullptr;
  if (!std::isfinite(pressure)) return "pressure that is not a number";
  context.parts.on_depth(
      input.time, (pressure - context.config.surface_pressure_pa) / (context.config.water_density * kStandardGravity));
  return nullptr;
}

const char* decode_transforms(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const auto plain = [](std::string_view frame) {
    while (frame.starts_with('/')) frame.remove_prefix(1);
    return std::string(frame);
  };
  for (const RosValue& transform : input.message["transforms"].elements()) {
    const auto rotation = rotation_of(transform["transform"]["rotation"]);
    const Eigen::Vector3d translation = vector_of(transform["transform"]["translation"]);
    const std::string parent = plain(transform["header"]["frame_id"].text());
    const std::string child = plain(transform["child_frame_id"].text());
    if (!input.message.ok()) return nullptr;
    if (!rotation || !translation.allFinite()) return "transform with an impossible value";
    const auto known = context.parents.find(child);
    const bool is_moving = known != context.parents.end();
    if (!is_moving && context.parents.size() >= kMaxFrames) continue;
    context.parents[child] = {parent, {*rotation, translation}, is_moving};
    if (!context.poses_from_transforms) continue;
    const Time time = time_of_header(transform["header"], input.time).value_or(input.time);
    if (auto fix = fix_of_transforms(context, child, time)) events.emplace_back(*std::move(fix));
  }
  return nullptr;
}

}  // namespace isobath
