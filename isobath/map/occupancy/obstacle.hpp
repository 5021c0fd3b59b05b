// Obstacle: an obstacle to avoid, or a convex piece of one, as an outline in the level body frame L (x forward,
// y starboard, m) at the moment of its detection.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/base/time.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/geometry/pose.hpp>

namespace isobath {

/// The part of the water column that an obstacle's echoes come from (perception/water_label.hpp).
enum class WaterLabel : std::uint8_t { kUnknown, kStanding, kBottom, kSurface };
inline const char* to_text(WaterLabel label) {
  switch (label) {
    case WaterLabel::kStanding: return "standing";
    case WaterLabel::kBottom: return "bottom";
    case WaterLabel::kSurface: return "surface";
    case WaterLabel::kUnknown: break;
  }
  return "unknown";
}

/// How an obstacle moves, as a tracker knows it at the obstacle's detection; axes of W (north, east), m, s.
struct ObstacleMotion {
  Eigen::Vector2d velocity_W = Eigen::Vector2d::Zero();
  Eigen::Matrix2d position_covariance = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Zero();
  std::uint32_t track = 0;  ///< number of the track; 0: it is not known to move
};

struct Obstacle {
  Polygon outline;                 ///< convex, corners in the positive sense from x to y
  Eigen::Vector2d nearest;         ///< point of the outline nearest to the vehicle
  double range_m = 0;              ///< to that point
  Angle bearing;                   ///< of that point, [0, 360) degrees clockwise from forward
  double existence = 0;            ///< probability that at least one cell of its strongest neighbourhood is occupied
  Eigen::Vector2d centre;          ///< mean of the cells that carry the evidence
  Eigen::Matrix2d covariance;      ///< extent: second moment of these cells about the centre, m2
  std::uint32_t hits = 0;          ///< echoes that support it
  Time last_hit;                   ///< of the last of these echoes
  bool behind = false;             ///< a nearer obstacle hides most of it
  bool possible_multiple = false;  ///< at a multiple of the range of a nearer obstacle in the same direction
  WaterLabel label = WaterLabel::kUnknown;
  /// From 1. The convex pieces of one connected obstacle share its number, and keep it from scan to scan
  /// (obstacle_numbers.hpp). A detector alone numbers the obstacles of each scan afresh, nearest first.
  int number = 0;
  ObstacleMotion motion;
  bool may_move = false;  ///< it is not known to move, but probably does not lie still; `motion` is a first estimate

  [[nodiscard]] bool moves() const { return motion.track != 0; }
};

/// The outline of an obstacle in W (north, east), which was detected at X_WB.
Polygon world_outline(const Obstacle& obstacle, const Pose& X_WB);

}  // namespace isobath
