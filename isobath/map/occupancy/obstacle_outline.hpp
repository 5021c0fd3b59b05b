// Comparison of obstacle outlines: the gap between two convex outlines, and the share of one that lies within the
// other.
//
// Areas are measured with about fourteen points spread evenly over an outline: shares are good to a tenth, which is
// better than sonar measures an outline. Units are the caller's.
#pragma once

#include <isobath/geometry/polygon.hpp>
#include <span>
#include <vector>

namespace isobath {

struct Circle {
  Eigen::Vector2d centre;
  double radius = 0;
};

/// A circle about the middle of an outline's box that contains the outline.
Circle circle_of(const Polygon& outline);
/// A convex outline with at most sixteen corners that contains the given one.
Polygon fewer_corners(const Polygon& outline);
/// Points spread evenly over a convex outline; at least one.
std::vector<Eigen::Vector2d> spread_over(const Polygon& outline);
/// Share of the points, each shifted by `moved`, that lie within a convex outline.
double share_inside(std::span<const Eigen::Vector2d> points, const Eigen::Vector2d& moved, const Polygon& outline);
/// Vector from a to b, both convex, where they are nearest; zero where a corner of one lies in the other.
Eigen::Vector2d gap(const Polygon& a, const Polygon& b);
Polygon moved_by(Polygon outline, const Eigen::Vector2d& shift);

}  // namespace isobath
