#include <gmock/gmock.h>
#include <cmath>
#include <isobath/base/random.hpp>
#include <isobath/sonar/roc.hpp>
#include <vector>

namespace isobath {
namespace {

// ledger: S6-04 S6-E20
TEST(EchoCounts, AreTheFourCellsOfAScriptedSet) {
  EchoCounts counts;
  EXPECT_FALSE(counts.p());
  EXPECT_FALSE(counts.f());
  for (int i = 0; i < 3; ++i) counts.add(true, true);
  counts.add(false, true);
  EXPECT_DOUBLE_EQ(*counts.p(), 0.75);
  EXPECT_FALSE(counts.f()) << "0/0 is missing, not 0";
  for (int i = 0; i < 9; ++i) counts.add(false, false);
  counts.add(true, false);
  EXPECT_EQ(counts, (EchoCounts{3, 1, 1, 9}));
  EXPECT_DOUBLE_EQ(*counts.f(), 0.1);
  counts += counts;
  EXPECT_EQ(counts, (EchoCounts{6, 2, 2, 18}));
}

// Published example values (Newcombe 1998, table I, method 3).
TEST(WilsonInterval, MatchesPublishedValues) {
  const auto near = [](Interval i, double low, double high) {
    EXPECT_NEAR(i.low, low, 5e-5);
    EXPECT_NEAR(i.high, high, 5e-5);
  };
  near(wilson_interval(81, 263), 0.2553, 0.3662);
  near(wilson_interval(15, 148), 0.0624, 0.1605);
  near(wilson_interval(0, 20), 0, 0.1611);
  near(wilson_interval(1, 29), 0.0061, 0.1718);
  near(wilson_interval(0, 0), 0, 1);
}

TEST(NormalQuantile, IsTheInverseOfTheTail) {
  for (double q : {1e-300, 1e-30, 1e-9, 0.001, 0.02, 0.3, 0.4999, 0.5}) {
    const double x = -normal_quantile(q);
    EXPECT_NEAR(normal_tail(x) / q, 1, 1e-12 * std::max(1.0, x * x));
  }
  EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-14);
  EXPECT_NEAR(normal_quantile(0.02), -2.053748910631823, 1e-14);
  EXPECT_NEAR(normal_quantile(1e-10), -6.361340902404056, 1e-13);
  EXPECT_NEAR(erfc_inverse(0.04), 2.053748910631823 / std::sqrt(2), 1e-14);
  EXPECT_NEAR(erfc_inverse(1.96), -2.053748910631823 / std::sqrt(2), 1e-13);
}

// ledger: S6-07
TEST(TheoreticalRoc, HasTheValuesOfEquation41) {
  const auto snr = [](double decibel) { return std::pow(10, decibel / 10); };
  EXPECT_NEAR(theoretical_detection(0.01, snr(11.15)), 0.9, 1e-3);
  EXPECT_NEAR(theoretical_detection(0.02, snr(10.46)), 0.9, 1e-3);
  EXPECT_NEAR(theoretical_detection(0.03, snr(10.00)), 0.9, 1e-3);
  EXPECT_NEAR(theoretical_detection(0.04, snr(9.64)), 0.9, 1e-3);
  EXPECT_NEAR(theoretical_detection(0.02, snr(9)), 0.778, 1e-3);
  EXPECT_NEAR(gaussian_threshold(0.02, 1), 2.054, 1e-3);
  for (double f : {0.01, 0.02, 0.5, 0.9}) EXPECT_NEAR(theoretical_detection(f, 0), f, 1e-14);
}

// ledger: S6-07
TEST(TheoreticalRoc, AgreesWithMonteCarlo) {
  Random random(7);
  constexpr int kRuns = 200000;
  for (double f : {0.01, 0.02, 0.04}) {
    const double amplitude = std::sqrt(std::pow(10, 0.9));
    const double threshold = gaussian_threshold(f, 1);
    int hits = 0;
    for (int i = 0; i < kRuns; ++i) hits += amplitude + random.normal() >= threshold;
    const double p = theoretical_detection(f, amplitude * amplitude);
    EXPECT_NEAR(hits / double(kRuns), p, 3 * std::sqrt(p * (1 - p) / kRuns));
  }
}

// ledger: S6-05
TEST(RocCurve, RisesFromNothingToEverything) {
  const std::vector<double> edges = {0, 1, 2, 3, 4};
  const RocCurve roc(edges, {4, 3, 2, 1}, {1, 2, 3, 4});
  const std::vector<RocPoint> wanted = {{4, 0, 0}, {3, 0.1, 0.4}, {2, 0.3, 0.7}, {1, 0.6, 0.9}, {0, 1, 1}};
  ASSERT_EQ(roc.points().size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_DOUBLE_EQ(roc.points()[i].threshold, wanted[i].threshold);
    EXPECT_DOUBLE_EQ(roc.points()[i].f, wanted[i].f);
    EXPECT_DOUBLE_EQ(roc.points()[i].p, wanted[i].p);
  }
  // Mann-Whitney: P(target above noise) + half of the ties, counted by hand over all pairs.
  double above = 0;
  const int noise[] = {4, 3, 2, 1}, target[] = {1, 2, 3, 4};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) above += noise[i] * target[j] * (j > i ? 1 : j == i ? 0.5 : 0);
  }
  EXPECT_NEAR(roc.area(), above / 100, 1e-14);
}

// ledger: S6-05 S6-06
TEST(RocCurve, IsReadBetweenItsPoints) {
  const RocCurve roc({0, 1, 2, 3, 4}, {4, 3, 2, 1}, {1, 2, 3, 4});
  const RocPoint point = roc.at_false_alarm(0.2);
  EXPECT_DOUBLE_EQ(point.p, 0.55);
  EXPECT_DOUBLE_EQ(point.threshold, 2.5);
  EXPECT_DOUBLE_EQ(roc.at_false_alarm(0).p, 0);
  EXPECT_DOUBLE_EQ(roc.at_false_alarm(1).p, 1);
  const RocCurve apart({0, 1, 2}, {5, 0}, {0, 5});
  EXPECT_DOUBLE_EQ(apart.at_false_alarm(0).p, 1) << "the top of a vertical stretch";
  EXPECT_DOUBLE_EQ(apart.area(), 1);
}

}  // namespace
}  // namespace isobath
