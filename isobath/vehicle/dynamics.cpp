#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <isobath/base/error.hpp>
#include <isobath/vehicle/dynamics.hpp>

namespace isobath {

namespace {

Vector6 wrench_at(const Eigen::Vector3d& force_B, const Eigen::Vector3d& p_BF, const Eigen::Vector3d& torque_B) {
  Vector6 wrench;
  wrench << force_B, p_BF.cross(force_B) + torque_B;
  return wrench;
}

ActuatorMatrix wrenches_of(const VehicleModel& model) {
  ActuatorMatrix wrenches(6, model.actuators());
  int i = 0;
  for (const Thruster& t : model.thrusters) {
    wrenches.col(i++) = wrench_at(t.direction_B, t.p_BT, t.torque_per_thrust * t.direction_B);
  }
  for (const Fin& f : model.fins) {
    wrenches.col(i++) = wrench_at(f.lift * f.direction_B, f.p_BF, Eigen::Vector3d::Zero());
  }
  return wrenches;
}

double time_constant(const VehicleModel& model, int actuator) {
  const int thrusters = static_cast<int>(model.thrusters.size());
  return actuator < thrusters ? model.thrusters[static_cast<std::size_t>(actuator)].time_constant
                              : model.fins[static_cast<std::size_t>(actuator - thrusters)].time_constant;
}

double limited(double command, double low, double high, double dead_zone) {
  return std::abs(command) < dead_zone ? 0 : std::clamp(command, low, high);
}

}  // namespace

struct VehicleDynamics::Motion {
  Eigen::Vector3d p_WB;
  Eigen::Vector4d q_WB;  ///< x, y, z, w
  Vector6 velocity;      ///< relative to the water

  Motion after(const Motion& rate, double dt) const {
    return {p_WB + dt * rate.p_WB, q_WB + dt * rate.q_WB, velocity + dt * rate.velocity};
  }
};

struct VehicleDynamics::Forces {
  Vector6 constant;  ///< at any speed
  Vector6 by_flow;   ///< times u |u|
};

VehicleDynamics::VehicleDynamics(const VehicleModel& model, const VehicleState& initial)
    : model_(model),
      state_(initial),
      actuators_(ActuatorVector::Zero(model.actuators())),
      effectiveness_(ActuatorVector::Ones(model.actuators())),
      wrenches_(wrenches_of(model)),
      half_decay_(ActuatorVector::Zero(model.actuators())),
      decay_(ActuatorVector::Zero(model.actuators())) {
  check_vehicle(model_);
  set_density(model_.reference_density);
}

void VehicleDynamics::set_model(const VehicleModel& model) {
  check_vehicle(model);
  ISOBATH_ASSERT(model.actuators() == actuators_.size());
  model_ = model;
  wrenches_ = wrenches_of(model);
  set_density(density_);
  dt_ = 0;  // time constants may have changed
}

void VehicleDynamics::set_density(double density) {
  ISOBATH_ASSERT(density > 0);
  density_ = density;
  mass_ = mass_matrix(model_, density);
  inverse_mass_ = mass_.llt().solve(Matrix6::Identity());
  fin_share_ = density / model_.reference_density;
  linear_ = fin_share_ * model_.linear_damping;
  lift_ = fin_share_ * model_.lift_damping;
  quadratic_ = fin_share_ * model_.quadratic_damping;
  const double weight = model_.mass * kGravity, buoyancy = density * model_.volume * kGravity;
  net_weight_ = weight - buoyancy;
  weight_moment_ = weight * model_.p_BG - buoyancy * model_.p_BC;
}

void VehicleDynamics::set_step(double dt) {
  ISOBATH_ASSERT(dt > 0);
  dt_ = dt;
  for (int i = 0; i < actuators_.size(); ++i) {
    const double lag = time_constant(model_, i);
    half_decay_(i) = lag > 0 ? std::exp(-0.5 * dt / lag) : 0;
    decay_(i) = lag > 0 ? std::exp(-dt / lag) : 0;
  }
}

void VehicleDynamics::set_effectiveness(int actuator, double effectiveness) {
  ISOBATH_ASSERT(actuator >= 0 && actuator < effectiveness_.size() && effectiveness >= 0 && effectiveness <= 1);
  effectiveness_(actuator) = effectiveness;
}

VehicleDynamics::Forces VehicleDynamics::forces_of(const ActuatorVector& actuators) const {
  Forces f{Vector6::Zero(), Vector6::Zero()};
  const int thrusters = static_cast<int>(model_.thrusters.size());
  for (int i = 0; i < thrusters; ++i) f.constant += actuators(i) * effectiveness_(i) * wrenches_.col(i);
  for (int i = thrusters; i < actuators.size(); ++i) {
    f.by_flow += fin_share_ * actuators(i) * effectiveness_(i) * wrenches_.col(i);
  }
  return f;
}

VehicleDynamics::Motion VehicleDynamics::rate(const Motion& at, const Forces& forces,
                                              const Eigen::Vector3d& current_W) const {
  const Eigen::Vector3d v = at.velocity.head<3>(), w = at.velocity.tail<3>();
  const Eigen::Matrix3d R_WB = Eigen::Quaterniond(at.q_WB).toRotationMatrix();
  const Eigen::Vector3d down_B = R_WB.row(2);

  const Vector6 momentum = mass_ * at.velocity;
  const Eigen::Vector3d a = momentum.head<3>(), b = momentum.tail<3>();
  Vector6 tau = forces.constant + at.velocity(0) * std::abs(at.velocity(0)) * forces.by_flow;
  tau.head<3>() += net_weight_ * down_B - w.cross(a);
  tau.tail<3>() += weight_moment_.cross(down_B) - v.cross(a) - w.cross(b);
  tau.noalias() -= linear_ * at.velocity;
  tau.noalias() -= std::abs(at.velocity(0)) * (lift_ * at.velocity);
  tau.noalias() -= quadratic_ * at.velocity.cwiseAbs().cwiseProduct(at.velocity);

  Motion out;
  out.p_WB = R_WB * v + current_W;
  const Eigen::Vector3d q = at.q_WB.head<3>();
  out.q_WB << 0.5 * (at.q_WB(3) * w + q.cross(w)), -0.5 * q.dot(w);
  out.velocity.noalias() = inverse_mass_ * tau;
  return out;
}

void VehicleDynamics::step(const ActuatorVector& commands, const WaterConditions& water, double dt,
                           const Vector6& external_B) {
  ISOBATH_ASSERT(commands.size() == actuators_.size());
  if (water.density != density_) set_density(water.density);
  if (dt != dt_) set_step(dt);

  ActuatorVector wanted = commands;
  int i = 0;
  for (const Thruster& t : model_.thrusters) {
    wanted(i) = limited(commands(i), -t.max_reverse, t.max_forward, t.dead_zone);
    if (t.time_constant == 0) actuators_(i) = wanted(i);
    ++i;
  }
  for (const Fin& f : model_.fins) {
    const double limit = f.max_deflection.radians();
    wanted(i) = limited(commands(i), -limit, limit, f.dead_zone.radians());
    if (f.time_constant == 0) actuators_(i) = wanted(i);
    ++i;
  }
  const ActuatorVector difference = actuators_ - wanted;
  const ActuatorVector later = wanted + decay_.cwiseProduct(difference);
  Forces first = forces_of(actuators_);
  Forces middle = forces_of(wanted + half_decay_.cwiseProduct(difference));
  Forces last = forces_of(later);
  first.constant += external_B;
  middle.constant += external_B;
  last.constant += external_B;

  const Eigen::Vector3d& current = water.current_W;
  Motion start;
  start.p_WB = state_.X_WB.translation;
  start.q_WB = state_.X_WB.rotation.quaternion().coeffs();
  start.velocity << state_.v_B - state_.X_WB.rotation.inverse() * current, state_.w_B;
  const Motion k1 = rate(start, first, current);
  const Motion k2 = rate(start.after(k1, 0.5 * dt), middle, current);
  const Motion k3 = rate(start.after(k2, 0.5 * dt), middle, current);
  const Motion k4 = rate(start.after(k3, dt), last, current);

  const double sixth = dt / 6;
  state_.X_WB.translation += sixth * (k1.p_WB + 2 * (k2.p_WB + k3.p_WB) + k4.p_WB);
  const Eigen::Vector4d q = start.q_WB + sixth * (k1.q_WB + 2 * (k2.q_WB + k3.q_WB) + k4.q_WB);
  state_.X_WB.rotation = Rotation::from_unit_quaternion(Eigen::Quaterniond(Eigen::Vector4d(q.normalized())));
  const Vector6 velocity = start.velocity + sixth * (k1.velocity + 2 * (k2.velocity + k3.velocity) + k4.velocity);
  state_.v_B = velocity.head<3>() + state_.X_WB.rotation.inverse() * current;
  state_.w_B = velocity.tail<3>();
  actuators_ = later;
}

Allocator::Allocator(const VehicleModel& model, const ActuatorVector& effectiveness)
    : thrusters_(static_cast<int>(model.thrusters.size())),
      fins_(static_cast<int>(model.fins.size())),
      wrenches_(wrenches_of(model)),
      low_(model.actuators()),
      high_(model.actuators()),
      min_flow_(model.autopilot.min_flow),
      reference_density_(model.reference_density) {
  ISOBATH_ASSERT(effectiveness.size() == 0 || effectiveness.size() == model.actuators());
  int i = 0;
  for (const Thruster& t : model.thrusters) {
    low_(i) = -t.max_reverse;
    high_(i++) = t.max_forward;
  }
  for (const Fin& f : model.fins) {
    high_(i) = f.max_deflection.radians();
    low_(i) = -high_(i);
    ++i;
  }
  if (effectiveness.size() > 0) wrenches_ = wrenches_ * effectiveness.asDiagonal();

  // Commands are scaled by their limits: the minimum of their squares then spares weak actuators.
  const auto inverse = [&](int from, int count, const Vector6& axes) -> Inverse {
    if (count == 0) return Inverse::Zero(0, 6);
    const Eigen::VectorXd share = 0.5 * (high_ - low_).segment(from, count);
    const Eigen::MatrixXd map = axes.asDiagonal() * wrenches_.middleCols(from, count) * share.asDiagonal();
    const Eigen::MatrixXd pseudo = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(map).pseudoInverse();
    return share.asDiagonal() * pseudo * axes.asDiagonal();
  };
  thruster_inverse_ = inverse(0, thrusters_, model.thruster_axes);
  fin_inverse_ = inverse(thrusters_, fins_, model.fin_axes);
}

Allocation Allocator::allocate(const Vector6& demand_B, double flow, double density) const {
  Allocation out;
  out.commands.resize(thrusters_ + fins_);
  if (thrusters_ > 0) {
    out.commands.head(thrusters_) = thruster_inverse_ * demand_B;
    for (int i = 0; i < thrusters_; ++i) {
      const double c = out.commands(i);
      const double limit = c > 0 ? high_(i) : low_(i);
      if (std::abs(c) > std::abs(limit)) out.scale = std::min(out.scale, limit / c);
    }
    out.commands.head(thrusters_) *= out.scale;
    out.achieved_B = wrenches_.leftCols(thrusters_) * out.commands.head(thrusters_);
  }
  if (fins_ > 0) {
    const double ratio = density / reference_density_;
    const double steered = std::copysign(std::max(std::abs(flow), min_flow_), flow);
    out.commands.tail(fins_) = (fin_inverse_ * demand_B) / (ratio * steered * std::abs(steered));
    out.commands.tail(fins_) = out.commands.tail(fins_).cwiseMax(low_.tail(fins_)).cwiseMin(high_.tail(fins_)).eval();
    out.achieved_B += ratio * flow * std::abs(flow) * (wrenches_.rightCols(fins_) * out.commands.tail(fins_));
  }
  return out;
}

}  // namespace isobath
