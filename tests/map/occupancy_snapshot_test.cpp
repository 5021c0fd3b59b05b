// What planners are given of a map in three dimensions: which water was measured, which is only thought to be free.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/voxel/occupancy_snapshot.hpp>

namespace isobath {
namespace {

const std::vector<std::string> kVertical = {"upright"};

// ledger: S5-32 S5-33
TEST(OccupancySnapshot, SaysOfEachVoxelWhatTheMapDoesAndWhetherAHeightWasTold) {
  VoxelMap map({.voxel_m = 0.5, .prior = 0.05, .occupied = 0.7, .free = 0.04, .max_log_odds = 6.9});
  VoxelBlocks &flat = map.layer("flat"), &vertical = map.layer("upright");
  Random random(7);
  for (int i = 0; i < 4000; ++i) {
    const int x = static_cast<int>(random.index(40)) - 20;
    const int y = static_cast<int>(random.index(40)) - 20;
    const int z = static_cast<int>(random.index(12));
    const double log_odds = 10 * random.uniform() - 5;
    (random.uniform() < 0.5 ? flat : vertical).add({x, y, z}, to_evidence(log_odds));
  }
  const OccupancySnapshot grid(map, kVertical, {0, 0, 2}, 50);
  int counts[4] = {};
  for (int x = -32; x < 32; ++x) {
    for (int y = -32; y < 32; ++y) {
      for (int z = -3; z < 16; ++z) {
        const VoxelIndex v(x, y, z);
        SpaceCell want = SpaceCell::kUnknown;
        if (map.space(v) == Space::kOccupied) want = SpaceCell::kOccupied;
        if (map.space(v) == Space::kFree) want = SpaceCell::kFree;
        const LogOdds16 tall = vertical.at(v);
        const bool clear = tall != kUnseen && log_odds_of(0.05) + to_log_odds(tall) <= log_odds_of(0.04);
        if (clear && map.probability(v) <= 0.2) want = SpaceCell::kMeasured;
        ASSERT_EQ(grid.at(v), want) << v.transpose();
        ++counts[static_cast<int>(want)];
      }
    }
  }
  for (const int count : counts) EXPECT_GT(count, 100);
}

TEST(OccupancySnapshot, KnowsNothingWhereNoSensorTellsHeight) {
  VoxelMap map({.voxel_m = 0.5});
  map.layer("flat").add({1, 2, 3}, to_evidence(-3));
  const OccupancySnapshot none(map, kVertical, {0, 0, 0}, 20);
  EXPECT_EQ(none.size(), VoxelIndex(0, 0, 0));
  EXPECT_EQ(none.at({1, 2, 3}), SpaceCell::kUnknown);
}

TEST(OccupancySnapshot, HoldsWhatLiesWithinItsReachAndNoMore) {
  VoxelMap map({.voxel_m = 0.5});
  VoxelBlocks& vertical = map.layer("upright");
  vertical.add({4, 4, 4}, to_evidence(-4));
  vertical.add({400, 4, 4}, to_evidence(-4));
  const OccupancySnapshot grid(map, kVertical, {2, 2, 2}, 30);
  EXPECT_EQ(grid.at({4, 4, 4}), SpaceCell::kMeasured);
  EXPECT_EQ(grid.at({400, 4, 4}), SpaceCell::kUnknown);
  EXPECT_EQ(grid.size(), VoxelIndex(16, 16, 16));
}

// ledger: S5-37
TEST(OccupancySnapshot, ColumnIsMeasuredWhereAllOfItIs) {
  VoxelMap map({.voxel_m = 0.5});
  for (int z = 2; z < 9; ++z) map.layer("upright").add({0, 0, z}, to_evidence(-4));  // 1.0 to 4.5 m
  const OccupancySnapshot grid(map, kVertical, {0, 0, 2}, 10);
  EXPECT_TRUE(grid.is_measured({0.2, 0.2, 2.7}, 1.6));
  EXPECT_FALSE(grid.is_measured({0.2, 0.2, 2.7}, 1.9));
  EXPECT_FALSE(grid.is_measured({0.2, 0.2, 1.2}, 0.3));
  EXPECT_FALSE(grid.is_measured({0.7, 0.2, 2.7}, 0.5)) << "beside it";
  map.layer("flat").add({0, 0, 5}, to_evidence(+8));
  EXPECT_FALSE(OccupancySnapshot(map, kVertical, {0, 0, 2}, 10).is_measured({0.2, 0.2, 2.7}, 1));
}

}  // namespace
}  // namespace isobath
