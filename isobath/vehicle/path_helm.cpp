#include <algorithm>
#include <cmath>
#include <Eigen/Dense>
#include <isobath/base/error.hpp>
#include <isobath/vehicle/path_helm.hpp>
#include <isobath/vehicle/plant.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// 1 / (1 + time s)^3 by the trapezoidal rule, with its first and second derivative.
class ThreeLags {
 public:
  ThreeLags(double time, double dt, double start) : time_(time), share_(dt / (2 * time + dt)), in_(start) {
    std::fill(std::begin(out_), std::end(out_), start);
  }
  void step(double in) {
    double before = in_, after = in;
    for (double& x : out_) {
      const double next = x + share_ * (before + after - 2 * x);
      before = x;
      after = x = next;
    }
    in_ = in;
  }
  [[nodiscard]] double value() const { return out_[2]; }
  [[nodiscard]] double first() const { return (out_[1] - out_[2]) / time_; }
  [[nodiscard]] double second() const { return (out_[0] - 2 * out_[1] + out_[2]) / (time_ * time_); }

 private:
  double time_, share_, in_;
  double out_[3];
};

}  // namespace

DepthLoop identify_depth_loop(std::span<const double> asked_m, std::span<const double> depth_m, double dt,
                              double filter_s) {
  const std::size_t count = asked_m.size();
  if (count < 10 || depth_m.size() != count || !(dt > 0) || !(filter_s > 0)) {
    throw Error("the record of depths is too short or not valid", {}, "ten samples or more of both");
  }
  ThreeLags asked(filter_s, dt, asked_m[0]), depth(filter_s, dt, depth_m[0]);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (std::size_t i = 1; i < count; ++i) {
    asked.step(asked_m[i]);
    depth.step(depth_m[i]);
    const Vector3d row(depth.first(), depth.second(), 1);  // 1: a steady offset
    normal += row * row.transpose();
    right += (asked.value() - depth.value()) * row;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> parts(normal);
  if (!(parts.eigenvalues()(0) > 1e-9 * static_cast<double>(count))) {
    throw Error("the record of depths varies too little to identify the vehicle's depth loop");
  }
  const Vector3d found = normal.ldlt().solve(right);
  return {found(0), found(1)};
}

DepthLoop measured_depth_loop(const VehicleModel& model, double speed, double period_s) {
  constexpr double kStep = 0.05, kSettle = 60;  // s
  constexpr int kWaves = 4;
  const double middle = std::min(10.0, 0.5 * model.limits.max_depth);
  // Half the height that demands the maximum climb rate, so that the loop stays linear.
  const double height = std::min(model.limits.max_climb_rate / model.autopilot.depth_bandwidth, 0.5 * middle);
  VehicleState start;
  start.X_WB.translation.z() = middle;
  start.v_B.x() = speed;
  DynamicVehicle vehicle(model, start);
  std::vector<double> asked, depth;
  for (double t = -kSettle; t < kWaves * period_s; t += kStep) {
    const double wanted = middle + (t > 0 ? height * std::sin(2 * std::numbers::pi * t / period_s) : 0);
    if (t >= 0) {
      asked.push_back(wanted);
      depth.push_back(vehicle.state().X_WB.translation.z());
    }
    vehicle.step({Angle(), wanted, speed, 0}, {model.reference_density, Vector3d::Zero()}, kStep);
  }
  return identify_depth_loop(asked, depth, kStep);
}

std::vector<Field> fields(PathHelmConfig& c) {
  return {Field::real("along_gain", &c.along_gain, {0, 10}, "1/s", "Gain of the virtual target's catch-up."),
          Field::real("approach", &c.approach_m, {0.1, 100}, "m", "Lateral distance with an approach of 30 degrees."),
          Field::real("heading_lag", &c.heading_lag_s, {0, 60}, "s", "Lag of the heading behind its set-point."),
          Field::real("drift_time", &c.drift_time_s, {0, 600}, "s", "Time constant of the drift filter; 0: not used."),
          Field::flag("shape_depth", &c.shape_depth, "Compensate depth set-points for the lag of the depth loop.")};
}

PathHelm::PathHelm(const SpacePath& path, const PathHelmConfig& config, const DepthLoop& loop, double speed)
    : path_(&path), config_(config), loop_(loop), speed_(speed), target_(path.frame_at(0)) {}

void PathHelm::follow(const SpacePath& path, double s) {
  path_ = &path;
  s_ = s;
  target_ = path.frame_at(s);
}

Setpoint PathHelm::step(const VehicleState& state, double dt) {
  const Vector3d v_W = state.X_WB.rotation * state.v_B;
  target_ = path_->frame_at(s_);
  const Vector3d tangent = target_.tangent();
  const Vector3d bend = target_.k1 * target_.R_WF.col(1) + target_.k2 * target_.R_WF.col(2);
  const Vector3d gap = state.X_WB.translation - target_.p_W;
  const double s_dot = std::max(0.0, config_.along_gain * gap.dot(tangent) + v_W.dot(tangent));

  const Vector2d ahead = tangent.head<2>().normalized(), starboard(-ahead.y(), ahead.x());
  const double level = tangent.head<2>().norm();
  const double turn = s_dot * bend.head<2>().dot(starboard) / level;  // rate of the path's heading
  const double beside = gap.head<2>().dot(starboard);
  const double wanted = std::atan2(ahead.y(), ahead.x()) - std::asin(beside / (std::abs(beside) + config_.approach_m));
  drift_.update(state.X_WB.rotation.heading(), v_W, config_.drift_time_s, dt);
  const Angle course = Angle::radians(wanted + config_.heading_lag_s * turn);

  Setpoint order;
  order.heading = (course - drift_.crab(course, speed_)).wrapped();
  order.depth = target_.p_W.z();
  if (config_.shape_depth) {
    order.depth += loop_.lag_s * s_dot * tangent.z() + loop_.lag2_s2 * s_dot * s_dot * bend.z();
  }
  order.speed = speed_;
  s_ += s_dot * dt;
  return order;
}

}  // namespace isobath
