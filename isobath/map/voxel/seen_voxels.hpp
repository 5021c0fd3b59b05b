// for_each_seen: visits the voxels of a map that any sensor has observed.
#pragma once

#include <isobath/map/voxel/voxel_map.hpp>

namespace isobath {

/// visit(v), block by block in the order of x, y, z.
template <class Visit>
void for_each_seen(const VoxelMap& map, const Visit& visit) {
  for (const VoxelIndex& corner : map.changed_after(0)) {
    for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
      const VoxelIndex v = corner + VoxelBlocks::place_of(i);
      if (map.is_seen(v)) visit(v);
    }
  }
}

}  // namespace isobath
