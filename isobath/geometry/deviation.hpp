// Standard deviations of plane vectors.
#pragma once

#include <algorithm>
#include <cmath>
#include <Eigen/Core>

namespace isobath {

/// Standard deviation along the direction in which it is greatest, of a symmetric covariance; 0 where rounding makes
/// the variance negative. The unit is the square root of that of the covariance.
inline double greatest_deviation(const Eigen::Matrix2d& covariance) {
  const double half = 0.5 * (covariance(0, 0) - covariance(1, 1)), off = 0.5 * (covariance(0, 1) + covariance(1, 0));
  return std::sqrt(std::max(0.0, 0.5 * covariance.trace() + std::hypot(half, off)));
}

}  // namespace isobath
