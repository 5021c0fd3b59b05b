// Shares of times that are counted in steps, held against the times themselves.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/onboard/latency_histogram.hpp>
#include <vector>

namespace isobath {
namespace {

// ledger: S6-31
TEST(LatencyHistogram, ItsSharesAreThoseOfTheTimes) {
  Random random(11);
  LatencyHistogram spread;
  std::vector<double> times;
  for (int i = 0; i < 20'000; ++i) {
    times.push_back(std::pow(10, random.uniform(-2.5, 4)));
    spread.add(times.back());
  }
  std::ranges::sort(times);
  const StageTime told = spread.time();
  EXPECT_EQ(told.count, 20'000U);
  EXPECT_NEAR(told.median_ms / times[10'000], 1, 0.0051);
  EXPECT_NEAR(told.p99_ms / times[19'800], 1, 0.0051);
  EXPECT_EQ(told.worst_ms, times.back());
}

TEST(LatencyHistogram, TimesBeyondItsStepsAreAtTheirEnds) {
  LatencyHistogram spread;
  EXPECT_EQ(spread.time().count, 0U);
  spread.add(0);
  EXPECT_EQ(spread.time().median_ms, 0);
  spread.add(1e7);
  spread.add(1e7);
  EXPECT_GT(spread.time().median_ms, 1e5);
  EXPECT_EQ(spread.time().worst_ms, 1e7);
}

}  // namespace
}  // namespace isobath
