// TargetScore: how much speaks for a cluster of the spherical grid to be a thing that stands there: many echoes, heard
// again, in the same place (Auran, Silven 1995, 3.1; ledger S4-46).
//
//   score = n / (n + 3)  x  (s - 1) / s  x  q
//     n  echoes of the cluster
//     s  scans that heard its most often heard cell
//     q  share of its echoes in cells that two scans or more have heard: 1 for what stands; what swims leaves a track
//        of cells that are heard once each
// A false echo scores 0 alone, and little where two happen to meet. The records of the cells say all of that, so
// nothing has to be followed. Between 0 and 1. Pure.
#pragma once

#include <isobath/map/spherical_clusters.hpp>

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

/// Of a cluster of the grid as it is.
TargetScore target_score(const SphericalGrid& grid, const SphericalCluster& cluster);

}  // namespace isobath
