// Guidance: set-points that lead along way-points, or keep a place (ledger S6-37, S7-15).
//
// LineOfSight steers for a point `lookahead` ahead on the line between two way-points (Fossen 2011, 12.3; integral
// action after Borhaug 2008): course = bearing - atan((e + sigma E) / lookahead), E' = lookahead (e + lookahead e' /
// speed) / ((e + sigma E)^2 + lookahead^2), e to starboard of the line, sigma = integral_gain times the speed. The e'
// is ours: it takes off what the approach to the line removes anyway, so that E learns the drift alone and does not
// overshoot. The integral is kept as a vector in W: what was learnt on one leg holds on the next, in the share that
// lies across it, and reverses with the leg. It stands still while the vehicle is off the line or turning, and never
// asks for more than 45 degrees: no wind-up. Where the velocity over ground is known, the drift across the hull is
// filtered and steered against at once (heading = course less the crab angle); the integral is left with what that
// misses.
//
// Depth and speed are those of the way-point ahead. A way-point counts as reached within the acceptance radius,
// horizontally; one that is passed further away counts as missed, and the path goes on: a vehicle that cannot turn
// tightly enough must not circle.
//
// Speed plan, where a VehicleSheet is given: the vehicle brakes in time (half its greatest braking) for a corner that
// it would overrun by more than the corner tolerance, slows while it still has far to turn, and, where it can hover,
// for the last way-point. Never below min_speed. A turn by theta that begins R before the corner ends r (1 - cos theta)
// - R sin theta beside the next leg, r = speed / max_yaw_rate, at least the turning radius.
//
// All takes the vehicle's own estimate: pose, and velocity over ground where there is one. A pose that is not finite
// leaves the last set-point standing. Units SI. One thread at a time; step allocates nothing.
#pragma once

#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/vehicle_sheet.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct Waypoint {
  double north = 0;  ///< m in W
  double east = 0;
  double depth = 0;
  double speed = 1;  ///< on the way to it, m/s
  /// Where the leg to it begins, m: its depth changes along the leg. Empty: at once.
  std::optional<double> from_depth = {};
};

struct GuidanceConfig {
  double lookahead = 8;          ///< m
  double acceptance_radius = 3;  ///< m
  double integral_gain = 0.5;    ///< sigma as a share of the speed; 0: none
  double drift_time = 4;         ///< s, of the filter on the drift across the hull; 0: the velocity is not used
  double corner_tolerance = 2;   ///< m
};

std::vector<Field> fields(GuidanceConfig& config);

/// How fast the vehicle is carried across its hull, kept in W so that it holds on another heading.
class Drift {
 public:
  /// `time_constant` s; nothing happens where a number is not finite.
  void update(Angle heading, const Eigen::Vector3d& v_W, double time_constant, double dt);
  /// By how much the course lies to starboard of the heading, at a speed ahead; within 60 degrees.
  [[nodiscard]] Angle crab(Angle heading, double speed) const;
  [[nodiscard]] const Eigen::Vector2d& velocity_W() const { return velocity_W_; }

 private:
  Eigen::Vector2d velocity_W_ = Eigen::Vector2d::Zero();
};

class LineOfSight {
 public:
  /// Throws Error without way-points. The first leg starts where the vehicle is at the first step. Without a sheet the
  /// speeds are those of the way-points.
  LineOfSight(const GuidanceConfig& config, std::vector<Waypoint> waypoints,
              const std::optional<VehicleSheet>& sheet = {});

  /// Follows these from now on, in place of what is left; `from` (north, east): where the first leg starts; without it,
  /// where the vehicle is at the next step. What was learnt of the drift stays. Throws Error without way-points.
  void follow(std::vector<Waypoint> waypoints, const std::optional<Eigen::Vector2d>& from = {});

  /// After the last way-point: its depth, the last bearing, speed 0, or min_speed where the sheet has one.
  Setpoint step(const Pose& X_WB, const std::optional<Eigen::Vector3d>& v_W, double dt);
  Setpoint step(const VehicleState& state, double dt) { return step(state.X_WB, state.X_WB.rotation * state.v_B, dt); }

  [[nodiscard]] bool finished() const { return next_ == waypoints_.size(); }
  [[nodiscard]] std::size_t next() const { return next_; }        ///< index of the way-point ahead
  [[nodiscard]] std::size_t reached() const { return reached_; }  ///< within the acceptance radius
  [[nodiscard]] std::size_t missed() const { return next_ - reached_; }
  [[nodiscard]] double cross_track() const { return cross_track_; }  ///< m to starboard of the leg
  [[nodiscard]] const std::vector<Waypoint>& waypoints() const { return waypoints_; }
  /// Where the leg under way starts (north, east); meaningless before the first step.
  [[nodiscard]] const Eigen::Vector2d& leg_start() const { return from_; }

 private:
  void advance(const Eigen::Vector2d& here);
  void learn(double aim, double dt);
  [[nodiscard]] double speed_ahead() const;
  [[nodiscard]] double corner_speed(Angle turn, double inside) const;
  [[nodiscard]] double depth_on(const Waypoint& goal, double speed) const;

  GuidanceConfig config_;
  std::vector<Waypoint> waypoints_;
  std::optional<VehicleSheet> sheet_;
  std::size_t next_ = 0;
  std::size_t reached_ = 0;
  bool started_ = false;
  Eigen::Vector2d from_ = Eigen::Vector2d::Zero();
  Angle bearing_;
  double to_go_ = 0;  ///< along the leg, to the way-point ahead, m
  double cross_track_ = 0;
  std::optional<double> cross_before_;  ///< at the step before, on the same leg
  double turn_limit_ = 0;               ///< speed of the turn under way; 0: none
  Eigen::Vector2d integral_W_ = Eigen::Vector2d::Zero();
  Drift drift_;
  Setpoint last_;
};

/// Holds a place with a vehicle that can move any way: velocity towards it, `gain` 1/s times the distance, limited.
Setpoint hold_station(const VehicleState& state, const Waypoint& place, Angle heading, double gain = 0.5);

struct StationConfig {
  double gain = 0.3;            ///< 1/s
  double integral_gain = 0.02;  ///< 1/s2, against a bias of the speeds; 0: none
  double turn_from = 2;         ///< m: a hovering vehicle without sway turns to its place from here on
  double circle_radius = 10;    ///< m, of a vehicle that cannot hover
  double drift_time = 4;        ///< s, as in GuidanceConfig
};

std::vector<Field> fields(StationConfig& config);

/// Keeps a place. A vehicle that can hover moves to it and holds it, by sway where it has any, else by turning to it
/// when it has been carried away; one that cannot circles it to starboard, at no tighter a radius than it can turn.
class StationKeeper {
 public:
  StationKeeper(const StationConfig& config, const VehicleSheet& sheet) : config_(config), sheet_(sheet) {}

  /// From now on this place; `speed` of the Waypoint is the most that is used to get there. Without a heading, that of
  /// the moment.
  void hold(const Waypoint& place, const std::optional<Angle>& heading = {});
  Setpoint step(const Pose& X_WB, const std::optional<Eigen::Vector3d>& v_W, double dt);

  [[nodiscard]] const Waypoint& place() const { return place_; }
  /// Of the circle; 0 for a vehicle that hovers.
  [[nodiscard]] double radius() const;

 private:
  [[nodiscard]] Setpoint hover(const Eigen::Vector2d& gap, Angle heading, double dt);
  [[nodiscard]] Setpoint circle(const Eigen::Vector2d& gap, Angle heading) const;

  StationConfig config_;
  VehicleSheet sheet_;
  Waypoint place_;
  std::optional<Angle> heading_;
  Eigen::Vector2d integral_W_ = Eigen::Vector2d::Zero();  ///< m/s
  bool turning_ = false;
  Drift drift_;
  Setpoint last_;
};

}  // namespace isobath
