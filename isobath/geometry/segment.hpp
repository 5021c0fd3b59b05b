// nearest_on_segment: the point of a straight segment nearest to a place in the plane.
#pragma once

#include <algorithm>
#include <Eigen/Core>

namespace isobath {

/// A segment of length 0 is its point a.
inline Eigen::Vector2d nearest_on_segment(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                          const Eigen::Vector2d& p) {
  const Eigen::Vector2d side = b - a;
  const double length2 = side.squaredNorm();
  if (length2 == 0) return a;
  return a + std::clamp((p - a).dot(side) / length2, 0.0, 1.0) * side;
}

}  // namespace isobath
