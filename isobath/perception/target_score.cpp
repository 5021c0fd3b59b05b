#include <algorithm>
#include <isobath/perception/target_score.hpp>

namespace isobath {

TargetScore target_score(const SphericalGrid& grid, const SphericalCluster& cluster) {
  TargetScore score;
  std::uint64_t again = 0;
  for (const SphericalPlace& place : cluster.cells) {
    const SphericalCell* cell = grid.cells().find(place.direction, place.layer);
    if (!cell) continue;
    score.echoes += cell->echoes;
    score.scans = std::max(score.scans, cell->scans);
    if (cell->scans >= 2) again += cell->echoes;
  }
  if (score.echoes > 0) score.stationary = static_cast<double>(again) / static_cast<double>(score.echoes);
  return score;
}

}  // namespace isobath
