// WholeObstacle: an obstacle with all its convex pieces, as reports, pages and tables count obstacles.
//
// A detector cuts a wall into many convex pieces, because planners need convex outlines. The pieces of one connected
// obstacle share Obstacle::number. An obstacle is compact if its extent is below kExtended_m (a pole, a buoy, a rock),
// else extended (a wall, a quay, a hull).
#pragma once

#include <isobath/map/occupancy/obstacle.hpp>
#include <span>
#include <vector>

namespace isobath {

struct WholeObstacle {
  static constexpr double kExtended_m = 6;  ///< minimum extent of an extended obstacle

  int number = 0;
  int pieces = 0;
  double extent_m = 0;             ///< largest distance between two corners of its pieces
  const Obstacle* nearest = {};    ///< the piece nearest to the vehicle, never null; a reference into the scan's pieces
  double existence = 0;            ///< largest of its pieces
  std::uint32_t hits = 0;          ///< echoes that support it
  bool behind = false;             ///< nearer obstacles hide most of each piece
  bool possible_multiple = false;  ///< so is every piece

  [[nodiscard]] const char* kind() const { return extent_m < kExtended_m ? "compact" : "extended"; }
};

/// The obstacles of a scan in the order of their numbers, nearest first. `pieces` must outlive the result.
std::vector<WholeObstacle> whole_obstacles(std::span<const Obstacle> pieces);

}  // namespace isobath
