#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/mission/agents/way_keeping.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

using Eigen::Vector2d;
using Way = std::vector<Vector2d>;

constexpr double kClearance = 3;

HazardMap map_of(const std::vector<Polygon>& outlines) {
  std::vector<Hazard> hazards;
  for (const Polygon& o : outlines) hazards.push_back({o, 0, HazardKind::kSeen, 0});
  return HazardMap(std::move(hazards));
}

// ledger: S6-47
TEST(WayKeeping, FindsTheFirstPlaceThatIsTooNearWhereTheVehicleItselfIsClear) {
  const HazardMap map = map_of({square(30, 4, 2)});
  EXPECT_TRUE(conflict_ahead(map, Way{{0, 0}, {60, 0}}, kClearance));
  EXPECT_FALSE(conflict_ahead(map, Way{{0, 0}, {60, 0}}, 1.99));
  EXPECT_FALSE(conflict_ahead(map, Way{{40, 0}, {60, 0}}, kClearance)) << "what lies behind";
}

// ledger: S6-50
TEST(WayKeeping, LetsAVehicleLeaveThatIsTooNearAlready) {
  const HazardMap map = map_of({square(0, 3, 2)});  // 1 m to starboard of the vehicle
  EXPECT_FALSE(conflict_ahead(map, Way{{0, 0}, {0, -40}}, kClearance)) << "straight away from it";
  EXPECT_TRUE(conflict_ahead(map, Way{{0, 0}, {0, 40}}, kClearance)) << "into it";
  const HazardMap wall = map_of({{{-50, 1}, {50, 1}, {50, 2}, {-50, 2}}});
  const auto along = conflict_ahead(wall, Way{{0, 0}, {40, 0}}, kClearance);
  ASSERT_TRUE(along) << "along it, never to be clear";
  EXPECT_NEAR(along->along_m, 2 * (kClearance - 1) + 1, 1e-9);
  const HazardMap two = map_of({square(0, 3, 2), square(30, 0, 2)});
  const auto other = conflict_ahead(two, Way{{0, 0}, {3, -8}, {30, -4}, {60, 0}}, kClearance);
  ASSERT_TRUE(other) << "another one further on";
  EXPECT_EQ(other->leg, 1);
  EXPECT_EQ(other->hazard, 1u);
  EXPECT_EQ(conflict_ahead(map_of({square(0, 0, 2)}), Way{{0, 0}, {40, 0}}, kClearance)->along_m, 0) << "inside";
}

// ledger: S6-55
TEST(WayKeeping, MendsAWayByMovingItsCornersAndNothingElse) {
  Random random(3);
  int mended_ways = 0;
  for (int i = 0; i < 300; ++i) {
    const double side = random.uniform() < 0.5 ? -1 : 1;
    const double half = random.uniform(1, 5);
    const double lateral = random.uniform(-1, 1);
    const Way before{{0, 0}, {40 - half, side * (half + kClearance)}, {40 + half, side * (half + kClearance)}, {90, 0}};
    const HazardMap map = map_of({square(40, side * lateral, half)});
    if (!conflict_ahead(map, before, kClearance)) continue;
    const auto after = mended(map, before, kClearance);
    ASSERT_TRUE(after) << "run " << i;
    ++mended_ways;
    ASSERT_EQ(after->size(), before.size());
    EXPECT_EQ(after->front(), before.front());
    EXPECT_EQ(after->back(), before.back());
    EXPECT_FALSE(map.conflict(*after, kClearance));
    for (std::size_t c = 1; c + 1 < before.size(); ++c) {
      EXPECT_LT(((*after)[c] - before[c]).norm(), 4) << "run " << i;
      EXPECT_GT(side * (*after)[c].y(), 0) << "the other side";
    }
  }
  EXPECT_GT(mended_ways, 50);
  EXPECT_FALSE(mended(map_of({square(30, 0, 2)}), Way{{0, 0}, {60, 0}}, kClearance)) << "no corner to move";
}

// ledger: S6-65
TEST(WayKeeping, FindsTheNearestPlaceAndOfEqualOnesTheOneNearerToTheVehicle) {
  const auto outside = [](const Vector2d& p) { return p.norm() >= 7.25; };
  const auto place = nearest_place({0, 0}, {-100, 0}, 20, outside);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->norm(), 7.5, 1e-9);
  EXPECT_LT((*place - Vector2d(-7.5, 0)).norm(), 0.5);
  EXPECT_EQ(nearest_place({9, 0}, {0, 0}, 0, outside), Vector2d(9, 0)) << "clear where it is";
  EXPECT_FALSE(nearest_place({0, 0}, {-100, 0}, 7, outside));
}

// ledger: S6-66
TEST(WayKeeping, AVehicleThatFloatsInAMarginShowsThatTheObstacleIsNotThere) {
  std::vector<Hazard> hazards = {{square(10, 0, 2), 12, HazardKind::kRemembered, 0},
                                 {square(40, 0, 2), 12, HazardKind::kRemembered, 1},
                                 {square(0, 0, 2), 1, HazardKind::kSeen, 2}};
  trim_margins(hazards, {0, 0}, 0.5);
  EXPECT_DOUBLE_EQ(hazards[0].margin_m, 7.5);
  EXPECT_DOUBLE_EQ(hazards[1].margin_m, 12);
  EXPECT_DOUBLE_EQ(hazards[2].margin_m, 0) << "its outline still holds the vehicle";
}

}  // namespace
}  // namespace isobath
