#include <algorithm>
#include <cmath>
#include <isobath/map/spherical/spherical_passage.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

/// The nearest occupied cell along the path.
void find_blocking(const SphericalGrid& grid, const Vector3d& course_G, double distance_m, double radius_m,
                   WayAhead& way) {
  const SphericalLayers& layers = grid.layers();
  const Vector3d from = grid.to_table(Vector3d::Zero()), course = grid.to_table(course_G) - from;
  // A content may lie anywhere in its cell, and the vehicle within a step of the cells' origin.
  const double half_cell = 0.5 * layers.thickness(layers.layer_at(std::min(distance_m, layers.range_m())));
  const double slack = grid.buckets().step().radians(), off = from.norm();
  double nearest = distance_m;
  grid.cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> cells) {
    const int first = grid.cells().first_occupied(d);
    if (first < 0) return;
    const double cosine = grid.axis_in_table(d).dot(course), inner = layers.inner(first);
    const double reach = radius_m + half_cell + off + inner * slack;
    if (inner * inner * (1 - cosine * cosine) > reach * reach && inner > reach) return;
    if (inner * cosine > nearest + reach) return;
    for (const SphericalCell& cell : cells) {
      if (static_cast<double>(cell.log_odds) < grid.occupied_log_odds()) continue;
      const Vector3d p = cell.point() - from;
      const double along = p.dot(course), wide = radius_m + 0.5 * layers.thickness(cell.layer);
      if (along < 0 || along > nearest || p.squaredNorm() - along * along > wide * wide) continue;
      if (way.blocking && along == nearest) continue;
      nearest = along;
      way.blocking = SphericalPlace{d, cell.layer};
    }
  });
  way.blocked_m = way.blocking ? nearest : 0;
}

/// The distance up to which the path's middle and its sides at the same level were all seen to be clear.
double clear_along(const SphericalGrid& grid, const Vector3d& course, double until, double radius_m) {
  const double level = course.head<2>().norm();
  const Vector3d side = level > 1e-9 ? Vector3d(-course.y() / level, course.x() / level, 0) : Vector3d(1, 0, 0);
  double clear = 0;
  for (int layer = 0; layer < grid.layers().count() && clear < until; ++layer) {
    const double r = std::min(grid.layers().middle(layer), until);
    for (const double aside : {0.0, -radius_m, radius_m}) {
      if (aside != 0 && r <= radius_m) continue;  // beside the vehicle
      if (!grid.was_clear(r * course + aside * side)) return clear;
    }
    clear = std::min(grid.layers().outer(layer), until);
  }
  return clear;
}

}  // namespace

const char* to_text(WayAhead::Verdict verdict) {
  switch (verdict) {
    case WayAhead::Verdict::kClear: return "clear";
    case WayAhead::Verdict::kUnknown: return "unknown";
    case WayAhead::Verdict::kBlocked: return "blocked";
  }
  return "";
}

WayAhead way_ahead(const SphericalGrid& grid, const Vector3d& course_G, double distance_m, double radius_m) {
  WayAhead way;
  const Vector3d course = course_G.normalized();
  find_blocking(grid, course, distance_m, radius_m, way);
  way.clear_m = clear_along(grid, course, way.blocking ? way.blocked_m : distance_m, radius_m);
  if (way.blocking) {
    way.verdict = WayAhead::Verdict::kBlocked;
  } else if (way.clear_m >= distance_m) {
    way.verdict = WayAhead::Verdict::kClear;
  }
  return way;
}

}  // namespace isobath
