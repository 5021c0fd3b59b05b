// Properties of the detector on random grids, against slow and obvious answers.
#include <algorithm>
#include <gtest/gtest.h>
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

// ledger: S6-28 S6-E19
TEST(DetectorProperty, DetectedCellsMatchASlowSum) {
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

TEST(DetectorProperty, EveryEvidentCellLiesInSomeOutline) {
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

// ledger: S6-29
TEST(DetectorProperty, ReportsInTheLevelBodyFrameOfTheMoment) {
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

}  // namespace
}  // namespace isobath
