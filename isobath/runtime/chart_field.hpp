// ChartField: a window of a depth map at the resolution of a picture: what is measured, what is charted, how far the
// nearest sounding is, and where the land lies. The rules are those of depth_chart.hpp.
//
// Cells are row-major from the north-west, `cell_m` wide; centres as in `centre`. Distances are exact between the
// centres of cells (Felzenszwalb and Huttenlocher 2012).
#pragma once

#include <cstdint>
#include <isobath/runtime/depth_chart.hpp>
#include <span>
#include <vector>

namespace isobath {

struct ChartField {
  int columns = 0, rows = 0;
  double cell_m = 1;
  Eigen::Vector2d north_west{0, 0};
  double reach_m = 0;             ///< how far from a sounding depths may be interpolated
  std::vector<float> measured;    ///< mean depth, NaN where none
  std::vector<float> charted;     ///< the same of depths that no sensor has confirmed
  std::vector<float> distance_m;  ///< to the nearest measured cell; infinite where there is none at all
  std::vector<std::uint8_t> land;

  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] Eigen::Vector2d centre(int column, int row) const {
    return {north_west.x() - (row + 0.5) * cell_m, north_west.y() + (column + 0.5) * cell_m};
  }
};

/// `columns` * `cell_m` need not be the whole width of the window.
ChartField chart_field(const DepthChart& chart, int columns, int rows, double cell_m);

/// Whether a sensor stands for the depth of this pixel.
bool measured_at(const DepthChart& chart, std::size_t pixel);

/// Mean confidence of the known pixels under each cell, rounded down; -1 where none is known.
std::vector<int> confidence_cells(const DepthChart& chart, const ChartField& field);

/// Depths to trace contours through: one for each `step` cells of the field, smoothed; NaN where none is to be drawn.
struct ChartNodes {
  GridFrame frame;  ///< in (north, east)
  int step = 1;
  std::vector<float> depth_m;             ///< smoothed
  std::vector<float> surface_m;           ///< what the surface says, NaN far outside reach and on land
  std::vector<std::uint8_t> approximate;  ///< farther than half the reach from a sounding, and not charted

  /// Bilinear in `surface_m`, at a cell of the field; NaN where a neighbour is missing.
  [[nodiscard]] float surface_at(int column, int row) const;
  [[nodiscard]] bool approximate_at(const Eigen::Vector2d& north_east) const;
};
ChartNodes chart_nodes(const DepthChart& chart, const ChartField& field, int step);

/// 1 inside of an odd number of rings, for each cell.
std::vector<std::uint8_t> inside_rings(const std::vector<std::vector<Eigen::Vector2d>>& rings, const ChartField& field);

/// Distance of each cell to the nearest cell that is set, in cells.
std::vector<float> distance_to_set(std::span<const std::uint8_t> set, int columns, int rows);

}  // namespace isobath
