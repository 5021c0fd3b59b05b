// Statistics of recordings that are known: what was put in must come out.
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/studies/comparison.hpp>
#include <numbers>

namespace isobath::comparison_test {
namespace {

constexpr int kBeams = 40, kBins = 240;
constexpr double kBin = 0.05, kBlind = 0.6;

std::shared_ptr<const BeamFan> fan_of(int beams, double first_deg, double step_deg) {
  auto fan = std::make_shared<BeamFan>();
  for (int b = 0; b < beams; ++b) {
    fan->azimuth.push_back(Angle::degrees(first_deg + b * step_deg));
    fan->width.push_back(Angle::degrees(step_deg));
  }
  return fan;
}

Ping ping_of(std::shared_ptr<const BeamFan> fan, std::vector<float> values, double t_s = 0) {
  Ping ping;
  ping.time = Time{} + seconds(t_s);
  ping.window = {0, kBin, static_cast<int>(values.size()) / fan->beams()};
  const auto storage = std::make_shared<std::vector<float>>(std::move(values));
  ping.intensity = {storage->data(), SampleType::kF32, fan->beams(), ping.window.bins, 4 * ping.window.bins, 4};
  ping.storage = storage;
  ping.fan = std::move(fan);
  return ping;
}

std::vector<float> rayleigh(Random& random, double scale, int count = kBeams * kBins) {
  std::vector<float> values;
  for (int i = 0; i < count; ++i)
    values.push_back(static_cast<float>(scale * std::sqrt(-2 * std::log(1 - random.uniform()))));
  return values;
}

/// Rayleigh noise of scale 8, and a target of 120 counts over 3 bins from bin 100 and 2 beams from beam 20.
SampleStatistics water_with_a_target(std::uint64_t seed) {
  Random random(seed);
  const auto fan = fan_of(kBeams, -20, 1);
  SampleCollector collector(kBlind);
  for (int i = 0; i < 20; ++i) {
    std::vector<float> values = rayleigh(random, 8);
    for (int b = 20; b < 22; ++b)
      for (int k = 100; k < 103; ++k) values[static_cast<std::size_t>(b * kBins + k)] = 120;
    collector.add(ping_of(fan, std::move(values), i));
  }
  return collector.finish("water");
}

// ledger: S6-08
TEST(Comparison, BackgroundIsRecoveredBesideATarget) {
  const SampleStatistics s = water_with_a_target(3);
  EXPECT_EQ(s.scans, 20);
  EXPECT_EQ(s.all.samples, 20 * kBeams * (kBins - 12)) << "behind the blind zone";
  // Median of a Rayleigh law: scale sqrt(2 ln 2).
  EXPECT_NEAR(s.all.median, 8 * std::sqrt(2 * std::numbers::ln2), 0.1);
  EXPECT_NEAR(s.all.low, 8 * std::sqrt(-2 * std::log(0.84)), 0.1);
  EXPECT_GT(s.background_share, 0.97);
  const NoiseFit& fit = s.fits[1];
  ASSERT_EQ(fit.law, NoiseLaw::kRayleigh);
  EXPECT_NEAR(fit.scale, 8, 0.25) << "the rule cuts the tail a little";
  EXPECT_LT(fit.statistic, s.fits[0].statistic) << "nearer than the Gaussian";
}

TEST(Comparison, TargetIsMeasured) {
  const SampleStatistics s = water_with_a_target(4);
  EXPECT_NEAR(s.bright_share, 6.0 / (kBeams * (kBins - 12)), 1e-4);
  EXPECT_NEAR(s.bright_over_db, 20 * std::log10(120 / (8 * 1.2533)), 0.4);
  ASSERT_EQ(s.strongest.size(), 20u);
  for (const StrongestEcho& e : s.strongest) {
    EXPECT_FLOAT_EQ(static_cast<float>(e.level), 120.f);
    EXPECT_NEAR(e.length_m, 3 * kBin, 1e-9);
    EXPECT_NEAR(e.width.degrees(), 2, 1e-9);
    EXPECT_NEAR(e.range_m, 100.5 * kBin, 1e-9);
  }
  const double cells = kBeams * (kBins - 12), many = std::round(0.002 * cells);
  EXPECT_GT(s.brightest_mean, (6 * 120 + (many - 6) * 25) / many);
  EXPECT_NEAR(s.brightest_others, 8 * 1.2533, 0.3);
}

TEST(Comparison, SpreadFromTurnToTurnIsToldFromAFixedPattern) {
  Random random(5);
  constexpr int kSteps = 100;
  std::vector<std::vector<float>> pattern;
  std::vector<std::shared_ptr<const BeamFan>> fans;
  for (int i = 0; i < kSteps; ++i) {
    pattern.push_back(rayleigh(random, 20, kBins));
    for (float& v : pattern.back()) v += 40;
    fans.push_back(fan_of(1, i * 3.6, 3.6));
  }
  SampleCollector collector(kBlind);
  for (int i = 0; i < 12 * kSteps; ++i) {
    std::vector<float> values = pattern[static_cast<std::size_t>(i % kSteps)];
    for (float& v : values) v += static_cast<float>(3 * random.normal());
    collector.add(ping_of(fans[static_cast<std::size_t>(i % kSteps)], std::move(values), 0.1 * i));
  }
  const SampleStatistics s = collector.finish("tank");
  EXPECT_GE(s.scans, 11);
  EXPECT_EQ(s.mean.azimuth.size(), static_cast<std::size_t>(kSteps));
  EXPECT_NEAR(s.spread_over_scans, 3, 0.05);
  EXPECT_NEAR(s.spread_over_cells, 20 * 0.6551, 0.4) << "standard deviation of the Rayleigh law";
}

TEST(Comparison, PingsOfAnotherWindowAreLeftOutAndCounted) {
  const auto fan = fan_of(kBeams, -20, 1);
  SampleCollector collector(kBlind);
  collector.add(ping_of(fan, std::vector<float>(kBeams * kBins, 5)));
  collector.add(ping_of(fan, std::vector<float>(kBeams * 100, 50), 1));
  const SampleStatistics s = collector.finish("settings");
  EXPECT_EQ(s.pings, 1u);
  EXPECT_EQ(s.left_out, 1u);
  EXPECT_NEAR(s.all.mean, 5, 0.1);
}

TEST(Comparison, NothingToCompareIsAnError) {
  EXPECT_THROW(SampleCollector(kBlind).finish("ranges"), Error);
  SampleCollector blind(100);
  blind.add(ping_of(fan_of(kBeams, -20, 1), std::vector<float>(kBeams * kBins, 5)));
  EXPECT_THROW(blind.finish("blind"), Error);
}

}  // namespace
}  // namespace isobath::comparison_test
