// Voxel maps for other programs: OctoMap's binary tree (.bt) and PLY points.
//
// Both formats have z up: x east, y north, in metres about the origin of W (voxels keep their exact positions). The
// tree only distinguishes occupied, free and unknown; a cube with eight equal parts becomes one leaf. The points are
// the centres of the occupied voxels with their probability. Errors: none; callers write the bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <isobath/map/voxel/voxel_map.hpp>
#include <string>

namespace isobath {

/// The bytes of the file. The tree cannot hold voxels more than 32767 edges from the origin; their blocks are counted.
struct OctoMapFile {
  std::string bytes;
  std::uint64_t left_out = 0;
};
OctoMapFile octomap_file(const VoxelMap& map);

/// Binary, little-endian: x, y, z and probability as float, in the order of the blocks.
std::string ply_file(const VoxelMap& map);

}  // namespace isobath
