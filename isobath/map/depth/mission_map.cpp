#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/fill_polygons.hpp>
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
  read_depths(snapshot);
}

void MissionMap::add_threat(const std::vector<Polygon>& rings, double detection_per_m, double destruction_per_m) {
  constexpr int kParts = 8;
  const PixelGrid parts{grid_.corner_m, grid_.pixel_m / kParts};
  const PixelWindow window{extent_.column * kParts, extent_.row * kParts, extent_.width * kParts,
                           extent_.height * kParts};
  fill_polygons(rings, parts, window, [&](Pixel part) {
    MissionCell& cell = cells_[slot({part.column >> 3, part.row >> 3})];
    static_assert(kParts == 1 << 3);
    cell.detection_per_m += detection_per_m / (kParts * kParts);
    cell.destruction_per_m += destruction_per_m / (kParts * kParts);
  });
}

void MissionMap::read_depths(const DepthSnapshot& snapshot) {
  constexpr int kSide = MissionCell::kPixels;
  std::vector<DepthPixel> pixels(static_cast<std::size_t>(kSide) * kSide);
  for (int row = extent_.row; row < extent_.row + extent_.height; ++row) {
    for (int column = extent_.column; column < extent_.column + extent_.width; ++column) {
      const PixelWindow window{column * kSide, row * kSide, kSide, kSide};
      MissionCell& cell = cells_[slot({column, row})];
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
