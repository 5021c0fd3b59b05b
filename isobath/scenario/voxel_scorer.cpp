#include <algorithm>
#include <cmath>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <isobath/scenario/voxel_scorer.hpp>
#include <unordered_map>
#include <vector>

namespace isobath {
namespace {

using Eigen::Vector3d;

enum class Truth : std::uint8_t { kUnasked, kEmpty, kSurface, kBelow };

/// The true states of the map's voxels and their neighbours; each is computed once.
class TrueVoxels {
 public:
  TrueVoxels(const VoxelMap& map, const World& world) : map_(map), world_(world) {}

  Truth at(const VoxelIndex& v) {
    Truth& known = place(v);
    if (known == Truth::kUnasked) known = find(v);
    return known;
  }

 private:
  Truth& place(const VoxelIndex& v) {
    const auto part = [](int i) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(i >> VoxelBlocks::kSideLog2)) & 0x1FFFFF;
    };
    std::vector<Truth>& block = blocks_[part(v.x()) << 42 | part(v.y()) << 21 | part(v.z())];
    if (block.empty()) block.resize(VoxelBlocks::kVolume, Truth::kUnasked);
    return block[static_cast<std::size_t>(VoxelBlocks::offset(v))];
  }
  [[nodiscard]] Truth find(const VoxelIndex& v) const {
    const Vector3d p = map_.centre_of(v);
    const double half = 0.5 * map_.voxel_m();
    const auto bottom = world_.bottom_depth(p.x(), p.y());
    if (bottom && p.z() - half > *bottom) return Truth::kBelow;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double way : {-1.0, 1.0}) {
        if (world_.blocked(p, way * Vector3d::Unit(axis), half)) return Truth::kSurface;
      }
    }
    return Truth::kEmpty;
  }

  const VoxelMap& map_;
  const World& world_;
  std::unordered_map<std::uint64_t, std::vector<Truth>> blocks_;
};

template <class Is>
bool any_near(const VoxelIndex& v, const Is& is) {
  for (int n = 0; n < 27; ++n) {
    if (is(v + VoxelIndex(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1))) return true;
  }
  return false;
}

}  // namespace

VoxelTruth judge(const VoxelMap& map, const World& world, std::uint64_t every) {
  VoxelTruth truth;
  TrueVoxels voxels(map, world);
  double loss = 0;
  std::uint64_t number = 0;
  for_each_seen(map, [&](const VoxelIndex& v) {
    if (number++ % every != 0) return;
    const Truth is = voxels.at(v);
    if (is == Truth::kBelow) return;
    const bool surface = is == Truth::kSurface;
    const double said = map.probability(v), p = std::clamp(said, 1e-4, 1 - 1e-4);
    ++truth.judged;
    loss -= std::log(surface ? p : 1 - p);
    VoxelTruth::Said& alike = truth.by_probability[static_cast<std::size_t>(std::min(9.0, 10 * said))];
    ++alike.voxels;
    alike.surface += surface ? 1 : 0;
    alike.probability += said;
    if (map.space(v) == Space::kOccupied) {
      ++truth.occupied;
      truth.right += any_near(v, [&](const VoxelIndex& n) { return voxels.at(n) == Truth::kSurface; }) ? 1 : 0;
    }
    if (surface) {
      ++truth.surface;
      truth.found += any_near(v, [&](const VoxelIndex& n) { return map.space(n) == Space::kOccupied; }) ? 1 : 0;
    }
  });
  if (truth.judged > 0) truth.log_loss = loss / static_cast<double>(truth.judged);
  for (VoxelTruth::Said& s : truth.by_probability) {
    if (s.voxels > 0) s.probability /= static_cast<double>(s.voxels);
  }
  return truth;
}

}  // namespace isobath
