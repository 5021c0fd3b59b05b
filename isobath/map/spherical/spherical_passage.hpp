// way_ahead: whether the vehicle can follow a straight path (Auran, Silven 1995, 3.3; ledger S4-12).
//
// An occupied cell blocks the path if its content lies within the vehicle's radius, plus half a cell, of the path. If
// no cell blocks it, the path is either clear, where its middle and both its sides at the same level were seen to be
// clear, or unknown from some range on: water that was never observed is not free water. A level fan of beams sees
// nothing above and below the middle, so no clear water is required there.
//
// Cost: each stored beam once, by the bits of its cells; points of three lines, one a layer (bench/README.md).
#pragma once

#include <isobath/map/spherical/spherical_grid.hpp>
#include <optional>

namespace isobath {

struct WayAhead {
  enum class Verdict : std::uint8_t { kClear, kUnknown, kBlocked } verdict = Verdict::kUnknown;
  double clear_m = 0;    ///< along the path, up to the first cell that blocks or point that is unknown
  double blocked_m = 0;  ///< distance along the path to the first cell that blocks; valid only for kBlocked
  std::optional<SphericalPlace> blocking;
};
const char* to_text(WayAhead::Verdict verdict);

/// `course_G` has any length but 0; `radius_m` is the vehicle's, with its margin.
WayAhead way_ahead(const SphericalGrid& grid, const Eigen::Vector3d& course_G, double distance_m, double radius_m);

}  // namespace isobath
