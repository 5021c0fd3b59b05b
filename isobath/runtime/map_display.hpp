// MapDisplay: the maps of a run as items for a page: occupancy around the vehicle, depths, voxels; of each only what
// has changed.
//
// Depths: the whole of what is charted once, coarse enough to be one picture (kOverview pixels a side); then each tile
// of the window in which a sonar has spoken, at full resolution, when it has changed. Voxels: of each block that has
// changed those at least as likely occupied as not; an eighth of these blocks a look, so that no ping waits for all.
// And the same in cubes of kCube voxels a side, which are a thirtieth of the bytes: what a page can draw at a glance.
//
// Items: docs/live-page.md. Times are the events'; each map is shown at most as often as its interval says. One thread.
#pragma once

#include <array>
#include <isobath/geometry/pose.hpp>
#include <isobath/map/body_grid.hpp>
#include <isobath/map/depth_map.hpp>
#include <isobath/map/voxel_map.hpp>
#include <isobath/runtime/display_items.hpp>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

namespace isobath {

class MapDisplay {
 public:
  static constexpr int kOverview = 512;
  static constexpr int kCube = 4;
  static constexpr Duration kGridInterval = std::chrono::milliseconds(450);
  static constexpr Duration kDepthInterval = std::chrono::seconds(1);
  static constexpr Duration kVoxelInterval = std::chrono::seconds(1);

  explicit MapDisplay(DisplayItems& items) : items_(items) {}

  void show(Time time, const BodyGrid& grid, const Pose& X_WB);
  /// Whether it is time to look at these again: a snapshot is not for nothing.
  [[nodiscard]] bool wants_depths(Time time) const { return show_again(depths_shown_, time, kDepthInterval); }
  void show(Time time, std::shared_ptr<const DepthSnapshot> depths);
  void show(Time time, const VoxelMap& voxels);
  /// The voxels stand elsewhere now: all of them are shown anew.
  void voxels_moved(Time time);

 private:
  void show_overview(Time time, const DepthSnapshot& depths);
  void show_tile(Time time, Pixel tile, const PixelGrid& grid, const DepthTile& pixels);
  void show_block(Time time, const VoxelMap& voxels, const VoxelIndex& corner);
  void show_cubes(Time time, double cube_m, std::uint64_t region);

  DisplayItems& items_;
  std::optional<Time> grid_shown_, depths_shown_, voxels_shown_;
  bool overview_shown_ = false;
  std::shared_ptr<const DepthSnapshot> depths_;  ///< as they were shown
  std::uint64_t voxel_revision_ = 0;
  std::vector<VoxelIndex> changed_;                ///< corners of blocks still to be shown
  std::size_t a_look_ = 0;                         ///< so many of them
  std::map<std::uint64_t, std::uint32_t> blocks_;  ///< that are shown: their voxels

  /// As many cubes a side as a block has voxels.
  struct Region {
    std::array<std::uint8_t, VoxelBlocks::kVolume> cubes{};  ///< the most likely voxel of each
    std::uint32_t voxels = 0;
  };
  std::map<std::uint64_t, Region> regions_;
  std::set<std::uint64_t> told_anew_;  ///< regions of the blocks of this look
};

}  // namespace isobath
