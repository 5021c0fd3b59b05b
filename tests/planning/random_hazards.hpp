// Random hazards, and their distances by formulas and sampling that the planner does not use.
#pragma once

#include <algorithm>
#include <cmath>
#include <isobath/base/random.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <numbers>
#include <vector>

namespace isobath::test {

/// A convex outline round a centre: 1 point, 2 a segment, else the hull of points on a circle.
inline Polygon random_outline(Random& random, const Eigen::Vector2d& centre, double radius) {
  const auto corners = 1 + random.index(7);
  Polygon points;
  for (std::uint64_t i = 0; i < corners; ++i) {
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const double r = radius * std::sqrt(random.uniform());
    points.emplace_back(centre + r * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return convex_hull(points);
}

inline std::vector<Hazard> random_hazards(Random& random, int count, double extent, double radius) {
  std::vector<Hazard> hazards;
  for (int i = 0; i < count; ++i) {
    const double x = random.uniform(-extent, extent);
    const double y = random.uniform(-extent, extent);
    Hazard h;
    h.outline = random_outline(random, {x, y}, random.uniform(0.1, radius));
    h.margin_m = random.uniform() < 0.5 ? 0 : random.uniform(0, 1);
    h.id = static_cast<std::uint32_t>(i);
    hazards.push_back(h);
  }
  return hazards;
}

/// Outside: to the nearest point of the outline, less the margin. Inside: less the depth below the sides' lines.
inline double plain_distance(const Hazard& h, const Eigen::Vector2d& p) {
  if (!contains(h.outline, p)) return (nearest_point(h.outline, p) - p).norm() - h.margin_m;
  double depth = INFINITY;
  for (std::size_t i = 0; i < h.outline.size(); ++i) {
    const Eigen::Vector2d side = h.outline[(i + 1) % h.outline.size()] - h.outline[i];
    depth = std::min(depth, cross(side, p - h.outline[i]) / side.norm());
  }
  return -depth - h.margin_m;
}

inline double plain_distance(const std::vector<Hazard>& hazards, const Eigen::Vector2d& p) {
  double least = INFINITY;
  for (const Hazard& h : hazards) least = std::min(least, plain_distance(h, p));
  return least;
}

/// Least distance at places along a way, one every `step` metres; never below the true least distance by more than
/// rounding, and above it by step / 2 at most.
inline double sampled_clearance(const std::vector<Hazard>& hazards, const std::vector<Eigen::Vector2d>& way,
                                double step) {
  double least = INFINITY;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const int pieces = 1 + static_cast<int>((way[i] - way[i - 1]).norm() / step);
    for (int k = 0; k <= pieces; ++k) {
      const Eigen::Vector2d p = way[i - 1] + static_cast<double>(k) / pieces * (way[i] - way[i - 1]);
      least = std::min(least, plain_distance(hazards, p));
    }
  }
  return least;
}

}  // namespace isobath::test
