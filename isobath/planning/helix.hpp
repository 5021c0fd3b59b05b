// The helix manoeuvre: on its way to an opening (between the pylons of a bridge, say) a vehicle follows an elliptic
// helix about the approach line, so that the narrow common beam of its sonars sweeps round the opening's edges (Horner
// et al. c. 2009, 6; ledger S5-41 to S5-47).
//
// Frame L of the approach line: x along it, y to starboard, z down. With the advance A per radian, semi-axes B
// (lateral) and C (vertical) and phase t,
//   x = A t,   y = B cos t,   z = -C sin t
// (height is C sin t, S5-E08). The view follows the tangent (A, -B sin t, -C cos t), a quarter turn ahead of the
// position: from t = -pi / 2 on it points at the starboard pylon, the surface, the port pylon, the bed (S5-42). It
// turns counter-clockwise seen from behind the vehicle, clockwise seen from the bridge (S5-E05).
//
// B and C are such that the beam just reaches the edges: B = A tan(psi_o / 2 - half_beam), C likewise, not below zero
// (S5-44), where psi_o = 2 atan(W / 2D) at the distance D from an opening of width W. D falls on the way, so that both
// grow; their derivatives are part of the tangent (S5-E16). SI units.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/geometry/space_path.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <limits>

namespace isobath {

/// A helix with constant semi-axes, in closed form (S5-49). Frames and jets are in L, by phase.
struct EllipticHelix {
  double advance_m = 6;   ///< A, per radian
  double lateral_m = 4;   ///< B
  double vertical_m = 2;  ///< C

  [[nodiscard]] CurveJet at(double phase) const;
  [[nodiscard]] double metres_per_radian(double phase) const;
  /// Serret-Frenet frame. Undefined for B = C = 0, and where the bend of a flat helix (C = 0) changes sides.
  [[nodiscard]] PathFrame frame(double phase) const;
  [[nodiscard]] double turn_m() const;  ///< advance per turn
  [[nodiscard]] double way_m() const;   ///< path length per turn
  [[nodiscard]] double stretch() const { return way_m() / turn_m(); }
  [[nodiscard]] double max_curvature() const;  ///< 1/m
  [[nodiscard]] Angle heading_swing() const;   ///< to each side
  [[nodiscard]] Angle pitch_swing() const;
};

/// A rectangle to go through: origin at its centre, x along the passage, level; y to starboard, z down.
struct Opening {
  Pose X_WO;
  double width_m = 25;
  double height_m = 8;
};

struct HelixConfig {
  double advance_m = 6;                   ///< A
  Angle half_beam = Angle::degrees(7.5);  ///< of the common beam
  Angle max_swing = Angle::degrees(20);   ///< of the heading: "a reasonable forward heading"
  Angle max_pitch = Angle::degrees(18);   ///< up and down
  double rise_m = 8;                      ///< length over which the helix begins
  double fall_m = 14;                     ///< length over which it ends
  double settle_m = 15;                   ///< length over which a new plan takes over from the old one
  double reaction_s = 5;                  ///< from an echo to a new heading, including the pings until it is believed
  double clearance_m = 5;                 ///< from the opening's plane when turning away: uncertainty of the pylons
  double pass_share = 0.9;                ///< share of the opening that must be known to be free to go through
  double margin_m = 1;                    ///< free water round the hull that is required to go through
};

std::vector<Field> fields(HelixConfig& config);

/// What a planned path demands of a vehicle at a steady speed: the maximum values at places 0.25 m apart.
struct PathDemand {
  Angle swing;                                                  ///< of the heading, off the line
  Angle pitch;                                                  ///< up or down
  double turn_rate = 0;                                         ///< rad/s; speed U times the curvature in any direction
  double climb_rate = 0;                                        ///< m/s, up or down
  double min_radius = std::numeric_limits<double>::infinity();  ///< m, in plan view
};

/// The minimum distance before the opening from which turning away still works, from the worst heading of the swing:
/// R (1 + sin max_swing) + speed reaction + clearance, R the tightest turn at that speed (S5-45).
double latest_decision_m(const HelixConfig& config, const VehicleParameters& parameters, double speed);

/// A planned approach: helix until `leave_m` before the opening, then straight through its middle.
struct HelixPlan {
  SpacePath path;
  double leave_m = 0;  ///< distance from the opening at which the helix begins to end
  PathDemand demand;
  bool within_limits = false;  ///< false: the path exceeds them even without a helix
};

/// Plans approaches, each in the frame of the approach line from the vehicle's first position to the first opening. A
/// new plan takes over from the last one with the same position, direction, curvature and rate of change of curvature
/// (S5-47).
///
/// leave_m is the minimum distance, not below latest_decision_m, for which the whole path keeps within the swing,
/// pitch, turn rate, turning radius and climb rate of configuration and vehicle. Costs about 3 ms at most. One thread
/// at a time.
class HelixPlanner {
 public:
  HelixPlanner(const HelixConfig& config, const VehicleParameters& parameters, double speed,
               const Eigen::Vector3d& start_W, const Opening& opening);

  /// Plans from the place of the vehicle's target on the last plan (`along_m` from the start, by `along`) to `beyond_m`
  /// behind the opening. `amplitude` in [0, 1]: share of the helix for which there is room.
  HelixPlan plan(const Opening& opening, double along_m, double amplitude = 1, double beyond_m = 10);
  /// From now on the helix is left where the last plan said.
  void leave() { left_ = true; }

  [[nodiscard]] const Pose& X_WL() const { return X_WL_; }
  /// Distance along the line from its start, m.
  [[nodiscard]] double along(const Eigen::Vector3d& p_W) const { return (X_WL_.inverse() * p_W).x(); }
  /// Phase of the helix; replanning does not disturb it.
  [[nodiscard]] double phase(double along_m) const;
  [[nodiscard]] double latest_m() const { return latest_m_; }

  /// A number and its first three derivatives with respect to the distance along the line.
  struct Jet {
    double v = 0, d1 = 0, d2 = 0, d3 = 0;
  };
  /// The parameters of one plan, which define its path.
  struct Shape {
    double advance, tan_half_beam;
    double opening_x, middle_y, middle_z;  ///< of the opening, in L
    double half_width, half_height;
    double leave, rise, fall, amplitude;
    double from, settle;            ///< where it takes over, and over what length
    Jet lateral_gap, vertical_gap;  ///< the old plan minus the new one there
  };

 private:
  HelixConfig config_;
  VehicleParameters parameters_;
  double speed_;
  Pose X_WL_;
  double latest_m_;
  bool left_ = false;
  Shape last_;
};

}  // namespace isobath
