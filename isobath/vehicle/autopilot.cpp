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

ActuatorVector Autopilot::update(const Setpoint& setpoint, const VehicleState& state, double flow, double dt) {
  const AutopilotConfig& c = model_.autopilot;
  const Rotation& R_WB = state.X_WB.rotation;
  const Eigen::Vector3d down_B = R_WB.inverse() * Eigen::Vector3d::UnitZ();
  const double roll = R_WB.roll().radians(), pitch = R_WB.pitch().radians();
  const double slow = c.integral_rate;

  // An axis falls short if the last commands did not reach its demand.
  const auto short_of = [&](int axis) {
    const double gap = std::abs(demand_B_(axis) - allocation_.achieved_B(axis));
    return gap > 1e-6 + 0.01 * std::abs(demand_B_(axis));
  };
  // Drag at the demanded rate is fed forward: the loops then only correct.
  const auto drag = [&](int axis, double rate) {
    return (model_.linear_damping(axis, axis) + model_.lift_damping(axis, axis) * std::abs(flow) +
            model_.quadratic_damping(axis, axis) * std::abs(rate)) *
           rate;
  };
  Vector6 tau = Vector6::Zero();

  {
    const double w = c.speed_bandwidth, u = state.v_B.x();
    // Fins need flow over them: even with a current from astern there must be enough.
    const bool by_fins = model_.fin_axes(5) > 0 && setpoint.speed > 0;
    const double least = by_fins ? c.min_flow + u - flow : -model_.limits.max_speed;
    const double wanted =
        std::clamp(std::max(setpoint.speed, least), -model_.limits.max_speed, model_.limits.max_speed);
    if (!speed_asked_) speed_asked_ = u;
    const double most = model_.limits.max_acceleration * dt;
    const double gain = std::clamp(wanted - *speed_asked_, -most, most);
    // The ramp must not run ahead of thrusters that fall short.
    const bool held = short_of(0), ahead = gain * (*speed_asked_ - u) > 0;
    if (!held || !ahead) *speed_asked_ += gain;
    const double lack = *speed_asked_ - u;
    const double through = *speed_asked_ + flow - u;  // the demand, as a speed through the water
    tau(0) = inertia_(0) * (gain / dt + w * (lack + slow * integrate(kSpeed, lack, dt, held))) + drag(0, through);
  }
  {
    const double w = c.speed_bandwidth, error = setpoint.sway_speed - state.v_B.y();
    const bool can = model_.thruster_axes(1) > 0;
    const double sum = integrate(kSway, error, dt, !can || short_of(1));
    tau(1) = can ? inertia_(1) * w * (error + slow * sum) + drag(1, setpoint.sway_speed) : 0;
  }
  {
    const double w = c.heading_bandwidth;
    const double error = (setpoint.heading - R_WB.heading()).wrapped().radians();
    const double limit = model_.limits.max_yaw_rate.radians();
    const double asked = limited(0.5 * w * error, limit), lack = asked - state.w_B.z();
    tau(5) = inertia_(5) * 2 * w * (lack + slow * integrate(kHeading, lack, dt, short_of(5))) + drag(5, asked);
  }
  const double w = c.depth_bandwidth;
  const double error = std::clamp(setpoint.depth, 0.0, model_.limits.max_depth) - state.X_WB.translation.z();
  const double rate = 0.5 * w * error, limit = model_.limits.max_climb_rate;
  double pitch_wanted = 0;
  if (c.depth_by == DepthBy::kHeave) {
    const double sinking = (R_WB * state.v_B).z();
    const double asked = limited(rate, limit), lack = asked - sinking;
    const double force = inertia_(2) * 2 * w * (lack + slow * integrate(kDepth, lack, dt, short_of(2))) +
                         drag(2, asked) - kGravity * (model_.mass - model_.reference_density * model_.volume);
    tau.head<3>() += force * down_B;
  } else {
    const double along = std::max(std::abs(state.v_B.x()), c.min_flow);
    const double steepest = c.max_pitch.radians();
    const double sum = integrate(kDepth, error, dt, short_of(4) || std::abs(rate) > 0.5 * limit);
    pitch_wanted = limited(-(limited(rate, limit) + 0.5 * w * slow * sum) / along, steepest);
  }
  const double a = c.attitude_bandwidth;
  // Righting moments are known and fed forward: they would otherwise leave the pitch short of its demand.
  const double righting =
      kGravity * (model_.mass * model_.p_BG.z() - model_.reference_density * model_.volume * model_.p_BC.z());
  tau(3) = inertia_(3) * a * (-a * roll - 2 * state.w_B.x());
  tau(4) = inertia_(4) * a * (a * (pitch_wanted - pitch) - 2 * state.w_B.y()) + righting * std::sin(pitch_wanted);

  demand_B_ = tau.cwiseProduct(model_.thruster_axes.cwiseMax(model_.fin_axes));
  allocation_ = allocator_.allocate(demand_B_, flow, model_.reference_density);
  return allocation_.commands;
}

}  // namespace isobath
