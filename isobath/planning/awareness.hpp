// Awareness: how much a map knows of the water that a vehicle is about to enter (ledger S5-58; Horner et al. c. 2009
// speak of situational awareness and define no measure).
//
//   entropy      of a voxel, H(P) = -P log2 P - (1 - P) log2 (1 - P), summed over a corridor: the missing knowledge in
//                bits. A voxel that no sensor has observed counts with the map's prior.
//   known share  share of the voxels that are free or occupied by the map's thresholds.
//   free share   share of the voxels that are free.
//
// A voxel belongs to the box that holds its centre. Costs about 60 ns a voxel.
#pragma once

#include <functional>
#include <isobath/geometry/pose.hpp>
#include <isobath/map/voxel/voxel_map.hpp>

namespace isobath {

/// A box along its own axes: x ahead, y to starboard, z down; origin at its centre.
struct WaterBox {
  Pose X_WC;
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
};

struct Awareness {
  std::size_t voxels = 0;
  double entropy_bits = 0;
  double known_share = 0;
  double free_share = 0;

  [[nodiscard]] double bits_a_voxel() const { return voxels > 0 ? entropy_bits / static_cast<double>(voxels) : 0; }
};

Awareness awareness(const VoxelMap& map, const WaterBox& box);

/// visit(v) for each voxel of the box, in order of x, y, z.
void for_each_voxel(const VoxelMap& map, const WaterBox& box, const std::function<void(const VoxelIndex&)>& visit);

}  // namespace isobath
