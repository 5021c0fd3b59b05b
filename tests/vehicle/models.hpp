// The vehicles of the project, and a plain ellipsoid-like body whose motion has closed forms.
#pragma once

#include <isobath/base/random.hpp>
#include <isobath/vehicle/dynamics.hpp>
#include <tests/support/data.hpp>

namespace isobath::test {

inline VehicleModel remus() { return load_vehicle(source_folder() / "vehicles" / "remus100.toml"); }
inline VehicleModel rov() { return load_vehicle(source_folder() / "vehicles" / "hovering_rov.toml"); }
inline VehicleModel six_thrusters() { return load_vehicle(source_folder() / "vehicles" / "bluerov2.toml"); }

/// Neutral, centres together, no damping, no actuators; M as `of` has it.
inline VehicleModel frictionless(VehicleModel of) {
  of.p_BG.setZero();
  of.p_BC.setZero();
  of.volume = of.mass / of.reference_density;
  of.linear_damping.setZero();
  of.lift_damping.setZero();
  of.quadratic_damping.setZero();
  of.thrusters.clear();
  of.fins.clear();
  return of;
}

/// C(nu) of the symmetric matrix M (Fossen 2011, theorem 3.2).
inline Matrix6 coriolis(const Matrix6& M, const Vector6& velocity) {
  const auto skew = [](const Eigen::Vector3d& a) {
    return Eigen::Matrix3d{{0, -a.z(), a.y()}, {a.z(), 0, -a.x()}, {-a.y(), a.x(), 0}};
  };
  const Vector6 momentum = M * velocity;
  Matrix6 c = Matrix6::Zero();
  c.topRightCorner<3, 3>() = c.bottomLeftCorner<3, 3>() = -skew(momentum.head<3>());
  c.bottomRightCorner<3, 3>() = -skew(momentum.tail<3>());
  return c;
}

/// At the reference density; the velocity is relative to the water.
inline Vector6 damping_wrench(const VehicleModel& m, const Vector6& velocity) {
  return -m.linear_damping * velocity - m.lift_damping * std::abs(velocity(0)) * velocity -
         m.quadratic_damping * velocity.cwiseAbs().cwiseProduct(velocity);
}

inline Vector6 random_velocity(Random& random, double size = 1) {
  Vector6 v;
  for (int i = 0; i < 6; ++i) v(i) = random.uniform(-size, size);
  return v;
}

inline VehicleState at_speed(double u, double depth = 10) {
  VehicleState s;
  s.X_WB.translation.z() = depth;
  s.v_B.x() = u;
  return s;
}

}  // namespace isobath::test
