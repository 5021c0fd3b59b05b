#include <gmock/gmock.h>
#include <cmath>
#include <isobath/sonar/noise_fit.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

struct Sample {
  EchoLevels levels;
  std::vector<std::uint64_t> counts;
  [[nodiscard]] NoiseFit fit(NoiseLaw law, int bootstraps = 99) const {
    NoiseFitConfig config;
    config.bootstraps = bootstraps;
    return fit_noise(levels, counts, law, config);
  }
  [[nodiscard]] bool accepts(NoiseLaw law) const { return fit(law).p_value > NoiseFitConfig{}.significance; }
};

Sample sample(const test::Background& law, int count, std::uint64_t seed, EchoLevels levels = {}) {
  Sample s{levels, std::vector<std::uint64_t>(levels.count(), 0)};
  Random random(seed);
  for (int i = 0; i < count; ++i) ++s.counts[levels.level(static_cast<float>(std::max(0.0, law(random))))];
  return s;
}

const EchoLevels kWhole;
const EchoLevels kReal(SampleType::kF32, 255);

// On whole numbers (ties!) and on reals.
// ledger: S6-08 S6-D01 S6-E13
TEST(NoiseFit, AcceptsTheRightLawAndRejectsTheOthers) {
  for (const EchoLevels& levels : {kWhole, kReal}) {
    const Sample lake = sample(test::gaussian(60, 9), 2000, 1, levels);
    EXPECT_TRUE(lake.accepts(NoiseLaw::kGaussian));
    EXPECT_FALSE(lake.accepts(NoiseLaw::kRayleigh));
    EXPECT_FALSE(lake.accepts(NoiseLaw::kK));
    const Sample speckle = sample(test::rayleigh(25), 2000, 2, levels);
    EXPECT_FALSE(speckle.accepts(NoiseLaw::kGaussian));
    EXPECT_TRUE(speckle.accepts(NoiseLaw::kRayleigh));
    EXPECT_TRUE(speckle.accepts(NoiseLaw::kK)) << "Rayleigh is the K law of large shape";
    const Sample clutter = sample(test::k_law(1, 20), 2000, 3, levels);
    EXPECT_FALSE(clutter.accepts(NoiseLaw::kGaussian));
    EXPECT_FALSE(clutter.accepts(NoiseLaw::kRayleigh));
    EXPECT_TRUE(clutter.accepts(NoiseLaw::kK));
    const Sample sea = sample(test::sea_mixture(12), 2000, 4, levels);
    EXPECT_FALSE(sea.accepts(NoiseLaw::kGaussian));
    EXPECT_FALSE(sea.accepts(NoiseLaw::kRayleigh));
    EXPECT_FALSE(sea.accepts(NoiseLaw::kK));
  }
}

TEST(NoiseFit, FindsTheParameters) {
  const NoiseFit lake = sample(test::gaussian(60, 9), 40000, 5).fit(NoiseLaw::kGaussian, 0);
  EXPECT_NEAR(lake.location, 60, 0.2);
  EXPECT_NEAR(lake.scale, 9, 0.15);
  EXPECT_NEAR(sample(test::rayleigh(25), 40000, 6).fit(NoiseLaw::kRayleigh, 0).scale, 25, 0.3);
  const NoiseFit clutter = sample(test::k_law(2, 20), 100000, 7, kReal).fit(NoiseLaw::kK, 0);
  EXPECT_NEAR(clutter.shape, 2, 0.2);
  EXPECT_NEAR(4 * clutter.shape * clutter.scale * clutter.scale, 2 * 20 * 20, 10);
}

// A test of size 10 % rejects the truth in about 10 % of the runs: p-values are uniform under the law, ties or not.
// ledger: S6-08
TEST(NoiseFit, RejectsTheTruthAtItsNominalRate) {
  int rejected = 0;
  constexpr int kRuns = 200;
  for (int i = 0; i < kRuns; ++i) {
    // Deviation of 1.2 counts: nearly all samples are ties.
    rejected += sample(test::gaussian(20, 1.2), 300, 100 + i).fit(NoiseLaw::kGaussian).p_value <= 0.1;
  }
  EXPECT_NEAR(rejected, 0.1 * kRuns, 4 * std::sqrt(0.09 * kRuns));
}

TEST(NoiseFit, OfTheKLawFollowsItsClosedForm) {
  NoiseFit fit;
  fit.law = NoiseLaw::kK;
  fit.scale = 3;
  fit.shape = 0.5;  // K_1/2 is elementary: F = 1 - exp(-x / scale)
  for (double x : {0.1, 1.0, 7.0, 40.0}) EXPECT_NEAR(cumulative(fit, x), -std::expm1(-x / 3), 1e-12);
  fit.shape = 1.5;  // F = 1 - (1 + u) exp(-u)
  for (double x : {0.1, 1.0, 7.0, 40.0}) EXPECT_NEAR(cumulative(fit, x), 1 - (1 + x / 3) * std::exp(-x / 3), 1e-12);
  fit.shape = 50;
  NoiseFit rayleigh;
  rayleigh.law = NoiseLaw::kRayleigh;
  rayleigh.scale = std::sqrt(2 * fit.shape) * fit.scale;
  for (double x : {5.0, 30.0, 80.0}) EXPECT_NEAR(cumulative(fit, x), cumulative(rayleigh, x), 0.01);
}

TEST(NoiseFit, SaysNothingAboutNextToNothing) {
  Sample silent{kWhole, std::vector<std::uint64_t>(256, 0)};
  EXPECT_EQ(silent.fit(NoiseLaw::kK).p_value, 0);
  silent.counts[0] = 1000;
  for (NoiseLaw law : {NoiseLaw::kGaussian, NoiseLaw::kRayleigh, NoiseLaw::kK}) {
    EXPECT_TRUE(std::isinf(silent.fit(law).statistic));
    EXPECT_EQ(silent.fit(law).p_value, 0);
  }
}

}  // namespace
}  // namespace isobath
