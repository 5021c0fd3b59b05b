// WorldSnapshot: all maps of a run at one instant, and the question that planners, agents and programs ask of them: can
// a vehicle pass here, how sure is that, and what stands in the way (Oskard 1990, I and III-D; design, 3; ledger S1-01,
// S1-03, S1-41)?
//
// WorldField is one depth field of what the depth map and the voxels know, for a vehicle in a band of depths. A pixel
// has the shoaler of the two: where the maps disagree, the more dangerous one stands, until the evidence of its own
// sonars clears it. Voxels above or below the band do not matter. Where the depth map knows nothing, voxels that were
// measured (occupancy_snapshot.hpp) from the top of the band on are water down to the first one that was not: a bound,
// as from a beam without an echo (DepthPixel::clear_only). All else is unknown.
//
// A single voxel closes nothing: there must be kLeastVoxels in and right beside its column, two voxels above and below
// the band included. Frame W; depths are below the surface. Any thread may ask. Cost: 15 ns per column of the voxels
// to make; to read, that of the depth map and 0.04 us per pixel (bench/space_bench.cpp).
#pragma once

#include <isobath/base/time.hpp>
#include <isobath/map/depth/depth_field.hpp>
#include <isobath/map/spherical/grid_snapshots.hpp>
#include <isobath/map/voxel/occupancy_snapshot.hpp>
#include <isobath/planning/traversability.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// Each pointer may be null: there is no such map.
struct WorldSnapshot {
  std::shared_ptr<const DepthField> depths = {};                   ///< charted and sensed
  std::shared_ptr<const std::vector<ChartObstacle>> objects = {};  ///< of the chart, and found by sonar
  std::optional<Time> looked_ahead = {};            ///< newest reading in `depths` of a range sonar that looks ahead
  std::shared_ptr<const GridSnapshot> sphere = {};  ///< the echoes around the vehicle
  std::shared_ptr<const OccupancySnapshot> voxels = {};  ///< around the vehicle; null where no sonar measures height

  [[nodiscard]] std::span<const ChartObstacle> all_objects() const {
    return objects ? std::span<const ChartObstacle>(*objects) : std::span<const ChartObstacle>();
  }
};

/// Depths between which a vehicle moves, its hull and the clearance included, m.
struct DepthBand {
  double top_m = 0;
  double bottom_m = 0;
};
/// The band of a path of (north, east, depth): the clearance above and below it.
DepthBand band_of(std::span<const Eigen::Vector3d> path, double clearance_m);

class WorldField final : public DepthField {
 public:
  static constexpr int kLeastVoxels = 4;

  /// Without a depth map, pixels are as wide as voxels; without voxels, it is the depth map.
  WorldField(const WorldSnapshot& world, const DepthBand& band);

  [[nodiscard]] PixelGrid grid() const override;
  [[nodiscard]] std::uint64_t version() const override { return depths_ ? depths_->version() : 0; }
  void read(PixelWindow window, std::span<DepthPixel> out) const override;
  /// Whether voxels close any column within the band.
  [[nodiscard]] bool has_solid() const { return has_solid_; }

 private:
  struct Column {
    bool solid = false;
    float depth_m = 0;  ///< solid: of the top of its first occupied voxel in the band; else: measured down to here
  };
  void add_voxels(const DepthBand& band);
  [[nodiscard]] DepthPixel merged(const DepthPixel& depths, const Eigen::Vector2d& centre, double half_m) const;
  [[nodiscard]] std::size_t index_of(int x, int y) const {
    return static_cast<std::size_t>(x) * static_cast<std::size_t>(voxels_->size().y()) + static_cast<std::size_t>(y);
  }

  std::shared_ptr<const DepthField> depths_;
  std::shared_ptr<const OccupancySnapshot> voxels_;
  std::vector<Column> columns_;  ///< of the box of the voxels, x north, y east
  double top_m_ = 0;
  bool has_solid_ = false;
};

/// Whether a vehicle can pass along a path, by all that the maps know: depths, charted and found objects, voxels. At
/// least one point.
Result<Traversability, CorridorRefusal> check_passage(const WorldSnapshot& world, std::span<const Eigen::Vector3d> path,
                                                      const PassageConfig& config);

}  // namespace isobath
