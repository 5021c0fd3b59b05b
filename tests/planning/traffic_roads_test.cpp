// Plans past still structures among moving bodies: by the road map, and by the search that it guides.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/planning/traffic/traffic_planner.hpp>
#include <numbers>

namespace isobath::traffic_roads {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;
using testing::HasSubstr;
using testing::IsEmpty;

MovingBody structure(int number, const Polygon& outline_W) {
  MovingBody body;
  body.number = number;
  body.outline = outline_W;
  return body;
}

MovingBody disc(int number, const Vector2d& p, const Vector2d& velocity, double radius_m) {
  MovingBody body;
  body.number = number;
  body.p_W = p;
  body.velocity_W = velocity;
  body.radius_m = radius_m;
  return body;
}

/// A quay of 30 m by 26 m about the straight way, open towards the vehicle: deeper than 20 s of way.
MovingBody quay() {
  return structure(100, {{40, -13}, {74, -13}, {74, 13}, {40, 13}, {40, 12}, {73, 12}, {73, -12}, {40, -12}});
}

/// A vehicle that follows its plans while the bodies keep their velocities.
struct Drive {
  TrafficPlanner planner;
  Vector2d goal;
  MotionState own;
  std::vector<MovingBody> bodies;
  Time now{};
  double least_m = INFINITY, length_m = 0;

  /// Whether it reaches the goal.
  bool run(double limit_s) {
    for (double t = 0; t < limit_s; t += 0.1) {
      move();
      if ((own.p_W - goal).norm() <= 2) return true;
    }
    return false;
  }
  void move() {
    const TrafficPlan& plan = planner.step(own, now, bodies);
    const Vector2d from = own.p_W;
    own = plan.trajectory.at(to_seconds(now - plan.start) + 0.1);
    length_m += (own.p_W - from).norm();
    now += seconds(0.1);
    for (MovingBody& body : bodies) {
      body.p_W += 0.1 * body.velocity_W;
      body.time = now;
      least_m = std::min(least_m, distance_to(body, own.p_W, 0) - 0.5);
    }
  }
};

Drive drive_to(const Vector2d& goal, std::vector<MovingBody> bodies, bool roads = true) {
  TrafficConfig config;
  config.roads = roads;
  if (!roads) config.search.max_expansions = 500;  // it is stuck soon, and its tries cost time
  Drive drive{TrafficPlanner(config, {}), goal, {{0, 0}, 0, 1.5}, std::move(bodies)};
  drive.planner.set_goal(goal, 2);
  return drive;
}

// The search alone runs into the quay, which is deeper than its horizon, and stays there. ledger: S3-13 S3-22 S3-26
TEST(TrafficRoads, LeadsRoundAQuayThatTrapsTheSearch) {
  Drive with = drive_to({110, 0}, {quay()}), without = drive_to({110, 0}, {quay()}, false);
  EXPECT_TRUE(with.run(120));
  EXPECT_GE(with.least_m, 0.25);
  EXPECT_LT(with.length_m, 1.05 * (std::hypot(40, 13.5) + 34 + std::hypot(36, 13.5) - 2)) << "round one of its sides";
  EXPECT_EQ(with.planner.road_work().detail, ShapeDetail::kEnclosure) << "the coarse shape is enough";
  EXPECT_FALSE(without.run(100));
  EXPECT_GT(without.own.p_W.x(), 40) << "in the quay";
  EXPECT_GE(without.least_m, 0.2);
}

// A search that is made while bodies block the path of the road map is guided by it. ledger: S3-22 S3-26
TEST(TrafficRoads, GuidesTheSearchAroundTheQuayAmongMovingBodies) {
  std::vector<MovingBody> bodies = {quay()};
  for (int i = 0; i < 6; ++i) bodies.push_back(disc(i, {44.0 + 10 * i, i % 2 == 0 ? 22 : -22}, {-0.7, 0}, 3));
  Drive drive = drive_to({110, 0}, bodies);
  EXPECT_TRUE(drive.run(140));
  EXPECT_GE(drive.least_m, 0.2);
}

// The goal lies in a basin whose coarse shapes cover it. ledger: S3-13 S3-D03
TEST(TrafficRoads, RefinesAShapeThatCoversTheGoal) {
  Drive drive = drive_to({62, 0}, {quay()});
  drive.own.p_W = {110, 0};
  drive.own.heading = pi;
  EXPECT_TRUE(drive.run(160));
  EXPECT_EQ(drive.planner.road_work().detail, ShapeDetail::kParts);
  EXPECT_GE(drive.least_m, 0.25);
}

// ledger: S3-37
TEST(TrafficRoads, SaysWhyNoPathLeadsToTheGoal) {
  std::vector<MovingBody> walls = {structure(1, {{40, -20}, {80, -20}, {80, -19}, {40, -19}}),
                                   structure(2, {{40, 19}, {80, 19}, {80, 20}, {40, 20}}),
                                   structure(3, {{40, -20}, {41, -20}, {41, 20}, {40, 20}}),
                                   structure(4, {{79, -20}, {80, -20}, {80, 20}, {79, 20}})};
  Drive closed = drive_to({60, 0}, walls);
  EXPECT_FALSE(closed.run(20));
  EXPECT_EQ(closed.planner.plan().action, TrafficAction::kStop);
  EXPECT_THAT(closed.planner.plan().reason, HasSubstr("no path leads to the goal: no path keeps the clearance"));
  EXPECT_EQ(closed.own.speed, 0);
  EXPECT_LT(closed.own.p_W.x(), 6) << "with room to turn";
  walls.pop_back();
  closed.bodies = walls;  // one of them has gone
  EXPECT_TRUE(closed.run(200));
  EXPECT_THAT(closed.planner.plan().road_reason, IsEmpty());
  EXPECT_GE(closed.least_m, 0.25);
}

// Two walls 3 m apart, whose gaps near the straight way are offset by 10 m: no vehicle with a turning radius of 5 m
// bends through them. A gap of 2.2 m through both, far aside, is the next candidate. ledger: S3-24 S3-D06
TEST(TrafficRoads, TakesAWiderPathWhereTheShortestDoesNotBend) {
  const auto wall = [](int number, double x, double from, double to) {
    return structure(number, {{x, from}, {x + 1, from}, {x + 1, to}, {x, to}});
  };
  Drive drive = drive_to({90, 0}, {wall(1, 40, -60, -1.5), wall(2, 40, 1.5, 36), wall(3, 40, 38.2, 60),
                                   wall(4, 44, -60, 8), wall(5, 44, 11, 36), wall(6, 44, 38.2, 60)});
  for (int step = 0; step < 1500 && (drive.own.p_W - drive.goal).norm() > 2; ++step) {
    const MotionState before = drive.own;
    drive.move();
    EXPECT_TRUE(drive.planner.plan().on_road) << step;
    EXPECT_LE(std::abs(std::remainder(drive.own.heading - before.heading, 2 * pi)), 0.2 * 1.5 * 0.1 + 1e-9);
    if (before.p_W.x() < 42 && drive.own.p_W.x() >= 42) {
      EXPECT_NEAR(drive.own.p_W.y(), 37.1, 1.1);
    }
  }
  EXPECT_LE((drive.own.p_W - drive.goal).norm(), 2);
  EXPECT_GT(drive.planner.road_work().refused_paths, 0);
  EXPECT_GE(drive.least_m, 0.25);
}

// No path bends as it must: the failure and its place are reported. ledger: S3-24
TEST(TrafficRoads, ReportsWhereNoPathBends) {
  // A lane of 3 m, at the end of which a gap leads back beside it.
  const std::vector<MovingBody> walls = {structure(1, {{-5, -2.5}, {60, -2.5}, {60, -1.5}, {-5, -1.5}}),
                                         structure(2, {{-5, 1.5}, {50, 1.5}, {50, 2}, {-5, 2}}),
                                         structure(3, {{53, -2.5}, {54, -2.5}, {54, 6}, {53, 6}}),
                                         structure(4, {{-5, 5}, {53, 5}, {53, 6}, {-5, 6}})};
  Drive drive = drive_to({0, 3.5}, walls);
  drive.own.speed = 0;
  drive.move();
  EXPECT_GT(drive.planner.road_work().refused_paths, 0);
  EXPECT_FALSE(drive.planner.plan().on_road);
  EXPECT_THAT(drive.planner.plan().road_reason, HasSubstr("turning radius of the vehicle needs"));
  for (int step = 0; step < 300; ++step) {
    const MotionState before = drive.own;
    drive.move();
    EXPECT_LE(std::abs(std::remainder(drive.own.heading - before.heading, 2 * pi)), 0.2 * 1.5 * 0.1 + 1e-9);
  }
  EXPECT_GE(drive.least_m, 0.2);
}

// Bodies that cross the path after the vehicle has passed, or before, leave the plan as it is; one that would meet it
// gives one new plan, along the same path with other speeds. ledger: S3-19 S3-20 S3-D05
TEST(TrafficRoads, MendsThePlanOnceWhenABodyTurnsAcrossThePath) {
  const MovingBody wall = structure(1, {{20, 3}, {60, 3}, {60, 4}, {20, 4}});
  const MovingBody other = structure(2, {{20, -4}, {60, -4}, {60, -3}, {20, -3}});
  // Between the walls there is no room to go round a body.
  Drive drive = drive_to({80, 0}, {wall, other, disc(7, {67, -24}, {0, 0}, 2), disc(8, {25, -30}, {0, 0.1}, 1)});
  while (drive.own.p_W.x() < 40) drive.move();
  const int before = drive.planner.plan().number;
  EXPECT_TRUE(drive.planner.plan().on_road);
  drive.bodies[2].velocity_W = {0, 1.1};  // it reaches the path when the vehicle does
  drive.move();
  EXPECT_EQ(drive.planner.plan().number, before + 1);
  EXPECT_TRUE(drive.planner.plan().mends);
  for (int step = 0; step < 40; ++step) drive.move();
  EXPECT_LE(drive.planner.plan().number, before + 2) << "then it stays free";
  EXPECT_TRUE(drive.run(60));
  EXPECT_GE(drive.least_m, 0.25);
  EXPECT_LT(drive.length_m, 79) << "only the speed has changed";
}

}  // namespace
}  // namespace isobath::traffic_roads
