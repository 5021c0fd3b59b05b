// Ways that a vehicle with a turning radius can follow: each is driven along its arcs and straights, and samples of
// that track are judged.
#include <gtest/gtest.h>
#include <isobath/planning/route_planner.hpp>
#include <isobath/planning/turning.hpp>
#include <tests/planning/random_hazards.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;
using test::random_hazards;
using Way = std::vector<Vector2d>;

constexpr double kStep = 0.05;

struct Driven {
  bool possible = true;
  Way track;
};

/// Goes along a way with circles of this radius at its corners: each step ahead by kStep, turning at 1 / radius while
/// on an arc. Written from the vehicle's side: it knows no tangent points but by half angles.
Driven drive(const Way& way, double radius) {
  Driven driven;
  double used = 0;
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const Vector2d leg = way[i + 1] - way[i], ahead = leg.normalized();
    double turn = 0;
    Vector2d next = ahead;
    if (i + 2 < way.size()) {
      next = (way[i + 2] - way[i + 1]).normalized();
      turn = std::acos(std::clamp(ahead.dot(next), -1.0, 1.0)) * (cross(ahead, next) > 0 ? 1 : -1);
    }
    const double tangent = radius * std::tan(std::abs(turn) / 2);
    if (used + tangent > leg.norm() + 1e-6) driven.possible = false;
    for (double s = used; s < leg.norm() - tangent; s += kStep) driven.track.emplace_back(way[i] + s * ahead);
    Vector2d p = way[i + 1] - tangent * ahead;
    const int pieces = 1 + static_cast<int>(std::abs(turn) * radius / kStep);
    double heading = std::atan2(ahead.y(), ahead.x());
    for (int k = 0; k < pieces && turn != 0; ++k) {
      driven.track.push_back(p);
      const double chord = 2 * radius * std::sin(std::abs(turn) / pieces / 2);
      heading += turn / pieces / 2;
      p += chord * Vector2d(std::cos(heading), std::sin(heading));
      heading += turn / pieces / 2;
    }
    if (turn != 0 && (p - way[i + 1] - tangent * next).norm() > 1e-6) driven.possible = false;
    used = tangent;
  }
  driven.track.push_back(way.back());
  return driven;
}

double min_of(const std::vector<Hazard>& hazards, const Way& track) {
  double least = INFINITY;
  for (const Vector2d& p : track) least = std::min(least, test::plain_distance(hazards, p));
  return least;
}

double start_off(const Way& way, double heading) {
  const Vector2d leg = way[1] - way[0];
  return std::abs(std::remainder(std::atan2(leg.y(), leg.x()) - heading, 2 * pi));
}

// ledger: S6-52
TEST(Turning, CornersNeedTheirRoom) {
  EXPECT_NEAR(tangent_length({0, 0}, {10, 0}, {10, 10}, 4), 4, 1e-12);
  EXPECT_EQ(tangent_length({0, 0}, {10, 0}, {20, 0}, 4), 0);
  EXPECT_EQ(tangent_length({0, 0}, {10, 0}, {0, 0}, 4), INFINITY);
  EXPECT_TRUE(corners_fit(Way{{0, 0}, {4, 0}, {4, 4}}, 4)) << "the ends need no room";
  EXPECT_FALSE(corners_fit(Way{{0, 0}, {3.9, 0}, {3.9, 10}}, 4));
  EXPECT_TRUE(corners_fit(Way{{0, 0}, {10, 0}, {10, 8}, {20, 8}}, 4));
  EXPECT_FALSE(corners_fit(Way{{0, 0}, {10, 0}, {10, 7.9}, {20, 7.9}}, 4)) << "two arcs on one leg";
}

// ledger: S6-52
TEST(Turning, ArcsTouchBothLegs) {
  const Way arc = rounded_corner({0, 0}, {10, 0}, {10, 10}, 4, 0.01);
  EXPECT_LT((arc.front() - Vector2d(6, 0)).norm(), 1e-12);
  EXPECT_LT((arc.back() - Vector2d(10, 4)).norm(), 1e-12);
  for (std::size_t i = 0; i < arc.size(); ++i) {
    EXPECT_NEAR((arc[i] - Vector2d(6, 4)).norm(), 4, 1e-12);
    if (i > 0) {
      EXPECT_GE(((arc[i] + arc[i - 1]) / 2 - Vector2d(6, 4)).norm(), 4 - 0.01);
    }
  }
}

// Towards places all around: the way starts ahead, its corners are the circle's, and it ends at the place.
// ledger: S6-52
TEST(Turning, FromAHeadingToAPlace) {
  constexpr double kRadius = 8;
  int found = 0;
  for (double heading = -3; heading < 3.2; heading += 0.7) {
    for (double bearing = 0; bearing < 6.3; bearing += 0.2) {
      for (const double away : {5.0, 17.0, 60.0}) {
        const Vector2d start(3, -4), target = start + away * Vector2d(std::cos(bearing), std::sin(bearing));
        for (const int side : {1, -1}) {
          const Vector2d centre = start + side * kRadius * Vector2d(-std::sin(heading), std::cos(heading));
          const auto corners = turn_towards(start, heading, kRadius, side, target, 0.05);
          if (!corners) {
            ASSERT_LT((target - centre).norm(), kRadius);
            continue;
          }
          ++found;
          Way way = {start};
          way.insert(way.end(), corners->begin(), corners->end());
          way.push_back(target);
          const Driven driven = drive(way, kRadius);
          ASSERT_TRUE(driven.possible);
          ASSERT_LE(kRadius * (1 - std::cos(start_off(way, heading))), 0.05 + 1e-9);
          if (corners->empty()) continue;
          ASSERT_LT(start_off(way, heading), 1e-9);
          // All of the turn is on the circle: no point of the track lies within it.
          for (const Vector2d& p : driven.track) ASSERT_GE((p - centre).norm(), kRadius - 1e-6);
        }
      }
    }
  }
  EXPECT_GT(found, 1000);
}

RouteTask turning_task(const Vector2d& start, double heading, const Vector2d& goal, double radius) {
  RouteTask task;
  task.start = start;
  task.heading = heading;
  task.goal = goal;
  task.turning_radius_m = radius;
  return task;
}

// ledger: S6-52
TEST(Turning, AVehicleThatHeadsAwayTurnsFirst) {
  const HazardMap map({});
  const auto path = plan_route(map, turning_task({0, 0}, pi, {100, 0}, 8), {});
  ASSERT_TRUE(path);
  EXPECT_LT(start_off(path->points, pi), 1e-9);
  EXPECT_TRUE(drive(path->points, 8).possible);
  EXPECT_LT(path->length_m, 100 + 8 * pi + 5);
  // With a wall close to one side it turns to the other.
  for (const double y : {10.0, -10.0}) {
    const HazardMap wall({{{{-50, y}, {50, y}}, 0, HazardKind::kCharted, 0}});
    const auto away = plan_route(wall, turning_task({0, 0}, pi, {60, 0}, 8), {});
    ASSERT_TRUE(away);
    double farthest = 0;
    for (const Vector2d& p : away->points) farthest = std::max(farthest, -p.y() * y / 10);
    EXPECT_GT(farthest, 14);
    EXPECT_FALSE(wall.conflict(away->points, 3.5));
  }
}

// A way that a lean at the start begins as well does not go round a circle first (11 of these 400 did).
// ledger: S6-52
TEST(Turning, DoesNotCircleWhereALeanWillDo) {
  ISOBATH_NOT_SANITIZED();
  Random random(11);
  int ways = 0, circles = 0;
  for (int i = 0; i < 400; ++i) {
    const HazardMap map(random_hazards(random, 12, 40, 4));
    const double radius = random.uniform(5, 8);
    RouteTask task = turning_task({-50, 0}, random.uniform(-0.4, 0.4), {50, random.uniform(-20, 20)}, radius);
    const auto path = plan_route(map, task, {});
    task.turning_radius_m = 0;
    const auto of_a_point = plan_route(map, task, {});
    if (!path || !of_a_point) continue;
    ++ways;
    circles += path->length_m > of_a_point->length_m + pi * radius;
  }
  EXPECT_GT(ways, 300);
  EXPECT_LE(circles, 1);
}

// Random maps and headings: the track that is driven keeps the clearance but for the 0.05 m that arcs may take, and
// the way as it stands keeps it wholly.
// ledger: S6-52
TEST(Turning, WhatComesOutCanBeDriven) {
  ISOBATH_NOT_SANITIZED();
  Random random(11);
  int ways = 0, cannot = 0, corners = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const int count = 3 + static_cast<int>(random.index(15));
    const HazardMap map(random_hazards(random, count, 40, 4));
    const double heading = random.uniform(-pi, pi);
    const double radius = random.uniform(2, 10);
    const double y = random.uniform(-20, 20);
    const RouteTask task = turning_task({-50, 0}, heading, {50, y}, radius);
    const auto path = plan_route(map, task, {});
    if (!path) {
      cannot += path.error() == RouteRefusal::kCannotTurn;
      continue;
    }
    if (path->escape_m > 0) continue;
    ++ways;
    corners += static_cast<int>(path->points.size()) - 2;
    ASSERT_LE(radius * (1 - std::cos(start_off(path->points, heading))), 0.05 + 1e-9);
    const Driven driven = drive(path->points, radius);
    ASSERT_TRUE(driven.possible);
    const std::vector<Hazard> all(map.hazards().begin(), map.hazards().end());
    ASSERT_GE(min_of(all, driven.track), 3.5 - 0.05 - 1e-9);
    ASSERT_FALSE(map.conflict(path->points, 3.5));
  }
  EXPECT_GT(ways, 240);
  EXPECT_GT(corners, ways);
  EXPECT_LT(cannot, 10);
}

// Starts amid hazards, a large circle, no heading: what a way for a point cannot do, one of arcs can. Each is driven.
// ledger: S6-52
TEST(Turning, WaysOfArcsWhereCornersAreTooSharp) {
  ISOBATH_NOT_SANITIZED();
  Random random(11);
  int ways = 0, cannot = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const HazardMap map(random_hazards(random, 60, 40, 3));
    RouteTask task = turning_task({0, 0}, random.uniform(-pi, pi), {50, random.uniform(-20, 20)}, 8);
    task.heading.reset();
    const auto path = plan_route(map, task, {});
    if (!path) {
      cannot += path.error() == RouteRefusal::kCannotTurn;
      continue;
    }
    ++ways;
    const Driven driven = drive(path->points, 8);
    ASSERT_TRUE(driven.possible);
    if (path->escape_m > 0) continue;
    const std::vector<Hazard> all(map.hazards().begin(), map.hazards().end());
    ASSERT_GE(min_of(all, driven.track), 3.5 - 0.05 - 1e-9);
  }
  EXPECT_GT(ways, 45);
  EXPECT_LE(cannot, 2);
}

// In a lane narrower than the turning circle it goes on to the open end, and turns round there.
// ledger: S6-52
TEST(Turning, GoesOnUntilThereIsRoomToTurn) {
  const auto wall = [](Vector2d a, Vector2d b) { return Hazard{{a, b}, 0, HazardKind::kCharted, 0}; };
  const HazardMap lane({wall({-60, 6}, {20, 6}), wall({-60, -6}, {20, -6})});
  const auto path = plan_route(lane, turning_task({0, 0}, 0, {-80, 0}, 8), {});
  ASSERT_TRUE(path);
  EXPECT_LT(start_off(path->points, 0), 0.2);
  EXPECT_TRUE(drive(path->points, 8).possible);
  EXPECT_FALSE(lane.conflict(path->points, 3.5));
  EXPECT_GT(path->length_m, 100);
}

// In a blind alley narrower than the turning circle a vehicle that heads inwards cannot turn round, and that is said.
// ledger: S6-52
TEST(Turning, SaysWhenItCannotTurn) {
  const auto wall = [](Vector2d a, Vector2d b) { return Hazard{{a, b}, 0, HazardKind::kCharted, 0}; };
  const HazardMap alley({wall({-40, 8}, {30, 8}), wall({-40, -8}, {30, -8}), wall({30, -8}, {30, 8})});
  EXPECT_EQ(plan_route(alley, turning_task({0, 0}, 0, {-80, 0}, 8), {}).error(), RouteRefusal::kCannotTurn);
  EXPECT_TRUE(plan_route(alley, turning_task({0, 0}, pi, {-80, 0}, 8), {}));
  EXPECT_TRUE(plan_route(alley, turning_task({0, 0}, 0, {-80, 0}, 0), {})) << "one that turns on the spot";
}

}  // namespace
}  // namespace isobath
