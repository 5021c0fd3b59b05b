// Guidance: set-points that lead along way-points, or hold a place.
//
// LineOfSight steers for a point `lookahead` ahead on the line between two way-points (Fossen 2011, 12.3; integral
// action after Borhaug 2008): heading = bearing - atan((e + sigma E) / lookahead), E' = lookahead e / ((e + sigma E)^2
// + lookahead^2), e to starboard of the line, so that a steady current leaves no offset. Depth and speed are those of
// the way-point ahead. A way-point counts as reached within the acceptance radius, horizontally; one that is passed
// further away counts as missed, and the path goes on: a vehicle that cannot turn tightly enough must not circle.
//
// Units SI. One thread at a time; step allocates nothing.
#pragma once

#include <isobath/vehicle/autopilot.hpp>
#include <vector>

namespace isobath {

struct Waypoint {
  double north = 0;  ///< m in W
  double east = 0;
  double depth = 0;
  double speed = 1;  ///< on the way to it, m/s
};

struct GuidanceConfig {
  double lookahead = 8;          ///< m
  double acceptance_radius = 3;  ///< m
  double integral_gain = 0;      ///< sigma, m/s; 0: none
};

std::vector<Field> fields(GuidanceConfig& config);

class LineOfSight {
 public:
  /// Throws Error without way-points. The first leg starts where the vehicle is at the first step.
  LineOfSight(const GuidanceConfig& config, std::vector<Waypoint> waypoints);

  /// After the last way-point: its depth, the last bearing, speed 0.
  Setpoint step(const VehicleState& state, double dt);

  [[nodiscard]] bool finished() const { return next_ == waypoints_.size(); }
  [[nodiscard]] std::size_t next() const { return next_; }        ///< index of the way-point ahead
  [[nodiscard]] std::size_t reached() const { return reached_; }  ///< within the acceptance radius
  [[nodiscard]] std::size_t missed() const { return next_ - reached_; }
  [[nodiscard]] double cross_track() const { return cross_track_; }  ///< m to starboard of the leg

 private:
  GuidanceConfig config_;
  std::vector<Waypoint> waypoints_;
  std::size_t next_ = 0;
  std::size_t reached_ = 0;
  bool started_ = false;
  Eigen::Vector2d from_ = Eigen::Vector2d::Zero();
  Angle bearing_;
  double cross_track_ = 0;
  double integral_ = 0;
};

/// Holds a place with a vehicle that can move any way: velocity towards it, `gain` 1/s times the distance, limited.
Setpoint hold_station(const VehicleState& state, const Waypoint& place, Angle heading, double gain = 0.5);

}  // namespace isobath
