// Shoal outlines: water of a chart that is too shallow (ledger S1-41), as few convex outlines that planners can go
// round.
//
// Blocked pixels of a row make runs; runs of rows that follow one another are joined to the convex hull of them all, as
// long as it reaches over none of them by more than `overreach_m` to the side. So a slanting shore is one outline, and
// with no overreach outlines are rectangles. Every blocked pixel lies within an outline; an outline covers nothing
// further from a blocked pixel of the same row than the overreach. Where there are too many, pixels are taken two by
// two and blocked if one of them is, until there are few enough. Cost: about 5 ms for 600 x 600 pixels.
#pragma once

#include <cstdint>
#include <isobath/geometry/polygon.hpp>
#include <isobath/map/depth_field.hpp>
#include <vector>

namespace isobath {

struct ShoalRule {
  double depth_m = 1;           ///< shallower than this is blocked
  bool unknown_blocks = false;  ///< whether water that nobody knows is blocked too
  double overreach_m = 1;
  int most_outlines = 1000;
};

/// Convex, in the positive sense, north and east in m.
std::vector<Polygon> shoal_outlines(const DepthField& map, PixelWindow window, const ShoalRule& rule);

}  // namespace isobath
