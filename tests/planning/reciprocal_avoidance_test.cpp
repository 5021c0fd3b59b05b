// Reciprocal avoidance against its definition and brute force.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/traffic/reciprocal_avoidance.hpp>
#include <numbers>

namespace isobath::reciprocal_avoidance {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

AvoidedDisc random_disc(Random& random, double far_m) {
  const double angle = random.uniform(0, 2 * pi), course = random.uniform(0, 2 * pi), speed = random.uniform(0, 1.5);
  return {far_m * Vector2d(std::cos(angle), std::sin(angle)), speed * Vector2d(std::cos(course), std::sin(course)),
          random.uniform(0.5, 3)};
}

/// Least distance of the centres within the horizon, less the radii.
double least_gap(const AvoidedDisc& own, const Vector2d& velocity, const AvoidedDisc& other, double horizon_s) {
  const Vector2d p = own.p - other.p, w = velocity - other.velocity;
  const double t = w.squaredNorm() > 0 ? std::clamp(-p.dot(w) / w.squaredNorm(), 0.0, horizon_s) : 0;
  return (p + t * w).norm() - own.radius_m - other.radius_m;
}

// With all of the responsibility, each velocity within the half plane keeps clear for the horizon, and the one on the
// border nearest to the own velocity just does.
TEST(ReciprocalAvoidance, HalfPlanesTouchTheForbiddenVelocities) {
  Random random(4);
  const ReciprocalConfig config{.share = 1};
  for (int i = 0; i < 500; ++i) {
    const AvoidedDisc own{{0, 0}, random_disc(random, 1).velocity, 0.5};
    const AvoidedDisc other = random_disc(random, random.uniform(4, 30));
    const HalfPlane plane = avoidance_half_plane(own, other, config);
    EXPECT_NEAR(least_gap(own, plane.point, other, config.horizon_s), 0, 1e-9);
    const Vector2d along(-plane.normal.y(), plane.normal.x());
    for (int k = 0; k < 20; ++k) {
      const Vector2d v = plane.point + random.uniform(0, 2) * plane.normal + random.uniform(-2, 2) * along;
      EXPECT_GE(least_gap(own, v, other, config.horizon_s), -1e-9);
    }
  }
}

// Against a fine grid of velocities: the nearest to the wanted one that all half planes allow, or the one that violates
// them least.
TEST(ReciprocalAvoidance, SolvesItsLinearProgramme) {
  Random random(5);
  const ReciprocalConfig config{.share = 1};
  int open = 0, closed = 0;
  for (int i = 0; i < 150; ++i) {
    const AvoidedDisc own{{0, 0}, random_disc(random, 1).velocity, 0.5};
    std::vector<AvoidedDisc> others;
    for (int k = 0; k < 8; ++k) others.push_back(random_disc(random, random.uniform(3.6, 12)));
    const Vector2d wanted(1.5, 0);
    const Vector2d found = reciprocal_velocity(own, wanted, others, config);
    const auto violation = [&](const Vector2d& v) {
      double greatest = 0;
      for (const AvoidedDisc& other : others) {
        const HalfPlane plane = avoidance_half_plane(own, other, config);
        greatest = std::max(greatest, -plane.normal.dot(v - plane.point));
      }
      return greatest;
    };
    double nearest = INFINITY, least = INFINITY;
    for (int a = -75; a <= 75; ++a) {
      for (int b = -75; b <= 75; ++b) {
        const Vector2d v(0.02 * a, 0.02 * b);
        if (v.norm() > 1.5) continue;
        const double by = violation(v);
        least = std::min(least, by);
        if (by <= 1e-12) nearest = std::min(nearest, (v - wanted).norm());
      }
    }
    EXPECT_LE(found.norm(), 1.5 + 1e-9);
    EXPECT_LE(violation(found), least + 1e-6);
    if (std::isfinite(nearest)) {
      ++open;
      EXPECT_LE((found - wanted).norm(), nearest + 1e-6);
    } else {
      ++closed;
    }
  }
  EXPECT_GT(open, 20);
  EXPECT_GT(closed, 10);
}

}  // namespace
}  // namespace isobath::reciprocal_avoidance
