// False echoes: labels echoes that do not come from an object at their position: multiples, and false alarms (Auran,
// Silven 1995, 5; ledger S4-52, by S4-43 and S4-46).
//
//   multiple  A surface at normal incidence reflects sound back to the vehicle, which reflects it again. Echoes appear
//             in the same direction at twice and three times the range. An echo is a multiple if its surface is found
//             at a half (third) of its range within `neighbours`: at least two other echoes of the same scan, or
//             occupied cells of the grid as it was before. Nothing behind a surface echoes directly, so little is lost.
//   false     An echo in no cluster that was detected again in the same place (TargetScore).
//   direct    All others.
//
// Not detected: mirror images of objects in an upright wall. They appear where an object would be behind the wall,
// which hides them from planners. Pure.
#pragma once

#include <isobath/perception/plane_scan.hpp>
#include <isobath/perception/target_score.hpp>
#include <vector>

namespace isobath {

enum class EchoCause : std::uint8_t { kDirect, kMultiple, kFalse };

struct FalseEchoConfig {
  int max_bounces = 3;  ///< multiples at up to this many times the range
  Angle neighbours = Angle::degrees(5);
  double tolerance = 3;    ///< standard deviations of the range
  double min_score = 0.2;  ///< minimum score of a cluster that counts as an object
};

/// For each echo of a level scan, whether it is a multiple. `before`: the grid before the scan, around the scan's
/// position, its axes x' east and y' north.
std::vector<bool> multiples_in(const PlaneScan& scan, const SphericalGrid& before, const FalseEchoConfig& config = {});

/// Clusters of the grid that count as objects.
std::vector<SphericalCluster> standing_clusters(const SphericalGrid& grid, double probability,
                                                const FalseEchoConfig& config = {});

/// Causes of the echoes at these points of the grid, given which are multiples. An echo is false if no cell of a
/// standing cluster is within one cell of it.
std::vector<EchoCause> causes_of(const SphericalGrid& grid, const std::vector<SphericalCluster>& standing,
                                 const std::vector<Eigen::Vector3d>& points_G, const std::vector<bool>& multiples);

}  // namespace isobath
