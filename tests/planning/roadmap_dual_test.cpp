// The dual road map and the visibility graph against plain checks of every leg, a flood fill, and Dijkstra over all
// pairs of corners.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/geometry/dynamic_delaunay.hpp>
#include <isobath/planning/roadmap/road_map.hpp>
#include <isobath/planning/roadmap/visibility_graph.hpp>
#include <map>
#include <numeric>
#include <optional>
#include <tests/planning/roadmap_scenes.hpp>

namespace isobath::roadmap_dual_test {
namespace {

using Eigen::Vector2d;

constexpr double kRadius = 1, kSpacing = 1;
constexpr int kSides = 12;

int most_points(const std::vector<Polygon>& bodies, double spacing_m) {
  double most = 40;
  for (const Polygon& body : bodies) {
    for (std::size_t k = 0; k < body.size(); ++k)
      most += 1 + (body[(k + 1) % body.size()] - body[k]).norm() / spacing_m;
  }
  return static_cast<int>(most);
}

struct Scene {
  Scene(std::vector<Polygon> outlines, double half_m, double spacing_m = kSpacing)
      : bodies(std::move(outlines)),
        obstacles(test::grown_parts(bodies, kRadius, kSides)),
        delaunay(most_points(bodies, spacing_m)) {
    const double out = 2 * half_m;
    for (double k = -1; k < 1; k += 0.25) {
      for (const Vector2d& p : {Vector2d(k, -1), Vector2d(1, k), Vector2d(-k, 1), Vector2d(-1, -k)}) {
        delaunay.insert(out * p, -1);
      }
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Polygon& body = bodies[i];
      for (std::size_t k = 0; k < body.size(); ++k) {
        const Vector2d side = body[(k + 1) % body.size()] - body[k];
        const double pieces = std::ceil(side.norm() / spacing_m);
        for (double j = 0; j < pieces; ++j) delaunay.insert(body[k] + j / pieces * side, static_cast<int>(i));
      }
    }
    map.emplace(delaunay, obstacles, Eigen::AlignedBox2d(Vector2d(-out, -out), Vector2d(out, out)));
  }
  std::vector<Polygon> bodies;
  GrownObstacles obstacles;
  DynamicDelaunay delaunay;
  std::optional<RoadMap> map;
};

/// For each node of the map a number that it shares with those it is connected to.
std::vector<int> components(const RoadMap& map) {
  std::vector<int> parent(map.nodes().size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[static_cast<std::size_t>(i)] != i) {
      parent[static_cast<std::size_t>(i)] = parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
      i = parent[static_cast<std::size_t>(i)];
    }
    return i;
  };
  for (const auto& arc : map.arcs()) parent[static_cast<std::size_t>(root(arc.from))] = root(arc.to);
  std::vector<int> numbers;
  for (std::size_t i = 0; i < parent.size(); ++i) numbers.push_back(root(static_cast<int>(i)));
  return numbers;
}

/// An independent notion of connected water: cells that keep a distance from all bodies, joined over their sides.
struct FloodFill {
  FloodFill(const std::vector<Polygon>& bodies, double half_m, double cell_m, double keep_m)
      : side(static_cast<int>(2 * half_m / cell_m)), half(half_m), cell(cell_m) {
    number.assign(static_cast<std::size_t>(side * side), -1);
    std::vector<char> open(number.size(), 1);
    for (std::size_t i = 0; i < open.size(); ++i) {
      for (const Polygon& body : bodies) open[i] = open[i] && distance_from(body, centre(i)) >= keep_m;
    }
    for (std::size_t seed = 0; seed < open.size(); ++seed) {
      if (!open[seed] || number[seed] >= 0) continue;
      std::vector<std::size_t> todo{seed};
      number[seed] = static_cast<int>(seed);
      while (!todo.empty()) {
        const std::size_t i = todo.back();
        todo.pop_back();
        const int x = static_cast<int>(i) % side, y = static_cast<int>(i) / side;
        for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
          if (x + dx < 0 || x + dx >= side || y + dy < 0 || y + dy >= side) continue;
          const auto j = static_cast<std::size_t>((y + dy) * side + x + dx);
          if (!open[j] || number[j] >= 0) continue;
          number[j] = static_cast<int>(seed);
          todo.push_back(j);
        }
      }
    }
  }
  [[nodiscard]] Vector2d centre(std::size_t i) const {
    return {-half + (static_cast<double>(i % static_cast<std::size_t>(side)) + 0.5) * cell,
            -half + (static_cast<double>(i / static_cast<std::size_t>(side)) + 0.5) * cell};
  }
  int side;
  double half, cell;
  std::vector<int> number;
};

void expect_free(const Scene& scene, const Vector2d& a, const Vector2d& b) {
  for (const GrownPart& part : scene.obstacles.parts()) {
    const Vector2d centre = part.outline.front();
    if ((nearest_on_segment(a, b, centre) - centre).norm() > 20) continue;
    ASSERT_GE(test::plain_distance(part.outline, a, b), kRadius - 1e-8);
    ASSERT_FALSE(test::plain_enters(part.grown, a, b, 1e-8));
  }
}

// ledger: S3-09 S3-E03
TEST(RoadmapDual, NoArcOfTenThousandScenesMeetsAGrownObstacle) {
  Random random(1);
  std::size_t arcs = 0;
  for (int i = 0; i < 10'000; ++i) {
    const int count = 2 + static_cast<int>(random.index(3));
    const Scene scene(test::random_bodies(random, count, 8, 4), 12, 2);
    const std::size_t every = i % 20 == 0 ? 1 : 16;  // all arcs of one scene in twenty, one arc in 16 of the others
    for (std::size_t k = random.index(every); k < scene.map->arcs().size(); k += every) {
      const auto& arc = scene.map->arcs()[k];
      const Vector2d &from = scene.map->nodes()[static_cast<std::size_t>(arc.from)],
                     &to = scene.map->nodes()[static_cast<std::size_t>(arc.to)];
      expect_free(scene, from, arc.via);
      expect_free(scene, arc.via, to);
      ++arcs;
    }
    if (testing::Test::HasFailure()) FAIL() << "scene " << i;
  }
  EXPECT_GT(arcs, 50'000u);
}

// Bodies overlap, enclose water and leave gaps of any width.
// ledger: S3-09
TEST(RoadmapDual, KeepsTheConnectivityThroughEveryGapThatIsWideEnough) {
  Random random(2);
  const double growth = kRadius / std::cos(std::numbers::pi / kSides);
  const double cell = 0.4, keep = std::hypot(growth, kSpacing / 2) + cell / 2;
  int enclosed = 0;
  for (int i = 0; i < 150; ++i) {
    std::vector<Polygon> bodies = test::random_bodies(random, 4, 8, 5);
    if (i % 3 == 0) {  // a ring with gaps, some of them shut
      for (int k = 0; k < 9; ++k) {
        const double angle = k * 2 * std::numbers::pi / 9;
        bodies.push_back(
            test::random_body(random, 9 * Vector2d(std::cos(angle), std::sin(angle)), random.uniform(1.5, 4), 6));
      }
    }
    const Scene scene(bodies, 14);
    const FloodFill fill(bodies, 14, cell, keep);
    const std::vector<int> component = components(*scene.map);
    std::map<int, int> component_of_water;
    for (std::size_t c = 0; c < fill.number.size(); c += 7) {
      if (fill.number[c] < 0) continue;
      const std::vector<int> joined = scene.map->attach(fill.centre(c));
      ASSERT_FALSE(joined.empty()) << "scene " << i << " at " << fill.centre(c).transpose();
      for (const int node : joined) {
        const auto [at, is_new] = component_of_water.emplace(fill.number[c], component[static_cast<std::size_t>(node)]);
        ASSERT_EQ(at->second, component[static_cast<std::size_t>(node)]) << "scene " << i;
      }
    }
    enclosed += component_of_water.size() > 1;
  }
  EXPECT_GT(enclosed, 5) << "scenes with water that is cut off";
}

// ledger: S3-08
TEST(RoadmapDual, PassesMidwayBetweenTwoDiscsWithLinearlyManyArcs) {
  std::vector<Polygon> discs(2);
  for (int i = 0; i < 48; ++i) {
    const double angle = i * std::numbers::pi / 24;
    const Vector2d out(3 * std::cos(angle), 3 * std::sin(angle));
    discs[0].push_back(Vector2d(-6, 0) + out);
    discs[1].push_back(Vector2d(6, 0) + out);
  }
  const Scene scene(discs, 15);
  int between = 0;
  for (const Vector2d& p : scene.map->nodes()) {
    if (std::abs(p.y()) > 3 || std::abs(p.x()) > 2.5) continue;
    EXPECT_NEAR(p.x(), 0, 0.05);
    ++between;
  }
  EXPECT_GT(between, 4);
  EXPECT_LE(scene.map->arcs().size(), 3 * static_cast<std::size_t>(scene.delaunay.size()));
}

/// Dijkstra over all pairs of corners, by plain checks.
double plain_shortest(const std::vector<GrownPart>& parts, const Vector2d& start, const Vector2d& goal) {
  std::vector<Vector2d> at{start, goal};
  for (const GrownPart& part : parts) at.insert(at.end(), part.grown.begin(), part.grown.end());
  std::vector<double> cost(at.size(), INFINITY);
  std::vector<char> closed(at.size(), 0);
  cost[0] = 0;
  while (true) {
    std::size_t i = at.size();
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (!closed[k] && (i == at.size() || cost[k] < cost[i])) i = k;
    }
    if (i == 1 || i == at.size() || cost[i] == INFINITY) return cost[1];
    closed[i] = 1;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const double through = cost[i] + (at[k] - at[i]).norm();
      if (through >= cost[k]) continue;
      bool free = true;
      for (const GrownPart& part : parts) free = free && !test::plain_enters(part.grown, at[i], at[k], 1e-9);
      if (free) cost[k] = through;
    }
  }
}

double length_of(const std::vector<Vector2d>& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
  return length;
}

// ledger: S3-14
TEST(RoadmapVisibility, TheShortestPathEqualsBruteForce) {
  Random random(3);
  int paths = 0, bent = 0;
  for (int i = 0; i < 120; ++i) {
    const auto parts = test::grown_parts(test::random_bodies(random, 2 + i % 5, 6, 4), kRadius, 6);
    const GrownObstacles obstacles(parts);
    const Vector2d start(-9, random.uniform(-9, 9)), goal(9, random.uniform(-9, 9));
    if (!obstacles.is_free(start, start) || !obstacles.is_free(goal, goal)) continue;
    const auto path = VisibilityGraph(obstacles).shortest_path(start, goal);
    const double expected = plain_shortest(parts, start, goal);
    ASSERT_EQ(path.empty(), std::isinf(expected));
    if (path.empty()) continue;
    ASSERT_NEAR(length_of(path), expected, 1e-6);
    ++paths;
    bent += path.size() > 2;
  }
  EXPECT_GT(paths, 80);
  EXPECT_GT(bent, 40);
}

// ledger: S3-14
TEST(RoadmapVisibility, ArcsAreFreeAndBothWays) {
  Random random(4);
  const auto parts = test::grown_parts(test::random_bodies(random, 6, 8, 4), kRadius, 8);
  const GrownObstacles obstacles(parts);
  const VisibilityGraph graph(obstacles);
  for (int i = 0; i < static_cast<int>(graph.nodes().size()); ++i) {
    for (const int j : graph.arcs_from(i)) {
      const auto back = graph.arcs_from(j);
      ASSERT_NE(std::find(back.begin(), back.end(), i), back.end());
      for (const GrownPart& part : parts) {
        ASSERT_FALSE(test::plain_enters(part.grown, graph.nodes()[static_cast<std::size_t>(i)].at,
                                        graph.nodes()[static_cast<std::size_t>(j)].at, 1e-8));
      }
    }
  }
}

}  // namespace
}  // namespace isobath::roadmap_dual_test
