#include <cmath>
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

/// Star-shaped about the origin, so that a place is inside just where it is nearer than the border in its direction.
struct Star {
  std::vector<double> angles, radii;
  Polygon corners;

  explicit Star(Random& random) {
    const auto n = 5 + random.index(10);  // less than half a turn between corners
    for (std::uint64_t i = 0; i < n; ++i) {
      angles.push_back((static_cast<double>(i) + random.uniform(0, 0.8)) * 2 * M_PI / static_cast<double>(n));
      radii.push_back(random.uniform(1, 10));
      corners.emplace_back(radii.back() * std::cos(angles.back()), radii.back() * std::sin(angles.back()));
    }
  }
  [[nodiscard]] bool holds(const Vector2d& p) const {
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector2d& a = corners[i];
      const Vector2d& b = corners[(i + 1) % corners.size()];
      if (cross(a, p) >= 0 && cross(p, b) >= 0 && cross(a, b) > 0 && a.dot(p) + b.dot(p) > 0) {
        return cross(b - a, p - a) >= 0;
      }
    }
    return false;
  }
};

// ledger: S6-39
TEST(SimplePolygon, SaysWhatLiesInsideWhateverTheSense) {
  Random random(11);
  int inside = 0;
  for (int round = 0; round < 100; ++round) {
    const Star star(random);
    Polygon turned(star.corners.rbegin(), star.corners.rend());
    ASSERT_TRUE(is_simple(star.corners));
    ASSERT_TRUE(is_simple(turned));
    for (int i = 0; i < 50; ++i) {
      const double x = random.uniform(-10, 10);
      const Vector2d p(x, random.uniform(-10, 10));
      ASSERT_EQ(encloses(star.corners, p), star.holds(p)) << round << ": " << p.transpose();
      ASSERT_EQ(encloses(turned, p), star.holds(p));
      ASSERT_EQ(inner_distance(turned, p) >= 0, star.holds(p));
      inside += star.holds(p);
    }
  }
  EXPECT_GT(inside, 500);
}

// ledger: S6-39
TEST(SimplePolygon, BordersAndCornersBelongToIt) {
  const Polygon bay{{0, 0}, {10, 0}, {10, 10}, {6, 10}, {6, 4}, {4, 4}, {4, 10}, {0, 10}};  // open to the east
  for (const Vector2d& p : bay) EXPECT_TRUE(encloses(bay, p));
  EXPECT_TRUE(encloses(bay, {5, 4}));
  EXPECT_TRUE(encloses(bay, {2, 10}));
  EXPECT_FALSE(encloses(bay, {5, 4 + 1e-12}));
  EXPECT_DOUBLE_EQ(inner_distance(bay, {5, 7}), -1);
  EXPECT_DOUBLE_EQ(inner_distance(bay, {5, 3}), 1);
  EXPECT_DOUBLE_EQ(inner_distance(bay, {5, 10}), -1);
  EXPECT_DOUBLE_EQ(inner_distance(bay, {13, 14}), -5);
}

// ledger: S6-39
TEST(SimplePolygon, AWayLeavesItWhereItFirstCrossesTheBorder) {
  const Polygon bay{{0, 0}, {10, 0}, {10, 10}, {6, 10}, {6, 4}, {4, 4}, {4, 10}, {0, 10}};
  EXPECT_NEAR(first_exit(bay, {2, 8}, {8, 8}).value(), 2.0 / 6, 1e-15);  // over the bay and in again
  EXPECT_FALSE(first_exit(bay, {2, 2}, {8, 3}).has_value());
  EXPECT_FALSE(first_exit(bay, {2, 4}, {8, 4}).has_value());   // along the end of the bay
  EXPECT_FALSE(first_exit(bay, {4, 10}, {4, 4}).has_value());  // along its side
  EXPECT_FALSE(first_exit(bay, {0, 0}, {10, 0}).has_value());  // along the border
  EXPECT_EQ(first_exit(bay, {5, 7}, {5, 1}).value(), 0);       // starts outside
  EXPECT_NEAR(first_exit(bay, {5, 2}, {5, 12}).value(), 0.2, 1e-15);
  EXPECT_FALSE(first_exit(bay, {5, 2}, {5, 2}).has_value());
  EXPECT_EQ(first_exit(bay, {5, 7}, {5, 7}).value(), 0);
  EXPECT_EQ(first_exit(bay, {10, 5}, {12, 5}).value(), 0);  // off the border at once
}

// Against steps along the way. ledger: S6-39
TEST(SimplePolygon, ExitsAgreeWithSmallSteps) {
  Random random(12);
  int exits = 0;
  for (int round = 0; round < 300; ++round) {
    const Star star(random);
    const double a_x = random.uniform(-3, 3), a_y = random.uniform(-3, 3);
    const double b_x = random.uniform(-9, 9), b_y = random.uniform(-9, 9);
    const Vector2d a(a_x, a_y), b(b_x, b_y);
    const auto share = first_exit(star.corners, a, b);
    constexpr int kSteps = 2000;
    int step = 0;
    while (step <= kSteps && star.holds(a + (b - a) * step / kSteps)) ++step;
    if (step > kSteps) {
      // A sliver between two steps may be cut; then the way is outside just there.
      if (share) {
        EXPECT_LT(inner_distance(star.corners, a + *share * (b - a)), 1e-6);
      }
    } else {
      ++exits;
      ASSERT_TRUE(share.has_value());
      EXPECT_LE(*share, static_cast<double>(step) / kSteps + 1e-9);
      EXPECT_NEAR(inner_distance(star.corners, a + *share * (b - a)) * (step > 0), 0, 1e-9);
    }
  }
  EXPECT_GT(exits, 100);
}

TEST(SimplePolygon, RefusesWhatCrossesTouchesOrFolds) {
  EXPECT_FALSE(is_simple({{0, 0}, {1, 0}}));
  EXPECT_FALSE(is_simple({{0, 0}, {1, 1}, {1, 0}, {0, 1}}));          // a bow tie
  EXPECT_FALSE(is_simple({{0, 0}, {2, 0}, {1, 0}}));                  // folds back on itself
  EXPECT_FALSE(is_simple({{0, 0}, {1, 0}, {1, 0}, {0, 1}}));          // a corner twice
  EXPECT_FALSE(is_simple({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}));  // a corner on a side
  EXPECT_TRUE(is_simple({{0, 0}, {2, 0}, {4, 0}, {4, 4}}));           // a corner on a straight side
}

TEST(SimplePolygon, ConvexOnesHaveNoHollow) {
  EXPECT_TRUE(is_convex({{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
  EXPECT_TRUE(is_convex({{0, 2}, {2, 2}, {2, 0}, {0, 0}}));
  EXPECT_TRUE(is_convex({{0, 0}, {1, 0}, {2, 0}, {2, 2}}));
  EXPECT_FALSE(is_convex({{0, 0}, {2, 0}, {0.5, 0.5}, {0, 2}}));
  EXPECT_FALSE(is_convex({{0, 0}, {1, 0}, {2, 0}}));
  Polygon pentagram;
  for (int i = 0; i < 5; ++i) pentagram.emplace_back(std::cos(i * 0.8 * M_PI), std::sin(i * 0.8 * M_PI));
  EXPECT_FALSE(is_convex(pentagram));
}

}  // namespace
}  // namespace isobath
