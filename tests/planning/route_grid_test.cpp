// Which steps are open: against the exact check of each, and the paper's coarse cells in every alignment.
#include <gtest/gtest.h>
#include <isobath/planning/route_grid.hpp>
#include <tests/planning/random_hazards.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

std::optional<std::size_t> beside(const RouteWindow& w, std::size_t cell, std::size_t step) {
  return w.at(w.centre(cell) + w.cell_m * Vector2d(kGridSteps[step].column, kGridSteps[step].row));
}

// Every step of random maps; hazards smaller than a cell and larger than many, half of them beyond the window's edge.
// ledger: S6-47 S6-49
TEST(RouteGrid, AStepIsOpenWhereItKeepsTheClearance) {
  ISOBATH_NOT_SANITIZED();
  Random random(1);
  std::int64_t open = 0, closed = 0, close_calls = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const HazardMap map(test::random_hazards(random, 25, 16, trial % 3 == 0 ? 0.2 : 5));
    const double cell = random.uniform(0.4, 1.5);
    const double x = random.uniform(-12, -8);
    const double y = random.uniform(-12, -8);
    const RouteWindow window{{x, y}, cell, 21, 17};
    const double reach = trial % 4 == 0 ? 0.05 : random.uniform(0.2, 2);
    const RouteGrid grid = RouteGrid::exact(map, window, reach);
    for (std::size_t i = 0; i < window.size(); ++i) {
      const double away = map.distance(window.centre(i)) - reach;
      if (std::abs(away) > 1e-6) {
        ASSERT_EQ(grid.blocked(i), away < 0);
      }
      for (std::size_t step = 0; step < 8; ++step) {
        const auto to = beside(window, i, step);
        if (!to) continue;
        const double kept = map.leg_distance(window.centre(i), window.centre(*to)) - reach;
        if (std::abs(kept) < 1e-6) {
          ++close_calls;
          continue;
        }
        ASSERT_EQ(grid.open(i, step), kept > 0) << "cell " << i << " step " << step << " keeps " << kept;
        ASSERT_EQ(grid.open(i, step), grid.open(*to, opposite(step)));
        ++(kept > 0 ? open : closed);
      }
    }
  }
  EXPECT_GT(open, 10000);
  EXPECT_GT(closed, 10000);
  EXPECT_LT(close_calls, 10);
}

// A hazard without size between cell centres closes the steps past it, and no centre.
// ledger: S6-47
TEST(RouteGrid, SeesWhatLiesBetweenCentres) {
  const HazardMap map({{{{0.5, 0.5}}, 0, HazardKind::kSeen, 0}});
  const RouteGrid grid = RouteGrid::exact(map, {{0, 0}, 1, 2, 2}, 0.1);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_FALSE(grid.blocked(i));
  EXPECT_TRUE(grid.open(0, 1));
  EXPECT_FALSE(grid.open(0, 5)) << "the diagonal through it";
  EXPECT_FALSE(grid.open(1, 6)) << "the other one";
}

// A square cell is blocked where a hazard touches it, wherever the hazard lies.
// ledger: S6-44 S6-E17
TEST(RouteGrid, CoarseCellsAreBlockedWhereAHazardTouchesThem) {
  const RouteWindow window{{0, 0}, 5, 9, 9};
  const auto blocked = [&](const Polygon& outline, double reach) {
    const HazardMap map({{outline, 0, HazardKind::kSeen, 0}});
    const RouteGrid grid = RouteGrid::coarse(map, window, reach, false);
    int count = 0;
    for (std::size_t i = 0; i < window.size(); ++i) count += grid.blocked(i);
    return count;
  };
  EXPECT_EQ(blocked({{20, 20}}, 0), 1);
  EXPECT_EQ(blocked({{22.5, 20}}, 0), 2) << "on an edge it touches both";
  EXPECT_EQ(blocked({{22.5, 22.5}}, 0), 4);
  EXPECT_EQ(blocked({{20, 20}, {30, 20}}, 0), 3);
  EXPECT_EQ(blocked({{12, 12}, {28, 12}, {28, 28}, {12, 28}}, 0), 25) << "large enough to hold whole cells";
  EXPECT_EQ(blocked({{20, 20}}, 5), 9) << "a disc of 5 m reaches the eight around by 2.5 m";
  // So an obstacle grows by anything between nothing and a cell on a side: not uniform.
  EXPECT_EQ(blocked({{17.6, 17.6}, {22.4, 17.6}, {22.4, 22.4}, {17.6, 22.4}}, 0), 1);
  EXPECT_EQ(blocked({{17.4, 17.4}, {22.6, 17.4}, {22.6, 22.6}, {17.4, 22.6}}, 0), 9);
}

// ledger: S6-49
TEST(RouteGrid, NoDiagonalPastABlockedCell) {
  const RouteWindow window{{0, 0}, 5, 3, 3};
  const HazardMap one({{{{5, 0}}, 0, HazardKind::kSeen, 0}});  // the cell at (1, 0)
  EXPECT_FALSE(RouteGrid::coarse(one, window, 0, false).open(0, 5)) << "past one";
  EXPECT_TRUE(RouteGrid::coarse(one, window, 0, false).open(0, 2));
  EXPECT_TRUE(RouteGrid::coarse(one, window, 0, true).open(0, 5)) << "as printed";
  const HazardMap two({{{{5, 0}}, 0, HazardKind::kSeen, 0}, {{{0, 5}}, 0, HazardKind::kSeen, 1}});
  EXPECT_FALSE(RouteGrid::coarse(two, window, 0, false).open(0, 5)) << "between two";
}

TEST(RouteGrid, RoomIsCheaper) {
  const HazardMap map({{{{0, 0}}, 0, HazardKind::kSeen, 0}});
  RouteGrid grid = RouteGrid::exact(map, {{-20, -20}, 1, 41, 41}, 2);
  grid.prefer_room(6, 0.5);
  const auto cost = [&](double x, double y) { return grid.leg_cost({x, y}, {x, y + 0.1}) / 0.1; };
  EXPECT_NEAR(cost(0, 0), 1.5, 1e-9);
  EXPECT_NEAR(cost(5, 0), 1 + 0.5 * (1 - 3.0 / 6), 0.1) << "3 m beyond the clearance";
  EXPECT_EQ(cost(12, 0), 1);
  for (double x = 0; x < 15; ++x) EXPECT_GE(cost(x, 0), cost(x + 1, 0));
}

}  // namespace
}  // namespace isobath
