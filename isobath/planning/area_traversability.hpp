// Area traversability at group and vehicle level, from the minimum and maximum known depth of each block of 8 x 8
// pixels alone (Oskard 1990, III-D; ledger S1-82, blocks of S1-38).
//
//   clear    if every pixel is known and min - z >= clearance
//   blocked  if max - z < clearance, or nothing is known
//   mixed    otherwise: part of it is too shallow, or unknown
// The value is the clear share plus half of the mixed share. Along a corridor the shares are those of the fine pixels
// that it meets, each judged by its block, so that `least` and `most` bracket the share of pixels on the fine map whose
// depth is enough (traversability S1-41 without charted objects and confidence). Vehicles in line abreast need the
// corridor of all of them, at the depth of the deepest.
//
// Unknown blocks do not count as water. Pure functions. Points (north, east, depth) in W, m, of a vehicle's lowest
// part. Cost: about 0.1 us a pixel of the corridor, and one tile of the map read for each 16 blocks.
#pragma once

#include <Eigen/Core>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/planning/traversability.hpp>
#include <span>

namespace isobath {

/// Vehicles in line abreast.
struct Formation {
  int vehicles = 1;
  double spacing_m = 0;       ///< between neighbours
  double depth_spread_m = 0;  ///< how much deeper than planned the deepest vehicle may be

  [[nodiscard]] double half_width_m(double of_one) const { return of_one + 0.5 * (vehicles - 1) * spacing_m; }
};

/// Pixels of a corridor by the verdict of their blocks.
struct AreaTraversability {
  std::size_t clear = 0;
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

/// Along a path that the middle of the formation follows; `passage` is that of one vehicle.
Result<AreaTraversability, CorridorRefusal> corridor_traversability(const DepthSnapshot& map,
                                                                    std::span<const Eigen::Vector3d> path,
                                                                    const PassageConfig& passage,
                                                                    const Formation& formation = {});

/// How many vehicles, up to formation.vehicles, can go abreast along the path.
struct VehiclesAbreast {
  int sure = 0;      ///< all blocks clear
  int possible = 0;  ///< no block blocked
};
Result<VehiclesAbreast, CorridorRefusal> vehicles_abreast(const DepthSnapshot& map,
                                                          std::span<const Eigen::Vector3d> path,
                                                          const PassageConfig& passage, Formation formation);

}  // namespace isobath
