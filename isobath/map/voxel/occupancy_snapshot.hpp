// OccupancySnapshot: the state of the voxels of a box at one instant, for planners: occupied, free, measured, or
// unknown (Horner et al. c. 2009, 5; ledger S5-32, S5-33).
//
// Occupied voxels are those that the map counts as occupied and whose probability is at least `kMinOccupied`: a voxel
// that is more likely water closes no passage by itself. Where the plan view has an obstacle, a voxel that is not
// measured is closed all the same.
//
// Free voxels are those that all sensors together count as free. Measured voxels are those that the height-resolving
// sensors (a vertical fan, or a beam that is narrow in both directions) count as free by themselves, and whose
// probability by all sensors is at most `kMaxMeasured`. A horizontal fan receives a whole vertical arc at once: the
// absence of an echo says little about any one place on the arc, and an echo at a berm's range applies to all heights
// (S5-34, S5-35). A passage over or under something requires measured water.
//
// The box contains what the height-resolving sensors have observed within a reach; outside, all is unknown. A grid
// never changes once made, so any thread may read it; copies share the voxels. Cost: 1 ns a voxel to make
// (bench/space_bench.cpp).
#pragma once

#include <cstdint>
#include <isobath/map/voxel/voxel_map.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace isobath {

enum class SpaceCell : std::uint8_t { kUnknown, kFree, kMeasured, kOccupied };

class OccupancySnapshot {
 public:
  static constexpr double kMaxMeasured = 0.2;  ///< S5-33
  static constexpr double kMinOccupied = 0.5;

  /// Covers `reach_m` around a point of W along each axis; `heights` names the layers that resolve height.
  OccupancySnapshot(const VoxelMap& map, std::span<const std::string> heights, const Eigen::Vector3d& centre_W,
                    double reach_m);

  [[nodiscard]] double voxel_m() const { return voxel_m_; }
  /// The lowest voxel, and the number of voxels along north, east and down; zero where nothing was measured.
  [[nodiscard]] const VoxelIndex& least() const { return least_; }
  [[nodiscard]] const VoxelIndex& size() const { return size_; }

  [[nodiscard]] SpaceCell at(const VoxelIndex& v) const {
    const VoxelIndex i = v - least_;
    if ((i.array() < 0).any() || (i.array() >= size_.array()).any()) return SpaceCell::kUnknown;
    return (*water_)[index_of(i)];
  }
  /// The whole column, from least().z() on; empty outside the box.
  [[nodiscard]] std::span<const SpaceCell> column(int x, int y) const {
    const VoxelIndex i(x - least_.x(), y - least_.y(), 0);
    if ((i.array() < 0).any() || (i.array() >= size_.array()).any()) return {};
    return {water_->data() + index_of(i), static_cast<std::size_t>(size_.z())};
  }
  /// The range of z layers that contains every measured voxel; if there is none, the first is greater than the last.
  [[nodiscard]] int first_measured() const { return first_measured_; }
  [[nodiscard]] int last_measured() const { return last_measured_; }

  /// Whether everything up to `half_height_m` above and below a point of W is measured.
  [[nodiscard]] bool is_measured(const Eigen::Vector3d& p_W, double half_height_m) const;
  /// The middles (north, east) of the columns within `reach_m` of a point of W, along each axis, that hold an occupied
  /// voxel up to `half_height_m` above or below it. Cost: 1 ns a voxel.
  [[nodiscard]] std::vector<Eigen::Vector2d> occupied_columns(const Eigen::Vector3d& p_W, double half_height_m,
                                                              double reach_m) const;

 private:
  [[nodiscard]] std::size_t index_of(const VoxelIndex& i) const {
    return (static_cast<std::size_t>(i.x()) * static_cast<std::size_t>(size_.y()) + static_cast<std::size_t>(i.y())) *
               static_cast<std::size_t>(size_.z()) +
           static_cast<std::size_t>(i.z());
  }

  double voxel_m_;
  VoxelIndex least_ = VoxelIndex::Zero(), size_ = VoxelIndex::Zero();
  int first_measured_ = 0, last_measured_ = -1;
  std::shared_ptr<const std::vector<SpaceCell>> water_;
};

}  // namespace isobath
