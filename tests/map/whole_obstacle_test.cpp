#include <cmath>
#include <gtest/gtest.h>
#include <isobath/map/occupancy/whole_obstacle.hpp>

namespace isobath {
namespace {

Obstacle square(int number, double x, double y, double side) {
  Obstacle o;
  o.number = number;
  o.outline = {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
  o.nearest = nearest_point(o.outline, Eigen::Vector2d::Zero());
  o.range_m = o.nearest.norm();
  o.existence = 0.9;
  o.hits = 10;
  return o;
}

TEST(WholeObstacles, PiecesOfOneNumberAreOneObstacle) {
  // A wall of three squares from 10 to 40 m to starboard, and a pole behind it.
  std::vector<Obstacle> pieces = {square(4, 5, 20, 10), square(4, 5, 10, 10), square(4, 5, 30, 10),
                                  square(2, 60, 0, 1)};
  pieces[2].existence = 0.99;
  pieces[0].behind = pieces[2].behind = pieces[3].behind = true;
  const std::vector<WholeObstacle> all = whole_obstacles(pieces);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].number, 4) << "the nearest first, whatever its number";
  EXPECT_EQ(all[0].pieces, 3);
  EXPECT_EQ(all[0].nearest, &pieces[1]);
  EXPECT_NEAR(all[0].extent_m, std::hypot(10, 30), 1e-9);
  EXPECT_STREQ(all[0].kind(), "extended");
  EXPECT_EQ(all[0].existence, 0.99);
  EXPECT_EQ(all[0].hits, 30u);
  EXPECT_FALSE(all[0].behind) << "one piece is in view";
  EXPECT_STREQ(all[1].kind(), "compact");
  EXPECT_TRUE(all[1].behind);
}

TEST(WholeObstacles, TheKindFollowsFromTheExtentOfAllPieces) {
  EXPECT_EQ(extent_of({}), 0);
  const std::vector<Polygon> two = {{{0, 0}, {1, 0}, {1, 1}}, {{4, 4}, {5, 5}, {4, 5}}};
  EXPECT_NEAR(extent_of(two), std::hypot(5, 5), 1e-9);
  EXPECT_STREQ(kind_of_obstacle(5.99), "compact");
  EXPECT_STREQ(kind_of_obstacle(kExtended_m), "extended");
}

TEST(WholeObstacles, OfNoPiecesAreNone) { EXPECT_TRUE(whole_obstacles({}).empty()); }

}  // namespace
}  // namespace isobath
