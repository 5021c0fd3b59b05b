#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/geometry/polygon.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

Vector2d nearest_on_side(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  const Vector2d side = b - a;
  const double length2 = side.squaredNorm();
  if (length2 == 0) return a;
  return a + std::clamp((p - a).dot(side) / length2, 0.0, 1.0) * side;
}

}  // namespace

Polygon convex_hull(std::vector<Vector2d> points) {
  const auto less = [](const Vector2d& a, const Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  };
  std::sort(points.begin(), points.end(), less);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Polygon hull;
  const auto extend = [&hull](const Vector2d& p, std::size_t keep) {
    while (hull.size() > keep && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) hull.pop_back();
    hull.push_back(p);
  };
  for (const Vector2d& p : points) extend(p, 1);
  const std::size_t lower = hull.size();
  for (auto p = points.rbegin() + 1; p != points.rend(); ++p) extend(*p, lower);
  hull.pop_back();
  return hull;
}

double area(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) twice += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  return twice / 2;
}

bool contains(const Polygon& convex, const Vector2d& p) {
  for (std::size_t i = 0; i < convex.size(); ++i) {
    if (cross(convex[(i + 1) % convex.size()] - convex[i], p - convex[i]) < 0) return false;
  }
  return convex.size() >= 3;
}

Vector2d nearest_point(const Polygon& convex, const Vector2d& p) {
  ISOBATH_ASSERT(!convex.empty());
  if (contains(convex, p)) return p;
  Vector2d best = convex.front();
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vector2d q = nearest_on_side(convex[i], convex[(i + 1) % convex.size()], p);
    if ((q - p).squaredNorm() < (best - p).squaredNorm()) best = q;
  }
  return best;
}

std::optional<double> ray_hit(const Polygon& polygon, const Vector2d& origin, const Vector2d& direction) {
  std::optional<double> nearest;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d a = polygon[i] - origin;
    const Vector2d side = polygon[(i + 1) % polygon.size()] - polygon[i];
    const double slope = cross(direction, side);
    if (slope == 0) continue;  // parallel: the neighbouring sides meet the ray
    const double distance = cross(a, side) / slope;
    const double along = cross(a, direction) / slope;
    if (distance >= 0 && along >= 0 && along <= 1 && (!nearest || distance < *nearest)) nearest = distance;
  }
  return nearest;
}

}  // namespace isobath
