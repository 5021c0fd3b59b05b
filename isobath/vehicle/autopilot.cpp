#include <algorithm>
#include <cmath>
#include <isobath/vehicle/autopilot.hpp>

namespace isobath {

Autopilot::Autopilot(const VehicleModel& model) : model_(model), allocator_(model) {
  allocation_.commands = ActuatorVector::Zero(model.actuators());
}

double Autopilot::integrate(Loop loop, double error, double dt, bool held) {
  double& sum = integral_[loop];
  if (!held || error * sum < 0) sum += error * dt;
  return sum;
}

bool Autopilot::falls_short(int axis) const {
  const double gap = std::abs(demand_B_(axis) - allocation_.achieved_B(axis));
  return gap > 1e-6 + 0.01 * std::abs(demand_B_(axis));
}

Autopilot::SpeedDemand Autopilot::speed_demand(const Step& step) {
  const double u = step.state.v_B.x();
  // Fins need flow over them: even with a current from astern there must be enough.
  const bool by_fins = model_.fin_axes(5) > 0 && step.setpoint.speed > 0;
  const double least = by_fins ? model_.autopilot.min_flow + u - step.flow : -model_.limits.max_speed;
  const double wanted =
      std::clamp(std::max(step.setpoint.speed, least), -model_.limits.max_speed, model_.limits.max_speed);
  if (!speed_asked_) speed_asked_ = u;
  const double most = model_.limits.max_acceleration * step.dt;
  const double gain = std::clamp(wanted - *speed_asked_, -most, most);
  // The ramp must not run ahead of thrusters that fall short.
  const bool held = falls_short(0), ahead = gain * (*speed_asked_ - u) > 0;
  if (!held || !ahead) *speed_asked_ += gain;
  return {*speed_asked_, gain / step.dt};
}

double Autopilot::depth_error(const Step& step) const {
  return std::clamp(step.setpoint.depth, 0.0, model_.limits.max_depth) - step.state.X_WB.translation.z();
}

double Autopilot::depth_pitch(const Step& step) {
  const AutopilotConfig& c = model_.autopilot;
  const double w = c.depth_bandwidth, error = depth_error(step), rate = 0.5 * w * error;
  const double limit = model_.limits.max_climb_rate;
  const double along = std::max(std::abs(step.state.v_B.x()), c.min_flow);
  const double sum = integrate(kDepth, error, step.dt, falls_short(4) || std::abs(rate) > 0.5 * limit);
  return limited_to(-(limited_to(rate, limit) + 0.5 * w * c.integral_rate * sum) / along, c.max_pitch.radians());
}

Vector6 Autopilot::within_reach(const Vector6& demand_B, double /*flow*/) const { return demand_B; }

ActuatorVector Autopilot::update(const Setpoint& setpoint, const VehicleState& state, double flow, double dt) {
  demand_B_ = wrench({setpoint, state, flow, dt}).cwiseProduct(model_.thruster_axes.cwiseMax(model_.fin_axes));
  allocation_ = allocator_.allocate(within_reach(demand_B_, flow), flow, model_.reference_density);
  return allocation_.commands;
}

}  // namespace isobath
