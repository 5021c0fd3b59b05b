// SpaceGrid: what was known of the voxels of a box at one instant, for those who plan through it: occupied, free,
// measured, or unknown (Horner et al. c. 2009, 5; ledger S5-32, S5-33).
//
// Occupied is what the map holds for occupied, and is at least `kLeastOccupied` likely to be: a voxel that is rather
// water closes no way by itself. Where the plan view has an obstacle, it is closed all the same unless it is measured.
//
// Free is what all sensors together hold for free. Measured is what the sensors that tell height (a fan that stands
// upright, a beam that is narrow both ways) hold for free by themselves, and what is at most `kMostMeasured` likely to
// be occupied by all. A fan that lies flat hears the whole of an arc at once: that it hears nothing says little of any
// one place on it, and what it hears at a berm's range it says of all heights (S5-34, S5-35). A way over or under
// something needs measured water.
//
// The box holds what the sensors that tell height have looked at, within a reach; outside, all is unknown. Never
// changes once made, so that any thread may look at it; copies share it. Cost: 1 ns a voxel to make
// (bench/space_bench.cpp).
#pragma once

#include <cstdint>
#include <isobath/map/voxel_map.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace isobath {

enum class SpaceCell : std::uint8_t { kUnknown, kFree, kMeasured, kOccupied };

class SpaceGrid {
 public:
  static constexpr double kMostMeasured = 0.2;  ///< S5-33
  static constexpr double kLeastOccupied = 0.5;

  /// Of what lies within `reach_m` of a point of W, along each axis; `heights` names the layers that tell height.
  SpaceGrid(const VoxelMap& map, std::span<const std::string> heights, const Eigen::Vector3d& centre_W, double reach_m);

  [[nodiscard]] double voxel_m() const { return voxel_m_; }
  /// Its least voxel, and how many there are along north, east and down; none where nothing was measured.
  [[nodiscard]] const VoxelIndex& least() const { return least_; }
  [[nodiscard]] const VoxelIndex& size() const { return size_; }

  [[nodiscard]] SpaceCell at(const VoxelIndex& v) const {
    const VoxelIndex i = v - least_;
    if ((i.array() < 0).any() || (i.array() >= size_.array()).any()) return SpaceCell::kUnknown;
    return (*water_)[index_of(i)];
  }
  /// All of a column, from least().z() on; empty outside of the box.
  [[nodiscard]] std::span<const SpaceCell> column(int x, int y) const {
    const VoxelIndex i(x - least_.x(), y - least_.y(), 0);
    if ((i.array() < 0).any() || (i.array() >= size_.array()).any()) return {};
    return {water_->data() + index_of(i), static_cast<std::size_t>(size_.z())};
  }
  /// Layers between which all lies that is measured; where nothing is, the first is greater than the last.
  [[nodiscard]] int first_measured() const { return first_measured_; }
  [[nodiscard]] int last_measured() const { return last_measured_; }

  /// Whether all that is up to `half_height_m` above and below a place of W is measured.
  [[nodiscard]] bool is_measured(const Eigen::Vector3d& p_W, double half_height_m) const;

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
