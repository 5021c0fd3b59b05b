// Speeds along a fixed path past moving bodies, against a grid of space and time of its own and dense samples.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/traffic/speed_plan.hpp>
#include <map>
#include <numbers>

namespace isobath::speed_plan {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

MovingBody disc(int number, const Vector2d& p, const Vector2d& velocity, double radius_m) {
  MovingBody body;
  body.number = number;
  body.p_W = p;
  body.velocity_W = velocity;
  body.radius_m = radius_m;
  return body;
}

SmoothPath straight(double length_m) { return {{{0, length_m, {{0, 0}, 0, 0}, 0}}}; }

/// Earliest arrival at `goal_m` on the straight path by states of place (0.125 m) and speed (0.25 m/s) each second,
/// checked at ten moments; infinite where the vehicle is caught. Its speeds are a part of those of the planner.
double arrival_on_grid(const std::vector<MovingBody>& bodies, double kept_m, double goal_m) {
  std::map<std::pair<int, int>, bool> here{{{0, 4}, true}};
  for (int k = 0; k < 60; ++k) {
    std::map<std::pair<int, int>, bool> next;
    double best = INFINITY;
    for (const auto& [state, reached] : here) {
      const auto [place, level] = state;
      for (int to = std::max(0, level - 1); to <= std::min(6, level + 1); ++to) {
        bool free = true;
        for (int part = 1; part <= 10 && free; ++part) {
          const double t = 0.1 * part, s = 0.125 * place + 0.25 * (level * t + (to - level) * t * t / 2);
          for (const MovingBody& body : bodies) free = free && distance_to(body, {s, 0}, k + t) >= kept_m;
          if (free && s >= goal_m) best = std::min(best, k + t);
        }
        if (free) next[{place + level + to, to}] = true;
      }
    }
    if (std::isfinite(best)) return best;
    here = std::move(next);
  }
  return INFINITY;
}

double least_gap(const Trajectory& motion, const std::vector<MovingBody>& bodies) {
  double least = INFINITY;
  for (double t = 0; t <= motion.duration_s(); t += 0.02) {
    for (const MovingBody& body : bodies) least = std::min(least, distance_to(body, motion.at(t).p_W, t));
  }
  return least;
}

TEST(SpeedPlan, SpeedsUpWhereThereIsNothing) {
  SpeedPlanner planner({});
  const SmoothPath path = straight(60);
  const auto plan = planner.plan(path, 0, {}, Time(), {});
  ASSERT_TRUE(plan);
  EXPECT_NEAR(plan->arrival_s, 60 / 1.5 + 1.5 / (2 * 0.25), 0.05);
  EXPECT_EQ(plan->free_s, 20);
  const Trajectory motion = plan->motion_along(path, 0, {}, 3);
  EXPECT_NEAR(motion.at(20).p_W.x(), 1.5 * 20 - 1.5 * 1.5 / (2 * 0.25), 0.05);
  EXPECT_NEAR(motion.at(1e3).speed, 0, 1e-9);
}

// One crosser: ahead of it or behind it, whichever arrives earlier, as on a fine grid. ledger: S3-18
TEST(SpeedPlan, PassesACrosserAheadOrBehindWhicheverArrivesEarlier) {
  SpeedPlanner planner({});
  const SmoothPath path = straight(36);
  const SpeedRules rules{.horizon_s = 20, .clear_s = 3, .distance_m = 0.8, .sigmas = 3, .arrival_m = 10};
  int ahead = 0, behind = 0;
  for (double from_m = 6; from_m <= 24; from_m += 0.75) {
    const std::vector<MovingBody> bodies = {disc(4, {14, -from_m}, {0, 0.9}, 2)};
    const auto plan = planner.plan(path, 1, bodies, Time(), rules);
    ASSERT_TRUE(plan) << from_m;
    EXPECT_LE(plan->arrival_s, arrival_on_grid(bodies, 0.9, 26) + 0.4) << from_m << ": within 0.1 m of the distance";
    EXPECT_GE(plan->arrival_s, arrival_on_grid(bodies, 0.8, 26) - 1) << from_m << ": its speeds are twice as fine";
    const Trajectory motion = plan->motion_along(path, 1, {}, 3);
    EXPECT_GE(least_gap(motion, bodies), 0.8) << from_m;
    double crossing_s = 0;
    while (motion.at(crossing_s).p_W.x() < 14 && crossing_s < 40) crossing_s += 0.05;
    (-from_m + 0.9 * crossing_s < 0 ? ahead : behind) += 1;
  }
  EXPECT_GE(ahead, 5);
  EXPECT_GE(behind, 5);
}

// Separation is never below the kept distance, on arcs, among many bodies, with growth and with a rotating bar; speeds
// and their changes keep the limits. ledger: S3-18 S3-12 S3-30
TEST(SpeedPlan, KeepsTheDistanceAndTheLimits) {
  Random random(7);
  const TrafficVehicle vehicle;
  SpeedPlanner planner(vehicle);
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    SmoothPath path;
    MotionState at{{0, 0}, 0, 0};
    for (int k = 0; k < 4; ++k) {
      const double length = random.uniform(3, 12), curvature = k % 2 == 0 ? 0 : random.uniform(-0.2, 0.2);
      path.pieces.push_back({path.length_m(), length, at, curvature});
      at = along_arc(at, curvature, length);
    }
    std::vector<MovingBody> bodies;
    for (int k = 0; k < 5; ++k) {
      const double course = random.uniform(0, 2 * pi), speed = random.uniform(0.1, 1.2);
      MovingBody body = disc(k, {random.uniform(6, 30), random.uniform(-15, 15)},
                             {speed * std::cos(course), speed * std::sin(course)}, random.uniform(0.5, 2));
      if (k == 4) {
        body.radius_m = 0.1;
        body.outline = {{-4, -0.3}, {4, -0.3}, {4, 0.3}, {-4, 0.3}};
        body.turn_rate = random.uniform(-0.2, 0.2);
      }
      bodies.push_back(body);
    }
    const double speed = random.uniform(0, 1.5);
    const auto plan = planner.plan(path, speed, bodies, Time(), {});
    if (!plan) continue;
    ++found;
    const Trajectory motion = plan->motion_along(path, speed, vehicle, 3);
    EXPECT_GE(least_gap(motion, bodies), 0.8) << i;
    for (const MotionSegment& segment : motion.segments) {
      EXPECT_LE(std::abs(segment.acceleration), 0.25 + 1e-9);
      EXPECT_LE(segment.after(segment.duration_s).speed, 1.5 + 1e-9);
    }
    const Vector2d first = motion.at(5).p_W;
    double along = 0, least = INFINITY;
    for (; along < path.length_m() + 5; along += 0.01) least = std::min(least, (path.at(along).p_W - first).norm());
    EXPECT_LT(least, 0.02) << "the motion stays on the path";
  }
  EXPECT_GT(found, 100);
}

// A body that comes along the path in the other direction. ledger: S3-18
TEST(SpeedPlan, NamesTheBodyThatLeavesNoSpeeds) {
  SpeedPlanner planner({});
  const std::vector<MovingBody> bodies = {disc(3, {40, 30}, {0, 0}, 2), disc(8, {20, 0}, {-1, 0}, 2)};
  const auto plan = planner.plan(straight(60), 1.5, bodies, Time(), {});
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().body, 8);
  EXPECT_GT(plan.error().time_s, 6);
  EXPECT_LT(plan.error().time_s, 18);
}

}  // namespace
}  // namespace isobath::speed_plan
