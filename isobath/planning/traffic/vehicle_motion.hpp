// VehicleMotion: how a vehicle with a turning radius and limited acceleration moves in the plane, as segments of
// constant curvature and constant acceleration; closed forms.
//
// Frame: the horizontal plane of W, x north, y east, m; heading from north to east, rad; speed along the heading, m/s.
// Curvature is positive to starboard, 1/m. Sway, current and the lag of the rudder are not modelled.
#pragma once

#include <Eigen/Core>
#include <isobath/base/field.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct TrafficVehicle {
  double radius_m = 0.5;        ///< of the disc that holds the hull
  double turning_radius_m = 5;  ///< minimum
  double max_turn_rate = 0.5;   ///< rad/s
  double min_speed = 0;         ///< m/s; above 0: the vehicle cannot stop
  double max_speed = 1.5;       ///< m/s
  double acceleration = 0.25;   ///< m/s^2
  double braking = 0.25;        ///< m/s^2

  /// 1/m, at any speed.
  [[nodiscard]] double max_curvature() const;
};

std::vector<Field> fields(TrafficVehicle& vehicle);

struct MotionState {
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();
  double heading = 0;
  double speed = 0;
};

/// Constant curvature and acceleration; the acceleration does not carry the speed below zero.
struct MotionSegment {
  double start_s = 0, duration_s = 0;  ///< from the start of the trajectory
  MotionState start;
  double curvature = 0, acceleration = 0;

  [[nodiscard]] MotionState after(double elapsed_s) const;
};

/// Distance `way_m` along an arc.
MotionState along_arc(const MotionState& start, double curvature, double way_m);

/// Segments one after the other.
struct Trajectory {
  std::vector<MotionSegment> segments;

  [[nodiscard]] double duration_s() const;
  /// The state at a time from the start; the last state afterwards.
  [[nodiscard]] MotionState at(double time_s) const;
  /// Appends a segment that begins where the last one ends, or at `start`.
  void append(const MotionState& start, double curvature, double acceleration, double duration_s);
};

/// The motion of least time from a state to within `arrival_m` of a goal in open water: an arc of least radius until
/// the goal lies ahead, then straight, always accelerating to the maximum speed. Empty where the goal lies within the
/// turning circle of its side.
struct DirectMotion {
  MotionState start;
  double curvature = 0;       ///< of the arc
  double arc_m = 0;           ///< length of the arc
  double arrival_s = 0;       ///< time until the arrival
  double accelerating_s = 0;  ///< time until the maximum speed
  double acceleration = 0, max_speed = 0;

  /// At a time from the start.
  [[nodiscard]] MotionState at(double time_s) const;
  /// As segments, for `duration_s`.
  void append_to(Trajectory& trajectory, double duration_s) const;
};
std::optional<DirectMotion> direct_motion(const TrafficVehicle& vehicle, const MotionState& start,
                                          const Eigen::Vector2d& goal_W, double arrival_m);

}  // namespace isobath
