// Path following in space: steers a vehicle by pitch rate and turn rate onto a path and along it (Horner et al. c.
// 2009, 6, after Kaminer et al.; ledger S5-48, S5-50 to S5-52, S5-55).
//
// A virtual target moves along the path with a frame F (PathFrame). V is the vehicle's velocity frame: x along the
// velocity, y level when the bank in W is zero. Errors are the position q_F = (x, y, z) of the vehicle in F and the
// angles of R_FV = Rz(psi) Ry(theta) Rx(phi). With U the speed, s' that of the target, and F turning by (torsion, -k2,
// k1) s',
//   x' = -s' (1 - k1 y - k2 z)      + U cos theta cos psi
//   y' = -s' (k1 x - torsion z)     + U cos theta sin psi
//   z' = -s' (k2 x + torsion y)     - U sin theta
//   theta' = q cos phi - r sin phi + s' (torsion sin psi + k2 cos psi)
//   psi'   = (q sin phi + r cos phi) / cos theta - s' (k1 + tan theta (torsion cos psi - k2 sin psi))
// which is the paper's with k2 = 0 (its s' is printed without the dot, S5-E07), and holds in a rotation-minimising
// frame with torsion = 0: straights and inflections are not special cases (S5-55).
//
// The law: s' = K1 x + U cos theta cos psi, approach angles d_th = asin(z / (|z| + d1)), d_ps = asin(-y / (|y| + d2)),
//   theta' = -K2 (theta - d_th) + (c2/c1) z U (sin theta - sin d_th) / (theta - d_th) + d_th'
//   psi'   = -K3 (psi - d_ps)   - (c2/c1) y U cos theta (sin psi - sin d_ps) / (psi - d_ps) + d_ps'
// makes V = |q_F|^2 / (2 c1) + ((theta - d_th)^2 + (psi - d_ps)^2) / (2 c2) fall as long as cos theta > 0. The
// quotients have the limit cos d. The guarantee does not hold where the vehicle cannot turn at the demanded rates;
// check the path's curvature first.
//
// Pure functions of their arguments; nothing allocates. SI, W north-east-down.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/geometry/space_path.hpp>

namespace isobath {

struct PathFollowingConfig {
  double k1 = 0.5;  ///< 1/s, along the path
  double k2 = 1;    ///< 1/s, of the pitch
  double k3 = 1;    ///< 1/s, of the heading
  double c1 = 1;    ///< m2, weight of the position error in V
  double c2 = 0.3;  ///< rad2, weight of the angle errors in V
  double d1 = 3;    ///< m, vertical distance at which the approach angle is 30 degrees
  double d2 = 3;    ///< m, the same laterally
};

std::vector<Field> fields(PathFollowingConfig& config);

/// A vehicle as a point with a velocity frame of zero bank (S5-48): flight path angle theta, nose up; heading psi.
struct CoursePoint {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  double theta = 0;  ///< rad
  double psi = 0;    ///< rad, not wrapped

  [[nodiscard]] Rotation R_WV() const {
    return Rotation::from_heading_pitch_roll(Angle::radians(psi), Angle::radians(theta), Angle());
  }
};

/// Their rates at speed U, pitch rate q and turn rate r; the 1 / cos theta of psi' is limited to 1000.
CoursePoint course_rates(const CoursePoint& at, double speed, double pitch_rate, double turn_rate);

struct PathErrors {
  Eigen::Vector3d q_F = Eigen::Vector3d::Zero();  ///< m
  double theta = 0, psi = 0, phi = 0;             ///< rad, of R_FV
};

PathErrors path_errors(const PathFrame& frame, const Eigen::Vector3d& p_W, const Rotation& R_WV);

struct PathErrorRates {
  Eigen::Vector3d q_F = Eigen::Vector3d::Zero();  ///< m/s
  double theta = 0, psi = 0;                      ///< rad/s
};

/// `s_dot`: speed of the virtual target, m/s.
PathErrorRates error_rates(const PathFrame& frame, const PathErrors& errors, double speed, double s_dot,
                           double pitch_rate, double turn_rate);

/// s' of S5-51, m/s.
double virtual_target_speed(const PathFollowingConfig& config, const PathErrors& errors, double speed);

struct PathFollowingOrder {
  double s_dot = 0;                             ///< of the virtual target, m/s
  double pitch_rate = 0, turn_rate = 0;         ///< q and r of the velocity frame, rad/s
  double approach_theta = 0, approach_psi = 0;  ///< d_th and d_ps, rad
  double lyapunov = 0;                          ///< V
};

PathFollowingOrder follow_path(const PathFollowingConfig& config, const PathFrame& frame, const PathErrors& errors,
                               double speed);

/// The law in a closed loop with an ideal vehicle that turns at once.
struct FollowedPoint {
  CoursePoint vehicle;
  double s = 0;  ///< of the virtual target, m
};

/// Advances by `dt` with the classical Runge-Kutta method.
FollowedPoint step_along(const SpacePath& path, const PathFollowingConfig& config, const FollowedPoint& at,
                         double speed, double dt);

}  // namespace isobath
