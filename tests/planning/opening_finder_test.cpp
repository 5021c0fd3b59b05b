// The opening between two bodies on the way: which one, how wide and high, and how much of it is known.
#include "measured_water.hpp"
#include <gtest/gtest.h>
#include <isobath/planning/opening_finder.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::MeasuredWater;

Hazard square(const Vector2d& centre, double half_m, int number) {
  Hazard hazard;
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
    hazard.outline.emplace_back(centre + half_m * Vector2d(x, y));
  hazard.obstacle = number;
  return hazard;
}

/// A row of pylons 25 m apart across a river that flows along `course`, as seen from upstream.
std::vector<Hazard> pylons(Angle course) {
  const Vector2d along(cos(course), sin(course)), aside(-along.y(), along.x());
  std::vector<Hazard> row;
  for (int i = 0; i < 4; ++i) row.push_back(square(60 * along + (25 * i - 37.5) * aside, 0.5, i + 1));
  return row;
}

const OpeningSearch kSearch{.depth_m = 3};

// ledger: S5-40, S5-43
TEST(OpeningFinder, TheOpeningOnTheWayLiesBetweenTheTwoPylonsBesideItOnAnyCourse) {
  for (const double degrees : {0.0, 80.0, 200.0, 355.0}) {
    const Angle course = Angle::degrees(degrees);
    const Vector2d along(cos(course), sin(course)), aside(-along.y(), along.x());
    const auto found = find_opening(pylons(course), Vector2d(3 * aside), 110 * along, kSearch, MeasuredWater().grid());
    ASSERT_TRUE(found) << degrees;
    EXPECT_EQ(found->port_number, 2);
    EXPECT_EQ(found->starboard_number, 3);
    EXPECT_LT((found->opening.X_WO.translation.head<2>() - 60 * along).norm(), 1.5);
    EXPECT_NEAR(found->opening.width_m, 24, 0.5);
    EXPECT_LT(abs((found->opening.X_WO.rotation.heading() - course).wrapped()).degrees(), 3);
    EXPECT_FALSE(found->bed_known);
  }
}

TEST(OpeningFinder, ABermAcrossTheWayIsNoSideThoughItIsSeenInPieces) {
  std::vector<Hazard> bodies = pylons(Angle());
  for (int i = 0; i < 20; ++i) {
    if (i != 10) bodies.push_back(square({45, 5.0 * i - 50}, 0.5, 9));
  }
  const auto found = find_opening(bodies, {0, 0}, {110, 0}, kSearch, MeasuredWater().grid());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->opening.X_WO.translation.x(), 60, 1);
}

TEST(OpeningFinder, NothingIsFoundWhereTheWayEndsBeforeItOrTheGapIsTooWideOrOneSideIsMissing) {
  const OccupancySnapshot map = MeasuredWater().grid();
  const std::vector<Hazard> row = pylons(Angle());
  EXPECT_FALSE(find_opening(row, {0, 0}, {50, 0}, kSearch, map));
  EXPECT_FALSE(find_opening(row, {0, 0}, {110, 0}, {.max_width_m = 20}, map));
  EXPECT_FALSE(find_opening(row, {0, 0}, {110, 0}, {.farthest_m = 50}, map));
  EXPECT_FALSE(find_opening(std::span(row).first(2), {0, 0}, {110, 0}, kSearch, map));
  EXPECT_FALSE(find_opening({}, {0, 0}, {0, 0}, kSearch, map));
}

// ledger: S5-40, S5-58
TEST(OpeningFinder, TheVoxelsSayHowHighItIsAndHowMuchOfItIsFree) {
  MeasuredWater water;
  water.clear({0, -20, 0}, {70, 20, 8});
  water.occupy({0, -20, 8}, {70, 20, 9});
  auto found = find_opening(pylons(Angle()), {0, 0}, {110, 0}, kSearch, water.grid());
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->bed_known);
  EXPECT_NEAR(found->bed_m, 8, 0.5);
  EXPECT_EQ(found->top_m, 0);
  EXPECT_NEAR(found->opening.height_m, 6, 0.5) << "3 m up to the surface, and as much down";
  EXPECT_EQ(free_share(*found, 1, water.grid()), 1);

  MeasuredWater narrow;  // what a straight approach sees
  narrow.clear({0, -4, 0}, {70, 4, 8});
  narrow.occupy({0, -20, 8}, {70, 20, 9});
  found = find_opening(pylons(Angle()), {0, 0}, {110, 0}, kSearch, narrow.grid());
  EXPECT_NEAR(free_share(*found, 1, narrow.grid()), 8.0 / 22, 0.05);

  water.occupy({50, -20, 0}, {70, 20, 1});  // a deck hangs into the water
  found = find_opening(pylons(Angle()), {0, 0}, {110, 0}, kSearch, water.grid());
  EXPECT_NEAR(found->top_m, 1, 0.5);
  EXPECT_NEAR(found->opening.height_m, 4, 0.5);
}

}  // namespace
}  // namespace isobath
