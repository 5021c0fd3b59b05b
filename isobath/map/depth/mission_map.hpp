// MissionMap: the coarsest map level, for planning whole missions (Oskard 1990, III-D; ledger S1-37, S1-E02,
// S1-E11).
//
// Cells of 128 x 128 pixels: 64 m for pixels of 0.5 m, 25 a mile (the paper's 25 x 25 a square mile, rounded to whole
// tiles of the finest map). Each cell holds the mean of its known depths, the share of its area that is known, and the
// rates at which a vehicle there is detected and destroyed, per metre of path: a rate, so that the risk of a path does
// not depend on how it is sampled. Depths come from one snapshot of the finer maps. Cells are addressed in cells of the
// map (pixel / 128).
#pragma once

#include <isobath/geometry/polygon.hpp>
#include <isobath/map/depth/depth_map.hpp>
#include <span>
#include <vector>

namespace isobath {

struct MissionCell {
  static constexpr int kPixels = 128;  ///< a side

  double mean_depth_m = 0;  ///< of the known part
  double known = 0;         ///< share of the area, 0..1
  double detection_per_m = 0;
  double destruction_per_m = 0;
};

class MissionMap {
 public:
  static constexpr std::int64_t kMaxCells = 1 << 22;
  /// All cells of the map, or those of a window of them; at most kMaxCells.
  explicit MissionMap(const DepthSnapshot& snapshot);
  MissionMap(const DepthSnapshot& snapshot, const PixelWindow& cells);

  [[nodiscard]] const PixelWindow& extent() const { return extent_; }
  /// The position of the cells; pixel_m is the side of a cell.
  [[nodiscard]] const PixelGrid& grid() const { return grid_; }
  [[nodiscard]] const MissionCell& at(Pixel cell) const { return cells_[slot(cell)]; }
  /// Adds the rates of a threat to the cells, each by the share of it that lies within the rings (even-odd rule, to an
  /// eighth of a cell along each side). From prior knowledge only.
  void add_threat(const std::vector<Polygon>& rings, double detection_per_m, double destruction_per_m);

 private:
  [[nodiscard]] std::size_t slot(Pixel cell) const {
    return static_cast<std::size_t>(cell.row - extent_.row) * extent_.width + (cell.column - extent_.column);
  }
  void read_depths(const DepthSnapshot& snapshot);

  PixelWindow extent_;
  PixelGrid grid_;
  std::vector<MissionCell> cells_;
};

}  // namespace isobath
