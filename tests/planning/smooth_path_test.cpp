// Paths of corners as arcs and legs, judged by dense samples.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/roadmap/obstacle_shapes.hpp>
#include <isobath/planning/roadmap/visibility_graph.hpp>
#include <isobath/planning/traffic/smooth_path.hpp>
#include <numbers>

namespace isobath::smooth_path_test {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double kRadius = 5;

GrownObstacles grown(const std::vector<Polygon>& outlines, double by_m) {
  std::vector<GrownPart> parts;
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    for (const Polygon& part : convex_parts(outlines[i])) {
      parts.push_back({static_cast<int>(i), static_cast<int>(i), part, grown_polygon(part, by_m, 12)});
    }
  }
  return GrownObstacles(std::move(parts));
}

Polygon box(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

/// Curvature at most 1 / radius, no jump in place or heading; returns the least distance to the outlines.
double expect_smooth(const SmoothPath& path, const std::vector<Polygon>& outlines) {
  double least = INFINITY;
  MotionState last = path.at(0);
  for (double s = 0; s <= path.length_m(); s += 0.05) {
    const MotionState at = path.at(s);
    EXPECT_LT((at.p_W - last.p_W).norm(), 0.0501);
    EXPECT_LE(std::abs(std::remainder(at.heading - last.heading, 2 * pi)), 0.0501 / kRadius);
    last = at;
    for (const Polygon& outline : outlines) least = std::min(least, -inner_distance(outline, at.p_W));
  }
  return least;
}

// ledger: S3-23
TEST(SmoothPath, TrimsTheLegsAtACorner) {
  const std::vector<Vector2d> corners = {{30, 0}, {30, 30}};
  const auto path = smooth_path({{0, 0}, 0, 0}, corners, kRadius, grown({}, 1));
  ASSERT_TRUE(path);
  ASSERT_EQ(path->pieces.size(), 3u);
  EXPECT_NEAR(path->pieces[0].length_m, 30 - kRadius * std::tan(pi / 4), 1e-9) << "rho tan(D / 2)";
  EXPECT_NEAR(path->pieces[1].length_m, kRadius * pi / 2, 1e-9);
  const Vector2d middle = path->at(path->pieces[1].start_m + path->pieces[1].length_m / 2).p_W;
  EXPECT_NEAR((middle - corners[0]).norm(), kRadius * (1 / std::cos(pi / 4) - 1), 1e-9) << "rho (1 / cos(D / 2) - 1)";
  EXPECT_NEAR((path->at(path->length_m()).p_W - corners[1]).norm(), 0, 1e-9);
}

TEST(SmoothPath, BeginsWithTheHeadingOfTheVehicle) {
  for (double heading = -3; heading <= 3; heading += 0.25) {
    const std::vector<Vector2d> corners = {{40, 0}};
    const MotionState start{{0, 0}, heading, 1};
    const auto path = smooth_path(start, corners, kRadius, grown({}, 1));
    ASSERT_TRUE(path);
    expect_smooth(*path, {});
    EXPECT_EQ(path->at(0).heading, heading);
    EXPECT_LT(path->length_m(), 40 + 2 * pi * kRadius);
    EXPECT_NEAR((path->at(path->length_m()).p_W - corners[0]).norm(), 0, 1e-9);
  }
}

// Shortest paths touch the obstacles at their corners, where an arc inside of the corner would cut them. Among boxes
// more than two turning radii apart each one can be smoothed. ledger: S3-23 S3-14
TEST(SmoothPath, GoesOutsideOfTheCornersOfShortestPaths) {
  Random random(3);
  int smoothed = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<Polygon> outlines;
    for (int k = 0; k < 4; ++k) {
      const double x = 25 + 30 * k + random.uniform(-3, 3), y = random.uniform(-12, 12), half = random.uniform(2, 10);
      outlines.push_back(box(x - random.uniform(0.5, 6), y - half, x + random.uniform(0.5, 6), y + half));
    }
    const auto wide = grown(outlines, 0.85), narrow = grown(outlines, 0.8);
    const auto points = VisibilityGraph(wide).shortest_path({0, 0}, {140, 0});
    ASSERT_GE(points.size(), 2u);
    const double towards = std::atan2(points[1].y(), points[1].x());
    const auto path = smooth_path({{0, 0}, towards, 1}, std::span(points).subspan(1), kRadius, narrow);
    if (!path) continue;
    ++smoothed;
    EXPECT_GE(expect_smooth(*path, outlines), 0.79);
    double corners_m = 0;
    for (std::size_t k = 1; k < points.size(); ++k) corners_m += (points[k] - points[k - 1]).norm();
    EXPECT_LT(path->length_m(), 1.05 * corners_m);
  }
  EXPECT_GE(smoothed, 295);
}

// Round the end of a thin wall and back, where the legs are nearer to each other than two radii. ledger: S3-24
TEST(SmoothPath, RefusesAHairpinNarrowerThanTwiceTheRadius) {
  const std::vector<Polygon> outlines = {box(-10, 0.9, 30, 1.1), box(-10, -8, 60, -3), box(36, -3, 40, 8),
                                         box(-10, 5, 36, 8)};
  const std::vector<Vector2d> corners = {{31, 0}, {32, 1}, {31, 2}, {0, 3}};
  const auto path = smooth_path({{0, -1}, 0, 1}, corners, kRadius, grown(outlines, 0.5));
  ASSERT_FALSE(path);
  EXPECT_EQ(path.error().place.x(), 31) << "the first corner that does not fit";
  const auto free = smooth_path({{0, -1}, 0, 1}, corners, kRadius, grown({outlines[0]}, 0.5));
  ASSERT_TRUE(free) << "in open water one arc goes round the wall";
  EXPECT_GE(expect_smooth(*free, {outlines[0]}), 0.49);
}

}  // namespace
}  // namespace isobath::smooth_path_test
