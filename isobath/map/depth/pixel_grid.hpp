// PixelGrid: the square pixels of a chart and their position in the world (ledger S1-27, S1-28).
//
// Column grows east and row grows south from the north-west corner of pixel (0, 0), so that rows lie in memory as a
// chart is printed and the quadrants of a quadtree are NW, NE, SW, SE in this order (S1-35). Points are (north, east)
// of W in metres. A pixel owns its west and north edges.
#pragma once

#include <cmath>
#include <cstdint>
#include <Eigen/Core>

namespace isobath {

struct Pixel {
  std::int32_t column = 0;
  std::int32_t row = 0;
  bool operator==(const Pixel&) const = default;
};

/// A rectangle of pixels: its north-west pixel and its size.
struct PixelWindow {
  std::int32_t column = 0;
  std::int32_t row = 0;
  std::int32_t width = 0;
  std::int32_t height = 0;
  bool operator==(const PixelWindow&) const = default;

  [[nodiscard]] bool contains(Pixel p) const {
    return p.column >= column && p.column - column < width && p.row >= row && p.row - row < height;
  }
};

struct PixelGrid {
  Eigen::Vector2d corner_m{0, 0};  ///< north, east of the north-west corner of pixel (0, 0)
  double pixel_m = 0.5;

  /// Floors, never truncates (S1-28). The point must lie within 2^30 pixels of the corner.
  [[nodiscard]] Pixel at(const Eigen::Vector2d& north_east) const {
    return {static_cast<std::int32_t>(std::floor((north_east.y() - corner_m.y()) / pixel_m)),
            static_cast<std::int32_t>(std::floor((corner_m.x() - north_east.x()) / pixel_m))};
  }
  [[nodiscard]] Eigen::Vector2d centre(Pixel p) const {
    return {corner_m.x() - (p.row + 0.5) * pixel_m, corner_m.y() + (p.column + 0.5) * pixel_m};
  }
};

}  // namespace isobath
