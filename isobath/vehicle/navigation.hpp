// Navigation: one fix of the vehicle's own position estimate.
#pragma once

#include <Eigen/Core>
#include <isobath/base/time.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/geometry/pose.hpp>
#include <optional>

namespace isobath {

struct Navigation {
  Time time;
  Pose X_WB;                                 ///< body in world: north-east-down, m
  std::optional<Eigen::Vector3d> v_WB = {};  ///< velocity of B in W, components in W, m/s
  /// Of (position in W, rotation vector in B), m2, m rad, rad2.
  std::optional<Eigen::Matrix<double, 6, 6>> covariance = {};
  std::optional<double> v_sigma = {};  ///< standard deviation of v_WB in the plane, along its longer axis, m/s
};

}  // namespace isobath
