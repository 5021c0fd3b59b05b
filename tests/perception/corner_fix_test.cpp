// A drifting vehicle that goes round a known body.
#include <array>
#include <cmath>
#include <Eigen/LU>
#include <gmock/gmock.h>
#include <isobath/perception/corner_fix.hpp>
#include <isobath/perception/scan_shapes.hpp>
#include <tests/support/plane_rays.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

PlaneCorner corner_at(const Vector2d& at, double sigma) {
  PlaneCorner corner;
  corner.at = at;
  corner.covariance = sigma * sigma * Matrix2d::Identity();
  return corner;
}

/// Corners whose walls run north and east, as those of corner_at.
template <std::size_t count>
std::array<ChartedCorner, count> charted(const std::array<Vector2d, count>& places) {
  std::array<ChartedCorner, count> corners;
  for (std::size_t i = 0; i < count; ++i) corners[i] = {places[i], {Vector2d::UnitX(), Vector2d::UnitY()}};
  return corners;
}

// ledger: S4-49
TEST(CornerFix, CornersOfTheChartAreWhereItsWallsMeet) {
  const std::array<ChartedWall, 7> walls{{{{0, 0}, {0, 10}},
                                          {{0, 10}, {-8, 10}},
                                          {{-8, 10}, {-16, 10.5}},  // nearly straight on
                                          {{0, 0}, {1, 0}},         // too short
                                          {{0, 10}, {0, 0}},        // drawn twice
                                          {{30, 0}, {40, 0}},
                                          {{40, 0.01}, {40, 9}}}};  // a gap
  const auto corners = corners_of(walls);
  ASSERT_EQ(corners.size(), 1u);
  EXPECT_EQ(corners[0].at, Vector2d(0, 10));
  EXPECT_NEAR(corners[0].along[0].dot(corners[0].along[1]), 0, 1e-12);
  EXPECT_NEAR((corners[0].along[0] + corners[0].along[1] + Vector2d(1, 1)).norm(), 0, 1e-12);
}

// ledger: S4-49
TEST(CornerFix, IsWhereChartAndSightAgree) {
  const PlanePosition believed{{10, 20}, Matrix2d::Identity()};
  const Vector2d error(0.6, -0.4);  // of the belief: what is seen is told off by as much
  const std::array<Vector2d, 2> places{Vector2d(14, 20), Vector2d(10, 30)};
  const auto chart = charted(places);
  const std::array<PlaneCorner, 2> seen{corner_at(places[0] + error, 0.1), corner_at(places[1] + error, 0.2)};
  const auto fix = corner_fix(believed, seen, chart);
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->corners, 2);
  EXPECT_LT((fix->at - (believed.at - error)).norm(), 1e-12);
  EXPECT_NEAR(fix->covariance(0, 0), 1 / (1 / 0.01 + 1 / 0.04), 1e-12);
  // an error of the heading swings a corner across the line of sight: the one to the north is of no use for east
  const auto swung = corner_fix(believed, {seen.data(), 1}, chart, Angle::degrees(5));
  const Vector2d swing = Vector2d(0.4, 4.6) * (5 * std::numbers::pi / 180);  // of a sight of (4.6, -0.4) m
  EXPECT_LT((swung->covariance - 0.01 * Matrix2d::Identity() - swing * swing.transpose()).norm(), 1e-12);
}

// ledger: S4-49
TEST(CornerFix, SaysNothingOfACornerThatFitsTwoPlacesOrNone) {
  const PlanePosition believed{{0, 0}, Matrix2d::Identity()};
  const auto chart = charted(std::array{Vector2d(10, 0), Vector2d(11, 0)});
  const std::array<PlaneCorner, 1> between{corner_at({10.4, 0}, 0.1)}, nowhere{corner_at({-8, 3}, 0.1)};
  EXPECT_FALSE(corner_fix(believed, between, chart));
  EXPECT_FALSE(corner_fix(believed, nowhere, chart));
  EXPECT_FALSE(corner_fix(believed, {}, chart));
  const PlanePosition sure{{0, 0}, 0.01 * Matrix2d::Identity()};
  PlaneCorner corner = corner_at({10.1, 0}, 0.1);
  EXPECT_TRUE(corner_fix(sure, std::array{corner}, chart));
  std::swap(corner.along[0], corner.along[1]);
  EXPECT_TRUE(corner_fix(sure, std::array{corner}, chart)) << "whichever face comes first";
  corner.along[0] = -corner.along[0];
  EXPECT_FALSE(corner_fix(sure, std::array{corner}, chart)) << "another corner of the same body";
}

/// Errors over three rounds of 69 m, as far as it believes and as it is.
struct Loop {
  double last_error = 0, worst_error = 0, last_sigma = 0, worst_normalised = 0;
  int fixes = 0;
};
Loop go_round(bool with_fixes, std::uint64_t seed) {
  Random random(seed);
  const std::array<Vector2d, 4> places{Vector2d(-3, -4), Vector2d(-1, 4), Vector2d(6, 6), Vector2d(4, -2)};
  test::PlanRoom body;
  std::vector<ChartedWall> walls;
  for (std::size_t i = 0; i < 4; ++i) walls.push_back({places[i], places[(i + 1) % 4]});
  for (const ChartedWall& wall : walls) body.segments.push_back({wall.a, wall.b});
  const std::vector<ChartedCorner> chart = corners_of(walls);
  const double bias_bearing = random.uniform(0, 2 * std::numbers::pi);
  const Vector2d bias = 0.01 * Vector2d(std::cos(bias_bearing), std::sin(bias_bearing));  // 1 % of the way
  const auto place = [](int i) { return Vector2d(1.5 + 11 * std::cos(i * 0.2), 1 + 11 * std::sin(i * 0.2)); };
  PlanePosition believed{place(0), 1e-4 * Matrix2d::Identity()};
  Loop loop;
  for (int i = 1; i <= 94; ++i) {
    const Vector2d step = place(i) - place(i - 1);
    believed.at += step + bias * step.norm();
    // drift of a correlation length of a round: its variance grows so that the bias is within it
    believed.covariance += 2 * step.norm() * 69 * 0.01 * 0.01 / 2 * Matrix2d::Identity();
    if (with_fixes) {
      PlaneScan scan = test::plan_scan(body, place(i), random, 1, 20);
      scan.from = believed.at;  // as it takes itself to be
      std::vector<PlaneCorner> seen;
      for (const ScanCorner& corner : shapes_of(scan).corners) {
        if (corner.convex) seen.push_back(corner);
      }
      if (const auto fix = corner_fix(believed, seen, chart)) {
        believed = fused(believed, *fix);
        ++loop.fixes;
      }
    }
    const Vector2d error = believed.at - place(i);
    loop.last_error = error.norm();
    loop.worst_error = std::max(loop.worst_error, error.norm());
    loop.worst_normalised = std::max(loop.worst_normalised, error.dot(believed.covariance.inverse() * error));
    loop.last_sigma = std::sqrt(believed.covariance.trace());
  }
  return loop;
}

// ledger: S4-49
TEST(CornerFix, BoundsTheDriftOnALoopRoundAKnownBodyThatGrowsWithoutIt) {
  ISOBATH_NOT_SANITIZED();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Loop without = go_round(false, seed), with = go_round(true, seed);
    EXPECT_NEAR(without.last_error, 0.01 * 94 * 2 * 11 * std::sin(0.1), 0.01) << "1 % of 207 m";
    EXPECT_EQ(without.worst_error, without.last_error) << "it grows all the way";
    EXPECT_GT(with.fixes, 40) << seed;
    EXPECT_LT(with.worst_error, 0.8) << seed;
    EXPECT_LT(with.last_error, 0.5) << seed;
    EXPECT_LT(with.last_sigma, 0.5) << seed;
    EXPECT_LT(with.worst_normalised, 25) << "it knows how far off it may be";
  }
}

}  // namespace
}  // namespace isobath
