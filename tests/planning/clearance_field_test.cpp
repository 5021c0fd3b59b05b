// What is open and what is closed in a box of water, and how far it is to what is closed.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/clearance_field.hpp>
#include <tests/planning/measured_water.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::MeasuredWater;

Hazard block(double north, double east, double half, HazardKind kind = HazardKind::kSeen) {
  return {{{north - half, east - half},
           {north + half, east - half},
           {north + half, east + half},
           {north - half, east + half}},
          0,
          kind,
          0};
}

ClearanceTask box(const Vector3d& least, const Vector3d& most) {
  ClearanceTask task;
  task.least = least;
  task.most = most;
  task.shallow_m = least.z() - 1;
  task.deep_m = most.z() + 1;
  return task;
}

bool is_closed(const ClearanceField& room, const Vector3d& p) { return room.distance(room.voxel_at(p)) == 0; }

// ledger: S5-36
TEST(ClearanceField, DistanceIsThatToTheNearestFaceOfWhatIsClosed) {
  MeasuredWater water;
  Random random(3);
  std::vector<VoxelIndex> closed;
  for (int i = 0; i < 60; ++i) {
    const VoxelIndex v(static_cast<int>(random.index(40)), static_cast<int>(random.index(30)),
                       static_cast<int>(random.index(16)));
    water.occupy(v.cast<double>() * 0.5, (v + VoxelIndex::Ones()).cast<double>() * 0.5);
    closed.push_back(v);
  }
  ClearanceTask task = box({0.1, 0.1, 0.1}, {19.9, 14.9, 7.9});
  task.max_m = 4;
  const ClearanceField room(water.grid(), task);
  ASSERT_EQ(room.size(), VoxelIndex(40, 30, 16));
  for (int i = 0; i < 3000; ++i) {
    const VoxelIndex v(static_cast<int>(random.index(40)), static_cast<int>(random.index(30)),
                       static_cast<int>(random.index(16)));
    double least = 4;
    for (const VoxelIndex& c : closed) {
      const Vector3d off = (((v - c).cwiseAbs().cast<double>().array() - 0.5).max(0.0) * 0.5).matrix();
      least = std::min(least, v == c ? 0.0 : off.norm());
    }
    ASSERT_NEAR(room.distance(v), least, 1e-6) << v.transpose();
    ASSERT_NEAR(room.distance(room.centre_of(v)), least, 1e-6) << "at a centre nothing is interpolated";
  }
}

// ledger: S5-33 S5-35
TEST(ClearanceField, AHazardOfThePlaneIsClosedButWhereItsWaterWasMeasured) {
  MeasuredWater water;
  water.clear({0, -10, 0}, {40, 10, 3});
  water.clear_flat({0, -10, 3}, {40, 10, 6});
  ClearanceTask task = box({0, -10, 0.1}, {40, 10, 7.9});
  const std::vector<Hazard> hazards = {block(20, 0, 3)};
  task.hazards = hazards;
  const ClearanceField room(water.grid(), task);
  EXPECT_FALSE(is_closed(room, {20, 0, 2})) << "measured";
  EXPECT_TRUE(is_closed(room, {20, 0, 4})) << "free by a fan that tells no height";
  EXPECT_TRUE(is_closed(room, {20, 0, 7})) << "never looked at";
  EXPECT_FALSE(is_closed(room, {30, 0, 7})) << "no hazard";
}

TEST(ClearanceField, AFenceAndAChartedObstacleStayClosed) {
  MeasuredWater water;
  water.clear({0, -10, 0}, {60, 10, 8});
  ClearanceTask task = box({0, -10, 0.1}, {60, 10, 7.9});
  const std::vector<Hazard> hazards = {block(20, 0, 2, HazardKind::kCharted),
                                       {{{40, -10}, {40, 10}}, -2, HazardKind::kFence, 0},
                                       block(50, 0, 2, HazardKind::kRemembered)};
  task.hazards = hazards;
  const ClearanceField room(water.grid(), task);
  EXPECT_TRUE(is_closed(room, {20, 0, 2}));
  for (double east = -9.75; east < 10; east += 0.5)
    EXPECT_TRUE(is_closed(room, {40.2, east, 2})) << "a line without gaps";
  EXPECT_FALSE(is_closed(room, {50, 0, 2}));
}

// ledger: S5-39
TEST(ClearanceField, OffTheDepthsOfTheMissionOnlyMeasuredWaterIsOpen) {
  MeasuredWater water;
  water.clear({10, -2, 0}, {20, 2, 8});
  ClearanceTask task = box({0, -10, 0.1}, {40, 10, 11.9});
  task.shallow_m = 2;
  task.deep_m = 5;
  const ClearanceField room(water.grid(), task);
  EXPECT_FALSE(is_closed(room, {30, 0, 3})) << "in the band";
  EXPECT_TRUE(is_closed(room, {30, 0, 7}));
  EXPECT_TRUE(is_closed(room, {30, 0, 0.7}));
  EXPECT_FALSE(is_closed(room, {15, 0, 7})) << "measured";
  EXPECT_TRUE(is_closed(room, {15, 0, 9})) << "below what was measured";
}

// ledger: S5-45
TEST(ClearanceField, WhatIsNotMeasuredMayStayOpenFartherOff) {
  MeasuredWater water;
  water.clear({0, -2, 0}, {10, 2, 8});
  water.occupy({32, -1, 2}, {33, 1, 4});
  ClearanceTask task = box({0, -10, 0.1}, {60, 10, 7.9});
  const std::vector<Hazard> hazards = {block(15, 0, 2), block(32, 0, 4), block(50, 0, 2, HazardKind::kCharted)};
  task.hazards = hazards;
  task.look_on_m = 20;
  task.vehicle_W = {2, 0, 3};
  const ClearanceField room(water.grid(), task);
  EXPECT_TRUE(is_closed(room, {15, 0, 3})) << "too near not to know";
  EXPECT_TRUE(room.is_unsure({30, 0, 3}));
  EXPECT_FALSE(is_closed(room, {30, 0, 3}));
  EXPECT_TRUE(is_closed(room, {32.5, 0, 3})) << "there is something";
  EXPECT_TRUE(is_closed(room, {50, 0, 3})) << "charted";
  EXPECT_FALSE(room.is_unsure({5, 0, 3}));
}

// ledger: S5-45
TEST(ClearanceField, WhatHangsTogetherIsAsNearAsItsNearestPart) {
  const OccupancySnapshot nothing = MeasuredWater().grid();
  ClearanceTask task = box({0, -40, 0.1}, {60, 40, 7.9});
  const std::vector<Hazard> hazards = {block(20, 0, 2), block(20, 6, 2), block(20, 13, 2), block(20, 30, 2)};
  task.hazards = hazards;
  task.vehicle_W = {0, 0, 3};
  task.look_on_m = 18.5;
  task.apart_m = 3;
  const ClearanceField room(nothing, task);
  EXPECT_TRUE(is_closed(room, {20, 0, 3})) << "18 m off";
  EXPECT_TRUE(is_closed(room, {20, 6, 3})) << "18.4 m off";
  EXPECT_TRUE(is_closed(room, {20, 13, 3})) << "21 m off, 3 m beside a near one";
  EXPECT_TRUE(room.is_unsure({20, 30, 3})) << "13 m beside the others";
}

/// Water that is open between 2 and 6 m and, in places, deeper, with things in it, on many tiles.
struct ManyTiles {
  ManyTiles() {
    water.clear({0, -24, 0}, {90, 24, 7});
    water.clear({60, -10, 7}, {80, 10, 11});
    Random random(17);
    for (int i = 0; i < 25; ++i) {
      const double north = static_cast<int>(random.index(170)) * 0.5,
                   east = static_cast<int>(random.index(90)) * 0.5 - 23;
      const double depth = static_cast<int>(random.index(12)) * 0.5;
      water.occupy({north, east, depth}, {north + 1, east + 1, depth + 1});
    }
    task = box({0, -24.9, 0.1}, {89.9, 24.9, 15.9});
    task.shallow_m = 2;
    task.deep_m = 6;
    task.hazards = hazards;
    task.look_on_m = 30;
  }
  MeasuredWater water;
  std::vector<Hazard> hazards = {block(20, -23, 4), block(70, 22, 5)};
  ClearanceTask task;
};

// Distances across the borders of tiles, by 16 bits and by floats, against all closed voxels one by one; what lies
// above and below the room's layers is closed, too, and changes none. ledger: S5-36
TEST(ClearanceField, MeasuresAcrossTilesAndToTheEndsOfItsLayers) {
  ISOBATH_NOT_SANITIZED();
  ManyTiles tiles;
  for (const double most : {3.0, 40.0}) {
    tiles.task.max_m = most;
    const ClearanceField room(tiles.water.grid(), tiles.task);
    const int first = room.voxel_at({0, 0, 0.1}).z(), last = room.voxel_at({0, 0, 15.9}).z();
    ASSERT_LT(room.size().z(), last - first + 1) << "layers in which all is closed are left out";
    std::vector<VoxelIndex> closed;
    VoxelIndex v;
    for (v.x() = 0; v.x() < room.size().x(); ++v.x()) {
      for (v.y() = 0; v.y() < room.size().y(); ++v.y()) {
        for (v.z() = first; v.z() <= last; ++v.z()) {
          if (room.distance(v) == 0) closed.push_back(v);
        }
      }
    }
    Random random(18);
    for (int i = 0; i < 40; ++i) {
      v = VoxelIndex(static_cast<int>(random.index(180)), static_cast<int>(random.index(100)),
                     static_cast<int>(random.index(static_cast<std::size_t>(room.size().z()))));
      int least = 1 << 30;  // square of the distance to a face, in halves of a voxel
      for (const VoxelIndex& c : closed) {
        const VoxelIndex off = (2 * (v - c).cwiseAbs().array() - 1).max(0);
        least = std::min(least, off.squaredNorm());
      }
      ASSERT_NEAR(room.distance(v), std::min(most, 0.25 * std::sqrt(least)), 1e-5) << v.transpose();
    }
  }
}

// Whoever asks first, a place within a tile is interpolated as one on its border is; and a way is held against the
// whole box, not against the layers that can be open.
TEST(ClearanceField, SaysTheSameWhateverWasAskedBefore) {
  const ManyTiles tiles;
  const ClearanceField room(tiles.water.grid(), tiles.task);
  Random random(19);
  for (int i = 0; i < 500; ++i) {
    Vector3d p;
    p.x() = random.uniform(0, 90);
    p.y() = random.uniform(-25, 25);
    p.z() = random.uniform(0, 12);
    double sum = 0;
    const Vector3d at = p / 0.5 - Vector3d::Constant(0.5);
    const VoxelIndex low = floor_of(at), first = room.voxel_at(low.cast<double>() * 0.5 + Vector3d::Constant(0.25));
    for (int corner = 0; corner < 8; ++corner) {
      const VoxelIndex step(corner & 1, corner >> 1 & 1, corner >> 2);
      double weight = 1;
      for (int a = 0; a < 3; ++a) weight *= 1 - std::abs(at[a] - low[a] - step[a]);
      sum += weight * room.distance(VoxelIndex(first + step));
    }
    ASSERT_NEAR(room.distance(p), sum, 1e-6) << p.transpose();
    if (i % 50 == 0) {
      const ClearanceField fresh(tiles.water.grid(), tiles.task);
      ASSERT_EQ(fresh.distance(p), room.distance(p));
    }
  }
  EXPECT_TRUE(room.holds({40, 0, 14})) << "closed, but of the box";
  EXPECT_EQ(room.distance(Vector3d(40, 0, 14)), 0);
  EXPECT_FALSE(room.holds({40, 0, 17}));
}

// What is known is the room in which nobody looks on.
// ledger: S5-45
TEST(ClearanceField, OfWhatIsKnownIsThatWithoutLookingOn) {
  ManyTiles tiles;
  const ClearanceField hoped(tiles.water.grid(), tiles.task);
  EXPECT_TRUE(hoped.has_unsure());
  const ClearanceField known = hoped.of_what_is_known();
  EXPECT_FALSE(known.has_unsure());
  tiles.task.look_on_m = 0;
  const ClearanceField never(tiles.water.grid(), tiles.task);
  EXPECT_FALSE(never.has_unsure());
  ASSERT_EQ(known.size(), never.size());
  int differ = 0;
  VoxelIndex v;
  for (v.x() = 0; v.x() < known.size().x(); ++v.x()) {
    for (v.y() = 0; v.y() < known.size().y(); ++v.y()) {
      for (v.z() = 0; v.z() < known.size().z(); ++v.z()) {
        ASSERT_EQ(known.distance(v), never.distance(v)) << v.transpose();
        differ += hoped.distance(v) != known.distance(v) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(differ, 100);
}

TEST(ClearanceField, RefusesABoxThatNoMemoryHolds) {
  const OccupancySnapshot nothing = MeasuredWater().grid();
  EXPECT_THROW(ClearanceField(nothing, box({0, 0, 0}, {1e4, 1e4, 100})), Error);
  EXPECT_THROW(ClearanceField(nothing, box({0, 0, 0}, {-10, 10, 10})), Error);
}

}  // namespace
}  // namespace isobath
