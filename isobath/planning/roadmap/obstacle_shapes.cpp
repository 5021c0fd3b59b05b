#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/geometry/exact_predicates.hpp>
#include <isobath/planning/roadmap/obstacle_shapes.hpp>
#include <limits>
#include <numbers>
#include <optional>

namespace isobath {
namespace {

using Eigen::Vector2d;
using CornerIds = std::vector<std::size_t>;

/// The corner that takes the place of side i to i + 1 when its neighbours are extended, if they meet.
std::optional<Vector2d> corner_instead_of_side(const Polygon& hull, std::size_t i) {
  const std::size_t n = hull.size();
  const Vector2d &a = hull[(i + n - 1) % n], &b = hull[i], &c = hull[(i + 1) % n], &d = hull[(i + 2) % n];
  const Vector2d before = b - a, after = d - c;
  const double turn = cross(before, after);
  if (turn <= 1e-12 * before.norm() * after.norm()) return std::nullopt;
  return b + cross(c - b, after) / turn * before;
}

/// Index triples of a triangulation of a simple polygon in the positive sense.
std::vector<CornerIds> ears_of(const Polygon& polygon) {
  CornerIds rest(polygon.size());
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = i;
  std::vector<CornerIds> ears;
  const auto is_ear = [&](std::size_t a, std::size_t b, std::size_t c) {
    if (orientation(polygon[a], polygon[b], polygon[c]) <= 0) return false;
    return std::none_of(rest.begin(), rest.end(), [&](std::size_t p) {
      return p != a && p != b && p != c && orientation(polygon[a], polygon[b], polygon[p]) >= 0 &&
             orientation(polygon[b], polygon[c], polygon[p]) >= 0 &&
             orientation(polygon[c], polygon[a], polygon[p]) >= 0;
    });
  };
  while (rest.size() > 3) {
    const std::size_t n = rest.size();
    std::size_t found = n;
    for (std::size_t i = 0; i < n && found == n; ++i) {
      if (is_ear(rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n])) found = i;
    }
    if (found < n) {
      ears.push_back({rest[(found + n - 1) % n], rest[found], rest[(found + 1) % n]});
    } else {  // what is left has corners on its sides: one of them goes
      for (std::size_t i = 0; i < n && found == n; ++i) {
        const auto &a = polygon[rest[(i + n - 1) % n]], &c = polygon[rest[(i + 1) % n]];
        if (orientation(a, polygon[rest[i]], c) == 0) found = i;
      }
      if (found == n) return {};
    }
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(found));
  }
  if (orientation(polygon[rest[0]], polygon[rest[1]], polygon[rest[2]]) > 0) ears.push_back(rest);
  return ears;
}

/// Joins b to a over a side that both have, if the result is convex.
bool join_parts(const Polygon& polygon, CornerIds& a, const CornerIds& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::size_t from = a[i], to = a[(i + 1) % a.size()];
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (b[j] != to || b[(j + 1) % b.size()] != from) continue;
      CornerIds whole;  // around a from `to` back to `from`, then around b
      for (std::size_t k = 0; k < a.size(); ++k) whole.push_back(a[(i + 1 + k) % a.size()]);
      for (std::size_t k = 2; k < b.size(); ++k) whole.push_back(b[(j + k) % b.size()]);
      for (std::size_t k = 0; k < whole.size(); ++k) {
        const auto corner = [&](std::size_t m) -> const Vector2d& { return polygon[whole[m % whole.size()]]; };
        if (orientation(corner(k), corner(k + 1), corner(k + 2)) < 0) return false;
      }
      a = std::move(whole);
      return true;
    }
  }
  return false;
}

}  // namespace

Polygon grown_polygon(const Polygon& convex, double radius_m, int sides) {
  ISOBATH_ASSERT(radius_m >= 0 && sides >= 3 && !convex.empty());
  const double out = radius_m / std::cos(std::numbers::pi / sides);
  std::vector<Vector2d> sums;
  sums.reserve(convex.size() * static_cast<std::size_t>(sides));
  for (int i = 0; i < sides; ++i) {
    const double angle = (2 * i + 1) * std::numbers::pi / sides;
    const Vector2d corner(out * std::cos(angle), out * std::sin(angle));
    for (const Vector2d& p : convex) sums.push_back(p + corner);
  }
  return convex_hull(std::move(sums));
}

Polygon convex_enclosure(const Polygon& points, int max_corners) {
  ISOBATH_ASSERT(max_corners >= 4);
  Polygon hull = convex_hull(points);
  while (hull.size() > static_cast<std::size_t>(max_corners)) {
    std::size_t best = hull.size();
    double least = std::numeric_limits<double>::infinity();
    Vector2d corner(0, 0);
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const auto meeting = corner_instead_of_side(hull, i);
      if (!meeting) continue;
      const double added = cross(*meeting - hull[i], hull[(i + 1) % hull.size()] - hull[i]);
      if (std::abs(added) >= least) continue;
      least = std::abs(added);
      best = i;
      corner = *meeting;
    }
    if (best == hull.size()) break;  // only where rounding leaves no side whose neighbours meet
    hull[best] = corner;
    hull.erase(hull.begin() + static_cast<std::ptrdiff_t>((best + 1) % hull.size()));
  }
  return hull;
}

std::vector<Polygon> convex_parts(const Polygon& outline) {
  if (!is_simple(outline)) return {convex_hull(outline)};
  Polygon polygon = outline;
  if (area(polygon) < 0) std::reverse(polygon.begin(), polygon.end());
  std::vector<CornerIds> parts = ears_of(polygon);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = i + 1; j < parts.size();) {
      if (!join_parts(polygon, parts[i], parts[j])) {
        ++j;
        continue;
      }
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;
    }
  }
  if (parts.empty()) return {convex_hull(outline)};
  std::vector<Polygon> result;
  for (const CornerIds& part : parts) {
    Polygon& p = result.emplace_back();
    for (const std::size_t i : part) p.push_back(polygon[i]);
  }
  return result;
}

std::vector<Polygon> shape_of(const Polygon& outline, ShapeDetail detail) {
  switch (detail) {
    case ShapeDetail::kEnclosure: return {convex_enclosure(outline)};
    case ShapeDetail::kHull: return {convex_hull(outline)};
    case ShapeDetail::kParts: break;
  }
  return convex_parts(outline);
}

}  // namespace isobath
