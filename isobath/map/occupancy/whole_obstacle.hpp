// WholeObstacle: an obstacle with all its convex pieces, as reports, pages and tables count obstacles.
//
// A detector cuts a wall into many convex pieces, because planners need convex outlines. The pieces of one connected
// obstacle share Obstacle::number, which people see. An obstacle is compact if its extent is below kExtended_m (a pole,
// a buoy, a rock), else extended (a wall, a quay, a hull).
#pragma once

#include <isobath/map/occupancy/obstacle.hpp>
#include <span>
#include <vector>

namespace isobath {

inline constexpr double kExtended_m = 6;  ///< minimum extent of an extended obstacle
/// "compact" or "extended".
inline const char* kind_of_obstacle(double extent_m) { return extent_m < kExtended_m ? "compact" : "extended"; }
/// Largest distance between two corners of these outlines; 0 without any.
double extent_of(std::span<const Polygon> outlines);

struct WholeObstacle {
  int number = 0;
  int pieces = 0;
  double extent_m = 0;             ///< largest distance between two corners of its pieces
  const Obstacle* nearest = {};    ///< the piece nearest to the vehicle, never null; a reference into the scan's pieces
  double existence = 0;            ///< largest of its pieces
  std::uint32_t hits = 0;          ///< echoes that support it
  bool behind = false;             ///< nearer obstacles hide most of each piece
  bool possible_multiple = false;  ///< so is every piece

  [[nodiscard]] const char* kind() const { return kind_of_obstacle(extent_m); }
};

/// The obstacles of a scan, nearest first. `pieces` must outlive the result.
std::vector<WholeObstacle> whole_obstacles(std::span<const Obstacle> pieces);

}  // namespace isobath
