// Multi-objective A* against the enumeration of all paths.
#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/planning/roadmap/pareto_search.hpp>
#include <set>

namespace isobath::roadmap_pareto_test {
namespace {

using Eigen::Vector2d;

bool dominated(const CostVector& worse, const CostVector& better) {
  return worse != better && better[0] <= worse[0] && better[1] <= worse[1] && better[2] <= worse[2];
}

/// The costs of all simple paths that no other dominates.
std::set<CostVector> enumerated(int nodes, const std::vector<CostArc>& arcs, int from, int to) {
  std::set<CostVector> all;
  std::vector<char> used(static_cast<std::size_t>(nodes), 0);
  const std::function<void(int, CostVector)> extend = [&](int node, const CostVector& cost) {
    if (node == to) {
      all.insert(cost);
      return;
    }
    used[static_cast<std::size_t>(node)] = 1;
    for (const CostArc& arc : arcs) {
      if (arc.from != node || used[static_cast<std::size_t>(arc.to)]) continue;
      extend(arc.to, {cost[0] + arc.cost[0], cost[1] + arc.cost[1], cost[2] + arc.cost[2]});
    }
    used[static_cast<std::size_t>(node)] = 0;
  };
  extend(from, {0, 0, 0});
  std::set<CostVector> best;
  for (const CostVector& c : all) {
    if (std::none_of(all.begin(), all.end(), [&](const CostVector& other) { return dominated(c, other); }))
      best.insert(c);
  }
  return best;
}

struct RandomGraph {
  int nodes;
  std::vector<CostArc> arcs;
};

/// Whole costs, small or zero, so that ties abound and sums are exact.
RandomGraph random_graph(Random& random) {
  RandomGraph g{2 + static_cast<int>(random.index(11)), {}};
  const auto count = static_cast<std::size_t>(g.nodes) * 5 / 2;
  const auto node = [&] { return static_cast<int>(random.index(static_cast<std::uint64_t>(g.nodes))); };
  const auto cost = [&] { return static_cast<double>(random.index(10)); };
  for (std::size_t i = 0; i < count; ++i) g.arcs.push_back({node(), node(), {cost(), cost(), cost()}});
  return g;
}

// ledger: S3-16
TEST(RoadmapPareto, TheSetEqualsExhaustiveEnumeration) {
  Random random(1);
  std::size_t largest = 0;
  for (int i = 0; i < 1000; ++i) {
    const RandomGraph g = random_graph(random);
    const ParetoSet set = pareto_paths(g.nodes, g.arcs, 0, g.nodes - 1);
    ASSERT_TRUE(set.complete);
    std::set<CostVector> costs;
    for (const ParetoPath& path : set.paths) {
      ASSERT_TRUE(costs.insert(path.cost).second);
      ASSERT_EQ(path.nodes.front(), 0);
      ASSERT_EQ(path.nodes.back(), g.nodes - 1);
    }
    ASSERT_EQ(costs, enumerated(g.nodes, g.arcs, 0, g.nodes - 1)) << "graph " << i;
    largest = std::max(largest, costs.size());
    // a choice by weights, or in any order, is a path that none dominates
    const Preference weighted{{0, 1, 2}, {random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)}};
    for (const Preference& preference : {weighted, Preference{}, Preference{{2, 1, 0}, {0, 0, 0}}}) {
      if (set.paths.empty()) continue;
      const auto best = std::min_element(set.paths.begin(), set.paths.end(), [&](const auto& a, const auto& b) {
        return is_preferred(a.cost, b.cost, preference);
      });
      for (const CostVector& c : costs) ASSERT_FALSE(is_preferred(c, best->cost, preference));
    }
  }
  EXPECT_GT(largest, 5u);
}

TEST(RoadmapPareto, ToleranceLeavesOutPathsThatAreNearlyDominated) {
  const std::vector<CostArc> arcs{{0, 1, {100, 10, 0}}, {0, 1, {101, 9.9, 0}}, {0, 1, {200, 5, 0}}};
  EXPECT_EQ(pareto_paths(2, arcs, 0, 1).paths.size(), 3u);
  EXPECT_EQ(pareto_paths(2, arcs, 0, 1, {0.02, 100}).paths.size(), 2u);
  EXPECT_FALSE(pareto_paths(2, arcs, 0, 1, {0, 2}).complete);
  EXPECT_EQ(pareto_paths(2, arcs, 1, 0).paths.size(), 0u);
  EXPECT_EQ(pareto_paths(2, arcs, 1, 1).paths.size(), 1u);
  const std::vector<CostArc> negative{{0, 1, {1, -1, 0}}};
  EXPECT_THROW(pareto_paths(2, negative, 0, 1), Error);
}

// ledger: S3-17
TEST(RoadmapPareto, DeviationIsTheIntegralOfTheDistanceToTheLine) {
  const Vector2d start(1, 2), goal(9, -3);
  EXPECT_EQ(deviation(start, goal, start, goal), 0);
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Vector2d a(random.uniform(-9, 9), random.uniform(-9, 9)), b(random.uniform(-9, 9), random.uniform(-9, 9));
    const Vector2d along = (goal - start).normalized(), across(-along.y(), along.x());
    double sum = 0;
    const int steps = 2000;
    for (int k = 0; k < steps; ++k) {
      const Vector2d p = a + (k + 0.5) / steps * (b - a);
      sum += std::abs(across.dot(p - start)) * (b - a).norm() / steps;
    }
    ASSERT_NEAR(deviation(a, b, start, goal), sum, 1e-4 * (1 + sum));
  }
}

// ledger: S3-17
TEST(RoadmapPareto, SymmetricDetoursTieAndTheChoiceIsTheSameEachTime) {
  const Vector2d start(0, 0), goal(10, 0), left(5, 3), right(5, -3);
  const auto cost = [&](const Vector2d& a, const Vector2d& b) {
    return CostVector{(b - a).norm(), deviation(a, b, start, goal), 0};
  };
  const std::vector<CostArc> arcs{
      {0, 1, cost(start, left)}, {0, 2, cost(start, right)}, {1, 3, cost(left, goal)}, {2, 3, cost(right, goal)}};
  const ParetoSet once = pareto_paths(4, arcs, 0, 3), again = pareto_paths(4, arcs, 0, 3);
  ASSERT_EQ(once.paths.size(), 1u) << "equal costs";
  EXPECT_EQ(once.paths[0].nodes, again.paths[0].nodes);
}

}  // namespace
}  // namespace isobath::roadmap_pareto_test
