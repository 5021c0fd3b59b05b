// The first echo of a made-up world, found by brute force: rays all over a cone, each followed until it meets the
// ground or the surface. It shares nothing with the code that it tests.
#pragma once

#include <cmath>
#include <isobath/geometry/pose.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <numbers>
#include <optional>

namespace isobath::test {

/// `depth(north, east)`: of the ground; whatever stands on it, walls and poles, is ground that reaches higher.
template <class World>
std::optional<double> first_echo(const World& depth, const Pose& X_WS, Angle half_angle, double max_range_m,
                                 int rings = 6, int rays = 24, double step_m = 0.1) {
  const Eigen::Matrix3d R = X_WS.rotation.matrix();
  const Eigen::Vector3d s = X_WS.translation;
  const auto inside = [&](const Eigen::Vector3d& u, double r) {
    const Eigen::Vector3d p = s + r * u;
    return p.z() < 0 || p.z() >= depth(p.x(), p.y());
  };
  double first = max_range_m;
  for (int ring = 0; ring <= rings; ++ring) {
    const double off = half_angle.radians() * ring / rings;
    for (int ray = 0; ray < (ring == 0 ? 1 : rays); ++ray) {
      const double about = 2 * std::numbers::pi * ray / rays;
      const Eigen::Vector3d u =
          R * Eigen::Vector3d(std::cos(off), std::sin(off) * std::cos(about), std::sin(off) * std::sin(about));
      for (double r = step_m; r < first; r += step_m) {
        if (!inside(u, r)) continue;
        double low = r - step_m, high = r;
        for (int i = 0; i < 8; ++i) (inside(u, (low + high) / 2) ? high : low) = (low + high) / 2;
        first = high;
        break;
      }
    }
  }
  return first < max_range_m ? std::optional(first) : std::nullopt;
}

}  // namespace isobath::test
