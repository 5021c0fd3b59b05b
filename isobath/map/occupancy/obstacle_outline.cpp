#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/map/occupancy/obstacle_outline.hpp>
#include <limits>
#include <numbers>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kPoints = 14;

}  // namespace

Circle circle_of(const Polygon& outline) {
  Vector2d low = outline.front(), high = outline.front();
  for (const Vector2d& p : outline) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Circle c{(low + high) / 2, 0};
  for (const Vector2d& p : outline) c.radius = std::max(c.radius, (p - c.centre).norm());
  return c;
}

Polygon fewer_corners(const Polygon& outline) {
  constexpr int kSides = 16;
  std::array<Vector2d, kSides> normal;
  std::array<double, kSides> reach;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    normal[i] = {std::cos(angle), std::sin(angle)};
    reach[i] = -std::numeric_limits<double>::infinity();
    for (const Vector2d& p : outline) reach[i] = std::max(reach[i], normal[i].dot(p));
  }
  std::vector<Vector2d> corners;
  const double apart = std::sin(2 * std::numbers::pi / kSides);
  for (int i = 0; i < kSides; ++i) {
    const int k = (i + 1) % kSides;
    const Vector2d turned_i(-normal[i].y(), normal[i].x()), turned_k(-normal[k].y(), normal[k].x());
    corners.emplace_back((reach[k] * turned_i - reach[i] * turned_k) / apart);
  }
  return convex_hull(std::move(corners));
}

std::vector<Vector2d> spread_over(const Polygon& outline) {
  Vector2d low = outline.front(), high = outline.front(), mean = Vector2d::Zero();
  for (const Vector2d& p : outline) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    mean += p / static_cast<double>(outline.size());
  }
  std::vector<Vector2d> samples;
  const double size = std::max(area(outline), 1e-6);
  const double step = std::max(std::sqrt(size / kPoints), (high - low).maxCoeff() / 64);
  for (double x = low.x() + step / 2; x < high.x(); x += step) {
    for (double y = low.y() + step / 2; y < high.y(); y += step) {
      if (contains(outline, {x, y})) samples.emplace_back(x, y);
    }
  }
  if (samples.size() >= 5) return samples;
  samples.assign(1, mean);  // a sliver
  for (const Vector2d& p : outline) samples.emplace_back(mean + 0.7 * (p - mean));
  return samples;
}

double share_inside(std::span<const Vector2d> points, const Vector2d& moved, const Polygon& outline) {
  const auto inside =
      std::count_if(points.begin(), points.end(), [&](const Vector2d& p) { return contains(outline, p + moved); });
  return static_cast<double>(inside) / static_cast<double>(points.size());
}

Vector2d gap(const Polygon& a, const Polygon& b) {
  Vector2d best = nearest_point(b, a.front()) - a.front();
  for (const Vector2d& p : a) {
    const Vector2d d = nearest_point(b, p) - p;
    if (d.squaredNorm() < best.squaredNorm()) best = d;
  }
  for (const Vector2d& p : b) {
    const Vector2d d = p - nearest_point(a, p);
    if (d.squaredNorm() < best.squaredNorm()) best = d;
  }
  return best;
}

Polygon moved_by(Polygon outline, const Vector2d& shift) {
  for (Vector2d& p : outline) p += shift;
  return outline;
}

}  // namespace isobath
