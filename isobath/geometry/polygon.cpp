#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/geometry/exact_predicates.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/geometry/segment.hpp>
#include <limits>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kBorder = 1e-9;  // of the size of the coordinates: a point nearer to a border lies on it

/// p must be on the line through a and b.
bool between(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  return (p.array() >= a.array().min(b.array())).all() && (p.array() <= a.array().max(b.array())).all();
}

bool on_side(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  return between(a, b, p) && orientation(a, b, p) == 0;
}

int sign(double x) { return (x > 0) - (x < 0); }

bool meet(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const int c_side = sign(orientation(a, b, c)), d_side = sign(orientation(a, b, d));
  const int a_side = sign(orientation(c, d, a)), b_side = sign(orientation(c, d, b));
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && between(a, b, c)) || (d_side == 0 && between(a, b, d)) || (a_side == 0 && between(c, d, a)) ||
         (b_side == 0 && between(c, d, b));
}

/// Whether the neighbouring sides a-b and b-c overlap.
bool folds_back(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return orientation(a, b, c) == 0 && (b - a).dot(c - b) < 0;
}

double border_distance(const Polygon& polygon, const Vector2d& p) {
  double least2 = (polygon.front() - p).squaredNorm();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d q = nearest_on_segment(polygon[i], polygon[(i + 1) % polygon.size()], p);
    least2 = std::min(least2, (q - p).squaredNorm());
  }
  return std::sqrt(least2);
}

/// Every share of the segment at which it may cross the border; additional ones do no harm.
std::vector<double> cuts(const Polygon& polygon, const Vector2d& a, const Vector2d& b) {
  std::vector<double> shares{0, 1};
  const Vector2d way = b - a;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d from = polygon[i] - a;
    const Vector2d side = polygon[(i + 1) % polygon.size()] - polygon[i];
    const double slope = cross(way, side);
    if (way.squaredNorm() > 0) shares.push_back(from.dot(way) / way.squaredNorm());  // a corner on the segment
    if (slope != 0) shares.push_back(cross(from, side) / slope);
  }
  std::erase_if(shares, [](double share) { return !(share >= 0 && share <= 1); });
  std::sort(shares.begin(), shares.end());
  return shares;
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
    const Vector2d q = nearest_on_segment(convex[i], convex[(i + 1) % convex.size()], p);
    if ((q - p).squaredNorm() < (best - p).squaredNorm()) best = q;
  }
  return best;
}

double distance_from(const Polygon& convex, const Vector2d& p) { return (nearest_point(convex, p) - p).norm(); }

double gap_between(const Polygon& a, const Polygon& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vector2d& p : a) least = std::min(least, distance_from(b, p));
  for (const Vector2d& p : b) least = std::min(least, distance_from(a, p));
  return least;
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

bool is_simple(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  if (n < 3) return false;
  const auto corner = [&](std::size_t i) -> const Vector2d& { return polygon[i % n]; };
  for (std::size_t i = 0; i < n; ++i) {
    if (corner(i) == corner(i + 1) || folds_back(corner(i), corner(i + 1), corner(i + 2))) return false;
    for (std::size_t j = i + 2; j < n && j + 1 < i + n; ++j) {
      if (meet(corner(i), corner(i + 1), corner(j), corner(j + 1))) return false;
    }
  }
  return true;
}

bool is_convex(const Polygon& polygon) {
  if (!is_simple(polygon)) return false;
  const double sense = area(polygon) < 0 ? -1 : 1;
  double most = 1;
  for (const Vector2d& p : polygon) most = std::max(most, p.cwiseAbs().maxCoeff());
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    const double slack = kBorder * most * (b - a).norm();
    for (const Vector2d& p : polygon) {
      if (sense * orientation(a, b, p) < -slack) return false;
    }
  }
  return true;
}

bool encloses(const Polygon& simple, const Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0; i < simple.size(); ++i) {
    const Vector2d& a = simple[i];
    const Vector2d& b = simple[(i + 1) % simple.size()];
    if (on_side(a, b, p)) return true;
    if ((a.y() > p.y()) != (b.y() > p.y()) && (orientation(a, b, p) > 0) == (b.y() > a.y())) inside = !inside;
  }
  return inside;
}

double inner_distance(const Polygon& simple, const Vector2d& p) {
  ISOBATH_ASSERT(!simple.empty());
  return encloses(simple, p) ? border_distance(simple, p) : -border_distance(simple, p);
}

std::optional<double> first_exit(const Polygon& simple, const Vector2d& a, const Vector2d& b) {
  ISOBATH_ASSERT(!simple.empty());
  const double border = kBorder * (1 + std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()));
  const auto outside = [&](double share) { return inner_distance(simple, a + share * (b - a)) < -border; };
  if (outside(0)) return 0;
  const std::vector<double> shares = cuts(simple, a, b);
  for (std::size_t i = 0; i + 1 < shares.size(); ++i) {
    if (outside((shares[i] + shares[i + 1]) / 2)) return shares[i];
  }
  if (outside(1)) return 1;
  return std::nullopt;
}

}  // namespace isobath
