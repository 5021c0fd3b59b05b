// Shapes of obstacles in plan for a road map: convex enclosures in three levels of detail, and their growth by the
// vehicle's radius (Rodin, Amin c. 1988, 2.1; ledger S3-10, S3-11, S3-13).
//
// A shape is a list of convex polygons in the positive sense, which together cover the outline. Coarse shapes cost less
// and lose concave water; detail is added only where no path is found. Units: m. Outlines are finite.
#pragma once

#include <cstdint>
#include <isobath/geometry/polygon.hpp>
#include <span>
#include <vector>

namespace isobath {

/// Levels of detail, coarsest first.
enum class ShapeDetail : std::uint8_t { kEnclosure, kHull, kParts };

/// The Minkowski sum of a convex polygon (one or two corners make a point or a segment) with a regular polygon of
/// `sides` sides around a disc. Its border is at a distance between the radius and radius / cos(pi / sides) from the
/// polygon (S3-10). sides >= 3; a radius of 0 gives the hull.
Polygon grown_polygon(const Polygon& convex, double radius_m, int sides);

/// A convex polygon of at most `max_corners` (>= 4) corners that holds the points, to rounding: their hull, from which
/// sides are taken away, each time the one that adds the least area. Cost: 1 us for 12 corners.
Polygon convex_enclosure(const Polygon& points, int max_corners = 6);

/// Convex polygons that meet only at their borders and together are the simple polygon, of any sense: ears are cut off,
/// and neighbours that form a convex polygon are joined (Hertel, Mehlhorn 1983: at most four times as many as the
/// fewest). The hull where the outline is not simple. O(n^2), after the O(n^2) check.
std::vector<Polygon> convex_parts(const Polygon& outline);

/// The shape of an outline, which need not be simple, at a level of detail.
std::vector<Polygon> shape_of(const Polygon& outline, ShapeDetail detail);

}  // namespace isobath
