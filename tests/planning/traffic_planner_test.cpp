// Plans through time among moving bodies, judged by dense samples of the motion, by a grid in space and time, and by
// motions drawn at random.
#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/planning/traffic/traffic_planner.hpp>
#include <limits>
#include <numbers>

namespace isobath::traffic_planner {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;
using testing::HasSubstr;

MovingBody disc(int number, const Vector2d& p, const Vector2d& velocity, double radius_m) {
  MovingBody body;
  body.number = number;
  body.p_W = p;
  body.velocity_W = velocity;
  body.radius_m = radius_m;
  return body;
}

/// Of the vehicle's disc along a motion to the shapes of the bodies, every 0.02 s.
double least_gap(const Trajectory& motion, const std::vector<MovingBody>& bodies, double radius_m, double until_s) {
  double least = std::numeric_limits<double>::infinity();
  for (double t = 0; t <= until_s; t += 0.02) {
    for (const MovingBody& body : bodies) least = std::min(least, distance_to(body, motion.at(t).p_W, t) - radius_m);
  }
  return least;
}

/// A vehicle that is stepped along its plans while the bodies keep their velocities.
struct Drive {
  TrafficPlanner planner;
  MotionState own;
  std::vector<MovingBody> bodies;
  Time now{};

  void move(double step_s) {
    const TrafficPlan& plan = planner.step(own, now, bodies);
    own = plan.trajectory.at(to_seconds(now - plan.start) + step_s);
    now += seconds(step_s);
    for (MovingBody& body : bodies) {
      body.p_W += step_s * body.velocity_W;
      body.time = now;
    }
  }
  [[nodiscard]] double gap() const {
    double least = std::numeric_limits<double>::infinity();
    for (const MovingBody& body : bodies) least = std::min(least, distance_to(body, own.p_W, 0) - 0.5);
    return least;
  }
};

Drive drive_to(const Vector2d& goal, double speed, std::vector<MovingBody> bodies, const TrafficVehicle& vehicle = {}) {
  Drive drive{TrafficPlanner({}, vehicle), {{0, 0}, 0, speed}, std::move(bodies)};
  drive.planner.set_goal(goal, 1);
  return drive;
}

// ledger: S3-01
TEST(TrafficPlanner, GoesStraightWhereThereIsNothing) {
  Drive drive = drive_to({60, 0}, 0, {});
  const TrafficPlan& plan = drive.planner.step(drive.own, drive.now, {});
  EXPECT_EQ(plan.action, TrafficAction::kFollow);
  EXPECT_NEAR(plan.arrival_s, 59 / 1.5 + 1.5 / (2 * 0.25), 1e-9) << "distance, and what it takes to accelerate";
  for (double t = 0; t < plan.free_s; t += 0.1) {
    EXPECT_NEAR(plan.trajectory.at(t).p_W.y(), 0, 1e-9);
    EXPECT_NEAR(plan.trajectory.at(t).speed, std::min(1.5, 0.25 * t), 1e-9);
  }
}

/// Earliest arrival on the straight line to (goal_m, 0) by a grid of places, speeds and times: all motions whose speed
/// changes by 0.25 m/s^2 or not in each half second. Transitions are checked at ten moments.
double arrival_on_grid(const MovingBody& body, double speed, double distance_m, double goal_m, double radius_m) {
  constexpr double kStep_s = 0.5, kSpeed = 0.125, kPlace_m = 0.03125;
  constexpr int kSpeeds = 13, kSteps = 80;
  const int places = static_cast<int>(goal_m / kPlace_m) + 1;
  std::vector<char> here(kSpeeds * places), next;
  here[static_cast<int>(speed / kSpeed) * places] = 1;
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kSteps; ++k) {
    next.assign(here.size(), 0);
    for (int v = 0; v < kSpeeds; ++v) {
      for (int s = 0; s < places; ++s) {
        if (here[v * places + s] == 0) continue;
        for (int w = std::max(0, v - 1); w <= std::min(kSpeeds - 1, v + 1); ++w) {
          const int to = s + v + w;  // (v + w) / 2 kSpeed kStep_s is so many places
          bool free = true;
          const bool near = std::abs(s * kPlace_m - body.p_W.x()) < 4;  // it crosses at a right angle
          for (int part = 0; near && part <= 10 && free; ++part) {
            const double t = 0.05 * part, mean = kSpeed * (v + (w - v) * t / kStep_s / 2);
            free = distance_to(body, {s * kPlace_m + mean * t, 0}, k * kStep_s + t) >= radius_m + distance_m;
          }
          if (!free) continue;
          if (to >= places) {
            best = std::min(best, (k + 1) * kStep_s - (to - places + 1) * kPlace_m / (kSpeed * std::max(w, 1)));
          } else {
            next[w * places + to] = 1;
          }
        }
      }
    }
    here.swap(next);
  }
  return best;
}

// The vehicle cannot leave its line: its turning radius is 1000 km. A crosser is let pass or passed before it,
// whichever arrives earlier, as on a fine grid of space and time. ledger: S3-18
TEST(TrafficPlanner, SlowsBehindACrosserOrHurriesAheadOfIt) {
  TrafficVehicle on_rails;
  on_rails.turning_radius_m = 1e6;
  int ahead = 0, behind = 0;
  for (const double from_m : {9.0, 12.0, 14.0, 16.0, 20.0}) {
    const std::vector<MovingBody> bodies = {disc(4, {20, -from_m}, {0, 0.8}, 2)};
    Drive drive = drive_to({35, 0}, 1, bodies, on_rails);
    const TrafficPlan& plan = drive.planner.step(drive.own, drive.now, bodies);
    const double grid_s = arrival_on_grid(bodies[0], 1, 0.25, 34, 0.5);
    ASSERT_EQ(plan.action, TrafficAction::kFollow) << from_m;
    EXPECT_GT(plan.arrival_s, grid_s - 0.1) << from_m;
    EXPECT_LT(plan.arrival_s, grid_s + 2) << from_m << ": the bound of the search, and its steps of a second";
    EXPECT_GE(least_gap(plan.trajectory, bodies, 0.5, plan.free_s), 0.25) << from_m;
    double crossing_s = 0;
    while (plan.trajectory.at(crossing_s).p_W.x() < 20 && crossing_s < 40) crossing_s += 0.05;
    (-from_m + 0.8 * crossing_s < 0 ? ahead : behind) += 1;
  }
  EXPECT_GE(ahead, 2);
  EXPECT_GE(behind, 2);
}

TEST(TrafficPlanner, NamesTheBodiesThatItPasses) {
  const std::vector<MovingBody> bodies = {disc(7, {20, -14}, {0, 1}, 2), disc(9, {-30, 40}, {0, 0}, 1)};
  Drive drive = drive_to({60, 0}, 1.5, bodies);
  const TrafficPlan& plan = drive.planner.step(drive.own, drive.now, bodies);
  const std::vector<Passage> passages = drive.planner.passages(drive.now, 5);
  ASSERT_EQ(passages.size(), 1u);
  EXPECT_EQ(passages[0].number, 7);
  EXPECT_NEAR(passages[0].gap_m, least_gap(plan.trajectory, {bodies[0]}, 0.5, plan.free_s), 0.02);
  EXPECT_GE(passages[0].gap_m, 0.25);
}

struct SmallScene {
  std::vector<MovingBody> bodies;
  Vector2d goal;
};

SmallScene small_scene(Random& random) {
  SmallScene scene{{}, {26, random.uniform(-6, 6)}};
  for (int i = 0; i < 6; ++i) {
    MovingBody body;
    do {
      const double speed = random.uniform(0, 1.2), course = random.uniform(0, 2 * pi);
      body = disc(i, {random.uniform(-4, 30), random.uniform(-14, 14)},
                  {speed * std::cos(course), speed * std::sin(course)}, random.uniform(0.5, 2.5));
    } while (body.p_W.norm() < 5 + body.radius_m);
    scene.bodies.push_back(body);
  }
  return scene;
}

/// Whether one of 60 motions of random arcs stays clear for 29 s, the last 9 of them braking and at rest.
bool some_motion_is_free(const SmallScene& scene, double distance_m, Random& random) {
  for (int trial = 0; trial < 60; ++trial) {
    MotionState at{{0, 0}, 0, 1.5};
    double curvature = 0, acceleration = 0;
    bool free = true;
    for (int k = 0; k < 290 && free; ++k) {
      if (k % 20 == 0) {
        curvature = 0.2 * (static_cast<double>(random.index(3)) - 1);
        acceleration = k >= 200 ? -0.25 : 0.25 * (static_cast<double>(random.index(3)) - 1);
      }
      at = MotionSegment{0, 0.1, at, curvature, at.speed >= 1.5 && acceleration > 0 ? 0 : acceleration}.after(0.1);
      for (const MovingBody& body : scene.bodies) free = free && distance_to(body, at.p_W, 0.1 * (k + 1)) > distance_m;
    }
    if (free) return true;
  }
  return false;
}

// Where a motion drawn at random keeps the margin, the planner finds one, and all that it then plans on the way to the
// goal keep it, too. ledger: S3-01 S3-21 S3-22 S3-E01
TEST(TrafficPlanner, KeepsTheMarginWhereSomeMotionDoes) {
  Random random(11);
  int solvable = 0, arrived = 0;
  for (int i = 0; i < 200; ++i) {
    const SmallScene scene = small_scene(random);
    if (!some_motion_is_free(scene, 0.5 + 0.25 + 0.06, random)) continue;
    ++solvable;
    Drive drive = drive_to(scene.goal, 1.5, scene.bodies);
    double least = drive.gap();
    bool there = false;
    for (int step = 0; step < 40 && !there; ++step) {
      drive.move(1);
      EXPECT_EQ(drive.planner.plan().reason, "") << i;
      least = std::min(least, drive.gap());
      there = (drive.own.p_W - scene.goal).norm() < 1.1;
    }
    EXPECT_GE(least, 0.25) << i;
    arrived += there;
  }
  EXPECT_GT(solvable, 150);
  EXPECT_GE(arrived, solvable - 2);
}

// Bodies drawn about the stated states meet the vehicle in less than exp(-k^2 / 2) of the draws, the share of a normal
// distribution in the plane beyond k sigma; without growth they do more often. ledger: S3-30
TEST(TrafficPlanner, MeetsUncertainBodiesMoreRarelyThanDesigned) {
  MovingBody body = disc(1, {25, -18}, {0, 1}, 2);
  body.position_covariance << 0.3, 0.05, 0.05, 0.2;
  body.velocity_covariance << 0.004, 0.001, 0.001, 0.003;
  const auto rate = [&](double sigmas) {
    TrafficConfig config;
    config.sigmas = sigmas;
    config.margin_m = 0;
    TrafficPlanner planner(config, {});
    planner.set_goal({60, 0}, 1);
    const TrafficPlan& plan = planner.step({{0, 0}, 0, 1.5}, Time(), std::span(&body, 1));
    EXPECT_EQ(plan.action, TrafficAction::kFollow);
    const Eigen::Matrix2d position = body.position_covariance.llt().matrixL();
    const Eigen::Matrix2d velocity = body.velocity_covariance.llt().matrixL();
    Random random(5);
    int met = 0;
    for (int i = 0; i < 1000; ++i) {
      MovingBody drawn = body;
      const double a = random.normal(), b = random.normal(), c = random.normal(), d = random.normal();
      drawn.p_W += position * Vector2d(a, b);
      drawn.velocity_W += velocity * Vector2d(c, d);
      bool contact = false;
      for (double t = 0; t < plan.free_s; t += 0.25) {
        contact = contact || distance_to(drawn, plan.trajectory.at(t).p_W, t) < 0.5;
      }
      met += contact;
    }
    return met / 1000.0;
  };
  EXPECT_LE(rate(2), std::exp(-2.0));
  EXPECT_LE(rate(3), std::exp(-4.5));
  EXPECT_GT(rate(0), 0.2);
}

/// Discs on a circle of 20 m about the vehicle that come in at 0.6 m/s, but for `open` places about a direction.
std::vector<MovingBody> closing_ring(int open, double direction) {
  std::vector<MovingBody> ring;
  for (int k = open; k < 24; ++k) {
    const double angle = (k - 0.5 * (open - 1)) * 2 * pi / 24 + direction;
    const Vector2d out(std::cos(angle), std::sin(angle));
    ring.push_back(disc(k, 20 * out, -0.6 * out, 3));
  }
  return ring;
}

// The gap is not where the goal is: half forward, or abeam. ledger: S3-37
TEST(TrafficPlanner, LeavesAClosingRingWhileAGapExists) {
  for (const double direction : {0.3 * pi, 0.5 * pi}) {
    Drive drive = drive_to({60, 0}, 1.5, closing_ring(4, direction));
    double least = drive.gap();
    for (int step = 0; step < 100 && drive.own.p_W.norm() < 30; ++step) {
      drive.move(0.5);
      least = std::min(least, drive.gap());
    }
    EXPECT_GE(drive.own.p_W.norm(), 30);
    EXPECT_GE(least, 0.25);
  }
}

// ledger: S3-37
TEST(TrafficPlanner, StopsAndReportsInARingWithoutAGap) {
  Drive drive = drive_to({60, 0}, 1.5, closing_ring(0, 0));
  int step = 0;
  while (step < 100 && drive.planner.plan().reason.find("no motion") == std::string::npos) {
    drive.move(0.5);
    if (drive.planner.plan().reason.empty()) {
      EXPECT_GE(drive.gap(), 0);
    }
    ++step;
  }
  EXPECT_EQ(drive.planner.plan().action, TrafficAction::kStop);
  EXPECT_THAT(drive.planner.plan().reason, HasSubstr("comes nearest to body"));
  for (int more = 0; more < 6; ++more) drive.move(0.5);
  EXPECT_LT(drive.own.speed, 0.3);
}

// A circle about two hulls that lie along the path closes the way between them; their outlines leave it open.
// ledger: S3-11
TEST(TrafficPlanner, GoesBetweenHullsThatCirclesWouldClose) {
  std::vector<MovingBody> hulls = {disc(1, {30, -2.5}, {0, 0}, 0), disc(2, {30, 2.5}, {0, 0}, 0)};
  for (MovingBody& hull : hulls) hull.outline = {{-10, -0.8}, {10, -0.8}, {10, 0.8}, {-10, 0.8}};
  Drive drive = drive_to({60, 0}, 1.5, hulls);
  EXPECT_NEAR(drive.planner.step(drive.own, drive.now, hulls).arrival_s, 59 / 1.5, 1e-6);
}

// A bar of 16 m that sweeps across the path. ledger: S3-12 S3-D04
TEST(TrafficPlanner, PassesARotatingBarInTime) {
  MovingBody bar = disc(1, {18, 0}, {0, 0}, 0.1);
  bar.outline = {{-8, -0.4}, {8, -0.4}, {8, 0.4}, {-8, 0.4}};
  for (const double rate : {-0.25, -0.1, 0.1, 0.25}) {
    bar.turn_rate = rate;
    Drive drive = drive_to({40, 0}, 1.5, {bar});
    const TrafficPlan& plan = drive.planner.step(drive.own, drive.now, drive.bodies);
    EXPECT_EQ(plan.action, TrafficAction::kFollow);
    EXPECT_GE(least_gap(plan.trajectory, {bar}, 0.5, plan.trajectory.duration_s()), 0.25) << rate;
    EXPECT_LT(plan.arrival_s, 39 / 1.5 + 6) << rate;
  }
}

TEST(TrafficPlanner, EndsOnACircleWhereTheVehicleCannotStop) {
  TrafficVehicle torpedo;
  torpedo.min_speed = 0.8;
  const std::vector<MovingBody> bodies = {disc(1, {20, -10}, {0, 0.8}, 2), disc(2, {30, 12}, {0, -0.8}, 2)};
  Drive drive = drive_to({80, 0}, 1.5, bodies, torpedo);
  const TrafficPlan& plan = drive.planner.step(drive.own, drive.now, bodies);
  for (double t = 0; t < plan.trajectory.duration_s(); t += 0.1) EXPECT_GE(plan.trajectory.at(t).speed, 0.8 - 1e-9);
  EXPECT_NEAR(std::abs(plan.trajectory.segments.back().curvature), torpedo.max_curvature(), 1e-12);
  EXPECT_NEAR(plan.trajectory.at(1e3).speed, 0.8, 1e-9);
  EXPECT_GE(least_gap(plan.trajectory, bodies, 0.5, plan.trajectory.duration_s()), 0.25);
}

// A plan stays the same until a body turns across it; then there is a new one in the same step. ledger: S3-20 S3-21
TEST(TrafficPlanner, KeepsItsPlanUntilABodyCrossesIt) {
  Drive drive = drive_to({60, 0}, 1.5, {disc(1, {25, -8}, {1, 0}, 2)});
  for (int step = 0; step < 30; ++step) drive.move(0.1);
  EXPECT_EQ(drive.planner.plan().number, 1);
  drive.bodies[0].velocity_W = {-0.5, 0.7};
  drive.move(0.1);
  EXPECT_EQ(drive.planner.plan().number, 2);
  EXPECT_EQ(drive.planner.plan().start, drive.now - seconds(0.1));
}

// No motion keeps the margin of the new settings: the plan of before is better than none, and than one without a
// margin. A plan for a faster vehicle is of no use. ledger: S3-03 S3-20
TEST(TrafficPlanner, GoesOnWithAFreePlanWhenItsSettingsChange) {
  const std::vector<MovingBody> bodies = {disc(1, {25, -8}, {0, 0.7}, 2), disc(2, {20, 9}, {0, -0.3}, 2)};
  Drive drive = drive_to({60, 0}, 1.5, bodies);
  drive.move(0.1);
  TrafficConfig wide;
  wide.margin_m = 80;
  TrafficPlanner wider(wide, {});
  wider.continue_from(drive.planner);
  drive.planner = std::move(wider);
  drive.move(0.1);
  EXPECT_EQ(drive.planner.plan().number, 1);
  EXPECT_EQ(drive.planner.plan().reason, "");
  EXPECT_EQ(drive.planner.plan().margin_m, 0.25);
  TrafficVehicle slow;
  slow.max_speed = 0.75;
  TrafficPlanner slower({}, slow);
  slower.continue_from(drive.planner);
  drive.planner = std::move(slower);
  drive.move(0.1);
  EXPECT_EQ(drive.planner.plan().number, 2);
  EXPECT_LE(drive.planner.plan().trajectory.at(20).speed, 0.75 + 1e-9);
}

TEST(TrafficPlanner, LeavesOutWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<MovingBody> bodies = {disc(1, {nan, 0}, {0, 0}, 1), disc(2, {10, 0}, {INFINITY, 0}, 1),
                                    disc(3, {10, 9}, {0, 0}, -1)};
  Drive drive = drive_to({60, 0}, 1.5, bodies);
  EXPECT_EQ(drive.planner.step(drive.own, drive.now, bodies).action, TrafficAction::kFollow);
  EXPECT_EQ(drive.planner.work().refused_bodies, 3);
  drive.own.heading = nan;
  const TrafficPlan& plan = drive.planner.step(drive.own, drive.now, bodies);
  EXPECT_EQ(plan.action, TrafficAction::kRefuse);
  EXPECT_THAT(plan.reason, HasSubstr("not finite"));
  TrafficVehicle still;
  still.min_speed = 1.5;
  EXPECT_THROW(TrafficPlanner({}, still), Error);
}

// Work is counted and bounded, whatever the bodies. ledger: S3-31
TEST(TrafficPlanner, BoundsItsWorkWithAThousandBodies) {
  Random random(8);
  std::vector<MovingBody> bodies;
  for (int i = 0; i < 1000; ++i) {
    const double angle = random.uniform(0, 2 * pi), far = random.uniform(6, 50), speed = random.uniform(0, 1.5);
    bodies.push_back(disc(i, {far * std::cos(angle), far * std::sin(angle)},
                          {speed * std::cos(3 * angle), speed * std::sin(3 * angle)}, 1));
  }
  TrafficConfig config;
  Drive drive = drive_to({140, 0}, 1.5, bodies);
  drive.move(0.1);
  const TrafficWork& work = drive.planner.work();
  EXPECT_LE(work.searches, 3);
  EXPECT_LE(work.expansions, 3 * config.search.max_expansions);
  EXPECT_GT(work.checks, 0);
}

}  // namespace
}  // namespace isobath::traffic_planner
