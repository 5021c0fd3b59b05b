// VehicleState: where the vehicle is and how it moves. What dynamics computes, and what simulated sensors measure.
#pragma once

#include <Eigen/Core>
#include <isobath/geometry/pose.hpp>

namespace isobath {

struct VehicleState {
  Pose X_WB;                                      ///< body in world: north-east-down, m
  Eigen::Vector3d v_B = Eigen::Vector3d::Zero();  ///< velocity of B over ground, components in B, m/s
  Eigen::Vector3d w_B = Eigen::Vector3d::Zero();  ///< roll, pitch and yaw rate (p, q, r), components in B, rad/s
};

}  // namespace isobath
