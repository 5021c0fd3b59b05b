// Random scenes of convex obstacles, and plain checks of legs against them, for the tests of road maps.
#pragma once

#include <algorithm>
#include <cmath>
#include <isobath/base/random.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/geometry/segment.hpp>
#include <isobath/planning/roadmap/grown_obstacles.hpp>
#include <isobath/planning/roadmap/obstacle_shapes.hpp>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

namespace isobath::test {

inline Polygon random_body(Random& random, const Eigen::Vector2d& centre, double size_m, int corners) {
  Polygon points;
  for (int i = 0; i < corners; ++i) {
    const double angle = random.uniform(0, 2 * std::numbers::pi), out = size_m * random.uniform(0.4, 1);
    points.emplace_back(centre + out * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return convex_hull(points);
}

/// Bodies within a square around the origin.
inline std::vector<Polygon> random_bodies(Random& random, int count, double half_m, double size_m) {
  std::vector<Polygon> bodies;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d centre(random.uniform(-half_m, half_m), random.uniform(-half_m, half_m));
    bodies.push_back(random_body(random, centre, random.uniform(0.3, 1) * size_m, 6));
  }
  return bodies;
}

inline std::vector<GrownPart> grown_parts(const std::vector<Polygon>& bodies, double radius_m, int sides) {
  std::vector<GrownPart> parts;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    parts.push_back({static_cast<int>(i), static_cast<int>(i), bodies[i], grown_polygon(bodies[i], radius_m, sides)});
  }
  return parts;
}

/// Distance of a leg to a convex polygon, 0 where they meet.
inline double plain_distance(const Polygon& convex, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  if (contains(convex, a) || contains(convex, b)) return 0;
  double least = INFINITY;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Eigen::Vector2d &c = convex[i], &d = convex[(i + 1) % convex.size()];
    const bool crosses = cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
    if (crosses) return 0;
    for (const auto& [p, q, at] : {std::tuple(c, d, a), std::tuple(c, d, b), std::tuple(a, b, c)}) {
      least = std::min(least, (nearest_on_segment(p, q, at) - at).norm());
    }
  }
  return least;
}

/// Whether a leg goes deeper than `slack` into a convex polygon: the sides cut it, and a piece lies inside all of them.
inline bool plain_enters(const Polygon& convex, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double slack) {
  std::vector<double> shares{0, 1};
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Eigen::Vector2d side = convex[(i + 1) % convex.size()] - convex[i];
    const double slope = cross(side, b - a);
    if (slope != 0) shares.push_back(std::clamp(cross(side, convex[i] - a) / slope, 0.0, 1.0));
  }
  std::sort(shares.begin(), shares.end());
  for (std::size_t k = 0; k + 1 < shares.size(); ++k) {
    const Eigen::Vector2d p = a + (shares[k] + shares[k + 1]) / 2 * (b - a);
    bool inside = true;
    for (std::size_t i = 0; i < convex.size() && inside; ++i) {
      const Eigen::Vector2d side = convex[(i + 1) % convex.size()] - convex[i];
      inside = cross(side.normalized(), p - convex[i]) > slack;
    }
    if (inside) return true;
  }
  return false;
}

}  // namespace isobath::test
