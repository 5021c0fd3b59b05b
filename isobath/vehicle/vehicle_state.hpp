// VehicleState: pose and velocity of the vehicle, which the dynamics compute and simulated sensors measure.
#pragma once

#include <Eigen/Core>
#include <isobath/base/time.hpp>
#include <isobath/geometry/pose.hpp>
#include <optional>

namespace isobath {

struct VehicleState {
  Pose X_WB;                                      ///< body in world: north-east-down, m
  Eigen::Vector3d v_B = Eigen::Vector3d::Zero();  ///< velocity of B over ground, components in B, m/s
  Eigen::Vector3d w_B = Eigen::Vector3d::Zero();  ///< roll, pitch and yaw rate (p, q, r), components in B, rad/s
};

/// Ground truth of the vehicle's motion at an instant; only a simulator knows it.
struct TrueMotion {
  Time time;
  VehicleState state;
  std::optional<double> altitude_m;                     ///< of B above the bottom; empty: no bottom below
  Eigen::Vector3d current_W = Eigen::Vector3d::Zero();  ///< of the water over ground, m/s
};

}  // namespace isobath
