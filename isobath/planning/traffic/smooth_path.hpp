// smooth_path: a path of corners as arcs of the vehicle's turning radius and straight legs, from the vehicle's heading
// on (Rodin, Amin c. 1988, 2.3; ledger S3-23, S3-24).
//
// Each bend of the path is a circle of the turning radius rho; the legs are the common tangents of successive circles.
// At a corner of turning angle D the circle first touches both legs: it trims them by rho tan(D / 2) and cuts the
// corner by rho (1 / cos(D / 2) - 1). Where that arc meets an obstacle, which lies inside the corners of a shortest
// path, the circle goes through the corner instead, so that the arc passes outside of it. Corners of the same sense
// whose trims do not fit on the leg between them become one bend, whose circle holds all of them. The path begins with
// an arc to the side that makes it shorter.
//
// Curvature is at most 1 / rho, and the heading is continuous; the curvature is not. Every piece is free of the grown
// obstacles. A path that cannot be smoothed so is refused with the place; other paths of the same corners may exist.
// Units: m, rad, frame W (vehicle_motion.hpp).
#pragma once

#include <isobath/base/error.hpp>
#include <isobath/planning/roadmap/grown_obstacles.hpp>
#include <isobath/planning/traffic/vehicle_motion.hpp>
#include <span>
#include <vector>

namespace isobath {

/// Constant curvature.
struct PathPiece {
  double start_m = 0, length_m = 0;  ///< along the path
  MotionState start;                 ///< its speed has no meaning
  double curvature = 0;
};

struct SmoothPath {
  std::vector<PathPiece> pieces;

  [[nodiscard]] double length_m() const;
  /// The place and heading at a distance along the path; beyond its ends those of the ends.
  [[nodiscard]] MotionState at(double along_m) const;
};

enum class SmoothFault : std::uint8_t {
  kTurn,     ///< the bends do not fit: a leg between them is too short for the turning radius
  kBlocked,  ///< an arc or a leg would meet an obstacle
};

struct SmoothRefusal {
  SmoothFault fault = SmoothFault::kTurn;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< the corner, or the start or the goal
};

/// `corners` follow the start; the last one is the goal. At least one; all finite. The heading at the goal is free.
Result<SmoothPath, SmoothRefusal> smooth_path(const MotionState& start, std::span<const Eigen::Vector2d> corners,
                                              double turning_radius_m, const GrownObstacles& obstacles);

}  // namespace isobath
