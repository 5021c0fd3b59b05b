// Trilateration: the position of a vehicle, from its distances to transponders at known positions (Oskard 1990, III,
// who calls it triangulation; ledger S1-10 S1-E04).
//
// Minimises sum_i (|p_W - p_WTi| - r_i)^2: linear start from differences of squared ranges, then Gauss-Newton. With a
// given depth (a pressure gauge, taken as exact) the fix is in the plane, from two or more ranges; without it in space,
// from three or more. A mirror image remains if there are only as many transponders as unknowns, or if all lie on one
// line (in space: in one plane). Then `near`, the last fix or any point on the vehicle's side, selects the solution.
// Transponders so nearly on a line or in a plane that the start would be ill-conditioned are treated in the same way;
// Gauss-Newton then uses their exact positions.
//
// Covariance: range_sigma^2 (J^T J)^-1; with a given depth, the depth row and column are 0. A gross range is found by
// its normalised residual |e_i| / (range_sigma sqrt(1 - h_i)) (Baarda's w-test), h_i its leverage: one range more than
// unknowns detects an error, two also identify the range. Units m, frame W. Pure; allocates nothing. Accuracy: exact
// ranges give the position within 1e-9 of the distance; refuses a geometry whose covariance is above 1e6 range_sigma^2.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/error.hpp>
#include <optional>
#include <span>

namespace isobath {

struct TransponderRange {
  Eigen::Vector3d p_WT = Eigen::Vector3d::Zero();  ///< transponder
  double range = 0;
};

struct TrilaterationAid {
  std::optional<double> depth;
  double range_sigma = 1;
  std::optional<Eigen::Vector3d> near = {};
  double gross = 4;  ///< normalised residual at which a range counts as gross
};

struct TrilaterationFix {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  int ranges = 0;
  double residual = 0;                 ///< sqrt(sum e^2 / (ranges - unknowns)); 0 if they are equal
  bool gross = false;                  ///< some range does not fit the others
  std::optional<std::size_t> suspect;  ///< index of that range, if it can be identified
};

enum class TrilaterationRefusal : std::uint8_t { kTooFewRanges, kBadGeometry, kMirrorImage };

Result<TrilaterationFix, TrilaterationRefusal> trilaterate(std::span<const TransponderRange> ranges,
                                                           const TrilaterationAid& aid);

}  // namespace isobath
