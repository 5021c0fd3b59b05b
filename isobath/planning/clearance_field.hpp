// ClearanceField: the clearance at each place of a box of water, for paths that may lead over or under hazards that
// close the plan view (Horner et al. c. 2009, 5; ledger S5-33 to S5-37, S5-39).
//
// Closed are
//   - voxels that the voxel map holds for occupied;
//   - at a hazard of the plan view, from surface to bed, all voxels that were not measured; a measured voxel was found
//     free by a sensor that measures height (occupancy_snapshot.hpp). A fence, a charted or an injected obstacle is
//     closed completely;
//   - voxels outside the band of depths that the mission goes through anyway, unless they were measured.
// Paths therefore keep their distance from surface and bed too: neither is ever measured to be free. All other voxels
// are open, as water outside all hazards is to the planners of the plane.
//
// A hazard that is farther from the vehicle than `look_on_m` may be left open for now, at the mission's depths, where
// its water is neither measured nor occupied (unsure): there is time to look, and to turn away (S5-45). This holds only
// if all hazards that are within `apart_m` of it, and of these in turn, are that far too.
//
// Distances are to the faces of the nearest closed voxel: exact at the centres of voxels, interpolated between them.
// Distances beyond `max_m` are given as `max_m`.
//
// Frame W. The answers never change, but they are computed when first needed, in tiles of 16 x 16 columns: one thread
// at a time. Cost: 6 ns per voxel for a whole box; for a path, the tiles that it passes (bench/space_bench.cpp).
#pragma once

#include <cstdint>
#include <isobath/map/voxel/occupancy_snapshot.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <memory>
#include <span>
#include <vector>

namespace isobath {

struct ClearanceTask {
  Eigen::Vector3d least = Eigen::Vector3d::Zero(), most = Eigen::Vector3d::Zero();  ///< the box, W
  std::span<const Hazard> hazards;                                                  ///< of the plan view, in W
  double shallow_m = 0, deep_m = 0;  ///< the band of depths that is open without having been measured
  double max_m = 5;                  ///< distances beyond are not resolved
  Eigen::Vector3d vehicle_W = Eigen::Vector3d::Zero();
  double apart_m = 0;    ///< hazards with no more than this between them count as one
  double look_on_m = 0;  ///< hazards farther than this from the vehicle may turn out to be open; 0: none
};

class ClearanceField {
 public:
  static constexpr double kMaxVoxels = 3e7;

  /// Throws Error where the box holds more than kMaxVoxels.
  ClearanceField(const OccupancySnapshot& grid, const ClearanceTask& task);
  ClearanceField(ClearanceField&&) = default;  ///< not while a field from of_what_is_known takes values from it
  /// The same field with all unsure voxels closed. It takes the values that do not differ from this one, which must
  /// outlive it.
  [[nodiscard]] ClearanceField of_what_is_known() const;
  /// Whether any voxel can be unsure.
  [[nodiscard]] bool has_unsure() const;

  [[nodiscard]] double voxel_m() const { return grid_.voxel_m(); }
  /// Number of voxels that can be open: the layers above and below them, to the end of the box, are closed.
  [[nodiscard]] const VoxelIndex& size() const { return size_; }
  /// Whether the box contains the place.
  [[nodiscard]] bool holds(const Eigen::Vector3d& p_W) const;
  /// The centre of a voxel, counted from the box's first one; and the voxel of a place.
  [[nodiscard]] Eigen::Vector3d centre_of(const VoxelIndex& i) const {
    return ((least_ + i).cast<double>().array() + 0.5) * voxel_m();
  }
  [[nodiscard]] VoxelIndex voxel_at(const Eigen::Vector3d& p_W) const { return floor_of(p_W / voxel_m()) - least_; }

  /// m; 0 outside the box, and in closed voxels.
  [[nodiscard]] double distance(const VoxelIndex& i) const {
    if (!inside(i)) return 0;
    const std::size_t tile = tile_of(i.x() >> kTileLog2, i.y() >> kTileLog2);
    if (measured_[tile] == 0) measure(i.x() >> kTileLog2, i.y() >> kTileLog2);
    return distance_[index_of(i.x(), i.y()) + static_cast<std::size_t>(i.z())];
  }
  [[nodiscard]] double distance(const Eigen::Vector3d& p_W) const;
  [[nodiscard]] bool is_unsure(const Eigen::Vector3d& p_W) const;
  /// Minimum distance along a leg, sampled at each half voxel.
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
  ClearanceField(const ClearanceField& other);
  [[nodiscard]] bool is_within_a_tile(const VoxelIndex& i) const;
  void clear();
  [[nodiscard]] bool differs_about(int tile_x, int tile_y) const;
  void trim(const ClearanceTask& task);
  [[nodiscard]] static std::vector<bool> may_open(const ClearanceTask& task);
  [[nodiscard]] std::vector<std::uint8_t> columns_of(const ClearanceTask& task) const;
  void look(int tile_x, int tile_y) const;
  void measure(int tile_x, int tile_y) const;
  template <class Square>
  void measure_by(int tile_x, int tile_y) const;

  OccupancySnapshot grid_;
  VoxelIndex least_, size_;
  int shallowest_ = 0, deepest_ = 0;  ///< of the box, which may be taller than the layers that are kept
  double max_m_;
  int reach_;                           ///< distance within which voxels matter, in voxels
  std::vector<std::uint8_t> off_band_;  ///< for each layer, 1 where it is off the mission's depths
  std::vector<std::uint8_t> columns_;   ///< kind of hazard in each column

  const ClearanceField* hoped_ = nullptr;  ///< the field whose unsure voxels are closed here; null: none

  // computed when first needed
  int tiles_x_ = 0, tiles_y_ = 0;
  mutable std::vector<std::uint8_t> looked_, measured_;
  std::unique_ptr<std::uint16_t[]> along_;  ///< voxels to the nearest closed one above or below, in tiles looked at
  std::unique_ptr<float[]> distance_;       ///< m, in tiles measured
};

}  // namespace isobath
