// MapDisplay: encodes the maps of a run as items for the live page: occupancy around the vehicle, depths, voxels and
// the spherical grid.
// Only what has changed is encoded.
//
// Depths: the charted area is encoded once, as one coarse picture (at most kOverview pixels a side). After that, each
// tile of the window with sonar readings is encoded at full resolution whenever it has changed. Voxels: each changed
// block is encoded with its voxels of probability 0.5 and more. One call encodes about an eighth of the changed blocks,
// so that no ping waits for all of them. The same voxels are also encoded as cubes of kCube voxels a side, which take a
// thirtieth of the bytes and give the page a quick overview.
//
// Items: docs/live-page.md. Times are those of the events. Each map has a minimum interval between two encodings. One
// thread.
#pragma once

#include <array>
#include <isobath/display/display_state.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/spherical/grid_snapshots.hpp>
#include <isobath/map/voxel/voxel_map.hpp>
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
  static constexpr Duration kSphereInterval = std::chrono::seconds(2);
  static constexpr std::size_t kSphereCells = 8000;

  explicit MapDisplay(DisplayState& items) : items_(items) {}

  void show(Time time, const BodyGrid& grid, const Pose& X_WB);
  /// Whether the next depths are due. Making a snapshot costs time, so ask first.
  [[nodiscard]] bool wants_depths(Time time) const { return show_again(depths_shown_, time, kDepthInterval); }
  void show(Time time, std::shared_ptr<const DepthSnapshot> depths);
  void show(Time time, const VoxelMap& voxels);
  /// The occupied cells of the spherical grid that hold an echo: how many, and the kSphereCells nearest. An echo is
  /// spread over several cells, of which one holds it.
  void show(Time time, const GridSnapshot& sphere);
  /// Call after the voxel map has moved: all voxels are encoded again.
  void voxels_moved(Time time);

 private:
  void show_overview(Time time, const DepthSnapshot& depths);
  void show_tile(Time time, Pixel tile, const PixelGrid& grid, const DepthTile& pixels);
  void show_block(Time time, const VoxelMap& voxels, const VoxelIndex& corner);
  void show_cubes(Time time, double cube_m, std::uint64_t region);

  DisplayState& items_;
  std::optional<Time> grid_shown_, depths_shown_, voxels_shown_, sphere_shown_;
  bool overview_shown_ = false;
  std::shared_ptr<const DepthSnapshot> depths_;  ///< as last shown
  std::uint64_t voxel_revision_ = 0;
  std::vector<VoxelIndex> changed_;                ///< corners of the blocks still to be shown
  std::size_t a_look_ = 0;                         ///< blocks per call
  std::map<std::uint64_t, std::uint32_t> blocks_;  ///< voxels of each block that is shown

  /// The cubes of one region, which has as many cubes a side as a block has voxels.
  struct Region {
    std::array<std::uint8_t, VoxelBlocks::kVolume> cubes{};  ///< the most likely voxel of each
    std::uint32_t voxels = 0;
  };
  std::map<std::uint64_t, Region> regions_;
  std::set<std::uint64_t> told_anew_;  ///< regions of the blocks of this call
};

}  // namespace isobath
