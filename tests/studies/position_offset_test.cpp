#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/studies/position_offset.hpp>
#include <vector>

namespace isobath {
namespace {

/// Differences of a log that lies off by `delta` over a bottom of hills, with noise and wild soundings.
std::vector<SlopeSample> log_over_hills(const Eigen::Vector2d& delta, double slope, double outliers) {
  Random random(5);
  std::vector<SlopeSample> samples;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector2d g{slope * random.normal(), slope * random.normal()};
    const bool wild = random.uniform() < outliers;
    samples.push_back({0.03 + g.dot(delta) + 0.1 * random.normal() + (wild ? 3.0 : 0.0), g});
  }
  return samples;
}

TEST(PositionOffset, IsFoundThroughNoiseAndWildSoundings) {
  const auto found = position_offset(log_over_hills({2, -3.5}, 0.1, 0.05));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->offset_m.x(), 2, 0.06);
  EXPECT_NEAR(found->offset_m.y(), -3.5, 0.06);
  EXPECT_NEAR(found->bias_m, 0.03, 0.01);
  EXPECT_GT(found->robust_sd_m, 0.3);
  EXPECT_NEAR(found->robust_sd_left_m, 0.1, 0.02);
  EXPECT_LT(found->sigma_m.maxCoeff(), 0.03);
}

TEST(PositionOffset, IsNotClaimedOverAnEvenBottomOrOfFewSoundings) {
  EXPECT_FALSE(position_offset(log_over_hills({2, -3.5}, 0.005, 0)));
  const auto samples = log_over_hills({2, -3.5}, 0.1, 0);
  EXPECT_FALSE(position_offset(std::span(samples).first(99)));
}

}  // namespace
}  // namespace isobath
