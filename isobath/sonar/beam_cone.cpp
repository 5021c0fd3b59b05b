#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/beam_cone.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

BeamCone::BeamCone(const Eigen::Vector3d& p_WS, const Eigen::Vector3d& u_W, Angle half_angle)
    : p_WS_(p_WS),
      u_W_(u_W),
      half_angle_(half_angle),
      sin_a_(std::sin(half_angle.radians())),
      cos_a_(std::cos(half_angle.radians())),
      cos_delta_(std::hypot(u_W.x(), u_W.y())) {
  ISOBATH_ASSERT(half_angle.radians() >= 0 && cos_a_ > 0 && std::abs(u_W.squaredNorm() - 1) < 1e-6);
  e_ = cos_delta_ > 0 ? Eigen::Vector2d(u_W.head<2>() / cos_delta_) : Eigen::Vector2d(1, 0);
  // cos^2 a - sin^2 delta, in a form that is accurate near 0.
  vertical_term_ = (cos_delta_ - sin_a_) * (cos_delta_ + sin_a_);
}

BeamCone::BeamCone(const RangeReading& reading, const Pose& X_WB)
    : BeamCone(X_WB * reading.X_BS.translation,
               (X_WB.rotation * (reading.X_BS.rotation * Eigen::Vector3d::UnitX())).normalized(), reading.width / 2) {}

Angle BeamCone::depression() const { return Angle::radians(std::atan2(u_W_.z(), cos_delta_)); }

double BeamCone::plan_tangent() const {
  return contains_vertical() ? kInfinity : sin_a_ / std::sqrt(vertical_term_);  // tan(asin(sin a / cos delta))
}

std::optional<DepthInterval> BeamCone::depth_interval(const Eigen::Vector2d& north_east) const {
  // A w^2 - 2 q u_z w + cos^2 a h^2 - q^2 <= 0 with w = z - s_z, on the side with q + w u_z >= 0. In coordinates x
  // along the azimuth and y across it, q^2 - A h^2 = sin^2 a x^2 - A y^2.
  const Eigen::Vector2d d = north_east - p_WS_.head<2>();
  const double x = e_.dot(d);
  const double y = e_.x() * d.y() - e_.y() * d.x();
  const double discriminant = sin_a_ * sin_a_ * x * x - vertical_term_ * y * y;
  const double q = x * cos_delta_;
  if (discriminant < 0 || (vertical_term_ > 0 && q < 0)) return std::nullopt;
  const double middle = q * u_W_.z();
  const double spread = cos_a_ * std::sqrt(discriminant);
  const double far = middle < 0 ? middle - spread : middle + spread;                         // A times one root
  const double product = (cos_a_ * y) * (cos_a_ * y) + (cos_a_ * x - q) * (cos_a_ * x + q);  // A times both
  const double near = far == 0 ? 0 : product / far;
  if (vertical_term_ > 0) {
    const double other = far == 0 ? 0 : far / vertical_term_;
    return DepthInterval{p_WS_.z() + std::min(near, other), p_WS_.z() + std::max(near, other)};
  }
  // The cone contains the vertical: the root farther along the vertical bounds the nappe ahead.
  const bool down = u_W_.z() > 0;
  double edge = near;
  if (vertical_term_ < 0) edge = down ? std::max(near, far / vertical_term_) : std::min(near, far / vertical_term_);
  if (vertical_term_ == 0 && q <= 0 && d.squaredNorm() > 0) return std::nullopt;
  return down ? DepthInterval{p_WS_.z() + edge, kInfinity} : DepthInterval{-kInfinity, p_WS_.z() + edge};
}

double BeamCone::slant_range(const Eigen::Vector2d& north_east) const {
  const Eigen::Vector2d d = north_east - p_WS_.head<2>();
  const double h2 = d.squaredNorm();
  const double q = e_.dot(d) * cos_delta_;
  if (h2 == 0) return 0;
  return q > 0 ? std::sqrt(h2 * (1 + u_W_.z() * u_W_.z() * h2 / (q * q))) : kInfinity;
}

DepthInterval BeamCone::planes(double h) const {
  const double delta = depression().radians();
  const double a = half_angle_.radians();
  return {p_WS_.z() + h * std::tan(delta - a), p_WS_.z() + h * std::tan(delta + a)};
}

std::optional<double> BeamCone::range_to_level(double depth_m) const {
  const double w = depth_m - p_WS_.z();
  const double down = w < 0 ? -u_W_.z() : u_W_.z();
  if (contains_vertical() && down > 0) return std::abs(w);
  const double steepest = down * cos_a_ + cos_delta_ * sin_a_;  // sin(delta + a)
  if (steepest <= 0) return std::nullopt;
  return std::abs(w) / steepest;
}

PlanFootprint plan_footprint(const BeamCone& cone, double range_m, double extension_m, double plan_tangent) {
  const Eigen::Vector2d s = cone.apex().head<2>();
  const Eigen::Vector2d& e = cone.heading();
  const Eigen::Vector2d n(-e.y(), e.x());
  const double steepness = std::abs(cone.axis().z());
  const double cos_delta = cone.cos_depression();
  const double sin_a = cone.sin_half_angle();
  const double cos_a = cone.cos_half_angle();
  // cos(|delta| - a), or 1 if |delta| < a; and cos(|delta| + a).
  const double ahead = steepness > sin_a ? cos_delta * cos_a + steepness * sin_a : 1;
  const double behind = cos_delta * cos_a - steepness * sin_a;
  const double reach = range_m * ahead + extension_m;
  const double across = range_m * sin_a + extension_m;
  if (reach * plan_tangent <= 2 * across) {
    return {{s, s + reach * (e - plan_tangent * n), s + reach * (e + plan_tangent * n), s}, 3};
  }
  const double back = behind < 0 ? range_m * behind - extension_m : 0;
  return {
      {s + back * e - across * n, s + reach * e - across * n, s + reach * e + across * n, s + back * e + across * n},
      4};
}

}  // namespace isobath
