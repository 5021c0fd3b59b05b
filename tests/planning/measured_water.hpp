// Maps in three dimensions by hand: boxes of water that was measured, and of what stands in it.
#pragma once

#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/voxel/occupancy_snapshot.hpp>

namespace isobath::test {

class MeasuredWater {
 public:
  MeasuredWater() : map_({.voxel_m = 0.5, .prior = 0.05, .occupied = 0.7, .free = 0.04, .max_log_odds = 6.9}) {}

  /// Corners in W, m: multiples of 0.5. What is measured there is clear, or is occupied.
  void clear(const Eigen::Vector3d& low, const Eigen::Vector3d& high) { put(low, high, "upright", -3); }
  void occupy(const Eigen::Vector3d& low, const Eigen::Vector3d& high) { put(low, high, "upright", +13); }
  /// By a fan that lies flat: no height is told.
  void clear_flat(const Eigen::Vector3d& low, const Eigen::Vector3d& high) { put(low, high, "flat", -3); }

  [[nodiscard]] OccupancySnapshot grid() const {
    const std::vector<std::string> vertical = {"upright"};
    return OccupancySnapshot(map_, vertical, {0, 0, 0}, 300);
  }

 private:
  void put(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const char* layer, double log_odds) {
    const VoxelIndex from = floor_of(low / 0.5), to = floor_of(high / 0.5);
    for (int x = from.x(); x < to.x(); ++x) {
      for (int y = from.y(); y < to.y(); ++y) {
        for (int z = from.z(); z < to.z(); ++z) map_.layer(layer).add({x, y, z}, to_evidence(log_odds));
      }
    }
  }

  VoxelMap map_;
};

}  // namespace isobath::test
