// What the receiver of a simulated sonar makes of amplitudes: decibels, a black level, a ceiling; and diffuse
// reverberation.
#include <algorithm>
#include <gtest/gtest.h>
#include <tests/sim/worlds.hpp>

namespace isobath {
namespace {
using namespace test;

constexpr int kBeams = 64, kBins = 200;

/// A fan in empty water that hears `level` counts of reverberation at every range, and nothing else.
SonarConfig diffuse(double level) {
  SonarConfig c = clean_beam(1, 1);
  c.beams = kBeams;
  c.sector = Angle::degrees(63);
  c.bins = kBins;
  c.range_m = 20;
  c.blanking_m = 0;
  c.ringing_level = 0;
  c.samples = SampleType::kF32;
  c.reverberation = {0, level, 20, level};
  return c;
}

std::vector<double> samples(const SonarConfig& config, std::uint64_t number = 0) {
  const Tank tank("[water]\nabsorption = \"none\"\n");
  SimulatedSonar sonar(config, *tank.world, *tank.water, 7, 1);
  const auto out = sonar.ping(Time{}, Pose{Rotation{}, {0, 0, 5}}, number);
  std::vector<double> values;
  for (int b = 0; b < config.beams; ++b)
    for (int k = 0; k < config.bins; ++k) values.push_back(static_cast<double>(out.ping->intensity(b, k)));
  return values;
}

double mean(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return sum / static_cast<double>(v.size());
}

// A Rayleigh amplitude of this mean: P(x < T) = 1 - exp(-pi/4 (T / mean)^2).
TEST(Receiver, ReverberationHasItsMeanAndTheRayleighLaw) {
  const std::vector<double> heard = [] {
    SonarConfig c = diffuse(20);
    c.speckle = true;
    return samples(c);
  }();
  EXPECT_NEAR(mean(heard), 20, 0.4);
  const auto below = std::count_if(heard.begin(), heard.end(), [](double v) { return v < 15; });
  EXPECT_NEAR(static_cast<double>(below) / static_cast<double>(heard.size()),
              1 - std::exp(-std::numbers::pi / 4 * 0.75 * 0.75), 0.01);
}

TEST(Receiver, ABlackLevelIsTakenOffAndCutsToZero) {
  SonarConfig c = diffuse(20);
  c.speckle = true;
  c.black_level = 15;
  const std::vector<double> heard = samples(c);
  const auto zeros = std::count(heard.begin(), heard.end(), 0.0);
  EXPECT_NEAR(static_cast<double>(zeros) / static_cast<double>(heard.size()),
              1 - std::exp(-std::numbers::pi / 4 * 0.75 * 0.75), 0.01);
  SonarConfig plain = c;
  plain.black_level = 0;
  const std::vector<double> before = samples(plain);
  for (std::size_t i = 0; i < heard.size(); ++i) EXPECT_NEAR(heard[i], std::max(0.0, before[i] - 15), 1e-4);
}

TEST(Receiver, DecibelsSpanTheWholeScaleAndTheThresholdReadsZero) {
  SonarConfig linear = diffuse(20), c = linear;
  linear.speckle = c.speckle = true;
  c.span_db = 26;  // 0 at 12.8 counts of amplitude
  const std::vector<double> amplitude = samples(linear), heard = samples(c);
  for (std::size_t i = 0; i < heard.size(); ++i) {
    EXPECT_NEAR(heard[i], std::max(0.0, 255 + 255 * 20 * std::log10(amplitude[i] / 255) / 26), 1e-3);
  }
  c.ceiling = 40;
  const std::vector<double> cut = samples(c);
  for (std::size_t i = 0; i < heard.size(); ++i) EXPECT_NEAR(cut[i], std::min(heard[i], 40.0), 1e-4);
}

TEST(Receiver, StillWaterLooksTheSameInEveryTurnButForItsNoise) {
  SonarConfig c = diffuse(20);
  c.speckle = true;
  EXPECT_NE(samples(c, 0), samples(c, 1));
  c.still = true;
  EXPECT_EQ(samples(c, 0), samples(c, 1));
  c.noise = BackgroundLaw::kGaussian;
  c.noise_level = 10;
  c.noise_sigma = 2;
  const std::vector<double> first = samples(c, 0), second = samples(c, 1);
  double squares = 0;
  for (std::size_t i = 0; i < first.size(); ++i) squares += std::pow(first[i] - second[i], 2);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(first.size())), 2 * std::numbers::sqrt2, 0.1);
}

}  // namespace
}  // namespace isobath
