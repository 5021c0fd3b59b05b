#include <isobath/world/voxel_truth.hpp>

namespace isobath {

double VoxelTruth::precision() const {
  return occupied > 0 ? static_cast<double>(right) / static_cast<double>(occupied) : 0;
}

double VoxelTruth::recall() const {
  return surface > 0 ? static_cast<double>(found) / static_cast<double>(surface) : 0;
}

}  // namespace isobath
