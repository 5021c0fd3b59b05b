#include <algorithm>
#include <cmath>
#include <isobath/geometry/polygon.hpp>
#include <isobath/planning/turning.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double kSlack = 1e-9;            // m, of room on a leg
constexpr double kLargestCorner = pi / 6;  // rad

Vector2d at_angle(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Turn from the direction a -> b to b -> c, in (-pi, pi].
double turn_at(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return std::atan2(cross(b - a, c - b), (b - a).dot(c - b));
}

}  // namespace

double tangent_length(const Vector2d& a, const Vector2d& b, const Vector2d& c, double radius) {
  const double turn = std::abs(turn_at(a, b, c));
  if (radius == 0) return 0;
  return turn > pi - 1e-6 ? INFINITY : radius * std::tan(turn / 2);
}

bool corners_fit(std::span<const Vector2d> way, double radius) {
  double before = 0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const double after = i + 1 < way.size() ? tangent_length(way[i - 1], way[i], way[i + 1], radius) : 0;
    if (before + after > (way[i] - way[i - 1]).norm() + kSlack) return false;
    before = after;
  }
  return true;
}

std::vector<Vector2d> rounded_corner(const Vector2d& a, const Vector2d& b, const Vector2d& c, double radius,
                                     double sag_m) {
  const double turn = turn_at(a, b, c), tangent = tangent_length(a, b, c, radius);
  if (turn == 0 || radius == 0 || !std::isfinite(tangent)) return {b};
  const Vector2d ahead = (b - a).normalized();
  const double side = turn > 0 ? 1 : -1;
  const Vector2d first = b - tangent * ahead;
  const Vector2d centre = first + side * radius * Vector2d(-ahead.y(), ahead.x());
  const double start = std::atan2(first.y() - centre.y(), first.x() - centre.x());
  const double piece = 2 * std::acos(std::max(0.0, 1 - sag_m / radius));
  const int pieces = std::max(1, static_cast<int>(std::min(1e4, std::ceil(std::abs(turn) / piece))));
  std::vector<Vector2d> points = {first};
  for (int i = 1; i <= pieces; ++i) points.emplace_back(centre + radius * at_angle(start + turn * i / pieces));
  return points;
}

std::optional<std::vector<Vector2d>> turn_towards(const Vector2d& start, double heading, double radius, int side,
                                                  const Vector2d& target, double off_m) {
  const Vector2d ahead = at_angle(heading);
  const double straight = (target - start).norm() > 0 ? (target - start).normalized().dot(ahead) : 1;
  if (straight > 0 && radius * (1 - straight) <= off_m) return std::vector<Vector2d>{};
  const Vector2d centre = start + side * radius * Vector2d(-ahead.y(), ahead.x());
  const Vector2d to = target - centre;
  const double rest = to.squaredNorm() - radius * radius;
  if (rest < 0) return std::nullopt;
  // On the circle at angle alpha the vehicle heads for alpha + side pi / 2.
  const double begin = heading - side * pi / 2;
  const double leave = std::atan2(to.y(), to.x()) - side * std::atan2(std::sqrt(rest), radius);
  double turn = std::fmod(side * (leave - begin), 2 * pi);
  if (turn < 0) turn += 2 * pi;
  const int count = std::max(1, static_cast<int>(std::ceil(turn / kLargestCorner)));
  const double each = turn / count;
  std::vector<Vector2d> corners;
  for (int i = 0; i < count; ++i) {
    corners.emplace_back(centre + radius / std::cos(each / 2) * at_angle(begin + side * (i + 0.5) * each));
  }
  return corners;
}

}  // namespace isobath
