// ObstacleTrails: the past centres of the obstacles that the agents remember, scan by scan, for the live page.
//
// A centre is kept if the centre of the outline has moved kStep_m from the last one kept. When a trail has kMaxPlaces
// centres, every second one is dropped, except the first and the last. A trail thus begins where the obstacle was first
// known, ends within a step of where it is, and is denser towards its end. Centres move as outlines grow, as drift is
// corrected, and as the obstacle moves; a trail does not tell these apart.
//
// Obstacles that the agents no longer report are forgotten. Frame W, m. Deterministic. One thread.
#pragma once

#include <Eigen/Core>
#include <isobath/mission/messages/messages.hpp>
#include <map>
#include <span>
#include <vector>

namespace isobath {

class ObstacleTrails {
 public:
  static constexpr double kStep_m = 0.5;
  static constexpr std::size_t kMaxPlaces = 16;

  void update(const KnownObstacles& known);
  /// Centres (north, east), the oldest first; empty if the obstacle is not known.
  [[nodiscard]] std::span<const Eigen::Vector2d> of(std::uint32_t id) const;

 private:
  std::map<std::uint32_t, std::vector<Eigen::Vector2d>> trails_;  ///< by id
};

}  // namespace isobath
