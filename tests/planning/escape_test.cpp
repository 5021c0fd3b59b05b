// Ways out of a vehicle that cannot stop, held against closed forms and against an integration of its own.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/escape.hpp>
#include <numbers>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

/// A row of points, not farther apart than half a metre.
std::vector<ObstaclePoint> row(const Vector2d& from, const Vector2d& to) {
  std::vector<ObstaclePoint> points;
  const int pieces = static_cast<int>(std::ceil((to - from).norm() / 0.5));
  for (int i = 0; i <= pieces; ++i) points.push_back({from + (to - from) * i / pieces});
  return points;
}

void add(std::vector<ObstaclePoint>& points, const std::vector<ObstaclePoint>& more) {
  points.insert(points.end(), more.begin(), more.end());
}

/// 1.5 m/s and 0.3 rad/s: a circle of 5 m.
EscapeTask task() {
  EscapeTask t;
  t.speed = 1.5;
  t.turn_rate = 0.3;
  t.room_m = 1.5;
  t.horizon_s = 20;
  return t;
}

TEST(EscapeSearch, OpenWaterIsFreeStraightOn) {
  const EscapeSearch search({}, task());
  const Escape best = search.best();
  EXPECT_TRUE(search.free(best));
  EXPECT_EQ(best.turn, 0);
  EXPECT_EQ(best.wait_s, 0);
  EXPECT_TRUE(std::isinf(best.room_m));
  EXPECT_FALSE(best.meets);
}

// ledger: S6-51
TEST(EscapeSearch, StraightOnMeetsAWallWhereItStands) {
  const auto wall = row({10, -30}, {10, 30});
  const EscapeSearch search(wall, task());
  const Escape on = search.try_turn(0);
  EXPECT_FALSE(search.free(on));
  EXPECT_NEAR(on.free_s, (10 - 1.5) / 1.5, 0.5);  // its room before the wall
  ASSERT_TRUE(on.meets);
  EXPECT_NEAR(on.meets->x(), 10, 1e-9);
  const Escape best = search.best();
  EXPECT_TRUE(search.free(best));
  EXPECT_GE(std::abs(best.turn), pi / 2);
  EXPECT_GE(best.room_m, 1.5);
}

TEST(EscapeSearch, TurnsToTheSideThatIsOpen) {
  for (const int side : {1, -1}) {
    std::vector<ObstaclePoint> corner = row({12, -30}, {12, 30});
    add(corner, row({-30, side * 4.0}, {12, side * 4.0}));
    const EscapeSearch search(corner, task());
    const Escape best = search.best();
    EXPECT_TRUE(search.free(best)) << side;
    EXPECT_LT(best.turn * side, 0) << side;
  }
}

// Along a row of pylons to the left there is as much room as through the gap to the right, which leads to the goal.
// Without a goal it takes the one that has a little more.
TEST(EscapeSearch, TakesTheGapThatLeadsToTheGoalAndNotTheWayAlongTheRow) {
  EscapeTask t = task();
  const std::vector<ObstaclePoint> pylons = {{{16, -8}}, {{14, 0}}, {{9, 9}}};
  const Escape anywhere = EscapeSearch(pylons, t).best();
  t.towards = pi / 6;
  const EscapeSearch search(pylons, t);
  EXPECT_FALSE(search.free(search.try_turn(0))) << "a pylon stands ahead";
  const Escape through = search.best();
  EXPECT_TRUE(search.free(through));
  EXPECT_GT(through.turn, 0);
  EXPECT_LT(through.turn, pi / 3);
  EXPECT_GE(through.room_m, 0.8 * std::min(anywhere.room_m, 2 * t.room_m) - 1e-9);
  t.towards = -pi / 6;
  EXPECT_LT(EscapeSearch(pylons, t).best().turn, 0) << "to the other side, if the goal lies there";
}

// A circle of 5 m to one side, what it takes to begin it, and the room beside: so wide must an alley be on either side.
TEST(EscapeSearch, AnAlleyWithoutRoomToTurnHasNoWayOut) {
  const auto alley = [](double half_width) {
    std::vector<ObstaclePoint> points = row({-40, -half_width}, {15, -half_width});
    add(points, row({-40, half_width}, {15, half_width}));
    add(points, row({15, -half_width}, {15, half_width}));
    return points;
  };
  const auto narrow = alley(3), wide = alley(14);
  EXPECT_FALSE(EscapeSearch(narrow, task()).free(EscapeSearch(narrow, task()).best()));
  EXPECT_TRUE(EscapeSearch(wide, task()).free(EscapeSearch(wide, task()).best()));
}

// The order leads into the alley: before it is in there is a way out, once it is there is none.
TEST(EscapeSearch, AnOrderIntoADeadEndIsSeenBeforeItIsEntered) {
  const auto dead_end_at = [](double x) {
    std::vector<ObstaclePoint> points = row({x, -3}, {x + 15, -3});
    add(points, row({x, 3}, {x + 15, 3}));
    add(points, row({x + 15, -3}, {x + 15, 3}));
    add(points, row({x, 3}, {x, 30}));
    add(points, row({x, -3}, {x, -30}));
    return points;
  };
  double refused_at = 0;
  for (double x = 20; x > -5; x -= 0.5) {
    const auto points = dead_end_at(x);
    const EscapeSearch search(points, task());
    if (search.free(search.after(0, 1))) continue;
    refused_at = x;
    EXPECT_TRUE(search.free(search.best())) << "no way out is left at " << x;
    break;
  }
  EXPECT_GT(refused_at, 3);  // half a circle takes it 5 m ahead, and 1.5 m more
  EXPECT_LT(refused_at, 12);
}

TEST(EscapeSearch, ACurrentCarriesItIntoWhatStandsDownstream) {
  const auto wall = row({-40, 6}, {40, 6});
  EscapeTask carried = task();
  EXPECT_TRUE(EscapeSearch(wall, carried).free(EscapeSearch(wall, carried).try_turn(0)));
  carried.drift = {0, 0.5};
  const Escape on = EscapeSearch(wall, carried).try_turn(0);
  EXPECT_NEAR(on.free_s, (6 - 1.5) / 0.5, 0.5);
  EXPECT_LT(EscapeSearch(wall, carried).best().turn, 0);
}

// 1.5 m/s over ground are 1 m/s of its own and 0.5 m/s of current, or 1.5 of its own: it must be free either way.
TEST(EscapeSearch, WhatMayBeACurrentFromAsternGoesOnInTheTurn) {
  EscapeTask unsure = task(), sure = task();
  unsure.astern = 0.5;
  sure.speed = 1;
  sure.drift = {0.5, 0};
  const auto wall = row({14, -60}, {14, 60});
  const double turn = pi / 2;  // along the wall, with the current towards it
  EXPECT_TRUE(EscapeSearch(wall, task()).free(EscapeSearch(wall, task()).try_turn(turn)));
  const Escape carried = EscapeSearch(wall, unsure).try_turn(turn);
  EXPECT_FALSE(EscapeSearch(wall, unsure).free(carried));
  EXPECT_NEAR(carried.free_s, EscapeSearch(wall, sure).try_turn(turn).free_s, 1e-9);
  EXPECT_GT(std::abs(EscapeSearch(wall, unsure).best().turn), turn) << "it must turn back";
}

TEST(EscapeSearch, LeavesWhatItIsTooNearToAlready) {
  const auto wall = row({-40, 1}, {40, 1});
  const EscapeSearch search(wall, task());
  EXPECT_TRUE(search.free(search.try_turn(-pi / 2)));
  EXPECT_FALSE(search.free(search.try_turn(pi / 6)));
}

TEST(EscapeSearch, TakesPointsThatAreNotFiniteForNone) {
  const std::vector<ObstaclePoint> points = {{{NAN, 0}}, {{5, INFINITY}}, {{INFINITY, NAN}}, {{5, 0}, {NAN, 0}}};
  EXPECT_TRUE(EscapeSearch(points, task()).free(EscapeSearch(points, task()).try_turn(0)));
}

// It crosses from port at the speed of the vehicle, to be 10 m ahead when the vehicle is there: straight on meets it, a
// turn behind it does not. One that leaves ahead is no obstacle at all. ledger: S3-30
TEST(EscapeSearch, PointsThatMoveAreWhereTheyWillBe) {
  const std::vector<ObstaclePoint> crosses = {{{9, -9}, {0, 1.5}}}, leaves = {{{4, 0}, {1.6, 0}}};
  EscapeTask far = task(), near = task();
  far.moving_s = 20;
  near.moving_s = 3;  // it would be met after five
  const EscapeSearch search(crosses, far);
  const Escape on = search.try_turn(0);
  ASSERT_TRUE(on.meets);
  EXPECT_NEAR(on.meets->x(), 9, 1e-9);
  EXPECT_GT(on.meets->y(), -3) << "where it then is";
  EXPECT_TRUE(search.free(search.try_turn(-pi / 2)));
  EXPECT_TRUE(EscapeSearch(leaves, task()).free(EscapeSearch(leaves, task()).try_turn(0)));
  EXPECT_TRUE(EscapeSearch(crosses, near).free(EscapeSearch(crosses, near).try_turn(0)));
}

// The way of a turn, integrated a hundred times finer: no free one comes nearer to a point than the room, less what the
// coarse steps leave between them.
TEST(EscapeSearch, WhatIsFreeKeepsItsRoomOnAFinerIntegration) {
  ISOBATH_NOT_SANITIZED();
  Random random(5);
  int free_ones = 0;
  for (int field = 0; field < 200; ++field) {
    std::vector<ObstaclePoint> points;
    for (int i = 0; i < 12; ++i) {
      const double x = random.uniform(-20, 20);
      const double y = random.uniform(-20, 20);
      if (std::hypot(x, y) > 2) points.push_back({{x, y}});
    }
    const EscapeTask t = task();
    const EscapeSearch search(points, t);
    const Escape best = search.best();
    if (!search.free(best)) continue;
    ++free_ones;
    Vector2d place(0, 0);
    double heading = 0, rate = 0, nearest = 1e9;
    constexpr double kDt = 0.0025;
    for (double s = 0; s < t.horizon_s; s += kDt) {
      const double wanted = s < best.wait_s ? 0 : best.turn;
      const double asked = std::clamp((wanted - heading) / t.lag_s, -t.turn_rate, t.turn_rate);
      rate += (asked - rate) * kDt / t.lag_s;
      heading += rate * kDt;
      place += kDt * t.speed * Vector2d(std::cos(heading), std::sin(heading));
      for (const ObstaclePoint& p : points) nearest = std::min(nearest, (p.place - place).norm());
    }
    EXPECT_GT(nearest, t.room_m - 0.35) << "field " << field << ", turn " << best.turn;
  }
  EXPECT_GT(free_ones, 100);
}

}  // namespace
}  // namespace isobath
