// Area traversability at group and vehicle level, from the minimum and maximum known depth of each block alone (Oskard
// 1990, III-D; ledger S1-82, blocks of S1-38).
//
//   clear    if every pixel is known and min - z >= clearance
//   blocked  if max - z < clearance, or nothing is known
//   mixed    otherwise: part of it is too shallow, or unknown
// The value is the clear share plus half of the mixed share. Along a corridor the shares are those of the fine pixels
// that it meets, each judged by its block, so that `least` and `most` bracket the result of traversability (S1-41) on
// the fine map. Vehicles in line abreast need the corridor of all of them, at the depth of the deepest.
//
// Unknown blocks do not count as water. Pure functions. Points (north, east, depth) in W, m, of a vehicle's lowest
// part.
#pragma once

#include <Eigen/Core>
#include <isobath/planning/traversability.hpp>
#include <span>

namespace isobath {

struct DepthSummary {
  double min_m = 0;  ///< of the known pixels
  double max_m = 0;
  std::int32_t known = 0;  ///< pixels; 0: min and max say nothing
  std::int32_t unknown = 0;
};

/// Blocks of `side` x `side` pixels of the fine grid; block (0, 0) begins at its pixel (0, 0).
struct BlockMap {
  PixelGrid fine;
  std::int32_t side = 8;  ///< 4 m of 0.5 m pixels
  PixelWindow window;     ///< of blocks, row by row; blocks outside are unknown
  std::span<const DepthSummary> blocks;

  [[nodiscard]] DepthSummary at(Pixel block) const;
  [[nodiscard]] Pixel block_of(Pixel fine_pixel) const;
};

/// Vehicles in line abreast.
struct Formation {
  int vehicles = 1;
  double spacing_m = 0;       ///< between neighbours
  double depth_spread_m = 0;  ///< how much deeper than planned the deepest vehicle may be

  [[nodiscard]] double half_width_m(double of_one) const { return of_one + 0.5 * (vehicles - 1) * spacing_m; }
};

struct AreaTraversability {
  std::size_t clear = 0;  ///< pixels of a corridor, blocks of an area
  std::size_t mixed = 0;
  std::size_t blocked = 0;

  [[nodiscard]] double least() const { return share(0); }
  [[nodiscard]] double most() const { return share(1); }
  [[nodiscard]] double value() const { return share(0.5); }
  [[nodiscard]] double mixed_share() const { return value_of(mixed); }
  /// No block is blocked; mixed blocks could all be clear.
  [[nodiscard]] bool possible() const { return blocked == 0 && clear + mixed > 0; }
  [[nodiscard]] bool sure() const { return blocked + mixed == 0 && clear > 0; }

 private:
  [[nodiscard]] double value_of(std::size_t part) const {
    const std::size_t all = clear + mixed + blocked;
    return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
  }
  [[nodiscard]] double share(double of_mixed) const { return value_of(clear) + of_mixed * value_of(mixed); }
};

/// Judges all blocks of a window at one depth.
AreaTraversability area_traversability(const BlockMap& map, PixelWindow blocks, double vehicle_z, double clearance_m,
                                       const Formation& formation = {});
/// Along a path that the middle of the formation follows; `passage` is that of one vehicle.
Result<AreaTraversability, CorridorRefusal> corridor_traversability(const BlockMap& map,
                                                                    std::span<const Eigen::Vector3d> path,
                                                                    const PassageConfig& passage,
                                                                    const Formation& formation = {});

/// How many vehicles, up to formation.vehicles, can go abreast along the path.
struct VehiclesAbreast {
  int sure = 0;      ///< all blocks clear
  int possible = 0;  ///< no block blocked
};
Result<VehiclesAbreast, CorridorRefusal> vehicles_abreast(const BlockMap& map, std::span<const Eigen::Vector3d> path,
                                                          const PassageConfig& passage, Formation formation);

}  // namespace isobath
