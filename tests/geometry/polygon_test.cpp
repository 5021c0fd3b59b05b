#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/polygon.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

TEST(Polygon, HullHoldsAllPointsAndIsConvex) {
  Random random(2);
  for (int round = 0; round < 50; ++round) {
    std::vector<Vector2d> points;
    for (int i = 0; i < 40; ++i) points.emplace_back(random.normal(), random.normal());
    const Polygon hull = convex_hull(points);
    for (const Vector2d& p : points) EXPECT_NEAR((nearest_point(hull, p) - p).norm(), 0, 1e-12);
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Vector2d& b = hull[(i + 1) % hull.size()];
      EXPECT_GT(cross(b - hull[i], hull[(i + 2) % hull.size()] - b), 0);
    }
  }
}

TEST(Polygon, HullLeavesOutPointsOnASideAndRepetitions) {
  const Polygon hull = convex_hull({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}, {0, 0}, {0, 1}});
  EXPECT_EQ(hull.size(), 4u);
  EXPECT_DOUBLE_EQ(area(hull), 4);
}

TEST(Polygon, NearestPointAndRayAgreeOnASquare) {
  const Polygon square{{1, -1}, {3, -1}, {3, 1}, {1, 1}};
  EXPECT_TRUE(nearest_point(square, {0, 0.5}).isApprox(Vector2d(1, 0.5)));
  EXPECT_TRUE(nearest_point(square, {0, 3}).isApprox(Vector2d(1, 1)));
  EXPECT_TRUE(nearest_point(square, {2, 0}).isApprox(Vector2d(2, 0)));
  EXPECT_TRUE(contains(square, {2, 0}));
  EXPECT_FALSE(contains(square, {0, 0}));
  EXPECT_DOUBLE_EQ(ray_hit(square, {0, 0}, {1, 0}).value(), 1);
  EXPECT_FALSE(ray_hit(square, {0, 0}, {-1, 0}).has_value());
  EXPECT_FALSE(ray_hit(square, {0, 2}, {1, 0}).has_value());
}

}  // namespace
}  // namespace isobath
