// How the map in three dimensions of a run is made (VoxelModel).
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/map/voxel_map.hpp>
#include <isobath/perception/fan_mapper.hpp>

namespace isobath {

struct VoxelModelConfig {
  enum class Sonars : std::uint8_t { kNone, kFans, kAll } sonars = Sonars::kFans;
  bool fit = true;
  bool surface = true;
  double window_m = 0;  ///< half the edge of a box about the vehicle; 0: all is kept
  bool spill = false;   ///< what leaves the window goes to a file
  bool vdb = false;     ///< writes voxels.vdb too
  int memory_mb = 0;    ///< 0: no bound
  VoxelMapConfig map{.voxel_m = 0.25, .prior = 0.05, .occupied = 0.25, .free = 0.045, .most_log_odds = 6.9};
  FanMapperConfig fans;
};
std::vector<Field> fields(VoxelModelConfig& config);

}  // namespace isobath
