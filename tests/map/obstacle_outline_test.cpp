// Outlines against random ones and closed forms.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/map/occupancy/obstacle_outline.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

Polygon random_outline(Random& random, int points) {
  std::vector<Vector2d> corners;
  const double stretch = random.uniform(0.1, 3);
  for (int i = 0; i < points; ++i) {
    const double x = random.normal();
    const double y = random.normal();
    corners.emplace_back(100 + stretch * x, y - 50);
  }
  return convex_hull(std::move(corners));
}

// ledger: S6-66
TEST(ObstacleOutline, HasFewerCornersAndStillHoldsTheOther) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Polygon all = random_outline(random, 200);
    const Polygon few = fewer_corners(all);
    ASSERT_LE(few.size(), 16u);
    for (const Vector2d& p : all) EXPECT_LT((nearest_point(few, p) - p).norm(), 1e-9);
    EXPECT_GE(area(few), area(all) - 1e-9);
    EXPECT_LT(area(few), 1.5 * area(all));
    const Circle c = circle_of(all);
    for (const Vector2d& p : all) EXPECT_LE((p - c.centre).norm(), c.radius + 1e-12);
  }
}

// ledger: S6-66
TEST(ObstacleOutline, MeasuresSharesByPoints) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Polygon o = random_outline(random, 12);
    const std::vector<Vector2d> points = spread_over(o);
    EXPECT_GE(points.size(), 4u);
    EXPECT_LE(points.size(), 40u);
    EXPECT_EQ(share_inside(points, Vector2d::Zero(), o), 1);
    EXPECT_EQ(share_inside(points, Vector2d(50, 0), o), 0);
  }
  const Polygon box = {{0, 0}, {8, 0}, {8, 4}, {0, 4}};
  for (const double cut : {0.25, 0.5, 0.75}) {
    EXPECT_NEAR(share_inside(spread_over(box), Vector2d(8 * cut, 0), box), 1 - cut, 0.1);
  }
  EXPECT_FALSE(spread_over({{0, 0}, {10, 0.001}, {10, 0.002}}).empty());
}

// ledger: S6-66
TEST(ObstacleOutline, FindsTheGapBetweenTwo) {
  const Polygon box = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  EXPECT_TRUE(gap(box, moved_by(box, {5, 1})).isApprox(Vector2d(3, 0)));
  EXPECT_TRUE(gap(box, moved_by(box, {-5, -6})).isApprox(Vector2d(-3, -4)));
  EXPECT_EQ(gap(box, moved_by(box, {1, 1})), Vector2d::Zero());
  Random random(4);
  for (int i = 0; i < 50; ++i) {  // against a fine sampling of both borders
    const Polygon a = random_outline(random, 8);
    const Polygon b = moved_by(random_outline(random, 8), {random.uniform(12, 20), 3});
    double least = 1e9;
    const auto on = [](const Polygon& o, int k) {
      const std::size_t side = static_cast<std::size_t>(k / 50) % o.size();
      return Vector2d(o[side] + k % 50 / 50.0 * (o[(side + 1) % o.size()] - o[side]));
    };
    for (int k = 0; k < 50 * static_cast<int>(a.size()); ++k) {
      least = std::min(least, (nearest_point(b, on(a, k)) - on(a, k)).norm());
    }
    EXPECT_LE(gap(a, b).norm(), least + 1e-9);
    EXPECT_GT(gap(a, b).norm(), least - 0.1);
  }
}

}  // namespace
}  // namespace isobath
