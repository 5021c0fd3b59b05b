#include <algorithm>
#include <array>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/voxel/occupancy_snapshot.hpp>

namespace isobath {
namespace {

bool tells_height(std::span<const std::string> heights, const std::string& sensor) {
  return std::find(heights.begin(), heights.end(), sensor) != heights.end();
}

struct Thresholds {
  int free, occupied, max_measured;
};

/// The evidence of one layer in a block.
struct Said {
  const LogOdds16* evidence;
  int height;  ///< all bits if the layer resolves height, else none
};

/// One number for each z layer of a block.
using Line = std::array<int, VoxelBlocks::kSide>;

/// Pools all layers along a line in depth. Free of branches, so that the compiler vectorises its loops.
void pool_line(std::span<const Said> layers, int line, int prior, const Thresholds& at, SpaceCell* water,
               Line& measured) {
  constexpr std::size_t kSide = VoxelBlocks::kSide;
  Line all, heights, seen{}, cells;  // seen: 1 by any sensor, 2 by one that resolves height
  all.fill(prior);
  heights.fill(prior);
  for (const Said& layer : layers) {
    const LogOdds16* evidence = layer.evidence + line;
    for (std::size_t k = 0; k < kSide; ++k) {
      const int said = -static_cast<int>(evidence[k] != kUnseen), more = evidence[k] & said;
      all[k] += more;
      heights[k] += more & layer.height;
      seen[k] |= said & (1 | (layer.height & 2));
    }
  }
  for (std::size_t k = 0; k < kSide; ++k) {
    const int occupied = -static_cast<int>(all[k] >= at.occupied), free = -static_cast<int>(all[k] <= at.free);
    const int clear = -static_cast<int>(heights[k] <= at.free) & -static_cast<int>(all[k] <= at.max_measured) &
                      -static_cast<int>((seen[k] & 2) != 0);
    int cell = occupied & static_cast<int>(SpaceCell::kOccupied);
    cell = (free & static_cast<int>(SpaceCell::kFree)) | (~free & cell);
    cell = (clear & static_cast<int>(SpaceCell::kMeasured)) | (~clear & cell);
    cells[k] = cell & -static_cast<int>(seen[k] != 0);
    measured[k] |= clear;
  }
  for (std::size_t k = 0; k < kSide; ++k) water[k] = static_cast<SpaceCell>(cells[k]);
}

}  // namespace

OccupancySnapshot::OccupancySnapshot(const VoxelMap& map, std::span<const std::string> heights,
                                     const Eigen::Vector3d& centre_W, double reach_m)
    : voxel_m_(map.voxel_m()) {
  constexpr int kSide = VoxelBlocks::kSide;
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(reach_m);
  const VoxelIndex low = map.voxel_at(centre_W - reach), high = map.voxel_at(centre_W + reach);
  const auto within = [&](const VoxelIndex& corner) {
    return (corner.array() + kSide > low.array()).all() && (corner.array() <= high.array()).all();
  };

  // 1. the box that the height-resolving sensors have observed
  std::vector<VoxelIndex> corners;
  for (const std::string& sensor : map.sensors()) {
    if (tells_height(heights, sensor)) map.find_layer(sensor)->corners_after(0, corners);
  }
  std::erase_if(corners, [&](const VoxelIndex& corner) { return !within(corner); });
  if (corners.empty()) return;
  least_ = corners.front();
  VoxelIndex most = corners.front();
  for (const VoxelIndex& corner : corners) {
    least_ = least_.cwiseMin(corner);
    most = most.cwiseMax(corner);
  }
  most.array() += kSide;
  size_ = most - least_;
  std::vector<SpaceCell> water(
      static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) * static_cast<std::size_t>(size_.z()),
      SpaceCell::kUnknown);

  // 2. block by block, the pooled evidence of all sensors
  const VoxelMapConfig& config = map.config();
  const Thresholds at{to_evidence(log_odds_of(config.free)),
                      to_evidence(log_odds_of(std::max(config.occupied, kMinOccupied))),
                      to_evidence(log_odds_of(kMaxMeasured))};
  const int prior = to_evidence(log_odds_of(config.prior));
  std::vector<std::pair<const VoxelBlocks*, bool>> layers;
  for (const std::string& sensor : map.sensors()) {
    layers.emplace_back(map.find_layer(sensor), tells_height(heights, sensor));
  }
  first_measured_ = most.z();
  last_measured_ = least_.z() - 1;
  std::vector<Said> said;
  VoxelIndex corner;
  for (corner.x() = least_.x(); corner.x() < most.x(); corner.x() += kSide) {
    for (corner.y() = least_.y(); corner.y() < most.y(); corner.y() += kSide) {
      for (corner.z() = least_.z(); corner.z() < most.z(); corner.z() += kSide) {
        said.clear();
        for (const auto& [layer, height] : layers) {
          if (const LogOdds16* evidence = layer->find(corner)) said.push_back({evidence, height ? -1 : 0});
        }
        if (said.empty()) continue;
        Line measured{};
        for (int line = 0; line < VoxelBlocks::kVolume; line += kSide) {
          const VoxelIndex first = corner + VoxelBlocks::place_of(line) - least_;
          pool_line(said, line, prior, at, &water[index_of(first)], measured);
        }
        for (int k = 0; k < kSide; ++k) {
          if (measured[static_cast<std::size_t>(k)] == 0) continue;
          first_measured_ = std::min(first_measured_, corner.z() + k);
          last_measured_ = std::max(last_measured_, corner.z() + k);
        }
      }
    }
  }
  water_ = std::make_shared<const std::vector<SpaceCell>>(std::move(water));
}

bool OccupancySnapshot::is_measured(const Eigen::Vector3d& p_W, double half_height_m) const {
  const Eigen::Vector3d half(0, 0, half_height_m);
  const VoxelIndex top = floor_of((p_W - half) / voxel_m_), bottom = floor_of((p_W + half) / voxel_m_);
  for (VoxelIndex v = top; v.z() <= bottom.z(); ++v.z()) {
    if (at(v) != SpaceCell::kMeasured) return false;
  }
  return true;
}

std::vector<Eigen::Vector2d> OccupancySnapshot::occupied_columns(const Eigen::Vector3d& p_W, double half_height_m,
                                                                 double reach_m) const {
  const Eigen::Vector3d half(reach_m, reach_m, half_height_m);
  const VoxelIndex low = floor_of((p_W - half) / voxel_m_).cwiseMax(least_);
  const VoxelIndex high = floor_of((p_W + half) / voxel_m_).cwiseMin(least_ + size_ - VoxelIndex::Ones());
  std::vector<Eigen::Vector2d> columns;
  if (high.z() < low.z()) return columns;
  for (int x = low.x(); x <= high.x(); ++x) {
    for (int y = low.y(); y <= high.y(); ++y) {
      const std::span<const SpaceCell> layer = column(x, y).subspan(static_cast<std::size_t>(low.z() - least_.z()),
                                                                    static_cast<std::size_t>(high.z() - low.z() + 1));
      if (std::ranges::find(layer, SpaceCell::kOccupied) == layer.end()) continue;
      columns.emplace_back((x + 0.5) * voxel_m_, (y + 0.5) * voxel_m_);
    }
  }
  return columns;
}

}  // namespace isobath
