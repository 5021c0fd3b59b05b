// A plan of segments and circles, and a level turn of beams in it, each the nearest of its rays: by plain loops.
#pragma once

#include <cmath>
#include <isobath/base/random.hpp>
#include <isobath/perception/plane_scan.hpp>
#include <limits>
#include <numbers>
#include <vector>

namespace isobath::test {

struct PlanSegment {
  Eigen::Vector2d a, b;
};
struct PlanCircle {
  Eigen::Vector2d centre;
  double radius;
};
struct PlanRoom {
  std::vector<PlanSegment> segments;
  std::vector<PlanCircle> circles;

  [[nodiscard]] double range(const Eigen::Vector2d& p, double bearing) const {
    const Eigen::Vector2d u(std::cos(bearing), std::sin(bearing));
    double nearest = std::numeric_limits<double>::infinity();
    for (const PlanSegment& s : segments) {
      const Eigen::Vector2d v = s.b - s.a, w = s.a - p;
      const double det = u.x() * v.y() - u.y() * v.x();
      const double t = (w.x() * v.y() - w.y() * v.x()) / det, share = (w.x() * u.y() - w.y() * u.x()) / det;
      if (t > 0 && share >= 0 && share <= 1) nearest = std::min(nearest, t);
    }
    for (const PlanCircle& c : circles) {
      const Eigen::Vector2d m = p - c.centre;
      const double b = u.dot(m), root = b * b - m.squaredNorm() + c.radius * c.radius;
      if (root < 0) continue;
      for (const double t : {-b - std::sqrt(root), -b + std::sqrt(root)}) {
        if (t > 0) nearest = std::min(nearest, t);
      }
    }
    return nearest;
  }
};

/// 144 beams of 2.5 degrees, 11 rays each; `noise` scales the errors that the scan says it has. Beams that hear nothing
/// within `reach_m` are left out.
inline PlaneScan plan_scan(const PlanRoom& room, const Eigen::Vector2d& from, Random& random, double noise = 1,
                           double reach_m = 40) {
  PlaneScan scan;
  scan.from = from;
  for (int beam = 0; beam < 144; ++beam) {
    const double bearing = beam * 2.5 * std::numbers::pi / 180;
    double nearest = std::numeric_limits<double>::infinity();
    for (int ray = 0; ray < 11; ++ray) {
      nearest =
          std::min(nearest, room.range(from, bearing + scan.beam_width.full.radians() * ((ray + 0.5) / 11 - 0.5)));
    }
    const double in_angle = random.normal();
    const double in_range = random.normal();
    if (nearest > reach_m) continue;
    scan.echoes.emplace_back(Angle::radians(bearing) + scan.sigma * (noise * in_angle),
                             nearest + noise * scan.range_sigma(nearest) * in_range);
  }
  scan.sort();
  return scan;
}

}  // namespace isobath::test
