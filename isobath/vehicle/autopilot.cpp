#include <algorithm>
#include <cmath>
#include <isobath/vehicle/autopilot.hpp>

namespace isobath {

namespace {

double limited(double value, double limit) { return std::clamp(value, -limit, limit); }

}  // namespace

Autopilot::Autopilot(const VehicleModel& model)
    : model_(model), inertia_(mass_matrix(model, model.reference_density).diagonal()), allocator_(model) {
  reset();
}

void Autopilot::reset() {
  speed_asked_.reset();
  demand_B_.setZero();
  allocation_.commands = ActuatorVector::Zero(model_.actuators());
  allocation_.achieved_B.setZero();
  std::fill(std::begin(integral_), std::end(integral_), 0.0);
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

double Autopilot::drag(int axis, double rate, double flow) const {
  return (model_.linear_damping(axis, axis) + model_.lift_damping(axis, axis) * std::abs(flow) +
          model_.quadratic_damping(axis, axis) * std::abs(rate)) *
         rate;
}

double Autopilot::speed_force(const Step& step) {
  const AutopilotConfig& c = model_.autopilot;
  const double w = c.speed_bandwidth, u = step.state.v_B.x();
  // Fins need flow over them: even with a current from astern there must be enough.
  const bool by_fins = model_.fin_axes(5) > 0 && step.setpoint.speed > 0;
  const double least = by_fins ? c.min_flow + u - step.flow : -model_.limits.max_speed;
  const double wanted =
      std::clamp(std::max(step.setpoint.speed, least), -model_.limits.max_speed, model_.limits.max_speed);
  if (!speed_asked_) speed_asked_ = u;
  const double most = model_.limits.max_acceleration * step.dt;
  const double gain = std::clamp(wanted - *speed_asked_, -most, most);
  // The ramp must not run ahead of thrusters that fall short.
  const bool held = falls_short(0), ahead = gain * (*speed_asked_ - u) > 0;
  if (!held || !ahead) *speed_asked_ += gain;
  const double lack = *speed_asked_ - u;
  const double through = *speed_asked_ + step.flow - u;  // the demand, as a speed through the water
  const double sum = integrate(kSpeed, lack, step.dt, held);
  return inertia_(0) * (gain / step.dt + w * (lack + c.integral_rate * sum)) + drag(0, through, step.flow);
}

double Autopilot::sway_force(const Step& step) {
  const AutopilotConfig& c = model_.autopilot;
  const double w = c.speed_bandwidth, error = step.setpoint.sway_speed - step.state.v_B.y();
  const bool can = model_.thruster_axes(1) > 0;
  const double sum = integrate(kSway, error, step.dt, !can || falls_short(1));
  if (!can) return 0;
  return inertia_(1) * w * (error + c.integral_rate * sum) + drag(1, step.setpoint.sway_speed, step.flow);
}

double Autopilot::heading_moment(const Step& step) {
  const AutopilotConfig& c = model_.autopilot;
  const double w = c.heading_bandwidth;
  const double error = (step.setpoint.heading - step.state.X_WB.rotation.heading()).wrapped().radians();
  const double limit = model_.limits.max_yaw_rate.radians();
  const double asked = limited(0.5 * w * error, limit), lack = asked - step.state.w_B.z();
  const double sum = integrate(kHeading, lack, step.dt, falls_short(5));
  return inertia_(5) * 2 * w * (lack + c.integral_rate * sum) + drag(5, asked, step.flow);
}

double Autopilot::depth_error(const Step& step) const {
  return std::clamp(step.setpoint.depth, 0.0, model_.limits.max_depth) - step.state.X_WB.translation.z();
}

double Autopilot::depth_force(const Step& step) {
  const AutopilotConfig& c = model_.autopilot;
  const double w = c.depth_bandwidth, rate = 0.5 * w * depth_error(step);
  const double sinking = (step.state.X_WB.rotation * step.state.v_B).z();
  const double asked = limited(rate, model_.limits.max_climb_rate), lack = asked - sinking;
  const double sum = integrate(kDepth, lack, step.dt, falls_short(2));
  return inertia_(2) * 2 * w * (lack + c.integral_rate * sum) + drag(2, asked, step.flow) -
         kGravity * (model_.mass - model_.reference_density * model_.volume);
}

double Autopilot::depth_pitch(const Step& step) {
  const AutopilotConfig& c = model_.autopilot;
  const double w = c.depth_bandwidth, error = depth_error(step), rate = 0.5 * w * error;
  const double limit = model_.limits.max_climb_rate;
  const double along = std::max(std::abs(step.state.v_B.x()), c.min_flow);
  const double sum = integrate(kDepth, error, step.dt, falls_short(4) || std::abs(rate) > 0.5 * limit);
  return limited(-(limited(rate, limit) + 0.5 * w * c.integral_rate * sum) / along, c.max_pitch.radians());
}

Eigen::Vector2d Autopilot::attitude_moments(const VehicleState& state, double pitch_wanted) const {
  const double a = model_.autopilot.attitude_bandwidth;
  const double roll = state.X_WB.rotation.roll().radians(), pitch = state.X_WB.rotation.pitch().radians();
  // Righting moments are known and fed forward: they would otherwise leave the pitch short of its demand.
  const double righting =
      kGravity * (model_.mass * model_.p_BG.z() - model_.reference_density * model_.volume * model_.p_BC.z());
  return {inertia_(3) * a * (-a * roll - 2 * state.w_B.x()),
          inertia_(4) * a * (a * (pitch_wanted - pitch) - 2 * state.w_B.y()) + righting * std::sin(pitch_wanted)};
}

ActuatorVector Autopilot::update(const Setpoint& setpoint, const VehicleState& state, double flow, double dt) {
  const Step step{setpoint, state, flow, dt};
  Vector6 tau = Vector6::Zero();
  tau(0) = speed_force(step);
  tau(1) = sway_force(step);
  tau(5) = heading_moment(step);
  double pitch_wanted = 0;
  if (model_.autopilot.depth_by == DepthBy::kHeave) {
    const Eigen::Vector3d down_B = state.X_WB.rotation.inverse() * Eigen::Vector3d::UnitZ();
    tau.head<3>() += depth_force(step) * down_B;
  } else {
    pitch_wanted = depth_pitch(step);
  }
  tau.segment<2>(3) = attitude_moments(state, pitch_wanted);

  demand_B_ = tau.cwiseProduct(model_.thruster_axes.cwiseMax(model_.fin_axes));
  allocation_ = allocator_.allocate(demand_B_, flow, model_.reference_density);
  return allocation_.commands;
}

}  // namespace isobath
