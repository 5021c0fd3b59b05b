#include <algorithm>
#include <cmath>
#include <isobath/geometry/deviation.hpp>
#include <isobath/geometry/segment.hpp>
#include <isobath/planning/traffic/moving_body.hpp>
#include <limits>

namespace isobath {
namespace {

/// From p to the border of a simple outline, negative inside. The exact inner_distance of polygon.hpp costs more.
double outer_distance(const Polygon& outline, const Eigen::Vector2d& p) {
  double least2 = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0, before = outline.size() - 1; i < outline.size(); before = i++) {
    const Eigen::Vector2d &a = outline[before], &b = outline[i];
    least2 = std::min(least2, (nearest_on_segment(a, b, p) - p).squaredNorm());
    const bool spans = (a.y() > p.y()) != (b.y() > p.y());
    if (spans && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside ? -std::sqrt(least2) : std::sqrt(least2);
}

}  // namespace

bool is_valid(const MovingBody& body) {
  const auto corner_is_finite = [](const Eigen::Vector2d& corner) { return corner.allFinite(); };
  return body.p_W.allFinite() && body.velocity_W.allFinite() && std::isfinite(body.radius_m) && body.radius_m >= 0 &&
         std::isfinite(body.turn_rate) && std::ranges::all_of(body.outline, corner_is_finite) &&
         body.position_covariance.allFinite() && body.velocity_covariance.allFinite() &&
         body.position_covariance.diagonal().minCoeff() >= 0 && body.velocity_covariance.diagonal().minCoeff() >= 0;
}

bool is_still(const MovingBody& body, double speed) {
  return body.velocity_W.norm() <= speed && body.turn_rate == 0 &&
         body.velocity_covariance.diagonal().maxCoeff() <= speed * speed;
}

double circumscribed_radius(const MovingBody& body) {
  double farthest = 0;
  for (const Eigen::Vector2d& corner : body.outline) farthest = std::max(farthest, corner.norm());
  return farthest + body.radius_m;
}

double predicted_growth(const MovingBody& body, double ahead_s, double sigmas) {
  if (body.position_covariance.isZero(0) && body.velocity_covariance.isZero(0)) return 0;
  const Eigen::Matrix2d spread = body.position_covariance + ahead_s * ahead_s * body.velocity_covariance;
  return sigmas * greatest_deviation(spread);
}

double distance_to(const MovingBody& body, const Eigen::Vector2d& p_W, double ahead_s) {
  const Eigen::Vector2d from = p_W - body.p_W - ahead_s * body.velocity_W;
  if (body.outline.empty()) return from.norm() - body.radius_m;
  const double c = std::cos(body.turn_rate * ahead_s), s = std::sin(body.turn_rate * ahead_s);
  const Eigen::Vector2d p(c * from.x() + s * from.y(), c * from.y() - s * from.x());
  return outer_distance(body.outline, p) - body.radius_m;
}

}  // namespace isobath
