// Whether the vehicle can go a way (Auran, Silven 1995, 3.3; ledger S4-12).
//
// What blocks: an occupied cell whose content lies within the vehicle's radius, and half a cell more, of the straight
// way. Where nothing does, the way was seen to be clear along its middle and both its sides at the same level, or it is
// unknown from some range on: water that nobody has looked at is not free water. Above and below the middle a level fan
// of beams sees nothing, so that is not asked for.
//
// Cost: stored beams once each, by the bits of their cells; points of three lines, one a layer (bench/README.md).
#pragma once

#include <isobath/map/spherical_grid.hpp>
#include <optional>

namespace isobath {

struct WayAhead {
  enum class Verdict : std::uint8_t { kClear, kUnknown, kBlocked } verdict = Verdict::kUnknown;
  double clear_m = 0;    ///< along the way, until the first that blocks or is unknown
  double blocked_m = 0;  ///< where the first cell that blocks lies along the way; meaningless for the others
  std::optional<SphericalPlace> blocking;
};
const char* to_text(WayAhead::Verdict verdict);

/// `course_G` has any length but 0; `radius_m` is the vehicle's, with its margin.
WayAhead way_ahead(const SphericalGrid& grid, const Eigen::Vector3d& course_G, double distance_m, double radius_m);

}  // namespace isobath
