// Exact predicates: `orientation` decides on which side of a line a point lies, `in_circle` whether it lies inside a
// circle. Both signs are exact within the limits below.
//
// Source: J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates, 1997. An
// evaluation in doubles with an error bound decides nearly all cases. In the others the determinant is summed without
// any rounding, as an expansion (a sum of doubles that do not overlap).
//
// Limits: IEEE doubles, rounding to nearest, and a compiler that contracts no expressions (-ffp-contract=off).
// Coordinates are finite, |x| < 1e70. The signs are not guaranteed where differences of coordinates are below 1e-70.
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
