// VoxelModel: the three-dimensional map of a run. Every ping of a fan of beams, lying flat or standing upright, goes
// into the layer of its image plane; what they say together is the map (Horner et al. c. 2009, 4; ledger S5-07, S5-13,
// S5-27 to S5-30).
//
// A sonar is known by the stance of its fan (flat or upright, to 45 degrees) and by the fan itself: as many beams, as
// wide, as high. So two sonars on one vehicle have a layer each, and a fan that is tilted on the way keeps its own.
//
// Memory: without a bound; within a window about the vehicle, what leaves it forgotten or spilled to a file; or up to
// so many megabytes, beyond which what changed longest ago spills. Spilling happens after a ping, so that one ping's
// blocks come on top. A spilled map gives the same files as one without bound (VoxelMap).
//
// Soundings in the water (Sounding::Kind::kWater, in the body frame), as an imaging sonar gives them with true
// elevation, are narrow beams and have a layer of their own: the voxels that a ray passes are free, the one where it
// ends is occupied; each counts once a swath, by an echo where there is one. The arm from the vehicle to the sonar,
// which a Swath does not carry, is taken to lie along the ray. Soundings of the bottom are the depth map's.
//
// A position that jumps (Pipeline) says nothing of the water between vehicle and obstacle: what was heard since the
// last jump, or in the last two minutes, moves along by whole voxels. So it is off, relative to the vehicle, by half a
// voxel and what dead reckoning has drifted since it was heard. What is older stays where the fixes of its time have
// put it.
//
// Edge of the voxels: by the sonar's range, unless `fit` is off; the first ping decides. Pings that voxels of this size
// cannot hold (FanMapper::fault_of), and those from beyond the end of the map, are left out and counted. Errors: Error,
// from the ping that shows it, where the window is smaller than the sonar's range; at once, where files are asked for
// that the program was built without. One thread.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <isobath/map/space_grid.hpp>
#include <isobath/map/voxel_map.hpp>
#include <isobath/perception/fan_mapper.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <isobath/runtime/voxel_config.hpp>
#include <isobath/runtime/voxel_truth.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// The map of a run, in numbers.
struct VoxelOutcome {
  struct Layer {
    std::string sensor;
    std::uint64_t pings = 0;
  };
  std::vector<Layer> layers;
  double voxel_m = 0;
  std::uint64_t seen = 0, occupied = 0, free = 0, blocks = 0;
  std::uint64_t megabytes = 0;
  std::optional<std::uint64_t> spilled;  ///< blocks in the file only, of each layer; where blocks can spill
  double vehicle_depth_m = 0;            ///< at the end
  std::uint64_t left_out = 0;            ///< blocks that have no place in an OctoMap file
  std::uint64_t moved = 0;               ///< jumps of the position that it moved along with
  std::optional<VoxelTruth> truth;       ///< of a simulated run
};

class VoxelModel {
 public:
  /// Blocks spill to this file, if by the configuration they spill at all.
  explicit VoxelModel(const VoxelModelConfig& config, std::filesystem::path spill_file = {});

  /// Whether it maps pings at all.
  [[nodiscard]] bool listens() const { return config_.sonars != VoxelModelConfig::Sonars::kNone; }
  void take(const PosedPing& posed);
  void take(const Swath& swath, const Pose& X_WB);
  /// The position jumped, m.
  void move_along(const Eigen::Vector3d& jump_W);
  /// Completes the file that blocks spill to, where there is one. Whether there is.
  bool save() const;
  /// Null before the first ping.
  [[nodiscard]] const VoxelMap* map() const { return map_.get(); }
  [[nodiscard]] VoxelOutcome outcome() const;
  /// Pings and soundings of which no voxels could be made, by reason.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& refused() const { return refused_; }
  /// What is known within a reach of the vehicle at the end of a sweep, for planning; null where none of the sonars
  /// that tell height (a fan that stands upright, soundings) has been heard since it was last asked, and without
  /// navigation.
  [[nodiscard]] std::shared_ptr<const SpaceGrid> space_around(const ScanResult& scan, double reach_m);

 private:
  struct Sonar {
    std::string name;
    bool flat;
    int beams;
    Angle width, height, span;
    std::uint64_t pings;
    FanMapper mapper;
    VoxelBlocks* layer;
  };
  Sonar& sonar_of(const Ping& ping);
  [[nodiscard]] double voxel_for(double range_m) const;
  void begin(double range_m);
  void note(Time time);
  void move_to(const Eigen::Vector3d& at_W);

  VoxelModelConfig config_;
  std::filesystem::path spill_file_;
  std::unique_ptr<VoxelMap> map_;
  std::vector<std::unique_ptr<Sonar>> sonars_;
  std::uint64_t shots_ = 0;         ///< swaths in the layer of soundings
  std::uint64_t heights_told_ = 0;  ///< looks of all that tell height, when it was last asked what is around
  double vehicle_depth_m_ = 0;
  std::uint64_t moved_ = 0, last_moved_ = 0;  ///< how often, and the revision then
  struct Heard {
    Time time;
    std::uint64_t revision;
  };
  std::deque<Heard> heard_;  ///< a second apart, of the last two minutes
  std::map<std::string, std::uint64_t> refused_;
};

}  // namespace isobath
