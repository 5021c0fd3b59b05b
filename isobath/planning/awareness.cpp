#include <cmath>
#include <isobath/planning/awareness.hpp>

namespace isobath {

using Eigen::Vector3d;

void for_each_voxel(const VoxelMap& map, const WaterBox& box, const std::function<void(const VoxelIndex&)>& visit) {
  const Vector3d half = 0.5 * box.size_m;
  const Vector3d reach = box.X_WC.rotation.matrix().cwiseAbs() * half;
  const VoxelIndex least = map.voxel_at(box.X_WC.translation - reach),
                   most = map.voxel_at(box.X_WC.translation + reach);
  const Pose X_CW = box.X_WC.inverse();
  for (int x = least.x(); x <= most.x(); ++x) {
    for (int y = least.y(); y <= most.y(); ++y) {
      for (int z = least.z(); z <= most.z(); ++z) {
        const VoxelIndex v(x, y, z);
        const Vector3d p_C = X_CW * map.centre_of(v);
        if ((p_C.cwiseAbs().array() <= half.array()).all()) visit(v);
      }
    }
  }
}

Awareness awareness(const VoxelMap& map, const WaterBox& box) {
  Awareness a;
  std::size_t known = 0, free = 0;
  for_each_voxel(map, box, [&](const VoxelIndex& v) {
    ++a.voxels;
    const double p = map.probability(v);
    if (p > 0 && p < 1) a.entropy_bits -= p * std::log2(p) + (1 - p) * std::log2(1 - p);
    const Space space = map.space(v);
    known += space != Space::kUnknown;
    free += space == Space::kFree;
  });
  if (a.voxels > 0) {
    a.known_share = static_cast<double>(known) / static_cast<double>(a.voxels);
    a.free_share = static_cast<double>(free) / static_cast<double>(a.voxels);
  }
  return a;
}

}  // namespace isobath
