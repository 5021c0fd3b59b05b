// A* against searches without any cleverness, on random maps; the printed listing's mistakes, one by one.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/grid_search.hpp>
#include <set>

namespace isobath {
namespace {

constexpr std::int32_t kWide = 31, kHigh = 23;
constexpr std::size_t kCells = static_cast<std::size_t>(kWide) * kHigh;

/// Blocked cells, and what it costs to be in the others: 1 or more.
struct Meadow {
  std::vector<bool> blocked = std::vector<bool>(kCells, false);
  std::vector<double> factor = std::vector<double>(kCells, 1);

  [[nodiscard]] bool enterable(std::size_t /*from*/, std::size_t to, std::size_t /*step*/) const {
    return !blocked[to];
  }
  /// No corner is cut.
  [[nodiscard]] bool passable(std::size_t from, std::size_t step) const {
    const GridStep s = kGridSteps[step];
    if (step < 4) return true;
    const auto at = static_cast<std::int64_t>(from);
    return !blocked[static_cast<std::size_t>(at + s.column)] && !blocked[static_cast<std::size_t>(at + s.row * kWide)];
  }
  [[nodiscard]] double step_cost(std::size_t from, std::size_t to, std::size_t step) const {
    return step_length(step) * (factor[from] + factor[to]) / 2;
  }
};

Meadow random_meadow(Random& random, double share, bool even) {
  Meadow meadow;
  for (std::size_t i = 0; i < kCells; ++i) {
    meadow.blocked[i] = random.uniform() < share;
    if (!even) meadow.factor[i] = random.uniform(1, 3);
  }
  return meadow;
}

template <class Visit>
void for_neighbours(const Meadow& meadow, std::size_t from, const Visit& visit) {
  const auto column = static_cast<std::int32_t>(from % kWide), row = static_cast<std::int32_t>(from / kWide);
  for (std::size_t step = 0; step < 8; ++step) {
    const std::int32_t c = column + kGridSteps[step].column, r = row + kGridSteps[step].row;
    if (c < 0 || c >= kWide || r < 0 || r >= kHigh) continue;
    const std::size_t to = static_cast<std::size_t>(r) * kWide + static_cast<std::size_t>(c);
    if (!meadow.blocked[to] && meadow.passable(from, step)) visit(to, meadow.step_cost(from, to, step));
  }
}

/// Dijkstra, by a set ordered by cost.
std::vector<double> costs_from(const Meadow& meadow, std::size_t start) {
  std::vector<double> cost(kCells, INFINITY);
  std::set<std::pair<double, std::size_t>> open = {{0, start}};
  cost[start] = 0;
  while (!open.empty()) {
    const std::size_t best = open.begin()->second;
    open.erase(open.begin());
    for_neighbours(meadow, best, [&](std::size_t to, double by) {
      if (cost[best] + by >= cost[to]) return;
      open.erase({cost[to], to});
      cost[to] = cost[best] + by;
      open.insert({cost[to], to});
    });
  }
  return cost;
}

// ledger: S6-48
TEST(GridSearch, CostsWhatDijkstraCosts) {
  Random random(1);
  int reached = 0, none = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Meadow meadow = random_meadow(random, random.uniform(0, 0.45), trial % 2 == 0);
    const std::size_t start = random.index(kCells);
    const std::size_t goal = random.index(kCells);
    meadow.blocked[start] = meadow.blocked[goal] = false;
    const std::vector<double> expected = costs_from(meadow, start);
    GridSearch<Meadow> search(meadow, kWide, kHigh, 1);
    const GridOutcome outcome = search.run(start, goal, 1'000'000);
    if (!std::isfinite(expected[goal])) {
      ++none;
      ASSERT_EQ(outcome, GridOutcome::kNoPath);
      // All that can be reached was looked at, each cell once.
      std::int64_t reachable = 0;
      for (const double c : expected) reachable += std::isfinite(c);
      ASSERT_EQ(search.expanded(), reachable);
      continue;
    }
    ++reached;
    ASSERT_EQ(outcome, GridOutcome::kReached);
    ASSERT_NEAR(search.cost(goal), expected[goal], 1e-9);
    // The path is one: from start to goal by possible steps, and costs what it says.
    const std::vector<std::size_t> path = search.path_to(goal);
    ASSERT_EQ(path.front(), start);
    ASSERT_EQ(path.back(), goal);
    double sum = 0;
    for (std::size_t i = 1; i < path.size(); ++i) {
      bool possible = false;
      for_neighbours(meadow, path[i - 1], [&](std::size_t to, double by) {
        if (to != path[i]) return;
        possible = true;
        sum += by;
      });
      ASSERT_TRUE(possible);
    }
    ASSERT_NEAR(sum, expected[goal], 1e-9);
  }
  EXPECT_GT(reached, 150);
  EXPECT_GT(none, 20);
}

// With a consistent heuristic no cell is expanded twice, and none that costs more than the goal.
// ledger: S6-48
TEST(GridSearch, TheHeuristicIsConsistent) {
  Random random(2);
  for (int trial = 0; trial < 100; ++trial) {
    Meadow meadow = random_meadow(random, 0.2, false);
    const std::size_t start = random.index(kCells);
    const std::size_t goal = random.index(kCells);
    meadow.blocked[start] = meadow.blocked[goal] = false;
    const std::vector<double> cost = costs_from(meadow, start);
    GridSearch<Meadow> search(meadow, kWide, kHigh, 1);
    if (search.run(start, goal, 1'000'000) != GridOutcome::kReached) continue;
    std::int64_t no_dearer = 0;
    for (const double c : cost) no_dearer += c <= cost[goal] + 1e-9;
    ASSERT_LE(search.expanded(), no_dearer);
  }
}

// The printed listing returns failure within the loop, after the first cell that is not the goal: here the first that
// the search looks at ends in a pocket. ledger: S6-E09
TEST(GridSearch, ADeadEndIsNoFailure) {
  Meadow meadow;
  for (std::int32_t row = 5; row <= 17; ++row) meadow.blocked[static_cast<std::size_t>(row) * kWide + 15] = true;
  for (std::int32_t column = 5; column < 15; ++column) {
    meadow.blocked[5 * kWide + static_cast<std::size_t>(column)] = true;
    meadow.blocked[17 * kWide + static_cast<std::size_t>(column)] = true;
  }
  const std::size_t start = 11 * kWide + 10, goal = 11 * kWide + 20;
  GridSearch<Meadow> search(meadow, kWide, kHigh, 1);
  ASSERT_EQ(search.run(start, goal, 1'000'000), GridOutcome::kReached);
  EXPECT_NEAR(search.cost(goal), costs_from(meadow, start)[goal], 1e-9);
}

// The printed listing never puts a neighbour that it finds into the open set: nothing beyond the start's neighbours
// would ever be seen. ledger: S6-E09
TEST(GridSearch, WhatIsFoundIsOpened) {
  const Meadow meadow;
  GridSearch<Meadow> search(meadow, kWide, kHigh, 1);
  ASSERT_EQ(search.run(0, kCells - 1, 1'000'000), GridOutcome::kReached);
  EXPECT_EQ(search.path_to(kCells - 1).size(), 31u);
  EXPECT_NEAR(search.cost(kCells - 1), 22 * std::numbers::sqrt2 + 8, 1e-9);
}

// A neighbour that is open already is updated where a cheaper way to it is found. ledger: S6-E09
TEST(GridSearch, WhatIsOpenIsUpdated) {
  Meadow meadow;
  for (std::size_t row = 0; row < kHigh; ++row) meadow.factor[row * kWide + 1] = 50;
  meadow.factor[22 * kWide + 1] = 1;  // dear but for the last row
  const std::size_t start = 0, goal = 2;
  GridSearch<Meadow> search(meadow, kWide, kHigh, 1);
  ASSERT_EQ(search.run(start, goal, 1'000'000), GridOutcome::kReached);
  EXPECT_NEAR(search.cost(goal), costs_from(meadow, start)[goal], 1e-9);
  EXPECT_LT(search.cost(goal), 50);
}

// ledger: S6-48
TEST(GridSearch, KeepsToItsBudget) {
  const Meadow meadow;
  GridSearch<Meadow> search(meadow, kWide, kHigh, 1);
  EXPECT_EQ(search.run(0, kCells - 1, 5), GridOutcome::kOutOfBudget);
  EXPECT_EQ(search.expanded(), 5);
  GridSearch<Meadow> enough(meadow, kWide, kHigh, 1);
  EXPECT_EQ(enough.run(7, 7, 0), GridOutcome::kReached) << "there already";
  EXPECT_EQ(enough.path_to(7).size(), 1u);
}

// ledger: S6-48
TEST(GridSearch, OfEquallyCheapPathsItAlwaysTakesTheSame) {
  Random random(4);
  const Meadow meadow = random_meadow(random, 0.15, true);
  std::size_t start = 0, goal = kCells - 1;
  while (meadow.blocked[start]) ++start;
  while (meadow.blocked[goal]) --goal;
  std::vector<std::size_t> first;
  for (int i = 0; i < 3; ++i) {
    GridSearch<Meadow> search(meadow, kWide, kHigh, 1);
    ASSERT_EQ(search.run(start, goal, 1'000'000), GridOutcome::kReached);
    if (i == 0) first = search.path_to(goal);
    EXPECT_EQ(search.path_to(goal), first);
  }
}

}  // namespace
}  // namespace isobath
