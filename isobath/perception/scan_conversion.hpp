// Scan conversion: lists the pixels of a triangle or a convex polygon, row by row (Oskard 1990, IV-B.2, citing Newman
// and Sproull; ledger S1-59).
//
// Corners are in pixel coordinates: x grows with the column (east), y with the row (south), and pixel (c, r) is the
// square [c, c + 1) x [r, r + 1). Either sense of rotation.
//
// `pixels_inside`: pixels whose centres are inside. A centre on a west or north side is inside, on an east or south
// side outside. Polygons that share a side therefore neither share nor miss a pixel, bit for bit, if they state its
// corners with equal numbers. `pixels_touched`: all pixels whose square meets the polygon, border and corners included;
// a polygon without an area is a line, which also works. Both are exact to the rounding of doubles.
//
// Spans come one per row from north to south, none empty, clipped to a window. `out` is replaced; it grows to at most
// the rows of the window. |coordinates| < 2^30. Cost: about two divisions per row.
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <isobath/map/depth/pixel_grid.hpp>
#include <span>
#include <vector>

namespace isobath {

/// Pixels column_begin <= column < column_end of a row.
struct PixelSpan {
  std::int32_t row = 0;
  std::int32_t column_begin = 0;
  std::int32_t column_end = 0;
  bool operator==(const PixelSpan&) const = default;
};

void pixels_inside(std::span<const Eigen::Vector2d> convex, const PixelWindow& clip, std::vector<PixelSpan>& out);
void pixels_touched(std::span<const Eigen::Vector2d> convex, const PixelWindow& clip, std::vector<PixelSpan>& out);

/// The rectangle around a segment; half_width 0 gives the segment itself.
std::array<Eigen::Vector2d, 4> thick_segment(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double half_width);

/// (north, east) in W to pixel coordinates.
inline Eigen::Vector2d pixel_coordinates(const PixelGrid& grid, const Eigen::Vector2d& north_east) {
  return {(north_east.y() - grid.corner_m.y()) / grid.pixel_m, (grid.corner_m.x() - north_east.x()) / grid.pixel_m};
}

}  // namespace isobath
