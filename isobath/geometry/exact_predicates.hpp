// Exact predicates: the side of a line, and inside or outside a circle, decided correctly for any doubles.
//
// Source: J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates, 1997. A
// double evaluation with an error bound nearly always decides; where it cannot, the determinant is summed without any
// rounding as an expansion (a sum of doubles that do not overlap). Needs IEEE doubles, round to nearest and no
// contraction. Coordinates are finite, |x| < 1e70, and relevant differences are over 1e-70.
#pragma once

#include <Eigen/Core>

namespace isobath {

/// The sign is exact: positive where a, b, c turn in the positive sense (from x to y), 0 where they lie on one line.
/// The value is about twice the area of the triangle.
double orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

/// The sign is exact: positive where d lies inside the circle through a, b, c (which turn in the positive sense), 0 on
/// the circle.
double in_circle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                 const Eigen::Vector2d& d);

}  // namespace isobath
