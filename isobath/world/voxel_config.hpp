// VoxelModelConfig: how the voxel map of a run is made (VoxelModel).
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/map/voxel/voxel_map.hpp>
#include <isobath/perception/fan_mapper.hpp>

namespace isobath {

struct VoxelModelConfig {
  enum class Sonars : std::uint8_t { kNone, kFans, kAll } sonars = Sonars::kFans;
  bool fit = true;
  bool surface = true;
  double window_m = 0;  ///< half the edge of a box around the vehicle; 0: everything is kept
  bool spill = false;   ///< blocks that leave the window go to a file
  bool vdb = false;     ///< also writes voxels.vdb
  int memory_mb = 0;    ///< maximum memory of the evidence; 0: no bound
  VoxelMapConfig map{.voxel_m = 0.25, .prior = 0.05, .occupied = 0.25, .free = 0.045, .max_log_odds = 6.9};
  FanMapperConfig fans;
};
std::vector<Field> fields(VoxelModelConfig& config);

}  // namespace isobath
