// Position from distances to known places.
#include <cmath>
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/trilateration.hpp>
#include <vector>

namespace isobath {
namespace {

using Vector3 = Eigen::Vector3d;

const std::vector<Vector3> kSquare = {{0, 0, 20}, {400, 0, 20}, {400, 400, 30}, {0, 400, 30}};
const std::vector<Vector3> kTetrahedron = {{0, 0, 0}, {400, 0, 0}, {400, 400, 60}, {0, 400, 90}, {200, 200, 10}};

std::vector<TransponderRange> ranges_to(const Vector3& p, const std::vector<Vector3>& transponders, std::size_t count) {
  std::vector<TransponderRange> ranges;
  for (std::size_t i = 0; i < count; ++i) ranges.push_back({transponders[i], (p - transponders[i]).norm()});
  return ranges;
}

const std::vector<Vector3> kPlaces = {{120, 80, 5}, {-300, 900, 50}, {0.1, 0.1, 0.5}, {200, 390, 29}};

// ledger: S1-10 S1-E04
TEST(Trilateration, ExactRangesAndDepthGiveThePosition) {
  for (const Vector3& p : kPlaces) {
    for (const std::size_t count : {3u, 4u}) {
      const auto fix = trilaterate(ranges_to(p, kSquare, count), {p.z(), 0.5});
      ASSERT_TRUE(fix);
      EXPECT_LT((fix->p_W - p).norm(), 1e-6);
      EXPECT_LT(fix->residual, 1e-6);
      EXPECT_FALSE(fix->gross);
    }
  }
}

// ledger: S1-10
TEST(Trilateration, ExactRangesGiveThePositionInSpace) {
  for (const Vector3& p : kPlaces) {
    const auto fix = trilaterate(ranges_to(p, kTetrahedron, 5), {{}, 0.5});
    ASSERT_TRUE(fix);
    EXPECT_LT((fix->p_W - p).norm(), 1e-6);
  }
}

// Three transponders fix a place and its image below their plane; two, at a known depth, one beside their line.
// ledger: S1-10
TEST(Trilateration, TheLastFixDecidesBetweenThePlaceAndItsMirrorImage) {
  const Vector3 p(120, 80, 5);
  for (const auto& [count, depth] : {std::pair(2u, std::optional(5.0)), std::pair(3u, std::optional<double>())}) {
    const auto ranges = ranges_to(p, kSquare, count);
    EXPECT_EQ(trilaterate(ranges, {depth, 0.5}).error(), TrilaterationRefusal::kMirrorImage);
    const auto fix = trilaterate(ranges, {depth, 0.5, p + Vector3(20, -15, 2)});
    ASSERT_TRUE(fix);
    EXPECT_LT((fix->p_W - p).norm(), 1e-6);
    const Vector3 other_side(p.x(), count == 2 ? -80 : 80, count == 2 ? 5 : 100);
    const auto image = trilaterate(ranges, {depth, 0.5, other_side});
    ASSERT_TRUE(image);
    EXPECT_GT((image->p_W - p).norm(), 20);
    for (const TransponderRange& r : ranges) EXPECT_NEAR((image->p_W - r.p_WT).norm(), r.range, 1e-6);
  }
}

// A bottom that is nearly flat leaves two candidates, but the fix uses the transponders' true depths.
// ledger: S1-10
TEST(Trilateration, TranspondersOnANearlyFlatBottomAreSharpInDepth) {
  const std::vector<Vector3> bottom = {{0, 0, 50.3}, {400, 0, 49.8}, {400, 400, 50.1}, {0, 400, 50.6}};
  const Vector3 p(150, 220, 12);
  const auto fix = trilaterate(ranges_to(p, bottom, 4), {{}, 0.5, Vector3(200, 200, 0)});
  ASSERT_TRUE(fix);
  EXPECT_LT((fix->p_W - p).norm(), 1e-6);
}

/// Of Gaussian ranges, Cramer-Rao.
Eigen::MatrixXd bound(const Vector3& p, const std::vector<TransponderRange>& ranges, int unknowns, double sigma) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(unknowns, unknowns);
  for (const TransponderRange& r : ranges) {
    const Eigen::VectorXd row = ((p - r.p_WT) / (p - r.p_WT).norm()).head(unknowns);
    information += row * row.transpose() / (sigma * sigma);
  }
  return information.inverse();
}

// ledger: S1-10
TEST(Trilateration, ErrorsHaveTheCovarianceOfTheBound) {
  const Vector3 p(120, 80, 150);
  for (const int unknowns : {2, 3}) {
    const auto exact = ranges_to(p, kTetrahedron, 5);
    const Eigen::MatrixXd expected = bound(p, exact, unknowns, 0.5);
    Random random(1);
    Eigen::MatrixXd found = Eigen::MatrixXd::Zero(unknowns, unknowns);
    int gross = 0;
    constexpr int kTrials = 2000;
    for (int i = 0; i < kTrials; ++i) {
      auto ranges = exact;
      for (TransponderRange& r : ranges) r.range += 0.5 * random.normal();
      const auto fix = trilaterate(ranges, {unknowns == 2 ? std::optional(p.z()) : std::nullopt, 0.5});
      ASSERT_TRUE(fix);
      EXPECT_LT((fix->covariance.topLeftCorner(unknowns, unknowns) - expected).norm(), 0.05 * expected.norm());
      const Eigen::VectorXd error = (fix->p_W - p).head(unknowns);
      found += error * error.transpose() / kTrials;
      gross += fix->gross;
    }
    for (int i = 0; i < unknowns; ++i) {
      EXPECT_NEAR(found(i, i), expected(i, i), 0.1 * expected(i, i));
      for (int j = 0; j < i; ++j) {
        EXPECT_NEAR(found(i, j), expected(i, j), 0.1 * std::sqrt(expected(i, i) * expected(j, j)));
      }
    }
    EXPECT_LE(gross, 3);  // 4 sigma: 6e-5 a range
  }
}

// ledger: S1-10
TEST(Trilateration, OneGrossRangeIsSeenAndNamed) {
  const Vector3 p(120, 80, 5);
  Random random(2);
  for (std::size_t wrong = 0; wrong < 5; ++wrong) {
    auto ranges = ranges_to(p, kTetrahedron, 5);
    for (TransponderRange& r : ranges) r.range += 0.5 * random.normal();
    ranges[wrong].range += 30;
    const auto fix = trilaterate(ranges, {p.z(), 0.5});
    ASSERT_TRUE(fix);
    EXPECT_TRUE(fix->gross);
    EXPECT_GT(fix->residual, 5);
    EXPECT_EQ(fix->suspect, wrong);
  }
  auto three = ranges_to(p, kSquare, 3);
  three[1].range += 30;
  const auto fix = trilaterate(three, {p.z(), 0.5});
  ASSERT_TRUE(fix);
  EXPECT_TRUE(fix->gross);
  EXPECT_EQ(fix->suspect, std::nullopt);  // any of the three could be the one
}

// ledger: S1-10
TEST(Trilateration, RefusesWhatCannotBeSolved) {
  const Vector3 p(120, 80, 5);
  EXPECT_EQ(trilaterate({}, {p.z(), 0.5}).error(), TrilaterationRefusal::kTooFewRanges);
  EXPECT_EQ(trilaterate(ranges_to(p, kSquare, 1), {p.z(), 0.5}).error(), TrilaterationRefusal::kTooFewRanges);
  EXPECT_EQ(trilaterate(ranges_to(p, kSquare, 2), {{}, 0.5}).error(), TrilaterationRefusal::kTooFewRanges);
  const std::vector<Vector3> line = {{0, 0, 0}, {100, 100, 0}, {200, 200, 0}};
  EXPECT_EQ(trilaterate(ranges_to(p, line, 3), {p.z(), 0.5}).error(), TrilaterationRefusal::kMirrorImage);
  EXPECT_EQ(trilaterate(ranges_to(p, line, 3), {{}, 0.5}).error(), TrilaterationRefusal::kBadGeometry);
  const std::vector<Vector3> one_place(4, Vector3(5, 5, 5));
  EXPECT_EQ(trilaterate(ranges_to(p, one_place, 4), {p.z(), 0.5}).error(), TrilaterationRefusal::kBadGeometry);
  auto broken = ranges_to(p, kSquare, 4);
  broken[3].range = NAN;
  EXPECT_FALSE(trilaterate(broken, {p.z(), 0.5}));
}

}  // namespace
}  // namespace isobath
