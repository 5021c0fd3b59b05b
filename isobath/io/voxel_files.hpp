// Voxel maps for other programs: OctoMap's binary tree (.bt) and PLY points.
//
// Both have z up: x east, y north, in metres about the origin of W (voxels keep their places exactly). The tree tells
// occupied, free and unknown apart and nothing finer; what is alike in all eight parts of a cube is one leaf. The
// points are the centres of the occupied voxels with their probability. Errors: Error where a file cannot be written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <isobath/map/voxel_map.hpp>
#include <string>

namespace isobath {

/// The file's bytes. Voxels more than 32767 edges from the origin have no place in such a tree and are counted.
struct OctoMapFile {
  std::string bytes;
  std::uint64_t left_out = 0;
};
OctoMapFile octomap_file(const VoxelMap& map);

/// Binary, little-endian: x, y, z and probability as float; in the order of the blocks.
std::string ply_file(const VoxelMap& map);

}  // namespace isobath
