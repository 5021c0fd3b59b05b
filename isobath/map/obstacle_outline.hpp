// Outlines of obstacles, compared: how far two convex outlines are apart, and how much of one lies within the other.
//
// Areas are measured by points spread evenly over an outline, about fourteen: shares are good to a tenth, which is
// better than sonar knows an outline. Units are the caller's.
#pragma once

#include <isobath/geometry/polygon.hpp>
#include <span>
#include <vector>

namespace isobath {

struct Circle {
  Eigen::Vector2d centre;
  double radius = 0;
};

/// About the middle of the box of an outline, holding all of it.
Circle circle_of(const Polygon& outline);
/// A convex outline of sixteen corners at most that holds the other.
Polygon fewer_corners(const Polygon& outline);
/// Points evenly spread over a convex outline; never none.
std::vector<Eigen::Vector2d> spread_over(const Polygon& outline);
/// Share of points, each moved by the same, that lie within a convex outline.
double share_inside(std::span<const Eigen::Vector2d> points, const Eigen::Vector2d& moved, const Polygon& outline);
/// From a to b, both convex, where they are nearest; zero where a corner of one lies in the other.
Eigen::Vector2d gap(const Polygon& a, const Polygon& b);
Polygon moved_by(Polygon outline, const Eigen::Vector2d& shift);

}  // namespace isobath
