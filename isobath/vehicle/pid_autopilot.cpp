#include <algorithm>
#include <cmath>
#include <isobath/vehicle/pid_autopilot.hpp>

namespace isobath {

PidAutopilot::PidAutopilot(const VehicleModel& model)
    : Autopilot(model), inertia_(mass_matrix(model, model.reference_density).diagonal()) {}

double PidAutopilot::drag(int axis, double rate, double flow) const {
  return (model_.linear_damping(axis, axis) + model_.lift_damping(axis, axis) * std::abs(flow) +
          model_.quadratic_damping(axis, axis) * std::abs(rate)) *
         rate;
}

double PidAutopilot::speed_force(const Step& step) {
  const AutopilotConfig& c = model_.autopilot;
  const double w = c.speed_bandwidth, u = step.state.v_B.x();
  const SpeedDemand asked = speed_demand(step);
  const double lack = asked.speed - u;
  const double through = asked.speed + step.flow - u;  // the demand, as a speed through the water
  const double sum = integrate(kSpeed, lack, step.dt, falls_short(0));
  return inertia_(0) * (asked.acceleration + w * (lack + c.integral_rate * sum)) + drag(0, through, step.flow);
}

double PidAutopilot::sway_force(const Step& step) {
  const AutopilotConfig& c = model_.autopilot;
  const double w = c.speed_bandwidth, error = step.setpoint.sway_speed - step.state.v_B.y();
  const bool can = model_.thruster_axes(1) > 0;
  const double sum = integrate(kSway, error, step.dt, !can || falls_short(1));
  if (!can) return 0;
  return inertia_(1) * w * (error + c.integral_rate * sum) + drag(1, step.setpoint.sway_speed, step.flow);
}

double PidAutopilot::heading_moment(const Step& step) {
  const AutopilotConfig& c = model_.autopilot;
  const double w = c.heading_bandwidth;
  const double error = (step.setpoint.heading - step.state.X_WB.rotation.heading()).wrapped().radians();
  const double limit = model_.limits.max_yaw_rate.radians();
  const double asked = limited_to(0.5 * w * error, limit), lack = asked - step.state.w_B.z();
  const double sum = integrate(kHeading, lack, step.dt, falls_short(5));
  return inertia_(5) * 2 * w * (lack + c.integral_rate * sum) + drag(5, asked, step.flow);
}

double PidAutopilot::depth_force(const Step& step) {
  const AutopilotConfig& c = model_.autopilot;
  const double w = c.depth_bandwidth, rate = 0.5 * w * depth_error(step);
  const double sinking = (step.state.X_WB.rotation * step.state.v_B).z();
  const double asked = limited_to(rate, model_.limits.max_climb_rate), lack = asked - sinking;
  const double sum = integrate(kDepth, lack, step.dt, falls_short(2));
  return inertia_(2) * 2 * w * (lack + c.integral_rate * sum) + drag(2, asked, step.flow) -
         kGravity * (model_.mass - model_.reference_density * model_.volume);
}

Eigen::Vector2d PidAutopilot::attitude_moments(const VehicleState& state, double pitch_wanted) const {
  const double a = model_.autopilot.attitude_bandwidth;
  const double roll = state.X_WB.rotation.roll().radians(), pitch = state.X_WB.rotation.pitch().radians();
  // Righting moments are known and fed forward: they would otherwise leave the pitch short of its demand.
  const double righting =
      kGravity * (model_.mass * model_.p_BG.z() - model_.reference_density * model_.volume * model_.p_BC.z());
  return {inertia_(3) * a * (-a * roll - 2 * state.w_B.x()),
          inertia_(4) * a * (a * (pitch_wanted - pitch) - 2 * state.w_B.y()) + righting * std::sin(pitch_wanted)};
}

Vector6 PidAutopilot::wrench(const Step& step) {
  Vector6 tau = Vector6::Zero();
  tau(0) = speed_force(step);
  tau(1) = sway_force(step);
  tau(5) = heading_moment(step);
  double pitch_wanted = 0;
  if (model_.autopilot.depth_by == DepthBy::kHeave) {
    const Eigen::Vector3d down_B = step.state.X_WB.rotation.inverse() * Eigen::Vector3d::UnitZ();
    tau.head<3>() += depth_force(step) * down_B;
  } else {
    pitch_wanted = depth_pitch(step);
  }
  tau.segment<2>(3) = attitude_moments(step.state, pitch_wanted);
  return tau;
}

}  // namespace isobath
