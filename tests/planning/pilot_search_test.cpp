// The pilot's path search, against a search without any cleverness.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/pilot_search.hpp>
#include <map>
#include <numbers>
#include <tests/planning/array_field.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::ArrayField;

const PixelGrid kGrid{{20, -20}, 1};
const PixelWindow kWindow{0, 0, 40, 40};

Vector3d middle(int column, int row, double z = 3) {
  const Vector2d c = kGrid.centre({column, row});
  return {c.x(), c.y(), z};
}

PilotSearchConfig narrow(double risk_weight = 1) {
  PilotSearchConfig c;
  c.passage = {0.3, 1};
  c.risk_weight = risk_weight;
  c.risk_reach_m = 2;
  c.margin_m = 40;
  return c;
}

ArrayField random_map(Random& random, double share) {
  ArrayField map(kGrid, kWindow, 10);
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) {
      if (random.uniform() < share) map.set({column, row}, random.uniform() < 0.3 ? DepthPixel{} : ArrayField::of(2));
    }
  }
  return map;
}

/// Bellman and Ford: relaxes every edge until nothing changes. Edges by the traversability query, T by counting.
double cheapest(const ArrayField& map, Pixel start, Pixel goal, const PilotSearchConfig& config,
                const RiskGrid& threats = {}) {
  const auto clear = [&](int column, int row) {
    const DepthPixel p = map.at({column, row});
    return p.known() && p.depth_m() >= 4;
  };
  // The search's area: start and goal lie in the map, the margin reaches beyond it; T counts pixels of the area.
  std::map<std::pair<int, int>, double> log_safety;
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) {
      int safe = 0, all = 0;
      for (int r = -2; r <= 2; ++r) {
        for (int c = -2; c <= 2; ++c) {
          ++all;
          safe += clear(column + c, row + r);
        }
      }
      log_safety[{row, column}] = std::log(static_cast<double>(std::max(safe, 1)) / all);
    }
  }
  struct Edge {
    int from, to;
    double cost;
  };
  std::vector<Edge> edges;
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) {
      for (int r = -1; r <= 1; ++r) {
        for (int c = -1; c <= 1; ++c) {
          const bool inside = kWindow.contains({column + c, row + r});
          if ((r == 0 && c == 0) || !inside || !clear(column, row) || !clear(column + c, row + r)) continue;
          const std::vector<Vector3d> leg = {middle(column, row), middle(column + c, row + r)};
          if (traversability(map, leg, config.passage)->strict() == 0) continue;
          const double risk = (log_safety[{row, column}] + log_safety[{row + r, column + c}]) / 2;
          const double rate = (threats.rate_at(middle(column, row).head<2>()) +
                               threats.rate_at(middle(column + c, row + r).head<2>())) /
                              2;
          edges.push_back({row * 40 + column, (row + r) * 40 + column + c,
                           std::hypot(r, c) * (1 - config.risk_weight * risk + config.threat_weight_m * rate)});
        }
      }
    }
  }
  std::vector<double> cost(1600, INFINITY);
  cost[static_cast<std::size_t>(start.row * 40 + start.column)] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (const Edge& e : edges) {
      const double total = cost[static_cast<std::size_t>(e.from)] + e.cost;
      if (total >= cost[static_cast<std::size_t>(e.to)] - 1e-12) continue;
      cost[static_cast<std::size_t>(e.to)] = total;
      changed = true;
    }
  }
  return cost[static_cast<std::size_t>(goal.row * 40 + goal.column)];
}

// ledger: S1-42
TEST(PilotSearch, CostsWhatAnExhaustiveSearchCosts) {
  Random random(1);
  int paths = 0, none = 0;
  for (int trial = 0; trial < 10; ++trial) {
    ArrayField map = random_map(random, trial < 5 ? 0.15 : 0.3);
    const Pixel start{2, 3}, goal{36, 35};
    map.set(start, 10.0);
    map.set(goal, 10.0);
    for (const double weight : {0.0, 2.0}) {
      const PilotSearchConfig config = narrow(weight);
      const double expected = cheapest(map, start, goal, config);
      const auto path = search_path(map, middle(2, 3), middle(36, 35), config);
      ASSERT_EQ(path.has_value(), std::isfinite(expected));
      path ? ++paths : ++none;
      if (!path) {
        EXPECT_EQ(path.error(), PilotRefusal::kNoPath);
        continue;
      }
      EXPECT_NEAR(path->cost, expected, 1e-9 * expected);
      EXPECT_GE(path->queries, path->expanded);
      EXPECT_EQ(traversability(map, path->points, config.passage)->strict(), 1);
      EXPECT_LE(path->length_m, path->cost + 1e-9);
    }
  }
  EXPECT_GT(paths, 6);
  EXPECT_GT(none, 0);
}

// Cells of 8 m with rates drawn at random: the cost is the least, and the way is no more dangerous than the straight
// one. ledger: S1-37 S1-78
TEST(PilotSearch, GoesRoundThreatsAsFarAsTheyAreWorth) {
  Random random(31);
  int went_round = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const ArrayField map(kGrid, kWindow, 10);
    RiskGrid threats{{{20, -20}, 8}, {0, 0, 5, 5}, {}};
    for (int i = 0; i < 25; ++i) threats.rate_per_m.push_back(random.uniform() < 0.4 ? 0.05 * random.uniform() : 0);
    PilotSearchConfig config = narrow(0);
    config.threat_weight_m = 60;
    const Vector3d start = middle(2, 19), goal = middle(37, 22);
    const auto found = search_path(map, start, goal, config, {}, &threats);
    ASSERT_TRUE(found) << to_text(found.error());
    EXPECT_NEAR(found->cost, cheapest(map, {2, 19}, {37, 22}, config, threats), 1e-6);
    std::vector<Vector2d> way;
    for (const Vector3d& p : found->points) way.emplace_back(p.head<2>());
    const std::vector<Vector2d> straight = {start.head<2>(), goal.head<2>()};
    const double risk = path_risk(threats, way).cost, of_straight = path_risk(threats, straight).cost;
    EXPECT_LE(risk, of_straight + 1e-9) << trial;
    went_round += risk < 0.7 * of_straight;
    config.threat_weight_m = 0;
    EXPECT_EQ(search_path(map, start, goal, config, {}, &threats)->points.size(), 2u) << "nothing is worth a detour";
  }
  EXPECT_GE(went_round, 6);
}

// ledger: S1-42
TEST(PilotSearch, WithoutRiskThePathIsTheShortest) {
  const ArrayField map(kGrid, kWindow, 10);
  const auto path = search_path(map, middle(5, 5), middle(25, 15), narrow(0));
  ASSERT_TRUE(path);
  EXPECT_NEAR(path->length_m, 10 * std::numbers::sqrt2 + 10, 1e-9);
  EXPECT_LE(path->points.size(), 4u);
  EXPECT_EQ(path->points.front(), middle(5, 5));
  EXPECT_EQ(path->points.back(), middle(25, 15));
  EXPECT_LE(path->expanded, 121) << "no more than the parallelogram of equally short paths";
}

/// A wall at row 20 with a narrow gap straight ahead and a wide one aside.
ArrayField two_gaps() {
  ArrayField map(kGrid, kWindow, 10);
  for (int column = 0; column < 40; ++column) {
    if (column != 10 && (column < 18 || column > 26)) map.set({column, 20}, 2);
  }
  return map;
}

// ledger: S1-42
TEST(PilotSearch, RiskPrefersTheWideGap) {
  const ArrayField map = two_gaps();
  const auto crossing = [&](double weight) {
    const auto path = search_path(map, middle(10, 30), middle(10, 10), narrow(weight));
    EXPECT_TRUE(path);
    for (std::size_t i = 0; i + 1 < path->points.size(); ++i) {
      const Vector3d a = path->points[i], b = path->points[i + 1];
      if (a.x() < -0.5 && b.x() >= -0.5) return a.y() + (b.y() - a.y()) * (-0.5 - a.x()) / (b.x() - a.x());
    }
    return std::nan("");
  };
  EXPECT_NEAR(crossing(0), -9.5, 1e-9);
  EXPECT_GT(crossing(40), -2);
}

// ledger: S1-42
TEST(PilotSearch, ReplansWhenAPixelOnThePathBecomesAnObstacle) {
  ArrayField map = two_gaps();
  const PilotSearchConfig config = narrow(0);
  const auto before = search_path(map, middle(10, 30), middle(10, 10), config);
  ASSERT_TRUE(before);
  map.set({10, 20}, 2.0);  // the narrow gap
  EXPECT_EQ(traversability(map, before->points, config.passage)->strict(), 0);
  const auto after = search_path(map, middle(10, 30), middle(10, 10), config);
  ASSERT_TRUE(after);
  EXPECT_GT(after->map_version, before->map_version);
  EXPECT_GT(after->length_m, before->length_m);
  EXPECT_EQ(traversability(map, after->points, config.passage)->strict(), 1);
}

// ledger: S1-42
TEST(PilotSearch, AVehicleTooWideForTheGapGoesRound) {
  const ArrayField map = two_gaps();
  PilotSearchConfig config = narrow(0);
  config.passage.half_width_m = 1.2;
  const auto path = search_path(map, middle(10, 30), middle(10, 10), config);
  ASSERT_TRUE(path);
  EXPECT_EQ(traversability(map, path->points, config.passage)->strict(), 1);
  EXPECT_GT(path->length_m, 25);
}

// Diagonal neighbours between two blocked ones. ledger: S1-42
TEST(PilotSearch, CutsNoCorner) {
  ArrayField map(kGrid, kWindow, 10);
  for (int i = 0; i < 40; ++i) map.set({i, i}, 2.0);  // a diagonal wall is closed
  PilotSearchConfig config = narrow(0);
  config.passage.half_width_m = 0;
  EXPECT_EQ(search_path(map, middle(5, 15), middle(15, 5), config).error(), PilotRefusal::kNoPath);
}

// ledger: S1-42
TEST(PilotSearch, ThePilotKeepsClearOfTheChart) {
  const ArrayField map(kGrid, kWindow, 10);
  const ChartObstacle wreck{{0, -15}, {0, 15}, 2};
  const PilotSearchConfig config = narrow(0);
  const auto path = search_path(map, middle(20, 30), middle(20, 10), config, std::span(&wreck, 1));
  ASSERT_TRUE(path);
  EXPECT_EQ(traversability(map, path->points, config.passage, std::span(&wreck, 1))->strict(), 1);
  EXPECT_GT(path->length_m, 30);
}

// ledger: S1-42
TEST(PilotSearch, NamesItsFailures) {
  ArrayField map = two_gaps();
  PilotSearchConfig config = narrow();
  EXPECT_EQ(search_path(map, middle(5, 20), middle(10, 10), config).error(), PilotRefusal::kStartBlocked);
  EXPECT_EQ(search_path(map, middle(10, 10), middle(5, 20), config).error(), PilotRefusal::kGoalBlocked);
  EXPECT_EQ(search_path(map, middle(10, 10), middle(60, 10), config).error(), PilotRefusal::kGoalBlocked) << "unknown";
  EXPECT_EQ(search_path(map, middle(10, 10), {NAN, 0, 0}, config).error(), PilotRefusal::kNotFinite);
  EXPECT_EQ(search_path(map, middle(10, 10), {1e6, 1e6, 3}, config).error(), PilotRefusal::kAreaTooLarge);
  config.passage.half_width_m = 1000;
  EXPECT_EQ(search_path(map, middle(10, 30), middle(10, 10), config).error(), PilotRefusal::kAreaTooLarge);
  config = narrow();
  config.max_expanded = 5;
  EXPECT_EQ(search_path(map, middle(10, 30), middle(10, 10), config).error(), PilotRefusal::kOutOfBudget);
  config = narrow();
  for (int column = 0; column < 40; ++column) map.set({column, 20}, 2.0);
  EXPECT_EQ(search_path(map, middle(10, 30), middle(10, 10), config).error(), PilotRefusal::kNoPath);
  EXPECT_EQ(search_path(map, middle(10, 10, 12), middle(11, 10), config).error(), PilotRefusal::kStartBlocked)
      << "deep";
}

}  // namespace
}  // namespace isobath
