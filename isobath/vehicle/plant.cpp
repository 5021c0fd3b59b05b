#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/vehicle/adaptive_autopilot.hpp>
#include <isobath/vehicle/pid_autopilot.hpp>
#include <isobath/vehicle/plant.hpp>

namespace isobath {

namespace {

// Moves `value` to `target` by `rate` at most; returns the distance covered meanwhile.
double ramp(double& value, double target, double rate, double dt) {
  const double change = target - value;
  const double taken = std::min(std::abs(change) / rate, dt);
  const double before = value;
  value = taken < dt ? target : value + std::copysign(rate * dt, change);
  return 0.5 * (before + value) * taken + value * (dt - taken);
}

}  // namespace

// Here, above the kinds of control, which include autopilot.hpp.
std::unique_ptr<Autopilot> make_autopilot(const VehicleModel& model) {
  if (model.autopilot.control == ControlKind::kPid) return std::make_unique<PidAutopilot>(model);
  return std::make_unique<AdaptiveAutopilot>(model);
}

void DynamicVehicle::step(const Setpoint& setpoint, const WaterConditions& water, double dt) {
  ISOBATH_ASSERT(dt > 0);
  const int parts = std::max(1, static_cast<int>(std::ceil(dt / kLongestStep - 1e-9)));
  const double part = dt / parts;
  for (int i = 0; i < parts; ++i) {
    const VehicleState& s = dynamics_.state();
    const double flow = (s.v_B - s.X_WB.rotation.inverse() * water.current_W).x();
    const ActuatorVector commands = autopilot_->update(setpoint, s, flow, part);
    const Vector6 pull = tether_m_ > 0 ? tether_wrench(tether_m_, s, water) : Vector6::Zero();
    dynamics_.step(commands, water, part, pull);
  }
}

KinematicVehicle::KinematicVehicle(const VehicleModel& model, const VehicleState& initial)
    : limits_(model.limits),
      depth_by_(model.autopilot.depth_by),
      max_pitch_(model.autopilot.max_pitch.radians()),
      can_sway_(model.thruster_axes(1) > 0 && !model.thrusters.empty()),
      state_(initial),
      speed_(initial.v_B.x()) {
  check_vehicle(model);
}

void KinematicVehicle::step(const Setpoint& setpoint, const WaterConditions& water, double dt) {
  ISOBATH_ASSERT(dt > 0);
  Eigen::Vector3d& p = state_.X_WB.translation;
  const double heading = state_.X_WB.rotation.heading().radians();
  const double top = limits_.max_speed;
  const Eigen::Vector2d current = water.current_W.head<2>();
  const double set = std::cos(heading) * current.x() + std::sin(heading) * current.y();    // ahead
  const double drift = std::cos(heading) * current.y() - std::sin(heading) * current.x();  // to starboard
  speed_ = std::clamp(speed_, set - top, set + top);                                       // the current may have grown
  const double wanted_speed = std::clamp(setpoint.speed, set - top, set + top);
  const double path = ramp(speed_, wanted_speed, limits_.max_acceleration, dt) - set * dt;  // through the water
  double side = 0;
  if (can_sway_) {
    sway_ = std::clamp(sway_, drift - top, drift + top);
    const double wanted_sway = std::clamp(setpoint.sway_speed, drift - top, drift + top);
    side = ramp(sway_, wanted_sway, limits_.max_acceleration, dt) - drift * dt;
  }

  double steepest = limits_.max_climb_rate * dt;
  if (depth_by_ == DepthBy::kPitch) steepest = std::min(steepest, std::abs(path) * std::sin(max_pitch_));
  const double depth = std::clamp(setpoint.depth, 0.0, limits_.max_depth);
  const double sunk = std::clamp(depth - p.z(), -steepest, steepest);
  // By pitch, sinking is part of the path; by heave it is additional.
  const double along = depth_by_ == DepthBy::kPitch ? std::copysign(std::sqrt(path * path - sunk * sunk), path) : path;

  double most = limits_.max_yaw_rate.radians() * dt;
  if (limits_.turning_radius > 0) most = std::min(most, std::abs(along) / limits_.turning_radius);
  const double wanted = (setpoint.heading - Angle::radians(heading)).wrapped().radians();
  const double turned = std::clamp(wanted, -most, most);
  const double share = most > 0 ? std::abs(turned) / most : 0;  // of the step that is spent turning

  // The chord of an arc points along the mean heading and is shorter by sinc of half the turn.
  const double half = 0.5 * turned;
  const double chord = share * (std::abs(half) > 1e-6 ? std::sin(half) / half : 1 - half * half / 6);
  const double mean = heading + half, after = heading + turned;
  const double c = chord * std::cos(mean) + (1 - share) * std::cos(after);
  const double s = chord * std::sin(mean) + (1 - share) * std::sin(after);
  p += Eigen::Vector3d(along * c - side * s + current.x() * dt, along * s + side * c + current.y() * dt, sunk);

  const double pitch =
      depth_by_ == DepthBy::kPitch && std::abs(path) > 1e-12 ? -std::asin(std::clamp(sunk / path, -1.0, 1.0)) : 0.0;
  state_.X_WB.rotation =
      Rotation::from_heading_pitch_roll(Angle::radians(after).wrapped(), Angle::radians(pitch), Angle());
  const Eigen::Vector3d through_B(speed_ - set, can_sway_ ? sway_ - drift : 0.0,
                                  depth_by_ == DepthBy::kPitch ? 0.0 : sunk / dt);
  state_.v_B = through_B + state_.X_WB.rotation.inverse() * Eigen::Vector3d(current.x(), current.y(), 0);
  state_.w_B = {-turned / dt * std::sin(pitch), 0, turned / dt * std::cos(pitch)};
}

std::unique_ptr<VehiclePlant> make_plant(const VehicleModel& model, PlantKind kind, const VehicleState& initial,
                                         const PlantDifference& difference, const PlantDifference& taken_for) {
  if (kind == PlantKind::kKinematic) return std::make_unique<KinematicVehicle>(model, initial);
  return std::make_unique<DynamicVehicle>(model, initial, difference, taken_for);
}

}  // namespace isobath
