// Echoes that are of no thing where they point: second bounces, and echoes of nothing (Auran, Silven 1995, 5; ledger
// S4-52, by S4-43 and S4-46).
//
//   multiple  A surface that is met squarely throws sound back to the vehicle, which throws it there again: an echo at
//             twice the range in the same direction, and at three times. Told by the surface itself, at a half (third)
//             of the range within `neighbours`: two echoes or more of the same scan, or occupied cells of the grid as
//             it was before. Behind a surface nothing is heard directly, so that little is lost.
//   false     What is in no cluster that was heard again in the same place (TargetScore).
//   direct    All else.
//
// Not told: images of things in an upright wall, which stand where a thing would stand behind it, and are hidden from
// planners by that wall. Pure.
#pragma once

#include <isobath/perception/plane_scan.hpp>
#include <isobath/perception/target_score.hpp>
#include <vector>

namespace isobath {

enum class EchoCause : std::uint8_t { kDirect, kMultiple, kFalse };
const char* to_text(EchoCause cause);

struct FalseEchoConfig {
  int most_bounces = 3;  ///< echoes at up to so many times the range
  Angle neighbours = Angle::degrees(5);
  double tolerance = 3;      ///< standard deviations of the range
  double least_score = 0.2;  ///< of a cluster that is a thing
};

/// Of each echo of a level scan whether it is a multiple; `before`: what was heard until then, around the place of the
/// scan, its axes x' east and y' north.
std::vector<bool> multiples_in(const PlaneScan& scan, const SphericalGrid& before, const FalseEchoConfig& config = {});

/// Clusters of the grid that are things.
std::vector<SphericalCluster> standing_clusters(const SphericalGrid& grid, double probability,
                                                const FalseEchoConfig& config = {});

/// Of echoes at these points of the grid, of which some are known to be multiples: false is what no standing cluster
/// has within a cell of it.
std::vector<EchoCause> causes_of(const SphericalGrid& grid, const std::vector<SphericalCluster>& standing,
                                 const std::vector<Eigen::Vector3d>& points_G, const std::vector<bool>& multiples);

}  // namespace isobath
