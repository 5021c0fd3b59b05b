// VoxelModel: the three-dimensional map of a run. Every ping of a fan, horizontal or vertical, goes into the layer of
// its sonar; the layers together are the map (Horner et al. c. 2009, 4; ledger S5-07, S5-13, S5-27 to S5-30).
//
// A sonar is identified by the stance of its fan (horizontal or vertical, divided at 45 degrees), by the fan itself
// (number, width and height of the beams, and the sector), and by where it is mounted and the heading of its axis in
// the body. Each sonar of a vehicle thus has a layer of its own, also two of one kind (S5-30), and a fan that is tilted
// during the run keeps its layer.
//
// Memory is unbounded by default. It can be bounded by a window around the vehicle, outside which blocks are forgotten
// or spilled to a file, or by a number of megabytes, beyond which the blocks that changed longest ago spill. Spilling
// happens after a ping, so the blocks of one ping come on top. A spilled map gives the same files as one without a
// bound (VoxelMap).
//
// Soundings in the water (Sounding::Kind::kWater, in the body frame) come from imaging sonars with true elevation and
// from pairs of cameras. They are narrow beams and have a layer of their own: the voxels that a ray passes are free,
// the voxel where it ends is occupied. A sounding that states the standard deviation of its range (a camera's) frees
// the water up to two of them before its end, and its end counts by the probability that it lies in that voxel. Each
// voxel counts once per swath, as occupied if any ray ends in it. A Swath does not state the lever arm from the vehicle
// to the sonar, so the arm is assumed to lie along the ray. Soundings of the bottom belong to the depth map.
//
// A jump of the position (Pipeline) does not change the distance from vehicle to obstacle. Blocks with evidence since
// the last jump, or from the last two minutes, therefore move along by whole voxels. Relative to the vehicle they are
// off by half a voxel plus the drift of dead reckoning since the measurement. Older evidence stays where the fixes of
// its time placed it.
//
// The edge of the voxels follows from the sonar's range at the first ping, unless `fit` is off. Pings that voxels of
// this size cannot represent (FanMapper::fault_of), and pings beyond the end of the map, are left out and counted.
// Errors: take throws Error if the window is smaller than the sonar's range; the constructor throws Error if the
// configuration asks for files that the program was built without. One thread.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <isobath/map/voxel/occupancy_snapshot.hpp>
#include <isobath/map/voxel/voxel_map.hpp>
#include <isobath/perception/fan_mapper.hpp>
#include <isobath/world/result_sinks.hpp>
#include <isobath/world/voxel_config.hpp>
#include <isobath/world/voxel_truth.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// Counts of the voxel map of a run.
struct VoxelOutcome {
  struct Layer {
    std::string sensor;
    std::uint64_t pings = 0;
  };
  std::vector<Layer> layers;
  double voxel_m = 0;
  std::uint64_t seen = 0, occupied = 0, free = 0, blocks = 0;
  std::uint64_t megabytes = 0;
  std::optional<std::uint64_t> spilled;  ///< blocks, over all layers, that are only in the file; if blocks can spill
  double vehicle_depth_m = 0;            ///< at the end
  std::uint64_t left_out = 0;            ///< blocks outside the range of an OctoMap file
  std::uint64_t moved = 0;               ///< jumps of the position that moved the map
  std::optional<VoxelTruth> truth;       ///< simulated runs only
};

/// The shallowest that solid matter reaches in one column of voxels.
struct ColumnTop {
  Eigen::Vector2d north_east{0, 0};  ///< centre of the column, W
  double depth_m = 0;                ///< upper side of its highest occupied voxel
};

class VoxelModel {
 public:
  /// Bodies of fewer occupied voxels than this, which touch each other, are taken for noise by tops().
  static constexpr std::size_t kSmallestBody = 8;

  /// `spill_file`: used if the configuration lets blocks spill.
  explicit VoxelModel(const VoxelModelConfig& config, std::filesystem::path spill_file = {});

  void update(const PosedPing& posed);
  void update(const Swath& swath, const Pose& X_WB);
  /// Moves recent evidence along with a jump of the position, m.
  void move_along(const Eigen::Vector3d& jump_W);
  /// Completes the spill file. Returns whether there is one.
  bool save() const;
  /// Null before the first ping.
  [[nodiscard]] const VoxelMap* map() const { return map_.get(); }
  [[nodiscard]] VoxelOutcome outcome() const;
  /// Counts of rejected pings and soundings, by reason.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& refused() const { return refused_; }
  /// The tops of all columns with occupied voxels, in order of north and east, as sensors that resolve height have
  /// found them; empty without such a sensor. Cost: about that of outcome().
  [[nodiscard]] std::vector<ColumnTop> tops() const;
  /// A snapshot of the occupancy within a reach of the vehicle at the end of a sweep, for planning. Null without
  /// navigation, and if no sonar that resolves height (vertical fan, soundings) has delivered data since the last call.
  [[nodiscard]] std::shared_ptr<const OccupancySnapshot> space_around(const ScanResult& scan, double reach_m);

 private:
  struct Sonar {
    std::string name;
    bool flat;
    int beams;
    Angle width, height, span;
    Eigen::Vector2d axis_B;  ///< level part of its axis
    Eigen::Vector3d at_B;    ///< where it is mounted
    std::uint64_t pings;
    FanMapper mapper;
    VoxelBlocks* layer;
  };
  Sonar& sonar_of(const Ping& ping);
  /// The layers of sensors that resolve height.
  [[nodiscard]] std::vector<std::string> height_layers() const;
  [[nodiscard]] double voxel_for(double range_m) const;
  void begin(double range_m);
  void note(Time time);
  void move_to(const Eigen::Vector3d& at_W);

  VoxelModelConfig config_;
  std::filesystem::path spill_file_;
  std::unique_ptr<VoxelMap> map_;
  std::vector<std::unique_ptr<Sonar>> sonars_;
  std::uint64_t shots_ = 0;         ///< swaths in the layer of soundings
  std::uint64_t heights_told_ = 0;  ///< pings and swaths of sonars that resolve height, at the last space_around
  double vehicle_depth_m_ = 0;
  std::uint64_t moved_ = 0, last_moved_ = 0;  ///< number of moves, and the revision at the last one
  struct Heard {
    Time time;
    std::uint64_t revision;
  };
  std::deque<Heard> heard_;  ///< revisions of the last two minutes, a second apart
  std::map<std::string, std::uint64_t> refused_;
};

}  // namespace isobath
