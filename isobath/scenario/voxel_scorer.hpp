// judge: the score of a voxel map against the scene.
//
// A voxel is truly occupied if a surface of the scene (the bottom, or a body at its current position) crosses one of
// the three axes through its centre, within its cube. Voxels entirely below the bottom are left out, because no sonar
// looks there. All other voxels that any sensor has observed are scored. The inside of a body, which sonar does not
// reach either, counts as empty if the map holds evidence there.
//
// Cost: about a microsecond per voxel. One thread.
#pragma once

#include <cstdint>
#include <isobath/map/voxel/voxel_map.hpp>
#include <isobath/sim/world.hpp>
#include <isobath/world/voxel_truth.hpp>

namespace isobath {

/// Scores every n-th observed voxel (n = `every`), in the order of the map.
VoxelTruth judge(const VoxelMap& map, const World& world, std::uint64_t every = 1);

}  // namespace isobath
