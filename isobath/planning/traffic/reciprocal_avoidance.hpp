// Reciprocal avoidance: the velocity that a disc chooses among moving discs by optimal reciprocal collision avoidance
// (van den Berg, Guy, Lin, Manocha, "Reciprocal n-body collision avoidance", ISRR 2009), as a baseline.
//
// Each other disc forbids the velocities that lead to contact within the time horizon. The disc takes its share of the
// least change of velocity that leaves this set, which is a half plane of velocities; the velocity nearest to the
// wanted one within all half planes and the maximum speed is a linear programme in two dimensions. Where the half
// planes have no velocity in common, the velocity that violates them least is taken. The disc moves in any direction
// and changes its velocity at once. Plane frame, m, m/s.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace isobath {

struct AvoidedDisc {
  Eigen::Vector2d p, velocity;
  double radius_m = 0;
};

struct ReciprocalConfig {
  double horizon_s = 10;
  double step_s = 0.1;     ///< within which an overlap is left
  double share = 0.5;      ///< of the change of velocity; 1: the others do not react
  double max_speed = 1.5;  ///< m/s
};

/// The velocities v with normal . (v - point) >= 0.
struct HalfPlane {
  Eigen::Vector2d point, normal;
};

HalfPlane avoidance_half_plane(const AvoidedDisc& own, const AvoidedDisc& other, const ReciprocalConfig& config);

/// The velocity nearest to `wanted`; `others` in the order of their distance.
Eigen::Vector2d reciprocal_velocity(const AvoidedDisc& own, const Eigen::Vector2d& wanted,
                                    std::span<const AvoidedDisc> others, const ReciprocalConfig& config);

}  // namespace isobath
