// WorldConfiguration: the settings of the maps in the world frame.
#pragma once

#include <isobath/map/depth/depth_map.hpp>
#include <isobath/perception/depth_parts.hpp>
#include <isobath/vehicle/state_evaluator.hpp>
#include <isobath/world/depth_prior.hpp>
#include <isobath/world/spherical_model.hpp>
#include <isobath/world/voxel_config.hpp>

namespace isobath {

struct WorldConfiguration {
  VoxelModelConfig voxels;
  SphericalModelConfig sphere;
  DepthMapConfig depth_map;
  DepthMapperParts depth;
  DepthPriorConfig prior;
  StateEvaluatorConfig state;
};

}  // namespace isobath
