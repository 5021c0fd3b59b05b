#include <algorithm>
#include <cmath>
#include <isobath/vehicle/path_following.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr double kSteepest = 1e-3;  // minimum cos theta in a division

double divisor_of(double theta) {
  const double c = std::cos(theta);
  return std::abs(c) > kSteepest ? c : std::copysign(kSteepest, c);
}

/// (sin a - sin b) / (a - b), with its limit cos b.
double sine_quotient(double a, double b) {
  const double half = 0.5 * (a - b);
  const double sinc = std::abs(half) < 1e-4 ? 1 - half * half / 6 : std::sin(half) / half;
  return std::cos(0.5 * (a + b)) * sinc;
}

/// asin(off / (|off| + scale)) and its derivative by `off`.
struct ApproachAngle {
  double angle, slope;
};
ApproachAngle approach_angle(double off, double scale) {
  const double wide = std::abs(off) + scale, sine = off / wide;
  return {std::asin(sine), scale / (wide * wide) / std::sqrt(1 - sine * sine)};
}

}  // namespace

std::vector<Field> fields(PathFollowingConfig& c) {
  return {Field::real("k1", &c.k1, {1e-3, 10}, "1/s", "Gain of the virtual target's catch-up along the path."),
          Field::real("k2", &c.k2, {1e-3, 10}, "1/s", "Gain of the pitch towards the approach angle."),
          Field::real("k3", &c.k3, {1e-3, 10}, "1/s", "Gain of the heading towards the approach angle."),
          Field::real("c1", &c.c1, {1e-3, 1e3}, "m2", "Weight of the position error in the Lyapunov function."),
          Field::real("c2", &c.c2, {1e-3, 1e3}, "rad2", "Weight of the angle errors in the Lyapunov function."),
          Field::real("d1", &c.d1, {0.1, 100}, "m", "Vertical distance at which the approach angle is 30 degrees."),
          Field::real("d2", &c.d2, {0.1, 100}, "m", "Lateral distance at which the approach angle is 30 degrees.")};
}

CoursePoint course_rates(const CoursePoint& at, double speed, double pitch_rate, double turn_rate) {
  const double level = speed * std::cos(at.theta);
  return {{level * std::cos(at.psi), level * std::sin(at.psi), -speed * std::sin(at.theta)},
          pitch_rate,
          turn_rate / divisor_of(at.theta)};
}

PathErrors path_errors(const PathFrame& frame, const Vector3d& p_W, const Rotation& R_WV) {
  const Rotation R_FV = Rotation::from_matrix(frame.R_WF.transpose() * R_WV.matrix());
  return {frame.R_WF.transpose() * (p_W - frame.p_W), R_FV.pitch().radians(), R_FV.heading().radians(),
          R_FV.roll().radians()};
}

PathErrorRates error_rates(const PathFrame& frame, const PathErrors& e, double speed, double s_dot, double pitch_rate,
                           double turn_rate) {
  const double level = speed * std::cos(e.theta);
  const Vector3d velocity_F(level * std::cos(e.psi), level * std::sin(e.psi), -speed * std::sin(e.theta));
  const Vector3d turn_F = s_dot * frame.turn_F();
  PathErrorRates rates;
  rates.q_F = velocity_F - s_dot * Vector3d::UnitX() - turn_F.cross(e.q_F);
  const double cphi = std::cos(e.phi), sphi = std::sin(e.phi), cpsi = std::cos(e.psi), spsi = std::sin(e.psi);
  rates.theta = pitch_rate * cphi - turn_rate * sphi + s_dot * (frame.torsion * spsi + frame.k2 * cpsi);
  const double cth = divisor_of(e.theta);
  rates.psi = (pitch_rate * sphi + turn_rate * cphi) / cth -
              s_dot * (frame.k1 + std::sin(e.theta) / cth * (frame.torsion * cpsi - frame.k2 * spsi));
  return rates;
}

double virtual_target_speed(const PathFollowingConfig& config, const PathErrors& e, double speed) {
  return config.k1 * e.q_F.x() + speed * std::cos(e.theta) * std::cos(e.psi);
}

PathFollowingOrder follow_path(const PathFollowingConfig& c, const PathFrame& frame, const PathErrors& e,
                               double speed) {
  PathFollowingOrder order;
  order.s_dot = virtual_target_speed(c, e, speed);
  const double y = e.q_F.y(), z = e.q_F.z();
  const PathErrorRates drift = error_rates(frame, e, speed, order.s_dot, 0, 0);  // without pitch and turn rate
  const ApproachAngle climb = approach_angle(z, c.d1), turn = approach_angle(-y, c.d2);
  order.approach_theta = climb.angle;
  order.approach_psi = turn.angle;
  const double off_theta = e.theta - climb.angle, off_psi = e.psi - turn.angle;
  const double wanted_theta =
      -c.k2 * off_theta + c.c2 / c.c1 * z * speed * sine_quotient(e.theta, climb.angle) + climb.slope * drift.q_F.z();
  const double wanted_psi = -c.k3 * off_psi -
                            c.c2 / c.c1 * y * speed * std::cos(e.theta) * sine_quotient(e.psi, turn.angle) -
                            turn.slope * drift.q_F.y();
  // Required rates about the vehicle's own axes, which are banked in F.
  const double up = wanted_theta - drift.theta, aside = std::cos(e.theta) * (wanted_psi - drift.psi);
  order.pitch_rate = up * std::cos(e.phi) + aside * std::sin(e.phi);
  order.turn_rate = aside * std::cos(e.phi) - up * std::sin(e.phi);
  order.lyapunov = e.q_F.squaredNorm() / (2 * c.c1) + (off_theta * off_theta + off_psi * off_psi) / (2 * c.c2);
  return order;
}

FollowedPoint step_along(const SpacePath& path, const PathFollowingConfig& config, const FollowedPoint& at,
                         double speed, double dt) {
  const auto moved = [](const FollowedPoint& from, const FollowedPoint& rate, double by) {
    return FollowedPoint{{from.vehicle.p_W + by * rate.vehicle.p_W, from.vehicle.theta + by * rate.vehicle.theta,
                          from.vehicle.psi + by * rate.vehicle.psi},
                         from.s + by * rate.s};
  };
  const auto rates = [&](const FollowedPoint& x) {
    const PathFrame frame = path.frame_at(x.s);
    const PathErrors errors = path_errors(frame, x.vehicle.p_W, x.vehicle.R_WV());
    const PathFollowingOrder order = follow_path(config, frame, errors, speed);
    return FollowedPoint{course_rates(x.vehicle, speed, order.pitch_rate, order.turn_rate), order.s_dot};
  };
  const FollowedPoint a = rates(at), b = rates(moved(at, a, dt / 2)), c = rates(moved(at, b, dt / 2)),
                      d = rates(moved(at, c, dt));
  return moved(moved(moved(moved(at, a, dt / 6), b, dt / 3), c, dt / 3), d, dt / 6);
}

}  // namespace isobath
