// SpaceRoom: how much room there is about each place of a box of water, for a way that may lead over or under what the
// plan view takes for closed (Horner et al. c. 2009, 5; ledger S5-33 to S5-37, S5-39).
//
// Closed is
//   - what the voxel map holds for occupied;
//   - where a hazard of the plan view stands, from surface to bed, all that is not measured: free, and looked at by a
//     sensor that tells height (space_grid.hpp). A fence, a charted or an injected obstacle is closed altogether;
//   - what lies outside the band of depths that the mission goes through anyway, and is not measured.
// So surface and bed keep their distance too: neither is ever measured to be free. Everything else is open, like water
// outside of all hazards is to the planners of the plane.
//
// A hazard that is farther from the vehicle than `look_on_m`, as are all that stand closer to it than `apart_m`, and
// closer to these, may be left open for now, at the mission's depths, where its water is neither measured nor held for
// occupied (unsure): there is time to look, and to turn away (S5-45).
//
// Distances are to the nearest closed voxel's faces, exact at centres of voxels, between them by interpolation; beyond
// `most_m` they are that.
//
// Frame W. What it says never changes, but it finds it out when it is asked, tile by tile of 16 x 16 columns: one
// thread at a time. Cost: of all of a box 6 ns a voxel, of a way through it the tiles that it passes
// (bench/space_bench.cpp).
#pragma once

#include <cstdint>
#include <isobath/map/space_grid.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <memory>
#include <span>
#include <vector>

namespace isobath {

struct SpaceRoomTask {
  Eigen::Vector3d least = Eigen::Vector3d::Zero(), most = Eigen::Vector3d::Zero();  ///< the box, W
  std::span<const Hazard> hazards;                                                  ///< of the plan view, in W
  double shallow_m = 0, deep_m = 0;  ///< the band of depths that is open without having been measured
  double most_m = 5;                 ///< distances beyond are not told apart
  Eigen::Vector3d vehicle_W = Eigen::Vector3d::Zero();
  double apart_m = 0;    ///< hazards that leave no more between them are one
  double look_on_m = 0;  ///< hazards farther than this from the vehicle may turn out to be open; 0: none
};

class SpaceRoom {
 public:
  static constexpr double kMostVoxels = 3e7;

  /// Throws Error where the box holds more than kMostVoxels.
  SpaceRoom(const SpaceGrid& grid, const SpaceRoomTask& task);
  SpaceRoom(SpaceRoom&&) = default;  ///< not while one of what is known takes from it
  /// The same with all closed that is unsure. What does not differ it takes from this one, which must outlive it.
  [[nodiscard]] SpaceRoom of_what_is_known() const;
  /// Whether anything in it can be unsure.
  [[nodiscard]] bool has_unsure() const;

  [[nodiscard]] double voxel_m() const { return grid_.voxel_m(); }
  /// Voxels that can be open: above and below there is none, to the end of the box.
  [[nodiscard]] const VoxelIndex& size() const { return size_; }
  /// Whether the box does.
  [[nodiscard]] bool holds(const Eigen::Vector3d& p_W) const;
  /// The centre of a voxel, counted from the box's least one; and the voxel of a place.
  [[nodiscard]] Eigen::Vector3d centre_of(const VoxelIndex& i) const {
    return ((least_ + i).cast<double>().array() + 0.5) * voxel_m();
  }
  [[nodiscard]] VoxelIndex voxel_at(const Eigen::Vector3d& p_W) const { return floor_of(p_W / voxel_m()) - least_; }

  /// m; 0 outside of the box, and in what is closed.
  [[nodiscard]] double distance(const VoxelIndex& i) const {
    if (!inside(i)) return 0;
    const std::size_t tile = tile_of(i.x() >> kTileLog2, i.y() >> kTileLog2);
    if (measured_[tile] == 0) measure(i.x() >> kTileLog2, i.y() >> kTileLog2);
    return distance_[index_of(i.x(), i.y()) + static_cast<std::size_t>(i.z())];
  }
  [[nodiscard]] double distance(const Eigen::Vector3d& p_W) const;
  [[nodiscard]] bool is_unsure(const Eigen::Vector3d& p_W) const;
  /// Least distance along a leg, looked at each half voxel.
  [[nodiscard]] double leg_distance(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W) const;

 private:
  static constexpr int kTileLog2 = 4, kTile = 1 << kTileLog2;
  static constexpr std::uint16_t kFar = 0x7FFF;  ///< voxels; a column has fewer
  [[nodiscard]] bool inside(const VoxelIndex& i) const {
    return (i.array() >= 0).all() && (i.array() < size_.array()).all();
  }
  [[nodiscard]] std::size_t column_of(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(size_.y()) + static_cast<std::size_t>(y);
  }
  [[nodiscard]] std::size_t index_of(int x, int y) const {
    return column_of(x, y) * static_cast<std::size_t>(size_.z());
  }
  [[nodiscard]] std::size_t tile_of(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(tiles_y_) + static_cast<std::size_t>(y);
  }
  SpaceRoom(const SpaceRoom& other);
  [[nodiscard]] bool is_within_a_tile(const VoxelIndex& i) const;
  void clear();
  [[nodiscard]] bool differs_about(int tile_x, int tile_y) const;
  void trim(const SpaceRoomTask& task);
  [[nodiscard]] static std::vector<bool> may_open(const SpaceRoomTask& task);
  [[nodiscard]] std::vector<std::uint8_t> columns_of(const SpaceRoomTask& task) const;
  void look(int tile_x, int tile_y) const;
  void measure(int tile_x, int tile_y) const;
  template <class Square>
  void measure_by(int tile_x, int tile_y) const;

  SpaceGrid grid_;
  VoxelIndex least_, size_;
  int shallowest_ = 0, deepest_ = 0;  ///< of the box, which may be taller than what is kept of it
  double most_m_;
  int reach_;                           ///< voxels that may matter
  std::vector<std::uint8_t> off_band_;  ///< of each layer, 1 where it is off the mission's depths
  std::vector<std::uint8_t> columns_;   ///< what stands there

  const SpaceRoom* hoped_ = nullptr;  ///< whose unsure voxels are closed here; null: nobody's

  // found out when asked
  int tiles_x_ = 0, tiles_y_ = 0;
  mutable std::vector<std::uint8_t> looked_, measured_;
  std::unique_ptr<std::uint16_t[]> along_;  ///< voxels to the nearest closed one above or below, of tiles looked at
  std::unique_ptr<float[]> distance_;       ///< m, of tiles measured
};

}  // namespace isobath
