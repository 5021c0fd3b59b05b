#include <isobath/planning/area_traversability.hpp>

namespace isobath {
namespace {

std::int32_t floor_divide(std::int32_t a, std::int32_t b) { return a / b - (a % b < 0 ? 1 : 0); }

void judge_block(const DepthSummary& b, double vehicle_z, double clearance, AreaTraversability& out) {
  if (b.known <= 0 || b.max_m - vehicle_z < clearance) {
    ++out.blocked;
  } else if (b.unknown == 0 && b.min_m - vehicle_z >= clearance) {
    ++out.clear;
  } else {
    ++out.mixed;
  }
}

}  // namespace

DepthSummary BlockMap::at(Pixel block) const {
  if (!window.contains(block)) return {0, 0, 0, side * side};
  const auto row = static_cast<std::size_t>(block.row - window.row);
  return blocks[row * static_cast<std::size_t>(window.width) + static_cast<std::size_t>(block.column - window.column)];
}

Pixel BlockMap::block_of(Pixel p) const { return {floor_divide(p.column, side), floor_divide(p.row, side)}; }

AreaTraversability area_traversability(const BlockMap& map, PixelWindow blocks, double vehicle_z, double clearance_m,
                                       const Formation& formation) {
  AreaTraversability out;
  for (std::int32_t row = blocks.row; row < blocks.row + blocks.height; ++row) {
    for (std::int32_t column = blocks.column; column < blocks.column + blocks.width; ++column) {
      judge_block(map.at({column, row}), vehicle_z + formation.depth_spread_m, clearance_m, out);
    }
  }
  return out;
}

Result<AreaTraversability, CorridorRefusal> corridor_traversability(const BlockMap& map,
                                                                    std::span<const Eigen::Vector3d> path,
                                                                    const PassageConfig& passage,
                                                                    const Formation& formation) {
  const auto swept = sweep(map.fine, path, formation.half_width_m(passage.half_width_m));
  if (!swept) return tl::unexpected(swept.error());
  AreaTraversability out;
  for (const SweptPixel& p : *swept) {
    judge_block(map.at(map.block_of(p.pixel)), p.vehicle_z + formation.depth_spread_m, passage.clearance_m, out);
  }
  return out;
}

Result<VehiclesAbreast, CorridorRefusal> vehicles_abreast(const BlockMap& map, std::span<const Eigen::Vector3d> path,
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
