// Directions as a spherical grid has them: azimuth from x' towards y', elevation up.
#pragma once

#include <cmath>
#include <Eigen/Core>
#include <numbers>

namespace isobath::test {

constexpr double kRadiansADegree = std::numbers::pi / 180;

inline Eigen::Vector3d towards(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * kRadiansADegree, e = elevation_deg * kRadiansADegree;
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

}  // namespace isobath::test
