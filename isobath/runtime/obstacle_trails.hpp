// ObstacleTrails: where the middles of the obstacles that the crew remembers lay at successive scans, for a page.
//
// A place is kept where the middle of an outline has come kStep_m from the last one kept. Of an obstacle that has
// kMostPlaces, every second is dropped but the first and the last: a trail begins where the obstacle was first known,
// ends within a step of where it is, and is the finer the later. Middles move as outlines grow, as drift is taken off,
// and a little with what moves: whether it moves is not said here.
//
// What the crew no longer tells is forgotten. Frames: W, m. Deterministic. One thread.
#pragma once

#include <Eigen/Core>
#include <isobath/mission/messages.hpp>
#include <map>
#include <span>
#include <vector>

namespace isobath {

class ObstacleTrails {
 public:
  static constexpr double kStep_m = 0.5;
  static constexpr std::size_t kMostPlaces = 16;

  void take(const KnownObstacles& known);
  /// North and east, the first place first; empty of an obstacle that is not known.
  [[nodiscard]] std::span<const Eigen::Vector2d> of(std::uint32_t id) const;

 private:
  std::map<std::uint32_t, std::vector<Eigen::Vector2d>> trails_;  ///< by id
};

}  // namespace isobath
