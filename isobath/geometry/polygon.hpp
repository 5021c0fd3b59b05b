// Convex hulls and simple polygons in the plane.
//
// A polygon is a list of corners without repetition of the first, in the positive sense from x to y (which is clockwise
// seen from above where x is forward and y starboard). Units are the caller's (metres everywhere in this project).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace isobath {

using Polygon = std::vector<Eigen::Vector2d>;

inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Andrew's monotone chain; corners on a side are left out. Returns the points unchanged if fewer than three of them
/// span an area.
Polygon convex_hull(std::vector<Eigen::Vector2d> points);

/// Positive for a polygon in the positive sense.
double area(const Polygon& polygon);

/// Whether p lies inside or on the border of a convex polygon.
bool contains(const Polygon& convex, const Eigen::Vector2d& p);

/// The point of a convex polygon (inside or border) nearest to p: p itself if it is inside. The polygon must not be
/// empty.
Eigen::Vector2d nearest_point(const Polygon& convex, const Eigen::Vector2d& p);
/// Distance of p from a convex polygon; 0 inside.
double distance_from(const Polygon& convex, const Eigen::Vector2d& p);
/// The shortest way from a corner of one convex polygon to the other; 0 where a corner of one lies in the other.
double gap_between(const Polygon& a, const Polygon& b);

/// Distance from `origin` along the unit vector `direction` to the first point of the border, if the ray meets it.
std::optional<double> ray_hit(const Polygon& polygon, const Eigen::Vector2d& origin, const Eigen::Vector2d& direction);

// Simple polygons: any sense, convex or not. Exact predicates decide, except where a comment gives a tolerance of 1e-9
// of the size of the coordinates for points on a border.

/// At least three corners, no side of length 0, and sides that meet only where one ends and the next begins. O(n^2).
bool is_simple(const Polygon& polygon);
/// Whether it is simple and every corner is on the inner side of each side or on it (to 1e-9); any sense.
bool is_convex(const Polygon& polygon);
/// Whether p lies inside or on the border.
bool encloses(const Polygon& simple, const Eigen::Vector2d& p);
/// Distance from p to the border: positive inside, negative outside. The polygon must not be empty.
double inner_distance(const Polygon& simple, const Eigen::Vector2d& p);
/// Where the segment from a to b first leaves the polygon, as a share of the segment: 0 where a is outside; empty if
/// the whole segment lies inside or on the border (to 1e-9).
std::optional<double> first_exit(const Polygon& simple, const Eigen::Vector2d& a, const Eigen::Vector2d& b);

}  // namespace isobath
