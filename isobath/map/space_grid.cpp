#include <algorithm>
#include <array>
#include <isobath/map/body_grid.hpp>
#include <isobath/map/space_grid.hpp>

namespace isobath {
namespace {

bool tells_height(std::span<const std::string> heights, const std::string& sensor) {
  return std::find(heights.begin(), heights.end(), sensor) != heights.end();
}

}  // namespace

SpaceGrid::SpaceGrid(const VoxelMap& map, std::span<const std::string> heights, const Eigen::Vector3d& centre_W,
                     double reach_m)
    : voxel_m_(map.voxel_m()) {
  constexpr int kSide = VoxelBlocks::kSide;
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(reach_m);
  const VoxelIndex low = map.voxel_at(centre_W - reach), high = map.voxel_at(centre_W + reach);
  const auto within = [&](const VoxelIndex& corner) {
    return (corner.array() + kSide > low.array()).all() && (corner.array() <= high.array()).all();
  };

  // 1. what the sensors that tell height have looked at
  std::vector<VoxelIndex> corners;
  VoxelIndex most = VoxelIndex::Zero();
  for (const std::string& sensor : map.sensors()) {
    if (!tells_height(heights, sensor)) continue;
    map.find_layer(sensor)->for_each(0, [&](const VoxelBlocks::Block& block) {
      if (!within(block.corner)) return;
      const VoxelIndex end = block.corner.array() + kSide;
      least_ = corners.empty() ? block.corner : VoxelIndex(least_.cwiseMin(block.corner));
      most = corners.empty() ? end : VoxelIndex(most.cwiseMax(end));
      corners.push_back(block.corner);
    });
  }
  if (corners.empty()) return;
  size_ = most - least_;
  water_.assign(
      static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) * static_cast<std::size_t>(size_.z()),
      SpaceCell::kUnknown);

  // 2. block by block, what all sensors say of it
  const VoxelMapConfig& config = map.config();
  const int prior = to_evidence(log_odds_of(config.prior)), free = to_evidence(log_odds_of(config.free)),
            occupied = to_evidence(log_odds_of(config.occupied)),
            most_measured = to_evidence(log_odds_of(kMostMeasured));
  std::vector<std::pair<const VoxelBlocks*, bool>> layers;
  for (const std::string& sensor : map.sensors()) {
    layers.emplace_back(map.find_layer(sensor), tells_height(heights, sensor));
  }
  VoxelIndex corner;
  for (corner.x() = least_.x(); corner.x() < most.x(); corner.x() += kSide) {
    for (corner.y() = least_.y(); corner.y() < most.y(); corner.y() += kSide) {
      for (corner.z() = least_.z(); corner.z() < most.z(); corner.z() += kSide) {
        std::array<int, VoxelBlocks::kVolume> all, heights_alone;
        std::array<std::uint8_t, VoxelBlocks::kVolume> seen{};  // 1: by any sensor, 2: by one that tells height
        all.fill(prior);
        heights_alone.fill(prior);
        bool any = false;
        for (const auto& [layer, height] : layers) {
          const LogOdds16* evidence = layer->find(corner);
          if (!evidence) continue;
          any = true;
          const std::uint8_t mark = height ? 3 : 1;
          for (std::size_t i = 0; i < all.size(); ++i) {
            const bool said = evidence[i] != kUnseen;
            all[i] += said ? evidence[i] : 0;
            heights_alone[i] += said && height ? evidence[i] : 0;
            seen[i] = static_cast<std::uint8_t>(seen[i] | (said ? mark : 0));
          }
        }
        if (!any) continue;
        for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
          const auto at = static_cast<std::size_t>(i);
          if (seen[at] == 0) continue;
          SpaceCell water = SpaceCell::kUnknown;
          if (all[at] >= occupied) water = SpaceCell::kOccupied;
          if (all[at] <= free) water = SpaceCell::kFree;
          if ((seen[at] & 2) != 0 && heights_alone[at] <= free && all[at] <= most_measured)
            water = SpaceCell::kMeasured;
          water_[index_of(corner + VoxelBlocks::place_of(i) - least_)] = water;
        }
      }
    }
  }
}

bool SpaceGrid::is_measured(const Eigen::Vector3d& p_W, double half_height_m) const {
  const Eigen::Vector3d half(0, 0, half_height_m);
  const VoxelIndex top = floor_of((p_W - half) / voxel_m_), bottom = floor_of((p_W + half) / voxel_m_);
  for (VoxelIndex v = top; v.z() <= bottom.z(); ++v.z()) {
    if (at(v) != SpaceCell::kMeasured) return false;
  }
  return true;
}

}  // namespace isobath
