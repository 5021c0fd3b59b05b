// TargetScore: the evidence that a cluster of the spherical grid is a stationary object: many echoes, detected again in
// the same place (Auran, Silven 1995, 3.1; ledger S4-46).
//
//   score = n / (n + 3)  x  (s - 1) / s  x  q
//     n  echoes of the cluster
//     s  scans that detected its most often detected cell
//     q  share of its echoes in cells that at least two scans detected: 1 for a stationary object; a swimming one
//        leaves a track of cells that are detected once each
// A single false echo scores 0, and two that coincide score little. The records of the cells suffice, so no tracking is
// needed. Between 0 and 1. Pure.
#pragma once

#include <isobath/map/spherical/spherical_clusters.hpp>

namespace isobath {

struct TargetScore {
  std::uint64_t echoes = 0;
  std::uint32_t scans = 0;
  double stationary = 0;
  [[nodiscard]] double value() const {
    if (scans == 0) return 0;
    const auto n = static_cast<double>(echoes), s = static_cast<double>(scans);
    return n / (n + 3) * (s - 1) / s * stationary;
  }
};

/// Score of a cluster of the present grid.
TargetScore target_score(const SphericalGrid& grid, const SphericalCluster& cluster);

}  // namespace isobath
