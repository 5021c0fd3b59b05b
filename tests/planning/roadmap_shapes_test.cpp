// Shapes of obstacles: what growth, enclosures, hulls and convex parts promise.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/polygon_parts.hpp>
#include <isobath/planning/roadmap/obstacle_shapes.hpp>
#include <numbers>
#include <tests/planning/roadmap_scenes.hpp>

namespace isobath::roadmap_shapes_test {
namespace {

using Eigen::Vector2d;

Polygon u_shape() { return {{0, 0}, {20, 0}, {20, 16}, {16, 16}, {16, 4}, {4, 4}, {4, 16}, {0, 16}}; }

// ledger: S3-10
TEST(RoadmapShapes, ABorderOfAGrownPolygonIsWithinTheBound) {
  Random random(1);
  for (const int sides : {3, 4, 8, 12, 16}) {
    for (int i = 0; i < 100; ++i) {
      const double radius = random.uniform(0.1, 5);
      Polygon body = test::random_body(random, {3, -2}, 4, 2 + i % 8);
      if (i % 10 == 0) body.resize(1);
      const Polygon border = grown_polygon(body, radius, sides);
      const double bound = radius * (1 / std::cos(std::numbers::pi / sides) - 1);
      for (std::size_t k = 0; k < border.size(); ++k) {
        for (double share = 0; share < 1; share += 0.1) {
          const Vector2d p = border[k] + share * (border[(k + 1) % border.size()] - border[k]);
          double away = (body.front() - p).norm();
          for (std::size_t j = 0; j < body.size(); ++j) {
            away = std::min(away, (nearest_on_segment(body[j], body[(j + 1) % body.size()], p) - p).norm());
          }
          ASSERT_GE(away, radius - 1e-9);
          ASSERT_LE(away, radius + bound + 1e-9);
        }
      }
    }
  }
}

// ledger: S3-11 S3-13
TEST(RoadmapShapes, EnclosuresHoldAllPointsWithFewCorners) {
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    Polygon points;
    const int count = 1 + static_cast<int>(random.index(40));
    for (int k = 0; k < count; ++k) points.emplace_back(10 * random.normal(), random.normal());
    const Polygon hull = convex_hull(points), enclosure = convex_enclosure(points);
    ASSERT_LE(enclosure.size(), std::max<std::size_t>(6, std::min<std::size_t>(hull.size(), 6)));
    if (hull.size() < 3) continue;
    ASSERT_TRUE(is_convex(enclosure));
    ASSERT_GE(area(enclosure), area(hull) - 1e-9);
    for (const Vector2d& p : points) {
      ASSERT_LT(distance_from(enclosure, p), 1e-9);
      ASSERT_LT(distance_from(hull, p), 1e-9);
    }
    if (count < 20) continue;  // of an elongated obstacle
    double radius2 = 0;
    for (const Vector2d& p : points) radius2 = std::max(radius2, (p - hull.front()).squaredNorm() / 4);
    ASSERT_LT(area(enclosure), std::numbers::pi * radius2) << "smaller than any circle around it";
  }
}

/// Random star-shaped outlines, and the U.
std::vector<Polygon> outlines() {
  std::vector<Polygon> all{u_shape()};
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    Polygon star;
    const int corners = 4 + static_cast<int>(random.index(20));
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * std::numbers::pi * (k + random.uniform(0, 0.5)) / corners;
      star.emplace_back(random.uniform(1, 10) * Vector2d(std::cos(angle), std::sin(angle)));
    }
    if (i % 2 == 0) std::reverse(star.begin(), star.end());
    if (is_simple(star)) all.push_back(star);
  }
  return all;
}

// ledger: S3-13
TEST(RoadmapShapes, ConvexPartsTogetherAreTheOutline) {
  Random random(4);
  for (const Polygon& outline : outlines()) {
    const auto parts = convex_parts(outline);
    double total = 0;
    for (const Polygon& part : parts) {
      ASSERT_TRUE(is_convex(part));
      total += area(part);
    }
    ASSERT_NEAR(total, std::abs(area(outline)), 1e-9 * total);
    for (int i = 0; i < 50; ++i) {
      const Vector2d p(random.uniform(-10, 20), random.uniform(-10, 16));
      if (std::abs(inner_distance(outline, p)) < 1e-6) continue;
      ASSERT_EQ(distance_from(std::span<const Polygon>(parts), p) == 0, encloses(outline, p));
    }
  }
  EXPECT_EQ(convex_parts(u_shape()).size(), 3u);
  EXPECT_EQ(convex_parts({{0, 0}, {4, 0}, {4, 4}, {0, 4}}).size(), 1u);
  const Polygon crossing{{0, 0}, {4, 4}, {4, 0}, {0, 4}};
  EXPECT_EQ(convex_parts(crossing), std::vector<Polygon>{convex_hull(crossing)});
  EXPECT_EQ(shape_of({{1, 2}}, ShapeDetail::kParts), (std::vector<Polygon>{{{1, 2}}}));
}

}  // namespace
}  // namespace isobath::roadmap_shapes_test
