#include <algorithm>
#include <cmath>
#include <isobath/vehicle/adaptive_law.hpp>
#include <isobath/vehicle/dynamics.hpp>

namespace isobath {

namespace {

Matrix6 beside_diagonal(Matrix6 m) {
  m.diagonal().setZero();
  return m;
}

/// The speed and the acceleration that each axis reaches.
struct AxisMotion {
  Vector6 speed, acceleration;
};

AxisMotion usual_motion(const VehicleModel& m) {
  const VehicleLimits& l = m.limits;
  const double turn = l.max_yaw_rate.radians();
  AxisMotion out;
  out.speed << l.max_speed, l.max_speed, l.max_climb_rate, turn, turn, turn;
  out.acceleration << l.max_acceleration, l.max_acceleration, l.max_acceleration, m.autopilot.attitude_bandwidth * turn,
      m.autopilot.attitude_bandwidth * turn, m.autopilot.heading_bandwidth * turn;
  return out;
}

Vector6 bandwidths(const AutopilotConfig& c) {
  Vector6 p;
  p << c.force_bandwidth, c.force_bandwidth, c.force_bandwidth, c.attitude_bandwidth, c.attitude_bandwidth,
      c.heading_bandwidth;
  return p;
}

/// The sum of what each actuator makes at most in each axis, fins at the maximum speed.
Vector6 authority(const VehicleModel& m) {
  Vector6 sum = Vector6::Zero();
  const auto add = [&sum](const Eigen::Vector3d& force, const Eigen::Vector3d& at) {
    sum.head<3>() += force.cwiseAbs();
    sum.tail<3>() += at.cross(force).cwiseAbs();
  };
  for (const Thruster& t : m.thrusters) add(std::max(t.max_forward, t.max_reverse) * t.direction_B, t.p_BT);
  const double pressure = m.limits.max_speed * m.limits.max_speed;
  for (const Fin& f : m.fins) add(f.lift * f.max_deflection.radians() * pressure * f.direction_B, f.p_BF);
  return sum;
}

}  // namespace

ParameterVector plant_parameters(const VehicleModel& m) {
  const double weight = kGravity * m.mass, buoyancy = kGravity * m.reference_density * m.volume;
  ParameterVector theta = ParameterVector::Zero();
  theta.segment<6>(kMasses) = mass_matrix(m, m.reference_density).diagonal();
  theta.segment<6>(kLinearDrag) = m.linear_damping.diagonal();
  theta.segment<6>(kQuadraticDrag) = m.quadratic_damping.diagonal();
  theta(kForce + 2) = weight - buoyancy;
  theta.segment<3>(kMoment) = weight * m.p_BG - buoyancy * m.p_BC;
  return theta;
}

ParameterRange parameter_range(const VehicleModel& m) {
  constexpr double kLeastMass = 0.3, kMostMass = 3, kMostDrag = 4;
  const ParameterVector file = plant_parameters(m);
  const Vector6 reach = authority(m), speed = usual_motion(m).speed;
  ParameterRange range{file, file};
  range.low.segment<6>(kMasses) *= kLeastMass;
  range.high.segment<6>(kMasses) *= kMostMass;
  // A drag that the file gives in one form only may show in the other one: the same force at the usual speed.
  const Vector6 linear = file.segment<6>(kLinearDrag), quadratic = file.segment<6>(kQuadraticDrag);
  const Vector6 both = linear + quadratic.cwiseProduct(speed);
  range.low.segment<12>(kLinearDrag).setZero();
  range.high.segment<6>(kLinearDrag) = kMostDrag * both;
  range.high.segment<6>(kQuadraticDrag) = kMostDrag * both.cwiseQuotient(speed);
  const double level = std::max(reach(0), reach(1));
  ParameterVector around = ParameterVector::Zero();
  around.segment<3>(kForce) << level, level, reach(2);
  around.segment<3>(kMoment) << reach(4), reach(3), std::max(reach(3), reach(4));
  around(kYaw) = reach(5);
  range.low -= around;
  range.high += around;
  return range;
}

AdaptiveLaw::AdaptiveLaw(const VehicleModel& m)
    : coupled_mass_(beside_diagonal(mass_matrix(m, m.reference_density))),
      coupled_linear_(beside_diagonal(m.linear_damping)),
      coupled_quadratic_(beside_diagonal(m.quadratic_damping)),
      lift_(m.lift_damping),
      file_(plant_parameters(m)),
      theta_(file_),
      leakage_(ParameterVector::Zero()),
      range_(parameter_range(m)) {
  constexpr double kUsualTilt = 0.3;  // rad
  const Vector6 p = bandwidths(m.autopilot), mass = file_.segment<6>(kMasses);
  const AxisMotion usual = usual_motion(m);
  feedback_ = 2 * p.cwiseProduct(mass);
  const Vector6 integral = p.cwiseProduct(p).cwiseProduct(mass), part = kShare * integral;
  const Vector6 speed2 = usual.speed.cwiseAbs2();
  gains_.segment<6>(kMasses) = part.cwiseQuotient(usual.acceleration.cwiseAbs2());
  gains_.segment<6>(kLinearDrag) = part.cwiseQuotient(speed2);
  gains_.segment<6>(kQuadraticDrag) = part.cwiseQuotient(speed2.cwiseAbs2());
  // One gain in the plane keeps Gamma constant while the hull turns under the force.
  const double level = m.thruster_axes(1) > 0 ? std::min(integral(0), integral(1)) : integral(0);
  gains_.segment<3>(kForce) << level, level, integral(2);
  gains_.segment<3>(kMoment) << integral(4), integral(3), std::min(part(3), part(4)) / (kUsualTilt * kUsualTilt);
  gains_(kYaw) = integral(5);
  leakage_.head<kForce>().setConstant(1 / kMemory_s);
  leakage_(kMoment + 2) = 1 / kMemory_s;
}

Regressor AdaptiveLaw::regressor(const ReferenceMotion& reference, const Vector6& velocity,
                                 const Eigen::Matrix3d& R_WB) const {
  const Vector6& r = reference.velocity;
  const Eigen::Vector3d v_r = r.head<3>(), w_r = r.tail<3>(), down_B = R_WB.row(2);
  Regressor Y = Regressor::Zero();
  for (int i = 0; i < 6; ++i) {
    Y(i, kMasses + i) = reference.acceleration(i);
    Y(i, kLinearDrag + i) = r(i);
    Y(i, kQuadraticDrag + i) = std::abs(velocity(i)) * r(i);
  }
  for (int i = 0; i < 3; ++i) {  // C nu_r = (-a x w_r, -a x v_r - b x w_r), momenta a and b
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
    Y.block<3, 1>(0, kMasses + i) -= velocity(i) * axis.cross(w_r);
    Y.block<3, 1>(3, kMasses + i) -= velocity(i) * axis.cross(v_r);
    Y.block<3, 1>(3, kMasses + 3 + i) -= velocity(3 + i) * axis.cross(w_r);
    Y.block<3, 1>(3, kMoment + i) = down_B.cross(axis);
  }
  Y.block<3, 3>(0, kForce) = -R_WB.transpose();
  Y(5, kYaw) = -1;
  return Y;
}

Vector6 AdaptiveLaw::known(const ReferenceMotion& reference, const Vector6& velocity) const {
  const Vector6& r = reference.velocity;
  const Vector6 momentum = coupled_mass_ * velocity;
  const Eigen::Vector3d a = momentum.head<3>(), b = momentum.tail<3>();
  Vector6 tau = coupled_mass_ * reference.acceleration + coupled_linear_ * r +
                coupled_quadratic_ * velocity.cwiseAbs().cwiseProduct(r) + std::abs(velocity(0)) * (lift_ * r);
  tau.head<3>() -= a.cross(r.tail<3>());
  tau.tail<3>() -= a.cross(r.head<3>()) + b.cross(r.tail<3>());
  return tau;
}

void AdaptiveLaw::adapt(const Regressor& Y, const Vector6& s, double dt) {
  const ParameterVector moved = theta_ + dt * (rate(Y, s) - leakage_.cwiseProduct(theta_ - file_));
  if (moved.allFinite()) theta_ = moved.cwiseMax(range_.low).cwiseMin(range_.high);
}

}  // namespace isobath
