#include <algorithm>
#include <isobath/display/obstacle_trails.hpp>
#include <isobath/map/occupancy/obstacle_outline.hpp>
#include <utility>

namespace isobath {
namespace {

void thin_out(std::vector<Eigen::Vector2d>& trail) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i + 1 < trail.size(); i += 2) trail[kept++] = trail[i];
  trail[kept++] = trail.back();
  trail.resize(kept);
}

}  // namespace

void ObstacleTrails::update(const KnownObstacles& known) {
  std::map<std::uint32_t, std::vector<Eigen::Vector2d>> trails;
  for (const RememberedObstacle& o : known.obstacles) {
    if (o.outline_W.empty()) continue;
    std::vector<Eigen::Vector2d> trail = std::move(trails_[o.id]);
    const Eigen::Vector2d middle = circle_of(o.outline_W).centre;
    if (trail.empty() || (middle - trail.back()).norm() >= kStep_m) {
      if (trail.size() == kMaxPlaces) thin_out(trail);
      trail.push_back(middle);
    }
    trails.emplace(o.id, std::move(trail));
  }
  trails_ = std::move(trails);
}

std::span<const Eigen::Vector2d> ObstacleTrails::of(std::uint32_t id) const {
  const auto found = trails_.find(id);
  return found == trails_.end() ? std::span<const Eigen::Vector2d>() : found->second;
}

}  // namespace isobath
