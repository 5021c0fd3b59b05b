// Ways past hazards: what they keep, what they cost, when there is none; judged by samples and plain searches.
#include <gtest/gtest.h>
#include <isobath/planning/plan_frame.hpp>
#include <isobath/planning/route_planner.hpp>
#include <tests/planning/random_hazards.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath::route_planner_test {
namespace {

using Eigen::Vector2d;
using test::random_hazards;
using test::sampled_clearance;
using Way = std::vector<Vector2d>;

Hazard hazard(Polygon outline, double margin = 0) { return {std::move(outline), margin, HazardKind::kSeen, 0}; }
Polygon box(double x, double y, double half_x, double half_y) {
  return {{x - half_x, y - half_y}, {x + half_x, y - half_y}, {x + half_x, y + half_y}, {x - half_x, y + half_y}};
}
RouteTask from_to(const Vector2d& start, const Vector2d& goal) {
  RouteTask task;
  task.start = start;
  task.goal = goal;
  return task;
}
std::vector<Hazard> list_of(const HazardMap& map) { return {map.hazards().begin(), map.hazards().end()}; }

/// A ring of segments round a centre.
std::vector<Hazard> ring(const Vector2d& centre, double radius) {
  std::vector<Hazard> walls;
  for (int i = 0; i < 24; ++i) {
    const double a = i * std::numbers::pi / 12, b = (i + 1) * std::numbers::pi / 12;
    walls.push_back(hazard(
        {centre + radius * Vector2d(std::cos(a), std::sin(a)), centre + radius * Vector2d(std::cos(b), std::sin(b))}));
  }
  return walls;
}

TEST(RoutePlanner, StraightWhereNothingIsInTheWay) {
  const HazardMap map({hazard(box(50, 40, 2, 2))});
  const auto path = plan_route(map, from_to({0, 0}, {100, 0}), {});
  ASSERT_TRUE(path);
  EXPECT_EQ(path->points, (Way{{0, 0}, {100, 0}}));
  EXPECT_DOUBLE_EQ(path->length_m, 100);
  EXPECT_NEAR(path->clearance_m, 38, 1e-12);
  EXPECT_EQ(path->escape_m, 0);
  EXPECT_EQ(plan_route(HazardMap({}), from_to({0, 0}, {100, 0}), {})->clearance_m, INFINITY);
}

/// The integral of 1 + the extra cost of an area along a path.
double cost_of(const Way& way, const CostlyArea& area) {
  double cost = 0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Vector2d leg = way[i] - way[i - 1];
    const int pieces = std::max(1, static_cast<int>(leg.norm() / 0.1));
    for (int k = 0; k < pieces; ++k) {
      const double away = (way[i - 1] + (k + 0.5) / pieces * leg - area.centre).norm();
      cost += leg.norm() / pieces * (1 + area.extra * std::max(0.0, 1 - away / area.radius_m));
    }
  }
  return cost;
}

// The dearer an area, the farther off its centre the path leads; never dearer than straight through, and no dearer than
// the best of many paths round it. ledger: S2-14 S2-22 S2-23
TEST(RoutePlanner, LeadsFartherRoundAnAreaTheDearerItIs) {
  const HazardMap map({hazard(box(100, -60, 2, 2))});
  for (const double radius : {0.0, 5.7}) {
    double nearest_before = -1;
    for (const double extra : {0.2, 1.0, 3.0, 10.0}) {
      RouteTask task = from_to({0, 0}, {200, 0});
      task.turning_radius_m = radius;
      if (radius > 0) task.heading = 0;
      task.costly = {{{100, 10}, 40, extra}};
      const auto path = plan_route(map, task, {});
      ASSERT_TRUE(path);
      const double cost = cost_of(path->points, task.costly[0]);
      double best = cost_of({task.start, task.goal}, task.costly[0]);
      EXPECT_LE(cost, best + 1e-6);
      for (double along = 30; along <= 100; along += 5) {
        for (double off = -60; off <= 0; off += 1) {
          best =
              std::min(best, cost_of({task.start, {100 - along, off}, {100 + along, off}, task.goal}, task.costly[0]));
        }
      }
      EXPECT_LT(cost, 1.02 * best) << extra;
      const double nearest = sampled_clearance({hazard(box(100, 10, 0.01, 0.01))}, path->points, 0.1);
      EXPECT_GE(nearest, nearest_before - 0.5);
      nearest_before = nearest;
    }
    EXPECT_GT(nearest_before, 30) << radius;
  }
}

// A wall whose nearer end is 12 m off the line: with 20 m of deviation there is a path, with 10 m there is none, and it
// does not lead round the other end. ledger: S2-15
TEST(RoutePlanner, StaysWithinItsCorridorOrSaysThatThereIsNoPath) {
  const HazardMap map({hazard(box(50, 24, 1, 36))});
  RouteTask task = from_to({0, 0}, {100, 0});
  task.corridor = {{0, 0}, {100, 0}, 20};
  const auto path = plan_route(map, task, {});
  ASSERT_TRUE(path);
  for (const Vector2d& p : path->points) EXPECT_LE(std::abs(p.y()), 20 + 1e-6);
  EXPECT_FALSE(map.conflict(path->points, 0.5 + 3));
  task.corridor->width_m = 10;
  EXPECT_EQ(plan_route(map, task, {}).error(), RouteRefusal::kNoPath);
  task.corridor.reset();
  EXPECT_TRUE(plan_route(map, task, {}));
}

// ledger: S6-48 S6-52
TEST(RoutePlanner, RoundAnObstacleAtTheWishedClearance) {
  const HazardMap map({hazard(box(50, 1, 2, 10))});
  const RouteConfig config;
  const auto path = plan_route(map, from_to({0, 0}, {100, 0}), config);
  ASSERT_TRUE(path);
  EXPECT_FALSE(map.conflict(path->points, 0.5 + config.clearance_m));
  EXPECT_LT(path->points[1].y(), 0) << "past the nearer end";
  EXPECT_GT(path->clearance_m, 5) << "there is room: it stands off";
  EXPECT_LT(path->length_m, 105);
  RouteConfig shortest;
  shortest.room_weight = 0;
  const auto hugging = plan_route(map, from_to({0, 0}, {100, 0}), shortest);
  ASSERT_TRUE(hugging);
  EXPECT_LT(hugging->clearance_m, 4.5);
  EXPECT_LE(hugging->length_m, path->length_m + 1e-9);
}

// 1000 random maps: what comes out keeps the clearance everywhere, by samples every 10 cm; smoothing never makes a way
// dearer; the same request gives the same way.
// ledger: S2-44 S6-48 S6-52
TEST(RoutePlanner, KeepsTheClearanceOnRandomMaps) {
  ISOBATH_NOT_SANITIZED();
  Random random(1);
  int ways = 0, straight = 0, none = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const int count = 5 + static_cast<int>(random.index(30));
    const HazardMap map(random_hazards(random, count, 30, 5));
    const double y0 = random.uniform(-20, 20);
    const double y1 = random.uniform(-20, 20);
    RouteTask task = from_to({-40, y0}, {40, y1});
    task.half_width_m = random.uniform(0, 1);
    RouteConfig config;
    config.clearance_m = random.uniform(0.2, 3);
    config.cell_m = trial % 2 == 0 ? 1 : 2;
    const auto path = plan_route(map, task, config);
    if (!path) {
      ASSERT_TRUE(path.error() == RouteRefusal::kNoPath || path.error() == RouteRefusal::kGoalBlocked ||
                  path.error() == RouteRefusal::kStartBlocked);
      ++none;
      continue;
    }
    const double need = task.half_width_m + config.clearance_m;
    const double sampled = sampled_clearance(list_of(map), path->points, 0.1);
    ASSERT_EQ(path->points.front(), task.start);
    ASSERT_EQ(path->points.back(), task.goal);
    ASSERT_GE(path->length_m, (task.goal - task.start).norm() - 1e-9);
    ++ways;
    if (path->escape_m == 0) {
      ASSERT_GE(sampled, need);
      ASSERT_FALSE(map.conflict(path->points, need));
    }
    ASSERT_NEAR(path->clearance_m, sampled, 0.05);  // a sample is 5 cm away at most
    straight += path->points.size() == 2;
    if (trial % 4 != 0) continue;
    RouteConfig rough = config;
    rough.smooth = false;
    const auto cells = plan_route(map, task, rough);
    ASSERT_TRUE(cells);
    ASSERT_LE(path->points.size(), cells->points.size());
    ASSERT_LE(path->length_m, (1 + config.room_weight) * cells->length_m);
    if (path->escape_m == 0) {
      ASSERT_GE(sampled_clearance(list_of(map), cells->points, 0.2), need);
    }
    if (trial % 8 == 0) {
      ASSERT_EQ(plan_route(map, task, config)->points, path->points);
    }
  }
  EXPECT_GT(ways - straight, 500);
  EXPECT_LT(none, 300);
}

// The clearance survives a change of frame and back.
// ledger: S6-46
TEST(RoutePlanner, IsClearInTheWorldToo) {
  Random random(9);
  for (int trial = 0; trial < 50; ++trial) {
    const HazardMap map(random_hazards(random, 20, 30, 5));
    const RouteTask task = from_to({-45, 0}, {45, 0});
    const auto path = plan_route(map, task, {});
    if (!path) continue;
    const PlanFrame frame{{6543.2, -1234.5}, Angle::radians(random.uniform(-3, 3))};
    Way world;
    for (const Vector2d& p : path->points) world.push_back(frame.to_world(p));
    std::vector<Hazard> moved = list_of(map);
    for (Hazard& h : moved) {
      for (Vector2d& p : h.outline) p = frame.to_world(p);
    }
    ASSERT_FALSE(HazardMap(moved).conflict(world, 3.5));
  }
}

// Without smoothing and wishes the way over cells costs what relaxing all steps until nothing changes costs, steps
// judged one by one.
// ledger: S6-48
TEST(RoutePlanner, TheWayOverCellsIsTheShortest) {
  ISOBATH_NOT_SANITIZED();
  Random random(3);
  int ways = 0;
  for (int trial = 0; trial < 8; ++trial) {
    const HazardMap map(random_hazards(random, 14, 9, 3));
    const RouteTask task = from_to({-12, -12}, {12, 12});
    RouteConfig config;
    config.smooth = false;
    config.room_weight = 0;
    config.clearance_m = 0.3;
    config.wished_clearance_m = 0;
    constexpr int kSide = 49, kShift = 12;  // cells -24 .. 24 both ways: more than the search looks at
    const auto centre = [](int i) { return Vector2d(i % kSide - kShift - 12, i / kSide - kShift - 12); };
    std::vector<double> cost(static_cast<std::size_t>(kSide) * kSide, INFINITY);
    const int start = kShift * kSide + kShift, goal = (kShift + 24) * kSide + kShift + 24;
    cost[static_cast<std::size_t>(start)] = 0;
    std::vector<std::pair<int, int>> steps;
    for (int i = 0; i < kSide * kSide; ++i) {
      for (const int by : {1, kSide - 1, kSide, kSide + 1}) {
        const int k = i + by;
        if (k >= kSide * kSide || (centre(i) - centre(k)).norm() > 1.5) continue;
        if (map.leg_distance(centre(i), centre(k)) < 0.8) continue;
        steps.emplace_back(i, k);
        steps.emplace_back(k, i);
      }
    }
    for (bool changed = true; changed;) {
      changed = false;
      for (const auto& step : steps) {
        const double total =
            cost[static_cast<std::size_t>(step.first)] + (centre(step.first) - centre(step.second)).norm();
        if (total >= cost[static_cast<std::size_t>(step.second)] - 1e-9) continue;
        cost[static_cast<std::size_t>(step.second)] = total;
        changed = true;
      }
    }
    const auto path = plan_route(map, task, config);
    ASSERT_EQ(path.has_value(), std::isfinite(cost[static_cast<std::size_t>(goal)]));
    if (!path) continue;
    ++ways;
    EXPECT_NEAR(path->length_m, cost[static_cast<std::size_t>(goal)], 1e-6);
  }
  EXPECT_GE(ways, 4);
}

// Where the wish costs too much the way is near the shortest all the same.
TEST(RoutePlanner, StandingOffCostsAtMostItsWeight) {
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const HazardMap map(random_hazards(random, 25, 30, 4));
    RouteConfig standing_off, shortest;
    shortest.room_weight = 0;
    standing_off.smooth = shortest.smooth = false;
    const RouteTask task = from_to({-45, 0}, {45, 0});
    const auto a = plan_route(map, task, standing_off), b = plan_route(map, task, shortest);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) continue;
    ASSERT_LE(a->length_m, b->length_m * (1 + standing_off.room_weight) + 1e-9);
    ASSERT_GE(a->length_m, b->length_m - 1e-9);
  }
}

/// Clearance of a coarse way between its cell centres.
double of_centres(const HazardMap& map, const RoutePath& path, bool goal_is_centre) {
  Way way = path.points;
  if (!goal_is_centre) way.pop_back();
  return sampled_clearance(list_of(map), way, 0.1);
}

// Every alignment of a rock to the coarse cells, in steps of half a metre; rocks from a point to 7 m.
// ledger: S6-44 S6-49 S6-52 S6-E17 S6-E18
TEST(RoutePlanner, CoarseCellsKeepHalfACellInAllAlignments) {
  ISOBATH_NOT_SANITIZED();
  RouteConfig careful = RouteConfig::as_printed();
  careful.cut_corners = false;
  RouteConfig dilated = careful;
  dilated.clearance_m = 5;
  double least = INFINITY, min_dilated = INFINITY, min_printed = INFINITY, most = 0;
  for (const double half : {0.0, 0.6, 1.5, 3.5}) {
    for (double x = 0; x < 5; x += 0.5) {
      for (double y = 0; y < 5; y += 0.5) {
        const HazardMap map({hazard(box(48 + x, y - 2, half, half)), hazard(box(43 + x, 4 + y, half, half))});
        const RouteTask task = from_to({0, 0}, {100, 0});
        const auto path = plan_route(map, task, careful), wide = plan_route(map, task, dilated),
                   printed = plan_route(map, task, RouteConfig::as_printed());
        ASSERT_TRUE(path && wide && printed);
        const double kept = of_centres(map, *path, true);
        ASSERT_GE(kept, 2.5 - 1e-9);
        ASSERT_GE(of_centres(map, *wide, true), 5);
        least = std::min(least, kept);
        most = std::max(most, kept);
        min_dilated = std::min(min_dilated, of_centres(map, *wide, true));
        min_printed = std::min(min_printed, of_centres(map, *printed, true));
      }
    }
  }
  EXPECT_LT(least, 3) << "no more than half a cell is sure";
  EXPECT_GT(most, 4) << "what cells add is not uniform";
  EXPECT_GE(min_dilated, 7.5 - 1e-9);
  EXPECT_LT(min_printed, 2.49) << "as printed, corners are cut";
}

// ledger: S6-49 S6-E18
TEST(RoutePlanner, AsPrintedItTouchesTheCornersOfBlockedCells) {
  // Two rocks that fill cells which meet at a corner: as printed the way leads through between them.
  const HazardMap map({hazard(box(10, 0, 2.4, 2.4)), hazard(box(5, 5, 2.4, 2.4)), hazard(box(0, 10, 2.4, 2.4)),
                       hazard(box(15, -5, 2.4, 2.4)), hazard(box(-5, 15, 2.4, 2.4))});
  const RouteTask task = from_to({0, 0}, {15, 15});
  const auto printed = plan_route(map, task, RouteConfig::as_printed());
  ASSERT_TRUE(printed);
  EXPECT_LT(printed->clearance_m, 0.2);
  RouteConfig careful = RouteConfig::as_printed();
  careful.cut_corners = false;
  const auto path = plan_route(map, task, careful);
  ASSERT_TRUE(path);
  EXPECT_GE(path->clearance_m, 2.5);
}

// The vehicle's own cell is blocked by coarsening, not by what is in it.
// ledger: S6-50
TEST(RoutePlanner, ACoarseStartMayBeLeft) {
  RouteConfig config = RouteConfig::as_printed();
  config.cut_corners = false;
  const HazardMap map({hazard({{2, 2}})});
  const auto path = plan_route(map, from_to({0, 0}, {-30, 0}), config);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->points.front(), Vector2d(0, 0));
  const HazardMap on_it({hazard(box(0, 0, 1, 1))});
  EXPECT_EQ(plan_route(on_it, from_to({0, 0}, {-30, 0}), config).error(), RouteRefusal::kStartBlocked);
  const HazardMap at_goal({hazard({{-31, 1}})});
  EXPECT_EQ(plan_route(at_goal, from_to({0, 0}, {-30, 0}), config).error(), RouteRefusal::kGoalBlocked);
  std::vector<Hazard> walls = ring({0, 0}, 12);
  EXPECT_EQ(plan_route(HazardMap(walls), from_to({0, 0}, {-30, 0}), config).error(), RouteRefusal::kNoPath);
}

// Nearer to a rock than the clearance, half within its margin, between two, at a wall: away, never nearer.
// ledger: S6-50
TEST(RoutePlanner, AStartTooNearToAHazardMayBeLeft) {
  const std::vector<std::vector<Hazard>> cases = {
      {hazard(box(3, 0, 1, 1))},
      {hazard(box(3, 0, 1, 1), 2.5)},
      {hazard(box(3, 0, 1, 1)), hazard(box(-3, 0, 1, 1))},
      {hazard({{-100, 1.5}, {100, 1.5}})},
      {hazard({{-30, 1.5}, {30, 1.5}}), hazard({{-30, -2}, {30, -2}})},
  };
  for (const std::vector<Hazard>& hazards : cases) {
    const HazardMap map(hazards);
    const double at_start = map.distance({0, 0});
    ASSERT_LT(at_start, 3.5);
    const auto path = plan_route(map, from_to({0, 0}, {40, -30}), {});
    if (hazards.size() == 2 && hazards[1].outline.size() == 2) {
      // Between two long walls the way out is longer than a vehicle may stay so near.
      EXPECT_EQ(path.error(), RouteRefusal::kStartBlocked);
      continue;
    }
    ASSERT_TRUE(path);
    EXPECT_GE(path->clearance_m, at_start - 1e-6) << "nowhere nearer than it stood";
    EXPECT_GT(path->escape_m, 0);
    EXPECT_LT(path->escape_m, 12) << "and soon away";
    // Once away it keeps away.
    double along = 0;
    for (std::size_t i = 1; i < path->points.size(); ++i) {
      if (along >= path->escape_m) {
        EXPECT_FALSE(map.conflict(Way{path->points[i - 1], path->points[i]}, 3.5));
      }
      along += (path->points[i] - path->points[i - 1]).norm();
    }
  }
}

// ledger: S6-50
TEST(RoutePlanner, RefusesAStartOnAnOutlineAndAGoalTooNear) {
  const HazardMap map({hazard(box(0, 0, 4, 5))});
  EXPECT_EQ(plan_route(map, from_to({1, 1}, {50, 0}), {}).error(), RouteRefusal::kStartBlocked);
  EXPECT_DOUBLE_EQ(map.distance({1, 1}), -3) << "how far";
  EXPECT_EQ(plan_route(map, from_to({50, 0}, {7.4, 0}), {}).error(), RouteRefusal::kGoalBlocked);
  EXPECT_TRUE(plan_route(map, from_to({50, 0}, {7.6, 0}), {}));
}

// Far beyond anything seen, and a wall so long that the first window does not hold its ends.
// ledger: S6-50
TEST(RoutePlanner, TheSearchGrowsUntilThereIsAWay) {
  const HazardMap wall({hazard({{50, -300}, {50, 200}})});
  const auto path = plan_route(wall, from_to({0, 0}, {100, 0}), {});
  ASSERT_TRUE(path);
  double farthest = 0;
  for (const Vector2d& p : path->points) farthest = std::max(farthest, p.y());
  EXPECT_GT(farthest, 203);
  EXPECT_FALSE(wall.conflict(path->points, 3.5));
  EXPECT_NEAR(path->length_m, 2 * std::hypot(50, 203.5), 6);
  const auto far = plan_route(wall, from_to({0, 0}, {9000, 4000}), {});
  ASSERT_TRUE(far);
  EXPECT_FALSE(wall.conflict(far->points, 3.5));
  EXPECT_LT(far->length_m, 1.05 * (std::hypot(50, 203.5) + std::hypot(8950, 3796.5)));
}

// ledger: S6-48 S6-E09
TEST(RoutePlanner, NoPathIsSaidOnlyAfterAllWasLookedAt) {
  const HazardMap map(ring({0, 0}, 20));
  const auto inside = plan_route(map, from_to({0, 0}, {100, 0}), {});
  ASSERT_FALSE(inside);
  EXPECT_EQ(inside.error(), RouteRefusal::kNoPath);
  EXPECT_EQ(plan_route(map, from_to({100, 0}, {0, 0}), {}).error(), RouteRefusal::kNoPath);
  RouteConfig frugal;
  frugal.max_expanded = 50;
  EXPECT_EQ(plan_route(map, from_to({100, 0}, {0, 0}), frugal).error(), RouteRefusal::kOutOfBudget);
  // With a gate just wide enough there is a way.
  std::vector<Hazard> gate = ring({0, 0}, 20);
  gate.erase(gate.begin() + 6, gate.begin() + 9);
  const auto out = plan_route(HazardMap(gate), from_to({0, 0}, {100, 0}), {});
  ASSERT_TRUE(out);
  EXPECT_GT(out->length_m, 105);
}

TEST(RoutePlanner, RefusesWhatIsNotFinite) {
  const HazardMap map({});
  const double nan = std::nan("");
  EXPECT_EQ(plan_route(map, from_to({nan, 0}, {1, 0}), {}).error(), RouteRefusal::kNotFinite);
  EXPECT_EQ(plan_route(map, from_to({0, 0}, {INFINITY, 0}), {}).error(), RouteRefusal::kNotFinite);
  EXPECT_EQ(plan_route(map, from_to({0, 0}, {1e9, 0}), {}).error(), RouteRefusal::kNotFinite);
  RouteTask task = from_to({0, 0}, {1, 0});
  task.heading = nan;
  EXPECT_EQ(plan_route(map, task, {}).error(), RouteRefusal::kNotFinite);
}

TEST(RoutePlanner, StartAndGoalMayBeOnePlace) {
  const HazardMap map({hazard({{4, 0}})});
  const auto path = plan_route(map, from_to({0, 0}, {0, 0}), {});
  ASSERT_TRUE(path);
  EXPECT_EQ(path->length_m, 0);
  const auto near = plan_route(map, from_to({0, 0}, {0.1, 0.2}), {});
  ASSERT_TRUE(near);
  EXPECT_LT(near->length_m, 0.5);
}

TEST(RoutePlanner, EveryRefusalHasItsWords) {
  for (const auto r : {RouteRefusal::kNotFinite, RouteRefusal::kStartBlocked, RouteRefusal::kGoalBlocked,
                       RouteRefusal::kNoPath, RouteRefusal::kOutOfBudget, RouteRefusal::kCannotTurn}) {
    EXPECT_GT(std::string(to_text(r)).size(), 10u);
  }
  RouteConfig config;
  for (const isobath::Field& field : fields(config)) EXPECT_FALSE(field.sentence().empty());
}

}  // namespace
}  // namespace isobath::route_planner_test
