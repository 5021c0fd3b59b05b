#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/obstacle_detector.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

BodyGrid grid_of(int cells, double cell_m = 1) {
  BodyGridConfig config;
  config.cell_m = cell_m;
  config.cells_x = config.cells_y = cells;
  return BodyGrid(config);
}

std::vector<Obstacle> obstacles_in(const BodyGrid& grid) { return ObstacleDetector().detect(grid, {}, {}).obstacles; }

// ledger: S6-24 S6-E23
TEST(ObstacleDetector, UnseenWaterIsNoObstacle) {
  const BodyGrid grid = grid_of(40);
  EXPECT_TRUE(obstacles_in(grid).empty());
}

// ledger: S6-28 S6-E19
TEST(ObstacleDetector, DetectedCellsMatchASlowSum) {
  Random random(5);
  for (int run = 0; run < 20; ++run) {
    BodyGrid grid = grid_of(12);
    for (std::size_t i = 0; i < grid.cells().size(); ++i) {
      grid.set_probability(grid.cells().cell(i), random.uniform(0.001, 0.2));
    }
    const Detection found = ObstacleDetector().detect(grid, {}, {});
    for (int x = 0; x < 12; ++x) {
      for (int y = 0; y < 12; ++y) {
        double n = 0;
        for (int i = std::max(0, x - 1); i <= std::min(11, x + 1); ++i) {
          for (int j = std::max(0, y - 1); j <= std::min(11, y + 1); ++j) n += grid.probability({i, j});
        }
        ASSERT_EQ(found.detected[grid.cells().index({x, y})] != 0, n >= 0.8);
      }
    }
  }
}

// ledger: S6-28 S6-E19
TEST(ObstacleDetector, ExactlyTheThresholdDetects) {
  BodyGridConfig config;
  config.cells_x = config.cells_y = 20;
  config.prior = 1e-9;
  config.p_min = 1e-12;
  BodyGrid grid(config);
  grid.set_probability({5, 5}, 0.8 - 8e-9);  // with eight cells of 1e-9 about it: 0.8
  EXPECT_EQ(obstacles_in(grid).size(), 1u);
  grid.set_probability({5, 5}, 0.79);
  EXPECT_TRUE(obstacles_in(grid).empty());
}

// ledger: S6-28
TEST(ObstacleDetector, TwoHalfBelievedNeighboursAreOneObstacle) {
  BodyGrid grid = grid_of(20);
  grid.set_probability({3, 3}, 0.4);
  grid.set_probability({3, 4}, 0.4);
  const auto found = obstacles_in(grid);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(area(found[0].outline), 2, 1e-9) << "the outline holds the two cells and no more";
  EXPECT_NEAR(found[0].existence, 1 - 0.6 * 0.6 * std::pow(0.99, 10), 0.02);
}

// ledger: S6-28
TEST(ObstacleDetector, BlockAtTheBorderHasTheCellsThatExist) {
  BodyGrid grid = grid_of(20);
  grid.set_probability({0, 0}, 0.9);
  EXPECT_EQ(obstacles_in(grid).size(), 1u);
  grid.set_probability({0, 0}, 0.71);
  EXPECT_TRUE(obstacles_in(grid).empty());
}

// ledger: S6-29
TEST(ObstacleDetector, ReportsInTheLevelBodyFrameOfTheMoment) {
  BodyGrid grid = grid_of(60);
  const auto cell = grid.cell_at({10.5, 0.2});
  ASSERT_TRUE(cell);
  grid.set_probability(*cell, 0.99);
  ASSERT_EQ(obstacles_in(grid).size(), 1u);
  const Obstacle before = obstacles_in(grid)[0];
  EXPECT_NEAR(before.range_m, 10, 0.51);
  grid.move({4, 0}, Angle::degrees(90), Eigen::Matrix2d::Zero());  // forward, then a right turn: now abeam to port
  const Obstacle after = obstacles_in(grid)[0];
  EXPECT_NEAR(after.bearing.degrees(), 270, 6);
  EXPECT_NEAR(after.range_m, before.range_m - 4, 1e-9);
  EXPECT_NEAR(area(after.outline), 1, 1e-9);
  for (const Vector2d& p : after.outline) EXPECT_LT(p.y(), 0);
}

TEST(ObstacleDetector, RingOfWallsKeepsItsWaterFree) {
  BodyGrid grid = grid_of(80, 0.25);
  for (int i = 10; i <= 70; ++i) {
    for (const Cell c : {Cell{10, i}, Cell{70, i}, Cell{i, 10}, Cell{i, 70}}) grid.set_probability(c, 0.98);
  }
  const auto found = obstacles_in(grid);
  EXPECT_GE(found.size(), 4u);
  double total = 0;
  for (const Obstacle& o : found) {
    total += area(o.outline);
    EXPECT_FALSE(contains(o.outline, Vector2d(0, 0)));
    EXPECT_GT(o.range_m, 7);
  }
  EXPECT_LT(total, 2 * 240 * 0.0625) << "not much more than the 240 cells of the ring";
}

TEST(ObstacleDetector, EveryEvidentCellLiesInSomeOutline) {
  Random random(9);
  for (int run = 0; run < 20; ++run) {
    BodyGrid grid = grid_of(50);
    std::vector<Cell> occupied;
    for (int i = 0; i < 120; ++i) {
      occupied.push_back({static_cast<int>(random.index(50)), static_cast<int>(random.index(50))});
      grid.set_probability(occupied.back(), 0.95);
    }
      const auto found = obstacles_in(grid);
    for (const Cell c : occupied) {
      const Vector2d p = grid.to_level_body(grid.cells().centre(c));
      EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const Obstacle& o) { return contains(o.outline, p); }));
    }
  }
}

TEST(ObstacleDetector, MarksWhatANearerObstacleHidesAndItsMultiples) {
  BodyGrid grid = grid_of(200, 0.1);
  const auto wall = [&](double range) {
    for (double y = -1.5; y <= 1.5; y += 0.05) grid.set_probability(*grid.cell_at({range, y * range / 2}), 0.98);
  };
  wall(2);
  wall(4);
  wall(5.2);
  grid.set_probability(*grid.cell_at({-3, 0}), 0.98);  // astern: nothing before it
  int multiples = 0, hidden = 0;
  for (const Obstacle& o : obstacles_in(grid)) {
    if (o.nearest.x() < 2.2) {
      EXPECT_FALSE(o.behind);
    } else {
      ++hidden;
      EXPECT_TRUE(o.behind);
      EXPECT_EQ(o.possible_multiple, o.nearest.x() < 5) << o.range_m;
      multiples += o.possible_multiple;
    }
  }
  EXPECT_GE(multiples, 1);
  EXPECT_GT(hidden, multiples);
}

TEST(ObstacleDetector, NearestComesFirstAndTwiceIsTheSame) {
  BodyGrid grid = grid_of(50);
  Random random(2);
  for (int i = 0; i < 60; ++i) {
    grid.set_probability({static_cast<int>(random.index(50)), static_cast<int>(random.index(50))}, 0.9);
  }
  const auto first = obstacles_in(grid);
  for (std::size_t i = 1; i < first.size(); ++i) EXPECT_LE(first[i - 1].range_m, first[i].range_m);
  const auto second = obstacles_in(grid);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].outline, second[i].outline);
}

}  // namespace
}  // namespace isobath
