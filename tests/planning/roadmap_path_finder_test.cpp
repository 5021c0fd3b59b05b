// Candidate paths: what they keep, how they are ordered, and when shapes get finer.
#include <gtest/gtest.h>
#include <isobath/planning/roadmap/path_finder.hpp>
#include <tests/planning/roadmap_scenes.hpp>

namespace isobath::roadmap_path_finder_test {
namespace {

using Eigen::Vector2d;

PathFinderConfig small_region() {
  PathFinderConfig c;
  c.region = {Vector2d(-40, -40), Vector2d(40, 40)};
  c.radius_m = 1;
  return c;
}

Polygon box(double x, double y, double half_x, double half_y) {
  return {{x - half_x, y - half_y}, {x + half_x, y - half_y}, {x + half_x, y + half_y}, {x - half_x, y + half_y}};
}
Polygon u_shape() { return {{0, 0}, {20, 0}, {20, 16}, {16, 16}, {16, 4}, {4, 4}, {4, 16}, {0, 16}}; }

void expect_sound(const PathCandidates& found, const std::vector<Polygon>& bodies, double radius_m) {
  ASSERT_FALSE(found.paths.empty());
  for (const PathCandidate& path : found.paths) {
    double length = 0, clearance = INFINITY;
    for (std::size_t i = 1; i < path.points.size(); ++i) {
      length += (path.points[i] - path.points[i - 1]).norm();
      for (const Polygon& body : bodies) {
        clearance = std::min(clearance, test::plain_distance(body, path.points[i - 1], path.points[i]));
      }
    }
    ASSERT_NEAR(path.length_m, length, 1e-9);
    ASSERT_GE(clearance, radius_m - 1e-8);
    ASSERT_LE(path.clearance_m, clearance + 1e-9) << "of shapes that hold the bodies";
  }
}

TEST(RoadmapPathFinder, InOpenWaterThePreferredPathIsTheStraightLine) {
  PathFinder finder(small_region());
  const auto found = finder.candidates({-30, 0}, {30, 5});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->paths[0].points, (std::vector<Vector2d>{{-30, 0}, {30, 5}}));
  EXPECT_EQ(found->paths[0].deviation_m2, 0);
}

// ledger: S3-08 S3-14 S3-16 S3-E02 S3-E04
TEST(RoadmapPathFinder, CandidatesKeepTheRadiusAndComeInOrderOfPreference) {
  Random random(1);
  int several = 0;
  for (int i = 0; i < 60; ++i) {
    PathFinderConfig config = small_region();
    if (i % 2 == 1) config.preference.weights = {1, 0.05, 5};
    PathFinder finder(config);
    const auto bodies = test::random_bodies(random, 12, 25, 6);
    for (std::size_t k = 0; k < bodies.size(); ++k) ASSERT_TRUE(finder.set_obstacle(static_cast<int>(k), bodies[k]));
    const auto found = finder.candidates({-38, 0}, {38, 0});
    ASSERT_TRUE(found.has_value()) << to_text(found.error());
    expect_sound(*found, bodies, 1);
    for (std::size_t k = 1; k < found->paths.size(); ++k) {
      const auto cost = [](const PathCandidate& p) { return CostVector{p.length_m, p.deviation_m2, p.delay_s}; };
      ASSERT_FALSE(is_preferred(cost(found->paths[k]), cost(found->paths[k - 1]), config.preference));
    }
    if (i % 2 == 0) {  // by length: the path of the visibility graph is in front
      for (const PathCandidate& path : found->paths) ASSERT_GE(path.length_m, found->paths[0].length_m);
    }
    several += found->paths.size() > 1;
  }
  EXPECT_GT(several, 40);
}

// ledger: S3-13 S3-E05
TEST(RoadmapPathFinder, AUShapeWithTheGoalInsideNeedsItsParts) {
  PathFinder finder(small_region());
  finder.set_obstacle(7, u_shape());
  finder.set_obstacle(8, box(-20, -20, 3, 3));
  const auto past = finder.candidates({-30, 8}, {30, 30});
  ASSERT_TRUE(past.has_value());
  EXPECT_EQ(finder.detail(7), ShapeDetail::kEnclosure) << "in open water the coarsest shapes do";
  const auto found = finder.candidates({10, -20}, {10, 8});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(finder.detail(7), ShapeDetail::kParts);
  EXPECT_EQ(finder.detail(8), ShapeDetail::kEnclosure) << "far from the failure";
  expect_sound(*found, convex_parts(u_shape()), 1);
}

TEST(RoadmapPathFinder, FindsTheGapBetweenTwoDiscsThatShutTheRegion) {
  PathFinder finder(small_region());  // two discs and two walls across the region; 3 m between the discs
  std::vector<Polygon> discs(2);
  for (int i = 0; i < 40; ++i) {
    const Vector2d out(std::cos(i * std::numbers::pi / 20), std::sin(i * std::numbers::pi / 20));
    discs[0].push_back(Vector2d(0, -14.7) + 13.2 * out);
    discs[1].push_back(Vector2d(0, 14.7) + 13.2 * out);
  }
  const std::vector<Polygon> walls{box(0, -34, 2, 6), box(0, 34, 2, 6), discs[0], discs[1]};
  for (std::size_t i = 0; i < walls.size(); ++i) finder.set_obstacle(static_cast<int>(i), walls[i]);
  const auto found = finder.candidates({-30, 0}, {30, 0});
  ASSERT_TRUE(found.has_value());
  expect_sound(*found, walls, 1);
}

// ledger: S3-11
TEST(RoadmapPathFinder, AGapThatCirclesWouldCloseIsUsed) {
  PathFinder finder(small_region());
  const std::vector<Polygon> bars{box(0, -3, 15, 1), box(0, 3, 15, 1)};  // circles around them would overlap
  for (std::size_t i = 0; i < bars.size(); ++i) finder.set_obstacle(static_cast<int>(i), bars[i]);
  const auto found = finder.candidates({-30, 0}, {30, 0});
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->paths[0].length_m, 60, 1e-9);
  EXPECT_NEAR(found->paths[0].clearance_m, 2, 1e-9);
  expect_sound(*found, bars, 1);
}

TEST(RoadmapPathFinder, ObstaclesThatMoveGiveThePathsOfThoseThatWereThere) {
  Random random(2);
  PathFinder moving(small_region());
  for (int cycle = 0; cycle < 15; ++cycle) {
    PathFinder fresh(small_region());
    for (int id = 0; id < 10; ++id) {
      const Vector2d centre(-20 + 4.5 * id, 12 * std::sin(0.3 * cycle + id));
      const Polygon body = test::random_body(random, centre, 3, 8);
      if ((cycle + id) % 7 == 0) {
        moving.remove_obstacle(id);
        continue;
      }
      moving.set_obstacle(id, body);
      fresh.set_obstacle(id, body);
    }
    const auto a = moving.candidates({-38, 1}, {38, 2}), b = fresh.candidates({-38, 1}, {38, 2});
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) continue;
    EXPECT_NEAR(a->paths[0].length_m, b->paths[0].length_m, 1e-9);
  }
}

TEST(RoadmapPathFinder, SaysWhyThereIsNoPath) {
  PathFinder finder(small_region());
  finder.set_obstacle(1, box(0, 0, 5, 5));
  EXPECT_EQ(finder.candidates({0, 5.5}, {30, 0}).error(), PathRefusal::kStartBlocked);
  EXPECT_EQ(finder.candidates({30, 0}, {0, 0}).error(), PathRefusal::kGoalBlocked);
  for (int i = 0; i < 4; ++i) {  // walls around the goal
    const bool upright = i % 2 == 0;
    finder.set_obstacle(10 + i, upright ? box(i == 0 ? 15 : 35, 0, 1, 12) : box(25, i == 1 ? 11 : -11, 12, 1));
  }
  EXPECT_EQ(finder.candidates({-30, 0}, {25, 0}).error(), PathRefusal::kNoPath);
  finder.remove_obstacle(11);
  EXPECT_TRUE(finder.candidates({-30, 0}, {25, 0}).has_value());
}

TEST(RoadmapPathFinder, RefusesWhatIsNotFiniteAndLeavesOutWhatReachesBeyondTheRegion) {
  PathFinder finder(small_region());
  EXPECT_THROW(finder.set_obstacle(1, {{0, 0}, {NAN, 0}, {0, 1}}), Error);
  EXPECT_THROW((void)finder.candidates({NAN, 0}, {0, 0}), Error);
  EXPECT_THROW((void)finder.candidates({0, 0}, {300, 0}), Error);
  EXPECT_TRUE(finder.set_obstacle(1, box(0, 0, 5, 5)));
  EXPECT_FALSE(finder.set_obstacle(1, box(38, 0, 5, 5)));
  EXPECT_EQ(finder.candidates({-30, 0}, {30, 0})->paths[0].points.size(), 2u);
  EXPECT_FALSE(finder.set_obstacle(2, {}));
  EXPECT_TRUE(finder.set_obstacle(3, {{5, 5}})) << "a point has a radius too";
  PathFinderConfig config = small_region();
  config.region = {Vector2d(0, 0), Vector2d(INFINITY, 1)};
  EXPECT_THROW(PathFinder{config}, Error);
}

}  // namespace
}  // namespace isobath::roadmap_path_finder_test
