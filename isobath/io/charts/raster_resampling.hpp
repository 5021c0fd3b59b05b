// The depth at a pixel of the map from the cells of a raster: of all cells within the pixel if cells are finer, between
// the centres of cells if they are coarser (read_prior.hpp). Internal to the readers of priors.
#pragma once

#include <cmath>
#include <cstddef>
#include <Eigen/Core>
#include <isobath/geometry/smooth_surface.hpp>
#include <vector>

namespace isobath {

/// Cells of a part of a raster, in the numbers of the file; NaN: no data.
struct RasterPiece {
  int column = 0, row = 0, width = 0, height = 0;
  std::vector<float> value, sigma;

  [[nodiscard]] std::size_t at(int c, int r) const {
    return static_cast<std::size_t>(r - row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(c - column);
  }
  [[nodiscard]] bool holds(int c, int r) const {
    return c >= column && r >= row && c < column + width && r < row + height && std::isfinite(value[at(c, r)]);
  }
};

struct RasterSpot {
  double depth = NAN, variance = NAN;
};

/// Combines the cells whose centres lie within a pixel of this half size about `cell`, in columns and rows of the
/// raster. "Shoalest" uses the sign of the file (+1 or -1): the lowest number if numbers are positive down, the highest
/// if positive up.
RasterSpot spot_of_area(const RasterPiece& piece, const Eigen::Vector2d& cell, const Eigen::Vector2d& half, Merge merge,
                        int sign);
/// Interpolates between the centres of cells.
RasterSpot spot_between(const RasterPiece& piece, const Eigen::Vector2d& cell, Merge merge, int sign);

}  // namespace isobath
