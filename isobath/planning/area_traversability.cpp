#include <array>
#include <isobath/planning/area_traversability.hpp>
#include <unordered_map>

namespace isobath {
namespace {

std::int32_t floor_divide(std::int32_t a, std::int32_t b) { return a / b - (a % b < 0 ? 1 : 0); }

/// The blocks of a map by pixel. A tile's blocks are read when the first of its pixels is asked for.
class BlocksByPixel {
 public:
  explicit BlocksByPixel(const DepthSnapshot& map) : map_(map) {}

  const DepthBlock& at(Pixel p) {
    const Pixel tile{floor_divide(p.column, DepthTile::kSide), floor_divide(p.row, DepthTile::kSide)};
    const auto [entry, is_new] = tiles_.try_emplace(std::uint64_t{static_cast<std::uint32_t>(tile.row)} << 32U |
                                                    static_cast<std::uint32_t>(tile.column));
    if (is_new) map_.read_blocks({tile.column * kSide, tile.row * kSide, kSide, kSide}, entry->second);
    const auto column = static_cast<std::size_t>((p.column - tile.column * DepthTile::kSide) / DepthBlock::kPixels);
    const auto row = static_cast<std::size_t>((p.row - tile.row * DepthTile::kSide) / DepthBlock::kPixels);
    return entry->second[row * kSide + column];
  }

 private:
  static constexpr int kSide = DepthTile::kBlocks;

  const DepthSnapshot& map_;
  std::unordered_map<std::uint64_t, std::array<DepthBlock, std::size_t{kSide} * kSide>> tiles_;
};

void judge_block(const DepthBlock& b, double vehicle_z, double clearance, AreaTraversability& out) {
  constexpr int kAll = DepthBlock::kPixels * DepthBlock::kPixels;
  if (b.unknown == kAll || 0.01 * b.max_cm - vehicle_z < clearance) {
    ++out.blocked;
  } else if (b.unknown == 0 && 0.01 * b.min_cm - vehicle_z >= clearance) {
    ++out.clear;
  } else {
    ++out.mixed;
  }
}

}  // namespace

Result<AreaTraversability, CorridorRefusal> corridor_traversability(const DepthSnapshot& map,
                                                                    std::span<const Eigen::Vector3d> path,
                                                                    const PassageConfig& passage,
                                                                    const Formation& formation) {
  const auto swept = sweep(map.grid(), path, formation.half_width_m(passage.half_width_m));
  if (!swept) return tl::unexpected(swept.error());
  BlocksByPixel blocks(map);
  AreaTraversability out;
  for (const SweptPixel& p : *swept) {
    judge_block(blocks.at(p.pixel), p.vehicle_z + formation.depth_spread_m, passage.clearance_m, out);
  }
  return out;
}

Result<VehiclesAbreast, CorridorRefusal> vehicles_abreast(const DepthSnapshot& map,
                                                          std::span<const Eigen::Vector3d> path,
                                                          const PassageConfig& passage, Formation formation) {
  VehiclesAbreast out;
  const int most = formation.vehicles;
  for (formation.vehicles = 1; formation.vehicles <= most; ++formation.vehicles) {
    const auto t = corridor_traversability(map, path, passage, formation);
    if (!t) return tl::unexpected(t.error());
    if (!t->possible()) break;
    out.possible = formation.vehicles;
    if (t->sure()) out.sure = formation.vehicles;
  }
  return out;
}

}  // namespace isobath
