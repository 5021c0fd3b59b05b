// Navigation: one fix of the vehicle's own estimate of where it is.
#pragma once

#include <Eigen/Core>
#include <isobath/base/time.hpp>
#include <isobath/geometry/pose.hpp>
#include <optional>

namespace isobath {

struct Navigation {
  Time time;
  Pose X_WB;                                              ///< body in world: north-east-down, m
  std::optional<Eigen::Vector3d> v_WB;                    ///< velocity of B in W, components in W, m/s
  std::optional<Eigen::Matrix<double, 6, 6>> covariance;  ///< of (position in W, rotation vector in B), m2, m rad, rad2
};

/// What the local metres mean on the globe; logs without it have no geographic output.
struct GeoOrigin {
  double latitude_deg = 0;   ///< WGS 84
  double longitude_deg = 0;  ///< WGS 84
};

}  // namespace isobath
