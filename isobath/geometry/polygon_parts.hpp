// Distances of a body in plan that consists of several convex polygons, its parts.
#pragma once

#include <isobath/geometry/polygon.hpp>
#include <span>

namespace isobath {

/// The point of the parts nearest to p; of several as near, that of the first part. There must be a part.
Eigen::Vector2d nearest_point(std::span<const Polygon> parts, const Eigen::Vector2d& p);
/// Distance of p from the nearest part; 0 inside one; infinite without parts.
double distance_from(std::span<const Polygon> parts, const Eigen::Vector2d& p);
/// gap_between (polygon.hpp) the outline and the part nearest to it; infinite without parts.
double gap_between(std::span<const Polygon> parts, const Polygon& outline);

}  // namespace isobath
