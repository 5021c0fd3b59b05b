#include <algorithm>
#include <cmath>
#include <isobath/planning/world_snapshot.hpp>
#include <limits>

namespace isobath {
namespace {

/// Voxels that are measured are said to be occupied with OccupancySnapshot::kMaxMeasured at most.
constexpr int kMeasuredConfidence = static_cast<int>(kFullConfidence * (1 - 2 * OccupancySnapshot::kMaxMeasured));
constexpr int kBeside = 2;  // voxels above and below the band that count for a column

struct Layers {
  int first = 0;
  int last = -1;
  bool whole = false;  ///< the voxels reach up to the top of the band, or to the surface
};

Layers layers_of(const OccupancySnapshot& voxels, const DepthBand& band) {
  const int least = voxels.least().z(), most = least + voxels.size().z() - 1;
  const double voxel = voxels.voxel_m();
  const int first = static_cast<int>(std::floor(std::max(0.0, band.top_m) / voxel));
  return {std::clamp(first, least, most + 1) - least,
          std::clamp(static_cast<int>(std::ceil(band.bottom_m / voxel)) - 1, least - 1, most) - least, first >= least};
}

int occupied_among(std::span<const SpaceCell> column, const Layers& band) {
  const int first = std::max(0, band.first - kBeside);
  const int last = std::min(static_cast<int>(column.size()) - 1, band.last + kBeside);
  int count = 0;
  for (int z = first; z <= last; ++z) count += column[static_cast<std::size_t>(z)] == SpaceCell::kOccupied;
  return count;
}

}  // namespace

DepthBand band_of(std::span<const Eigen::Vector3d> path, double clearance_m) {
  DepthBand band{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Eigen::Vector3d& p : path) {
    band.top_m = std::min(band.top_m, p.z() - clearance_m);
    band.bottom_m = std::max(band.bottom_m, p.z() + clearance_m);
  }
  return band;
}

WorldField::WorldField(const WorldSnapshot& world, const DepthBand& band)
    : depths_(world.depths), voxels_(world.voxels), top_m_(band.top_m) {
  if (!voxels_ || voxels_->size().minCoeff() <= 0 || !(band.top_m <= band.bottom_m)) {
    voxels_ = nullptr;
    return;
  }
  add_voxels(band);
}

void WorldField::add_voxels(const DepthBand& band) {
  const VoxelIndex size = voxels_->size(), least = voxels_->least();
  const Layers layers = layers_of(*voxels_, band);
  const double voxel = voxels_->voxel_m();
  columns_.resize(index_of(size.x() - 1, size.y() - 1) + 1);
  std::vector<std::uint8_t> occupied(columns_.size(), 0);
  for (int x = 0; x < size.x(); ++x) {
    for (int y = 0; y < size.y(); ++y) {
      const auto cells = voxels_->column(least.x() + x, least.y() + y);
      int z = layers.first;
      while (z <= layers.last && cells[static_cast<std::size_t>(z)] == SpaceCell::kMeasured) ++z;
      Column& column = columns_[index_of(x, y)];
      column.depth_m = static_cast<float>(layers.whole ? (least.z() + z) * voxel : top_m_);
      while (z <= layers.last && cells[static_cast<std::size_t>(z)] != SpaceCell::kOccupied) ++z;
      column.solid = z <= layers.last;
      if (column.solid) column.depth_m = static_cast<float>((least.z() + z) * voxel);
      occupied[index_of(x, y)] = static_cast<std::uint8_t>(std::min(occupied_among(cells, layers), 255));
    }
  }
  for (int x = 0; x < size.x(); ++x) {
    for (int y = 0; y < size.y(); ++y) {
      Column& column = columns_[index_of(x, y)];
      if (!column.solid) continue;
      int count = 0;
      for (int i = std::max(0, x - 1); i <= std::min(size.x() - 1, x + 1); ++i) {
        for (int j = std::max(0, y - 1); j <= std::min(size.y() - 1, y + 1); ++j) count += occupied[index_of(i, j)];
      }
      column.solid = count >= kLeastVoxels;
      if (!column.solid) column.depth_m = static_cast<float>(top_m_);
      has_solid_ = has_solid_ || column.solid;
    }
  }
}

PixelGrid WorldField::grid() const {
  if (depths_) return depths_->grid();
  return voxels_ ? PixelGrid{{0, 0}, voxels_->voxel_m()} : PixelGrid{};
}

void WorldField::read(PixelWindow window, std::span<DepthPixel> out) const {
  if (depths_) {
    depths_->read(window, out);
  } else {
    std::fill(out.begin(), out.end(), DepthPixel{});
  }
  if (!voxels_) return;
  const PixelGrid pixels = grid();
  std::size_t i = 0;
  for (std::int32_t row = 0; row < window.height; ++row) {
    for (std::int32_t column = 0; column < window.width; ++column, ++i) {
      out[i] = merged(out[i], pixels.centre({window.column + column, window.row + row}), pixels.pixel_m / 2);
    }
  }
}

DepthPixel WorldField::merged(const DepthPixel& depths, const Eigen::Vector2d& centre, double half_m) const {
  const double voxel = voxels_->voxel_m();
  // The columns that share an area with the pixel.
  constexpr double kEdge = 1e-6;
  const auto first = [&](double at, int least) {
    return static_cast<int>(std::floor((at - half_m) / voxel + kEdge)) - least;
  };
  const auto last = [&](double at, int least) {
    return static_cast<int>(std::ceil((at + half_m) / voxel - kEdge)) - 1 - least;
  };
  const VoxelIndex least = voxels_->least(), size = voxels_->size();
  const int x0 = first(centre.x(), least.x()), x1 = last(centre.x(), least.x());
  const int y0 = first(centre.y(), least.y()), y1 = last(centre.y(), least.y());
  if (x1 < 0 || y1 < 0 || x0 >= size.x() || y0 >= size.y()) return depths;
  const bool whole = x0 >= 0 && y0 >= 0 && x1 < size.x() && y1 < size.y();
  double solid_m = std::numeric_limits<double>::infinity(), clear_m = solid_m;
  for (int x = std::max(0, x0); x <= std::min(size.x() - 1, x1); ++x) {
    for (int y = std::max(0, y0); y <= std::min(size.y() - 1, y1); ++y) {
      const Column& c = columns_[index_of(x, y)];
      double& least_m = c.solid ? solid_m : clear_m;
      least_m = std::min<double>(least_m, c.depth_m);
    }
  }
  if (std::isfinite(solid_m)) {
    if (depths.known() && depths.depth_m() <= solid_m) return depths;
    return {DepthPixel::word_of_depth(solid_m),
            DepthPixel::word_of_state(kMeasuredConfidence, kSensed | kSeenByObstacle, depths.minute())};
  }
  if (depths.known() || !whole || clear_m <= top_m_) return depths;
  return {DepthPixel::word_of_depth(clear_m), DepthPixel::word_of_state(kMeasuredConfidence, kSensed, depths.minute())};
}

Result<Traversability, CorridorRefusal> check_passage(const WorldSnapshot& world, std::span<const Eigen::Vector3d> path,
                                                      const PassageConfig& config) {
  return traversability(WorldField(world, band_of(path, config.clearance_m)), path, config, world.all_objects());
}

}  // namespace isobath
