#include <gmock/gmock.h>
#include <isobath/sonar/roc.hpp>
#include <vector>

namespace isobath {
namespace {

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

TEST(NormalTail, MatchesPublishedValues) {
  EXPECT_NEAR(normal_tail(1.959963984540054), 0.025, 1e-15);
  EXPECT_NEAR(normal_tail(-2.053748910631823), 0.98, 1e-15);
  EXPECT_NEAR(normal_tail(6.361340902404056) / 1e-10, 1, 1e-13);
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
