// ChartField: a window of a depth map at picture resolution: measured depths, charted depths, the distance to the
// nearest sounding, and land. depth_chart.hpp states the rules.
//
// Cells are row-major from the north-west, `cell_m` wide; `centre` gives their centres. Distances between the centres
// of cells are exact (Felzenszwalb and Huttenlocher 2012).
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <functional>
#include <isobath/geometry/contours.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/map/depth/pixel_grid.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

using DepthSurface = std::function<std::optional<double>(double north_m, double east_m)>;

struct DepthChart {
  struct Point {
    Eigen::Vector2d north_east{0, 0};
    std::string label;  ///< may be empty
  };

  PixelGrid grid;
  PixelWindow window;
  std::vector<float> depth_m;            ///< width * height, row-major; NaN where unknown
  std::vector<std::uint8_t> confidence;  ///< 0..20, 255 unknown; same size, or empty
  std::vector<std::uint8_t> flags;       ///< PixelFlag; same size, or empty: every known depth is measured
  std::vector<std::vector<Eigen::Vector2d>> tracks;
  std::vector<std::vector<Eigen::Vector2d>> shore;  ///< closed rings, the first corner not repeated
  std::vector<Point> obstructions;
  std::optional<GeoOrigin> origin;  ///< empty: the frame shows metres
  int charted_confidence = 5;       ///< highest without confirmation by a sonar
  std::string title;
  std::string survey, date;  ///< of the data; may be empty
  std::string datum;         ///< "Depths below mean water of January 2025"
  DepthSurface surface;      ///< may be empty: no interpolation
  /// m; 0: three times the mean measured depth, at least 25 m, which is the widest spacing of soundings that IHO S-44
  /// (edition 6, 3.5) accepts without full coverage.
  double reach_m = 0;
};

struct ChartField {
  int columns = 0, rows = 0;
  double cell_m = 1;
  Eigen::Vector2d north_west{0, 0};
  double reach_m = 0;             ///< largest distance from a sounding to interpolate over
  std::vector<float> measured;    ///< mean depth, NaN where none
  std::vector<float> charted;     ///< mean of depths that no sensor has confirmed
  std::vector<float> distance_m;  ///< to the nearest measured cell; infinite if there is none
  std::vector<std::uint8_t> land;

  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] Eigen::Vector2d centre(int column, int row) const {
    return {north_west.x() - (row + 0.5) * cell_m, north_west.y() + (column + 0.5) * cell_m};
  }
};

/// `columns` * `cell_m` need not equal the width of the window.
ChartField chart_field(const DepthChart& chart, int columns, int rows, double cell_m);

/// Whether a pixel's depth was measured by a sensor, or charted and confirmed by a depth sonar.
bool measured_at(const DepthChart& chart, std::size_t pixel);

/// Mean confidence of the known pixels under each cell, rounded down; -1 where none is known.
std::vector<int> confidence_cells(const DepthChart& chart, const ChartField& field);

/// Smoothed depths to trace contours through, one for each block of `step` x `step` cells; NaN where none is drawn.
struct ChartNodes {
  GridFrame frame;  ///< in (north, east)
  int step = 1;
  std::vector<float> depth_m;             ///< smoothed
  std::vector<float> surface_m;           ///< of the surface, NaN far outside reach and on land
  std::vector<std::uint8_t> approximate;  ///< farther than half the reach from a sounding, and not charted

  /// Bilinear in `surface_m`, at a cell of the field; NaN where a neighbour is missing.
  [[nodiscard]] float surface_at(int column, int row) const;
  [[nodiscard]] bool approximate_at(const Eigen::Vector2d& north_east) const;
};
ChartNodes chart_nodes(const DepthChart& chart, const ChartField& field, int step);

/// For each cell: 1 inside an odd number of rings, else 0.
std::vector<std::uint8_t> inside_rings(const std::vector<std::vector<Eigen::Vector2d>>& rings, const ChartField& field);

/// Distance of each cell to the nearest cell that is set, in cells.
std::vector<float> distance_to_set(std::span<const std::uint8_t> set, int columns, int rows);

}  // namespace isobath
