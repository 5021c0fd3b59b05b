// Guidance: set-points that follow way-points or hold a position (ledger S6-37, S7-15).
//
// LineOfSight steers for a point `lookahead` ahead on the line between two way-points (Fossen 2011, 12.3; integral
// action after Borhaug 2008): course = bearing - atan((e + sigma E) / lookahead), E' = lookahead (e + lookahead e' /
// speed) / ((e + sigma E)^2 + lookahead^2), e to starboard of the line, sigma = integral_gain times the speed. The e'
// is not in the source: it subtracts what the approach to the line removes anyway, so that E learns only the drift and
// does not overshoot. The integral is kept as a vector in W: its component across a leg applies on the next leg too,
// and reverses with the leg. It stops while the vehicle is off the line or turning, and never demands more than 45
// degrees (anti-windup). Where the velocity over ground is known, the drift across the hull is filtered and compensated
// at once (heading = course less the crab angle); the integral corrects the remainder.
//
// Depth and speed are those of the way-point ahead. A way-point counts as reached within the acceptance radius,
// horizontally. One that is passed farther away counts as missed and the path continues, so that a vehicle that cannot
// turn tightly enough does not circle.
//
// Speed plan, if a VehicleParameters is given: the vehicle brakes in time (at half its maximum deceleration) for a
// corner that it would overrun by more than the corner tolerance, slows while it still has far to turn, and, if it can
// hover, brakes for the last way-point, unless it is to go on from there. Never below min_speed. A turn by theta that
// begins R before the corner ends r (1 - cos theta) - R sin theta beside the next leg, r = speed / max_yaw_rate, at
// least the turning radius.
//
// All functions take the vehicle's own estimate: pose, and velocity over ground if there is one. A pose that is not
// finite leaves the last set-point in force. Units SI. One thread at a time; step allocates nothing.
#pragma once

#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct Waypoint {
  double north = 0;  ///< m in W
  double east = 0;
  double depth = 0;
  double speed = 1;  ///< on the way to it, m/s
  /// Depth where the leg to it begins, m: the depth changes along the leg. Empty: the depth changes at once.
  std::optional<double> from_depth = {};
  double radius_m = 0;  ///< within which it counts as reached; 0: as configured
};

struct GuidanceConfig {
  double lookahead = 8;          ///< m
  double acceptance_radius = 3;  ///< m
  double integral_gain = 0.5;    ///< sigma as a share of the speed; 0: none
  double drift_time = 4;         ///< s, of the filter on the drift across the hull; 0: the velocity is not used
  double corner_tolerance = 2;   ///< m
  bool slow_at_corners = true;   ///< false: at full speed into every corner, as Herman 1988 reports of the lake (S2-46)
};

std::vector<Field> fields(GuidanceConfig& config);

/// The velocity of the drift across the hull, kept in W so that it applies on another heading: a low-pass for steering.
/// CurrentEstimate also says how sure it is.
class Drift {
 public:
  /// `time_constant` in s; ignores values that are not finite.
  void update(Angle heading, const Eigen::Vector3d& v_W, double time_constant, double dt);
  /// The angle by which the course lies to starboard of the heading, at a speed ahead; within 60 degrees.
  [[nodiscard]] Angle crab(Angle heading, double speed) const;
  [[nodiscard]] const Eigen::Vector2d& velocity_W() const { return velocity_W_; }

 private:
  Eigen::Vector2d velocity_W_ = Eigen::Vector2d::Zero();
};

class LineOfSight {
 public:
  /// Throws Error without way-points. The first leg starts at the vehicle's position at the first step. Without a sheet
  /// the speeds are those of the way-points.
  LineOfSight(const GuidanceConfig& config, std::vector<Waypoint> waypoints,
              const std::optional<VehicleParameters>& parameters = {});

  /// Follows these way-points from now on and drops the remaining ones. `from` (north, east) is the start of the first
  /// leg; without it, the vehicle's position at the next step. The learnt drift stays. Throws Error without way-points.
  void follow(std::vector<Waypoint> waypoints, const std::optional<Eigen::Vector2d>& from = {});

  /// Where the vehicle will go on after the last way-point, until the next `follow`: the last way-point is then a
  /// corner like the others. Empty: it is the end.
  void go_on_to(const std::optional<Eigen::Vector2d>& then) { then_ = then; }

  /// After the last way-point: its depth, the last bearing, speed 0, or min_speed where the sheet has one.
  Setpoint step(const Pose& X_WB, const std::optional<Eigen::Vector3d>& v_W, double dt);
  Setpoint step(const VehicleState& state, double dt) { return step(state.X_WB, state.X_WB.rotation * state.v_B, dt); }

  [[nodiscard]] bool finished() const { return next_ == waypoints_.size(); }
  [[nodiscard]] std::size_t next() const { return next_; }        ///< index of the way-point ahead
  [[nodiscard]] std::size_t reached() const { return reached_; }  ///< within the acceptance radius
  [[nodiscard]] std::size_t missed() const { return next_ - reached_; }
  [[nodiscard]] double cross_track() const { return cross_track_; }  ///< m to starboard of the leg
  [[nodiscard]] const std::vector<Waypoint>& waypoints() const { return waypoints_; }
  /// Start of the present leg (north, east); undefined before the first step.
  [[nodiscard]] const Eigen::Vector2d& leg_start() const { return from_; }

 private:
  [[nodiscard]] double acceptance_radius(const Waypoint& place) const;
  void advance(const Eigen::Vector2d& here);
  void learn(double aim, double dt);
  [[nodiscard]] double speed_ahead() const;
  [[nodiscard]] double corner_speed(Angle turn, double inside) const;
  [[nodiscard]] double depth_on(const Waypoint& goal, double speed) const;

  GuidanceConfig config_;
  std::vector<Waypoint> waypoints_;
  std::optional<VehicleParameters> parameters_;
  std::optional<Eigen::Vector2d> then_;  ///< as in go_on_to
  std::size_t next_ = 0;
  std::size_t reached_ = 0;
  bool started_ = false;
  Eigen::Vector2d from_ = Eigen::Vector2d::Zero();
  Angle bearing_;
  double to_go_ = 0;  ///< along the leg, to the way-point ahead, m
  double cross_track_ = 0;
  std::optional<double> cross_before_;  ///< at the step before, on the same leg
  double turn_limit_ = 0;               ///< speed of the present turn; 0: none
  Eigen::Vector2d integral_W_ = Eigen::Vector2d::Zero();
  Drift drift_;
  Setpoint last_;
};

struct StationConfig {
  double gain = 0.3;            ///< 1/s
  double integral_gain = 0.02;  ///< 1/s2, against a bias of the speeds; 0: none
  double turn_from = 2;         ///< m: a hovering vehicle without sway turns to its position from here on
  double circle_radius = 10;    ///< m, of a vehicle that cannot hover
  double drift_time = 4;        ///< s, as in GuidanceConfig
};

std::vector<Field> fields(StationConfig& config);

/// Holds a position. A vehicle that can hover moves to it and holds it, by sway if it has any, else by turning to it
/// after a drift. One that cannot hover circles it to starboard, at no smaller a radius than it can turn.
class StationKeeper {
 public:
  StationKeeper(const StationConfig& config, const VehicleParameters& parameters)
      : config_(config), parameters_(parameters) {}

  /// Sets the position; `speed` of the Waypoint is the maximum speed towards it. Without a heading, the present one is
  /// held.
  void hold(const Waypoint& place, const std::optional<Angle>& heading = {});
  Setpoint step(const Pose& X_WB, const std::optional<Eigen::Vector3d>& v_W, double dt);

  [[nodiscard]] const Waypoint& place() const { return place_; }
  /// Radius of the circle at this speed; 0 for a vehicle that hovers.
  [[nodiscard]] double radius(double speed) const;

 private:
  [[nodiscard]] Setpoint hover(const Eigen::Vector2d& gap, Angle heading, double dt);
  [[nodiscard]] Setpoint circle(const Eigen::Vector2d& gap, Angle heading) const;

  StationConfig config_;
  VehicleParameters parameters_;
  Waypoint place_;
  std::optional<Angle> heading_;
  Eigen::Vector2d integral_W_ = Eigen::Vector2d::Zero();  ///< m/s
  bool turning_ = false;
  Drift drift_;
  Setpoint last_;
};

}  // namespace isobath
