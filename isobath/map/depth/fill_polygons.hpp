// fill_polygons: the pixels of a grid whose centres lie within polygons.
#pragma once

#include <cstdint>
#include <functional>
#include <isobath/geometry/polygon.hpp>
#include <isobath/map/depth/pixel_grid.hpp>
#include <vector>

namespace isobath {

/// Calls `visit` with every pixel of the window whose centre lies within the rings (even-odd rule), row by row from the
/// north-west. Cost: rows that the rings meet times corners of the rings, and the pixels.
void fill_polygons(const std::vector<Polygon>& rings, const PixelGrid& grid, const PixelWindow& window,
                   const std::function<void(Pixel)>& visit);

}  // namespace isobath
