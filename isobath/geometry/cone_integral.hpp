// cone_integral: the integral along a leg of a quantity that is 1 at the centre of a circle and falls linearly to 0 at
// its radius, m. By the midpoints of pieces of half a metre at most.
#pragma once

#include <algorithm>
#include <cmath>
#include <Eigen/Core>

namespace isobath {

inline double cone_integral(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& centre,
                            double radius) {
  constexpr double kPiece = 0.5;  // m
  const Eigen::Vector2d leg = to - from;
  const double length = leg.norm();
  const int pieces = static_cast<int>(std::clamp(std::ceil(length / kPiece), 1.0, 1e6));
  double sum = 0;
  for (int k = 0; k < pieces; ++k) {
    const Eigen::Vector2d p = from + (k + 0.5) / pieces * leg;
    sum += std::max(0.0, 1 - (p - centre).norm() / radius);
  }
  return length * sum / pieces;
}

}  // namespace isobath
