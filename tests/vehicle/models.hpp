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
