#include <algorithm>
#include <cmath>
#include <isobath/vehicle/adaptive_autopilot.hpp>

namespace isobath {

namespace {

constexpr double kUnknownCurrent = 0.3;  // m/s, standard deviation of a component at the start

/// A limited velocity and its derivative: where the limit acts, the velocity does not change.
struct Limited {
  Limited(double velocity, double rate, double limit)
      : value(limited_to(velocity, limit)), derivative(std::abs(velocity) < limit ? rate : 0) {}
  double value, derivative;
};

/// The thrusts for a demand without their limits; fins are left out.
ActuatorVector unlimited_thrusts(const Allocator& allocator, const VehicleModel& model, const Vector6& demand_B,
                                 double flow) {
  const Allocation a = allocator.allocate(demand_B, flow, model.reference_density);
  return a.commands.head(static_cast<Eigen::Index>(model.thrusters.size())) / a.scale;
}

/// The largest share in [0, 1] of `more` that the thrusters make beside `base`.
double largest_share(const VehicleModel& model, const ActuatorVector& base, const ActuatorVector& more) {
  double share = 1;
  for (Eigen::Index i = 0; i < more.size(); ++i) {
    const Thruster& t = model.thrusters[static_cast<std::size_t>(i)];
    const double limit = more(i) > 0 ? t.max_forward : -t.max_reverse;
    if (more(i) != 0 && (base(i) + more(i) - limit) * more(i) > 0) {
      share = std::clamp((limit - base(i)) / more(i), 0.0, share);
    }
  }
  return share;
}

}  // namespace

AdaptiveAutopilot::AdaptiveAutopilot(const VehicleModel& model)
    : Autopilot(model),
      law_(model),
      adapts_(model.autopilot.control == ControlKind::kAdaptive),
      axes_(Vector6::Zero()),
      current_(kUnknownCurrent) {
  if (!model.thrusters.empty()) axes_ = model.thruster_axes;
  if (!model.fins.empty()) axes_ = axes_.cwiseMax(model.fin_axes);
}

Vector6 AdaptiveAutopilot::velocity_through_water(const Step& step) {
  const VehicleState& at = step.state;
  Vector6 velocity;
  velocity << step.flow, at.v_B.tail<2>(), at.w_B;
  if (axes_(1) > 0) return velocity;
  const Angle heading = at.X_WB.rotation.heading();
  current_.update(heading, at.X_WB.rotation * at.v_B, at.w_B.z(), step.dt);
  const Eigen::Vector3d current_W(current_.velocity_W().x(), current_.velocity_W().y(), 0);
  velocity(1) -= (at.X_WB.rotation.inverse() * current_W).y();
  return velocity;
}

void AdaptiveAutopilot::refer_to_speeds(const Step& step, const Vector6& velocity, ReferenceMotion& reference) {
  const AutopilotConfig& c = model_.autopilot;
  const VehicleState& at = step.state;
  const bool heaves = c.depth_by == DepthBy::kHeave;
  const Angle heading = at.X_WB.rotation.heading();
  // L: level with the hull's heading; of a vehicle that dives by pitch, the hull's own frame.
  const Eigen::Matrix3d R_LB =
      heaves ? (Rotation::from_heading(heading).inverse() * at.X_WB.rotation).matrix() : Eigen::Matrix3d::Identity();
  const Eigen::Vector3d v_L = R_LB * at.v_B;
  const SpeedDemand ahead = speed_demand(step);
  const Eigen::Vector2d asked(ahead.speed, axes_(1) > 0 ? step.setpoint.sway_speed : v_L.y());

  const double gain = kLeadShare * c.force_bandwidth, longest = kCatchUp * model_.limits.max_speed / gain;
  lead_ += step.dt * (v_L.head<2>() - asked);
  const bool is_far = lead_.norm() > longest;
  if (is_far) lead_ *= longest / lead_.norm();

  const double lambda = 0.5 * c.depth_bandwidth;
  const Limited sinking(lambda * depth_error(step), -lambda * v_L.z(), model_.limits.max_climb_rate);
  Eigen::Vector3d rate_L, change_L;
  rate_L << asked - gain * lead_, sinking.value;
  const Eigen::Vector2d catching = is_far ? Eigen::Vector2d::Zero() : Eigen::Vector2d(gain * (asked - v_L.head<2>()));
  change_L << ahead.acceleration + catching.x(), catching.y(), sinking.derivative;
  reference.velocity.head<3>() = R_LB.transpose() * rate_L;
  reference.acceleration.head<3>() = R_LB.transpose() * change_L;
  reference.velocity.head<3>() += velocity.head<3>() - at.v_B;  // from over ground to through the water
}

void AdaptiveAutopilot::refer_to_attitude(const Step& step, ReferenceMotion& reference) {
  const AutopilotConfig& c = model_.autopilot;
  const VehicleState& at = step.state;
  const Rotation& R_WB = at.X_WB.rotation;
  Angle pitch = R_WB.pitch(), roll = R_WB.roll();  // as they are, where the vehicle cannot change them
  if (axes_(3) > 0) roll = Angle();
  if (c.depth_by == DepthBy::kPitch) {
    pitch = Angle::radians(depth_pitch(step));
  } else if (axes_(4) > 0) {
    pitch = Angle();
  }
  const Rotation R_DB = Rotation::from_heading_pitch_roll(step.setpoint.heading, pitch, roll).inverse() * R_WB;
  const Eigen::Quaterniond& q = R_DB.quaternion();
  const double sign = q.w() < 0 ? -1 : 1;
  const Eigen::Vector3d error = 2 * sign * q.vec();
  const Eigen::Vector3d change = sign * (q.w() * at.w_B + q.vec().cross(at.w_B));
  const double limit = model_.limits.max_yaw_rate.radians();
  for (int i = 0; i < 3; ++i) {
    const double lambda = 0.5 * (i == 2 ? c.heading_bandwidth : c.attitude_bandwidth);
    const Limited turn(-lambda * error(i), -lambda * change(i), i == 2 ? limit : 2 * limit);
    reference.velocity(3 + i) = turn.value;
    reference.acceleration(3 + i) = turn.derivative;
  }
}

Vector6 AdaptiveAutopilot::within_reach(const Vector6& demand_B, double flow) const {
  if (allocator().allocate(demand_B, flow, model_.reference_density).scale == 1) return demand_B;
  Vector6 within = demand_B;
  within.head<2>().setZero();
  for (const int axis : {1, 0}) {
    Vector6 alone = Vector6::Zero();
    alone(axis) = demand_B(axis);
    within(axis) = demand_B(axis) * largest_share(model_, unlimited_thrusts(allocator(), model_, within, flow),
                                                  unlimited_thrusts(allocator(), model_, alone, flow));
  }
  return within;
}

Vector6 AdaptiveAutopilot::wrench(const Step& step) {
  const Vector6 velocity = velocity_through_water(step);
  ReferenceMotion reference;
  refer_to_speeds(step, velocity, reference);
  refer_to_attitude(step, reference);
  for (int i = 0; i < 6; ++i) {
    if (axes_(i) > 0) continue;
    reference.velocity(i) = velocity(i);
    reference.acceleration(i) = 0;
  }
  s_ = velocity - reference.velocity;
  const Regressor Y = law_.regressor(reference, velocity, step.state.X_WB.rotation.matrix());
  const Vector6 known = law_.known(reference, velocity);
  if (adapts_) {
    Vector6 learnt = s_;
    for (int i = 0; i < 6; ++i) {
      if (falls_short(i)) learnt(i) = 0;
    }
    law_.adapt(Y, learnt, step.dt);
  }
  return law_.wrench(Y, known, s_);
}

}  // namespace isobath
