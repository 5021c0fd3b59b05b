#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/mission_map.hpp>

namespace isobath {
namespace {

PixelWindow all_cells(const DepthSnapshot& snapshot) {
  const int side = std::max(1, (1 << snapshot.trees().levels()) / MissionCell::kPixels);
  return {0, 0, side, side};
}

/// Whether the whole window is unknown: one query instead of 16384.
bool untouched(const DepthSnapshot& snapshot, const PixelWindow& window) {
  const PixelWindow both = overlap(window, snapshot.window().extent());
  if (both.width > 0 && both.height > 0) return false;
  const auto empty = [&](const RegionQuadtree& tree) {
    if (!tree.square().contains({window.column, window.row})) return true;
    const RegionQuadtree::Leaf leaf = tree.leaf_at({window.column, window.row});
    return leaf.value == DepthPixel::kUnknownDepth && leaf.window.width >= window.width;
  };
  return empty(snapshot.trees().prior()) && empty(snapshot.trees().sensed());
}

}  // namespace

MissionMap::MissionMap(const DepthSnapshot& snapshot) : MissionMap(snapshot, all_cells(snapshot)) {}

MissionMap::MissionMap(const DepthSnapshot& snapshot, const PixelWindow& cells)
    : extent_(cells), grid_{snapshot.grid().corner_m, snapshot.grid().pixel_m * MissionCell::kPixels} {
  const std::int64_t count = std::int64_t{cells.width} * cells.height;
  ISOBATH_ASSERT(count > 0 && count <= kMaxCells);
  cells_.resize(static_cast<std::size_t>(count));
  refresh(snapshot, extent_);
}

void MissionMap::add_threat(const std::vector<Polygon>& rings, double detection_per_m, double destruction_per_m) {
  constexpr int kParts = 8;
  const double step = grid_.pixel_m / kParts;
  for (int row = 0; row < extent_.height * kParts; ++row) {
    const double north = grid_.corner_m.x() - extent_.row * grid_.pixel_m - (row + 0.5) * step;
    std::vector<double> crossings;  // of this row with the rings, east
    for (const Polygon& ring : rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
        if ((a.x() > north) == (b.x() > north)) continue;
        crossings.push_back(a.y() + (north - a.x()) / (b.x() - a.x()) * (b.y() - a.y()));
      }
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const double west = grid_.corner_m.y() + extent_.column * grid_.pixel_m;
      const auto part_at = [&](double east) {  // the first part whose centre is not west of it
        return static_cast<int>(std::ceil(std::clamp((east - west) / step - 0.5, 0.0, 1.0 * extent_.width * kParts)));
      };
      for (int part = part_at(crossings[i]); part < part_at(crossings[i + 1]); ++part) {
        MissionCell& cell = cells_[slot({extent_.column + part / kParts, extent_.row + row / kParts})];
        cell.detection_per_m += detection_per_m / (kParts * kParts);
        cell.destruction_per_m += destruction_per_m / (kParts * kParts);
      }
    }
  }
}

void MissionMap::refresh(const DepthSnapshot& snapshot) {
  const PixelWindow window = snapshot.window().extent();
  constexpr int kShift = 7;
  static_assert(MissionCell::kPixels == 1 << kShift);
  const int first_column = window.column >> kShift, first_row = window.row >> kShift;
  refresh(snapshot, {first_column, first_row, ((window.column + window.width - 1) >> kShift) - first_column + 1,
                     ((window.row + window.height - 1) >> kShift) - first_row + 1});
}

void MissionMap::refresh(const DepthSnapshot& snapshot, const PixelWindow& cells) {
  constexpr int kSide = MissionCell::kPixels;
  std::vector<DepthPixel> pixels(static_cast<std::size_t>(kSide) * kSide);
  const PixelWindow part = overlap(cells, extent_);
  for (int row = part.row; row < part.row + part.height; ++row) {
    for (int column = part.column; column < part.column + part.width; ++column) {
      const PixelWindow window{column * kSide, row * kSide, kSide, kSide};
      MissionCell& cell = cells_[slot({column, row})];
      cell.mean_depth_m = cell.known = 0;
      if (untouched(snapshot, window)) continue;
      snapshot.read(window, pixels);
      std::int64_t sum_cm = 0, known = 0;
      for (const DepthPixel& pixel : pixels) {
        if (!pixel.known()) continue;
        sum_cm += pixel.depth_cm();
        ++known;
      }
      cell.known = static_cast<double>(known) / static_cast<double>(pixels.size());
      cell.mean_depth_m = known > 0 ? 0.01 * static_cast<double>(sum_cm) / static_cast<double>(known) : 0;
    }
  }
}

}  // namespace isobath
