// Ways in three dimensions: over, under, between; when there is none; judged by samples against what was put there.
#include <gtest/gtest.h>
#include <isobath/planning/space_route.hpp>
#include <numbers>
#include <tests/planning/measured_water.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::MeasuredWater;

/// A berm across all of a river that is measured from surface to bed, as the plan view sees it: closed.
struct River {
  River() {
    hazards.push_back({{{30, -25}, {34, -25}, {34, 25}, {30, 25}}, 0, HazardKind::kSeen, 1});
    task.start = {0, 0, 5};
    task.goal = {60, 0, 5};
  }
  void measure() {
    water.clear({0, -25, 0}, {70, 25, 9});
    water.occupy({31, -25, 5}, {33, 25, 9});
  }
  [[nodiscard]] Result<SpaceRoutePath, RouteRefusal> plan() {
    task.hazards = hazards;
    return plan_space_route(water.grid(), task, config);
  }

  MeasuredWater water;
  std::vector<Hazard> hazards;
  SpaceRouteTask task;
  SpaceRouteConfig config;
};

/// Of a way's middle to a box, by samples a centimetre apart.
double distance_to_box(const std::vector<Vector3d>& way, const Vector3d& low, const Vector3d& high) {
  double least = INFINITY;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const int n = std::max(1, static_cast<int>((way[i] - way[i - 1]).norm() / 0.01));
    for (int k = 0; k <= n; ++k) {
      const Vector3d p = way[i - 1] + (way[i] - way[i - 1]) * (static_cast<double>(k) / n);
      least = std::min(least, (p - p.cwiseMax(low).cwiseMin(high)).norm());
    }
  }
  return least;
}

double steepest(const std::vector<Vector3d>& way) {
  double most = 0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Vector3d leg = way[i] - way[i - 1];
    if (std::abs(leg.z()) > 0.26) most = std::max(most, std::abs(leg.z()) / leg.head<2>().norm());
  }
  return most;
}

// ledger: S5-35 S5-36 S5-39
TEST(SpaceRoute, LeadsOverWhatClosesThePlanView) {
  River river;
  river.measure();
  const auto path = river.plan();
  ASSERT_TRUE(path) << to_text(path.error());
  EXPECT_GE(distance_to_box(path->points, {31, -25, 5}, {33, 25, 9}), 0.25 + 1.2 - 0.15);
  for (const Vector3d& p : path->points) EXPECT_GE(p.z(), 0.25 + 1.2 - 0.01) << "the surface is kept clear of, too";
  EXPECT_LE(steepest(path->points), river.task.steepest + 1e-9);
  EXPECT_EQ(path->points.front(), river.task.start);
  EXPECT_EQ(path->points.back(), river.task.goal);
  EXPECT_LT(path->length_m, 62);
  EXPECT_DOUBLE_EQ(path->sure_m, path->length_m);
}

// ledger: S5-33 S5-34
TEST(SpaceRoute, ThereIsNoneWhereNobodyHasMeasuredAHeight) {
  River river;
  river.config.decide_m = 40;
  river.water.clear({0, -2, 4}, {10, 2, 6});
  river.water.clear_flat({0, -25, 0}, {70, 25, 5});
  EXPECT_EQ(river.plan().error(), RouteRefusal::kNoPath);
  river.water.clear({26, -25, 0}, {38, 25, 5});
  EXPECT_TRUE(river.plan());
}

// ledger: S5-45
TEST(SpaceRoute, LooksOnWhileThereIsTimeToTurnAway) {
  River river;
  river.water.clear({0, -4, 3}, {20, 4, 7});
  river.config.decide_m = 20;
  const auto path = river.plan();
  ASSERT_TRUE(path);
  EXPECT_NEAR(path->sure_m, 30, 1);
  EXPECT_LT(path->sure_m, path->length_m);
  river.task.start.x() = 12;
  EXPECT_EQ(river.plan().error(), RouteRefusal::kNoPath) << "18 m before it";
}

// ledger: S5-36
TEST(SpaceRoute, FindsOutOfADeadEnd) {
  River river;
  river.measure();
  // A bay that opens towards the start: the straight way and all that looks good leads into it.
  river.water.occupy({22, -10, 0}, {23, 10, 9});
  river.water.occupy({10, -10, 0}, {22, -9, 9});
  river.water.occupy({10, 9, 0}, {22, 10, 9});
  river.task.start = {18, 0, 3};
  river.task.goal.z() = 3;
  const auto path = river.plan();
  ASSERT_TRUE(path) << to_text(path.error());
  EXPECT_GE(distance_to_box(path->points, {22, -10, 0}, {23, 10, 9}), 1.3);
  EXPECT_GE(distance_to_box(path->points, {10, -10, 0}, {22, -9, 9}), 1.3);
  EXPECT_GE(distance_to_box(path->points, {10, 9, 0}, {22, 10, 9}), 1.3);
}

// ledger: S5-36 S5-47
TEST(SpaceRoute, CanBeTurnedByAVehicleThatNeedsRoomToTurn) {
  River river;
  river.measure();
  river.water.occupy({20, -2, 0}, {21, 2, 9});
  river.hazards.push_back({{{20, -2}, {21, -2}, {21, 2}, {20, 2}}, 0, HazardKind::kSeen, 2});
  river.task.turning_radius_m = 5;
  river.task.heading = Angle::degrees(60);
  const auto path = river.plan();
  ASSERT_TRUE(path) << to_text(path.error());
  const Vector3d first = path->points[1] - path->points[0];
  EXPECT_NEAR(std::atan2(first.y(), first.x()), std::numbers::pi / 3, 0.27)
      << "it leaves as it heads, by an arc's chord";
  EXPECT_GE(distance_to_box(path->points, {20, -2, 0}, {21, 2, 9}), 1.3);
}

TEST(SpaceRoute, KeepsToTheDepthsOfTheMission) {
  River river;
  river.measure();
  river.task.min_depth_m = 4;
  EXPECT_EQ(river.plan().error(), RouteRefusal::kNoPath) << "over the berm there is none so deep";
}

TEST(SpaceRoute, AVehicleThatCanRiseOnTheSpotMay) {
  River river;
  river.measure();
  river.task.start = {28.6, 0, 6};
  river.task.steepest = 0.1;
  const auto slowly = river.plan();
  river.task.steepest = std::numeric_limits<double>::infinity();
  const auto at_once = river.plan();
  ASSERT_TRUE(slowly && at_once);
  EXPECT_LE(steepest(slowly->points), 0.1 + 1e-9);
  EXPECT_GT(steepest(at_once->points), 1);
  EXPECT_GT(slowly->length_m, at_once->length_m + 10) << "it goes back and forth for its height";
}

TEST(SpaceRoute, GoesForAFarGoalInPart) {
  River river;
  river.measure();
  river.task.goal = {500, 0, 5};
  const auto path = river.plan();
  ASSERT_TRUE(path);
  EXPECT_EQ(path->points.back(), river.task.goal);
  EXPECT_NEAR(path->points[path->points.size() - 2].x(), river.config.reach_m, 0.6);
}

TEST(SpaceRoute, RefusesWhatHasNoAnswer) {
  River river;
  river.measure();
  river.task.goal.x() = NAN;
  EXPECT_EQ(river.plan().error(), RouteRefusal::kNotFinite);
  river.task.goal = {32, 0, 7};
  EXPECT_EQ(river.plan().error(), RouteRefusal::kGoalBlocked);
  river.task.goal = {60, 0, 5};
  river.task.start = {32, 0, 7};
  EXPECT_EQ(river.plan().error(), RouteRefusal::kStartBlocked);
  river.task.start = {0, 0, 5};
  river.config.max_expanded = 3;
  EXPECT_EQ(river.plan().error(), RouteRefusal::kOutOfBudget);
}

TEST(SpaceRoute, TellsWhetherAWayIsClearAndHowFarItIsKnown) {
  River river;
  river.measure();
  river.task.hazards = river.hazards;
  const ClearanceField room = room_for(river.water.grid(), river.task, river.config, true);
  const std::vector<Vector3d> over = {{3, 0, 3}, {60, 0, 3}}, into = {{3, 0, 6}, {60, 0, 6}};
  EXPECT_TRUE(is_clear(room, over, 1.5));
  EXPECT_FALSE(is_clear(room, over, 2.3));
  EXPECT_FALSE(is_clear(room, into, 0.1));
  EXPECT_DOUBLE_EQ(sure_length(room, over), 57);
}

}  // namespace
}  // namespace isobath
