#include "array_field.hpp"
#include "measured_water.hpp"
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/world_snapshot.hpp>

namespace isobath::test {
namespace {

using Eigen::Vector3d;

/// 40 x 40 m of 20 m deep water around the origin, pixels of 1 m.
std::shared_ptr<ArrayField> deep_square() {
  return std::make_shared<ArrayField>(PixelGrid{{20, -20}, 1}, PixelWindow{0, 0, 40, 40}, 20.0);
}

std::shared_ptr<const OccupancySnapshot> snapshot_of(const MeasuredWater& water) {
  return std::make_shared<const OccupancySnapshot>(water.grid());
}

const std::vector<Vector3d> kEast = {{0, -10, 5}, {0, 10, 5}};

// ledger: S1-41, S5-32
TEST(WorldSnapshot, AWallOfVoxelsClosesWaterThatTheDepthMapCallsDeep) {
  MeasuredWater water;
  water.clear({-10, -10, 2}, {10, 10, 9});
  WorldSnapshot world{.depths = deep_square(), .voxels = snapshot_of(water)};
  const auto open = check_passage(world, kEast, {});
  ASSERT_TRUE(open);
  EXPECT_EQ(open->strict(), 1) << open->reason();

  water.occupy({-3, 2, 4}, {3, 3, 7});
  world.voxels = snapshot_of(water);
  const auto closed = check_passage(world, kEast, {});
  ASSERT_TRUE(closed && closed->blocking);
  EXPECT_EQ(*closed->blocking->depth_m, 4);
  EXPECT_NEAR(closed->blocking->along_m, 11, 1.01) << "the wall begins 12 m along, and the hull is 1 m on each side";
  EXPECT_EQ(closed->unknown, 0u);
}

TEST(WorldSnapshot, ASpanAboveTheVehicleAndARockBelowItCloseNothing) {
  MeasuredWater water;
  water.occupy({-5, -5, 0}, {5, 5, 3});
  water.occupy({-5, -5, 7.5}, {5, 5, 9});
  const WorldSnapshot world{.depths = deep_square(), .voxels = snapshot_of(water)};
  EXPECT_EQ(check_passage(world, kEast, {.clearance_m = 1})->strict(), 1);
  EXPECT_LT(check_passage(world, kEast, {.clearance_m = 3})->strict(), 1);
}

TEST(WorldSnapshot, WaterThatOnlyVoxelsHaveMeasuredIsKnownAsFarDownAsTheyWent) {
  MeasuredWater water;
  water.clear({-10, -12, 2}, {10, 12, 8});
  const WorldSnapshot world{.voxels = snapshot_of(water)};
  EXPECT_EQ(check_passage(world, kEast, {.clearance_m = 2})->strict(), 1);
  EXPECT_LT(check_passage(world, kEast, {.clearance_m = 4})->strict(), 1) << "8 m were measured, 9 m are needed";
  const std::vector<Vector3d> beyond = {{0, -10, 5}, {0, 18, 5}};
  const auto verdict = check_passage(world, beyond, {});
  EXPECT_GT(verdict->unknown, 0u);
  EXPECT_FALSE(verdict->blocking->depth_m) << "unknown water is not clear, and nothing stands in it";
}

TEST(WorldSnapshot, WithoutMapsAllIsUnknown) {
  const auto verdict = check_passage({}, kEast, {});
  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->unknown, verdict->pixels);
  EXPECT_EQ(verdict->clear, 0u);
}

TEST(WorldSnapshot, AShoalOfTheDepthMapStandsThoughVoxelsHaveMeasuredWater) {
  const auto field = deep_square();
  for (int column = 18; column < 22; ++column) field->set({column, 20}, 4.0);
  MeasuredWater water;
  water.clear({-10, -12, 2}, {10, 12, 8});
  const WorldSnapshot world{.depths = field, .voxels = snapshot_of(water)};
  EXPECT_EQ(*check_passage(world, kEast, {})->blocking->depth_m, 4);
}

TEST(WorldSnapshot, AFewVoxelsAloneCloseNothing) {
  MeasuredWater water;
  water.occupy({0, 0, 5}, {0.5, 1, 5.5});
  WorldSnapshot world{.depths = deep_square(), .voxels = snapshot_of(water)};
  EXPECT_EQ(check_passage(world, kEast, {})->strict(), 1) << "two voxels";
  water.occupy({0, 0, 5}, {0.5, 1, 6});
  world.voxels = snapshot_of(water);
  EXPECT_LT(check_passage(world, kEast, {})->strict(), 1) << "four";
}

// Against every voxel, one by one.
TEST(WorldField, HasTheShoalerOfDepthMapAndVoxelsInEachPixel) {
  Random random(11);
  const auto below = [&](double count) { return std::floor(random.uniform(0, count)); };
  for (int round = 0; round < 20; ++round) {
    const auto field = deep_square();
    MeasuredWater water;
    for (int i = 0; i < 12; ++i) {
      const Vector3d low(0.5 * below(50) - 12, 0.5 * below(50) - 12, 0.5 * below(30));
      water.occupy(low, low + Vector3d(1 + below(3), 1 + below(3), 1 + below(3)));
      field->set({static_cast<int>(below(40)), static_cast<int>(below(40))}, 1.0 + below(10));
    }
    const auto voxels = snapshot_of(water);
    const DepthBand band{4, 8};
    const WorldField world({.depths = field, .voxels = voxels}, band);
    for (int row = 0; row < 40; ++row) {
      for (int column = 0; column < 40; ++column) {
        const Eigen::Vector2d centre = field->grid().centre({column, row});
        double wanted = field->at({column, row}).depth_m();
        for (double north = centre.x() - 0.25; north < centre.x() + 0.5; north += 0.5) {
          for (double east = centre.y() - 0.25; east < centre.y() + 0.5; east += 0.5) {
            for (double down = band.top_m + 0.25; down < band.bottom_m; down += 0.5) {
              if (voxels->at(floor_of(Vector3d(north, east, down) / 0.5)) != SpaceCell::kOccupied) continue;
              wanted = std::min(wanted, down - 0.25);
            }
          }
        }
        ASSERT_NEAR(world.at({column, row}).depth_m(), wanted, 0.005) << row << ' ' << column;
      }
    }
  }
}

}  // namespace
}  // namespace isobath::test
