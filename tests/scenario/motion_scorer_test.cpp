#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/scenario/motion_scorer.hpp>
#include <isobath/scenario/set_distance.hpp>
#include <numeric>

namespace isobath::motion_scorer_test {
namespace {

using Eigen::Vector2d;

constexpr double kCutOff_m = MotionScorer::kCutOff_m;

double cost_of(const Eigen::MatrixXd& cost, const std::vector<std::size_t>& columns) {
  double sum = 0;
  for (Eigen::Index row = 0; row < cost.rows(); ++row)
    sum += cost(row, static_cast<Eigen::Index>(columns[static_cast<std::size_t>(row)]));
  return sum;
}

double least_of_all(const Eigen::MatrixXd& cost) {
  std::vector<std::size_t> order(static_cast<std::size_t>(cost.cols()));
  std::iota(order.begin(), order.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  do {
    least = std::min(least, cost_of(cost, order));
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

TEST(LeastAssignment, CostsAsLittleAsTheBestOfAllAssignments) {
  Random random(7);
  for (int trial = 0; trial < 60; ++trial) {
    const Eigen::Index rows = 1 + trial % 5, columns = rows + trial % 3;
    Eigen::MatrixXd cost(rows, columns);
    // Whole numbers, so that there are ties.
    for (Eigen::Index i = 0; i < cost.size(); ++i) cost.data()[i] = static_cast<double>(random.index(8));
    const std::vector<std::size_t> assigned = least_assignment(cost);
    std::vector<std::size_t> once = assigned;
    std::ranges::sort(once);
    EXPECT_EQ(std::ranges::adjacent_find(once), once.end()) << "a column is taken twice";
    EXPECT_DOUBLE_EQ(cost_of(cost, assigned), least_of_all(cost)) << "trial " << trial;
  }
}

TEST(MotionScorer, ABodyWithoutATrackCostsTheCutOffAndSoDoesATrackWithoutABody) {
  MotionScorer scorer;
  const std::vector<MotionScorer::TrueBody> bodies = {{0, {10, 0}, {1, 0}, true}, {1, {20, 0}, {0, 1}, true}};
  const std::vector<MotionScorer::Track> one = {{5, {10, 3}, {1, 0.5}}};
  scorer.add(1, bodies, one);
  EXPECT_DOUBLE_EQ(scorer.score().ospa_m, (3 + kCutOff_m) / 2);
  EXPECT_DOUBLE_EQ(scorer.score().held_share, 0.5);
  EXPECT_DOUBLE_EQ(scorer.score().velocity_rms, 0.5);
  EXPECT_DOUBLE_EQ(scorer.score().position_rms_m, 3);
  const std::vector<MotionScorer::Track> far = {{5, {10, 0}, {1, 0}}, {6, {20, 0}, {0, 1}}, {7, {-30, 0}, {0, 1}}};
  scorer.add(2, bodies, far);
  EXPECT_DOUBLE_EQ(scorer.score().ospa_m, ((3 + kCutOff_m) / 2 + kCutOff_m / 3) / 2) << "the mean of both scans";
  EXPECT_DOUBLE_EQ(scorer.score().false_tracks, 0.5);
}

TEST(MotionScorer, ABodyIsKnownFromItsFirstTrackOnAndAnotherTrackIsASwitch) {
  MotionScorer scorer;
  const auto at = [](double t) { return std::vector<MotionScorer::TrueBody>{{3, {t, 0}, {1, 0}, true}}; };
  const auto track = [](std::uint32_t number, double t) {
    return std::vector<MotionScorer::Track>{{number, {t, 0}, {1, 0}}};
  };
  scorer.add(10, at(10), {});
  scorer.add(14, at(14), track(1, 14));
  scorer.add(15, at(15), track(1, 15));
  scorer.add(16, at(16), track(2, 16));
  const MotionScore score = scorer.score();
  EXPECT_EQ(score.bodies, 1);
  EXPECT_EQ(score.known, 1);
  EXPECT_DOUBLE_EQ(score.known_after_s, 4);
  EXPECT_EQ(score.switches, 1);
}

TEST(MotionScorer, WhatIsHiddenAndWhatHardlyMovesDoesNotCount) {
  MotionScorer scorer;
  const std::vector<MotionScorer::TrueBody> bodies = {{0, {10, 0}, {1, 0}, false}, {1, {40, 0}, {0.1, 0}, true}};
  const std::vector<MotionScorer::Track> coasting = {{5, {11, 0}, {1, 0}}};
  scorer.add(1, bodies, coasting);
  EXPECT_EQ(scorer.score().scans, 0);
  EXPECT_EQ(scorer.score().bodies, 0);
}

}  // namespace
}  // namespace isobath::motion_scorer_test
