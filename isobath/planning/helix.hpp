// The helix manoeuvre: on its way to an opening (between the pylons of a bridge, say) a vehicle points the narrow
// common beam of its sonars round the opening's edges, by following an elliptic helix about the approach line (Horner
// et al. c. 2009, 6; ledger S5-41 to S5-47).
//
// Frame L of the approach line: x along it, y to starboard, z down. With the advance A a radian, semi-axes B (lateral)
// and C (vertical) and phase t,
//   x = A t,   y = B cos t,   z = -C sin t
// (height is C sin t, S5-E08). The view follows the tangent (A, -B sin t, -C cos t), a quarter turn ahead of the place:
// from t = -pi / 2 it points at the starboard pylon, the surface, the port pylon, the bed (S5-42); counter-clockwise
// seen from behind the vehicle, clockwise seen from the bridge (S5-E05).
//
// B and C let the beam just reach the edges: B = A tan(psi_o / 2 - half_beam), C likewise, not below zero (S5-44),
// where psi_o = 2 atan(W / 2D) at the distance D from an opening of width W. On the way D falls, so that both grow;
// their derivatives are part of the tangent (S5-E16). Units SI.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/geometry/space_path.hpp>
#include <isobath/vehicle/vehicle_sheet.hpp>
#include <limits>

namespace isobath {

/// With semi-axes that stay as they are; closed forms (S5-49). Frames and jets are in L, by the phase.
struct EllipticHelix {
  double advance_m = 6;   ///< A, a radian
  double lateral_m = 4;   ///< B
  double vertical_m = 2;  ///< C

  [[nodiscard]] CurveJet at(double phase) const;
  [[nodiscard]] double metres_per_radian(double phase) const;
  /// Serret-Frenet. Not for B = C = 0, nor where the bend of a flat one (C = 0) changes sides.
  [[nodiscard]] PathFrame frame(double phase) const;
  [[nodiscard]] double turn_m() const;  ///< advance in a turn
  [[nodiscard]] double way_m() const;   ///< way in a turn
  [[nodiscard]] double stretch() const { return way_m() / turn_m(); }
  [[nodiscard]] double max_curvature() const;  ///< 1/m
  [[nodiscard]] Angle heading_swing() const;   ///< to each side
  [[nodiscard]] Angle pitch_swing() const;
};

/// A rectangle to go through: origin in its middle, x along the way through it, level; y to starboard, z down.
struct Opening {
  Pose X_WO;
  double width_m = 25;
  double height_m = 8;
};

/// What the vehicle sees of it: bearings of the pylons in W, elevations (up) of water surface and bed.
struct OpeningBearings {
  Angle port, starboard;
  Angle surface, bed;
};

struct OpeningAngles {
  Angle horizontal, vertical;  ///< psi_o, theta_o
};

/// psi_o = wrap(starboard - port) and theta_o = surface - bed (S5-43): positive on any course. The paper's differences
/// have the other sign for compass bearings (S5-E06), and the pylons' subscripts at theta (S5-E04).
OpeningAngles opening_angles(const OpeningBearings& bearings);
/// From the middle line, `distance_m` before it.
OpeningAngles opening_angles(const Opening& opening, double distance_m);
/// The opening across a level line of heading `line`, `distance_m` ahead of p_W, that bearings from there make.
Opening opening_seen(const Eigen::Vector3d& p_W, Angle line, double distance_m, const OpeningBearings& bearings);

struct HelixConfig {
  double advance_m = 6;                   ///< A
  Angle half_beam = Angle::degrees(7.5);  ///< of the common beam
  Angle max_swing = Angle::degrees(20);   ///< of the heading: "a reasonable forward heading"
  Angle max_pitch = Angle::degrees(18);   ///< up and down
  double rise_m = 8;                      ///< in which the helix begins
  double fall_m = 14;                     ///< in which it ends
  double settle_m = 15;                   ///< in which a new plan takes over from the old one
  double reaction_s = 5;                  ///< from an echo to a new course, with the pings that it takes to believe
  double clearance_m = 5;                 ///< from the opening's plane, when turning away: doubt about the pylons
  double pass_share = 0.9;                ///< of the opening known to be free, to go through
  double margin_m = 1;                    ///< of free water round the hull, to go through
};

std::vector<Field> fields(HelixConfig& config);

/// B and C by the law above.
struct HelixAmplitudes {
  double lateral_m = 0, vertical_m = 0;
};
HelixAmplitudes helix_amplitudes(const HelixConfig& config, const OpeningAngles& angles);

/// What a planned path asks of a vehicle at a steady speed: the greatest values at places 0.25 m apart.
struct PathDemand {
  Angle swing;            ///< of the heading, off the line
  Angle pitch;            ///< up or down
  double turn_rate = 0;   ///< rad/s; U times the curvature, whichever way it bends
  double climb_rate = 0;  ///< m/s, up or down
  double least_radius = std::numeric_limits<double>::infinity();  ///< m, in plan
};

/// The least distance before the opening from which turning away still works, from the worst heading of the swing:
/// R (1 + sin max_swing) + speed reaction + clearance, R the tightest turn at that speed (S5-45).
double latest_decision_m(const HelixConfig& config, const VehicleSheet& sheet, double speed);

/// A planned approach: helix until `leave_m` before the opening, then straight through its middle.
struct HelixPlan {
  SpacePath path;
  double leave_m = 0;  ///< distance from the opening at which the helix begins to end
  PathDemand demand;
  bool within_limits = false;  ///< false: not even without a helix
};

/// Plans approaches, each in the frame of the approach line that the first opening makes with the vehicle's place; a
/// new plan takes over from the last one with the same place, direction, curvature and rate of change of it (S5-47).
///
/// leave_m is the least distance, not below latest_decision_m, for which the whole path keeps within the swing, pitch,
/// turn rate, turning radius and climb rate of configuration and vehicle. Costs about 3 ms at most. One thread at a
/// time.
class HelixPlanner {
 public:
  HelixPlanner(const HelixConfig& config, const VehicleSheet& sheet, double speed, const Eigen::Vector3d& start_W,
               const Opening& opening);

  /// From where the vehicle's target is on the last plan (`along_m` from the start, by `along`), to `beyond_m` behind
  /// the opening. `amplitude` in [0, 1]: share of the helix that there is room for.
  HelixPlan plan(const Opening& opening, double along_m, double amplitude = 1, double beyond_m = 10);
  /// Leaves the helix where the last plan said, from now on.
  void leave() { left_ = true; }

  [[nodiscard]] const Pose& X_WL() const { return X_WL_; }
  /// Along the line from its start, m.
  [[nodiscard]] double along(const Eigen::Vector3d& p_W) const { return (X_WL_.inverse() * p_W).x(); }
  /// Phase of the helix; it goes on evenly whatever is planned anew.
  [[nodiscard]] double phase(double along_m) const;
  [[nodiscard]] double latest_m() const { return latest_m_; }

  /// A number and its first three derivatives by the way along the line.
  struct Jet {
    double v = 0, d1 = 0, d2 = 0, d3 = 0;
  };
  /// What one plan is made of; all that its path needs.
  struct Shape {
    double advance, tan_half_beam;
    double opening_x, middle_y, middle_z;  ///< of the opening, in L
    double half_width, half_height;
    double leave, rise, fall, amplitude;
    double from, settle;            ///< where it takes over, and in what length
    Jet lateral_gap, vertical_gap;  ///< what the old plan had there beyond the new one
  };

 private:
  HelixConfig config_;
  VehicleSheet sheet_;
  double speed_;
  Pose X_WL_;
  double latest_m_;
  bool left_ = false;
  Shape last_;
};

}  // namespace isobath
