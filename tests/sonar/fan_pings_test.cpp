// The generator of pings that other tests stand on has the laws that it states.
#include <cmath>
#include <gtest/gtest.h>
#include <tests/support/fan_pings.hpp>

namespace isobath {
namespace {

using test::FanPing;
using test::FanPings;
using test::FanSettings;
using test::FanSource;

struct Moments {
  double sum = 0, squares = 0, below = 0;
  int count = 0;
  void add(double v, double level) {
    sum += v;
    squares += v * v;
    below += v < level;
    ++count;
  }
  [[nodiscard]] double mean() const { return sum / count; }
  [[nodiscard]] double share_below() const { return below / count; }
};

template <class Want>
Moments moments(FanPings& pings, int count, double level, const Want& want) {
  Moments m;
  for (int n = 0; n < count; ++n) {
    const FanPing p = pings.next();
    EXPECT_EQ(check(p.ping), PingFault::kNone);
    for (int b = 0; b < p.ping.fan->beams(); ++b)
      for (int k = 0; k < p.ping.window.bins; ++k)
        if (want(p, b, k)) m.add(static_cast<double>(p.ping.intensity(b, k)), level);
  }
  return m;
}

TEST(FanPings, NoiseIsRayleighOfItsMeanAndKWithATexture) {
  FanSettings s;
  s.noise = 30;
  const auto all = [](const FanPing&, int, int) { return true; };
  FanPings plain(s);
  const Moments rayleigh = moments(plain, 8, 19.5, all);
  EXPECT_NEAR(rayleigh.mean(), 30, 0.3);
  EXPECT_NEAR(rayleigh.share_below(), 1 - std::exp(-std::numbers::pi / 4 * std::pow(19.5 / 30, 2)), 0.01);
  s.k_shape = 2;
  s.noise = 15;
  FanPings spiky(s);
  const Moments k = moments(spiky, 20, 60, all);
  EXPECT_NEAR(k.squares / k.count, 4 / std::numbers::pi * 15 * 15, 8) << "the texture has mean 1";
  const double b = std::sqrt(4 * 2 / (4 / std::numbers::pi * 15 * 15));  // mean power 4 v / b^2
  EXPECT_NEAR(1 - k.share_below(), 2 * std::pow(b * 60 / 2, 2) * std::cyl_bessel_k(2, b * 60), 0.003);
}

TEST(FanPings, RingsBeginAtTheirDistanceAndHaveTheirMeanPower) {
  FanSettings s;
  s.noise = 1;
  s.bottom = {4, 40};
  FanPings pings(s);
  for (const int bin : {35, 60, 100, 200}) {
    const Moments m = moments(pings, 6, 0, [bin](const FanPing&, int, int k) { return k == bin; });
    const double expected = pings.ring(s.bottom, (bin + 0.5) * s.bin_m) + 4 / std::numbers::pi;
    EXPECT_NEAR(m.squares / m.count, expected, 0.15 * expected + 0.2) << bin;
  }
  const FanPing p = pings.next();
  EXPECT_EQ(p.source[p.at(3, 39)], FanSource::kNoise);
  EXPECT_EQ(p.source[p.at(3, 60)], FanSource::kBottom);
  EXPECT_EQ(pings.ring(s.surface, 10), 0);
}

TEST(FanPings, ATargetStandsInItsBinWithSideLobesBesideIt) {
  FanSettings s;
  s.noise = 2;
  s.targets = {{15.05, 0, 200, 0}};
  FanPings pings(s);
  const FanPing p = pings.next();
  const int middle = s.beams / 2;
  EXPECT_NEAR(p.ping.intensity(middle, 150), 200 * std::sqrt(pings.lobe(pings.azimuth(middle), s.width)), 8);
  EXPECT_EQ(p.source[p.at(middle, 150)], FanSource::kTarget);
  EXPECT_EQ(p.source[p.at(middle, 149)], FanSource::kNoise);
  EXPECT_EQ(p.source[p.at(5, 150)], FanSource::kSideLobe);
  EXPECT_NEAR(p.echo[p.at(5, 150)], 200 * 200 * std::pow(10, -2.5), 1e-9);
}

TEST(FanPings, DeadBeamsStavesGainAndSaturationAreAsSet) {
  FanSettings s;
  s.noise = 20;
  s.dead = {7};
  s.stave_gains = {1, 2};
  s.targets = {{10.05, 0.3, 900, 0.05}};
  FanPings pings(s);
  const auto of = [&](int first, int last) {
    FanPings same(s);
    return moments(same, 4, 0, [&](const FanPing&, int b, int k) { return b >= first && b < last && k > 120; }).mean();
  };
  EXPECT_EQ(of(7, 8), 0);
  EXPECT_NEAR(of(8, 64), 20, 0.6);
  EXPECT_NEAR(of(64, 128), 40, 1.2);
  const FanPing loud = pings.next({}, 3);
  const int beam = static_cast<int>((0.3 / s.sector + 0.5) * s.beams);
  EXPECT_EQ(loud.ping.intensity(beam, 100), 255);
  EXPECT_NEAR(loud.noise[loud.at(100, 0)], 36 * 4 / std::numbers::pi * 400, 1e-6);
}

TEST(FanPings, NeighboursFluctuateTogetherAndSpeckleHasItsMemory) {
  FanSettings s;
  s.beams = 400;  // a fifth of a width apart
  s.width = 5 * s.sector / s.beams;
  s.noise = 0.5;
  s.height = 2;
  s.bottom = {3, 100};
  const auto correlation = [&](int beams, double memory) {
    s.memory = memory;
    FanPings pings(s);
    const FanPing before = pings.next(), after = beams == 0 ? pings.next() : before;
    double cross = 0, squares = 0, sum = 0;
    int count = 0;
    for (int b = 0; b + beams < s.beams; ++b) {
      for (int k = 60; k < 120; ++k, ++count) {
        // By their means: powers of mean 1.
        const double p = std::pow(static_cast<double>(before.ping.intensity(b, k)), 2) / before.echo[before.at(b, k)];
        const double q =
            std::pow(static_cast<double>(after.ping.intensity(b + beams, k)), 2) / after.echo[after.at(b, k)];
        cross += p * q;
        squares += p * p;
        sum += p;
      }
    }
    const double mean = sum / count;
    return (cross / count - mean * mean) / (squares / count - mean * mean);
  };
  // Powers correlate as the square of the waves, these as the overlap of patterns, exp2(-(d / w)^2).
  EXPECT_NEAR(correlation(1, 0), std::pow(std::exp2(-0.04), 2), 0.05);
  EXPECT_NEAR(correlation(5, 0), std::pow(std::exp2(-1), 2), 0.08);
  EXPECT_NEAR(correlation(20, 0), 0, 0.06);
  EXPECT_NEAR(correlation(0, 0), 0, 0.06);
  EXPECT_NEAR(correlation(0, 0.9), 0.81, 0.08);
}

TEST(FanPings, AreAFunctionOfTheirSettings) {
  FanSettings s;
  s.bottom = {4, 40};
  FanPings one(s), same(s);
  s.seed = 2;
  FanPings other(s);
  const auto samples = [](FanPings& pings) {
    const FanPing p = pings.next();
    std::vector<float> all;
    for (int b = 0; b < p.ping.fan->beams(); ++b)
      for (int k = 0; k < p.ping.window.bins; ++k) all.push_back(p.ping.intensity(b, k));
    return all;
  };
  const std::vector<float> first = samples(one);
  EXPECT_EQ(first, samples(same));
  EXPECT_NE(first, samples(other));
  EXPECT_NE(first, samples(one)) << "the next ping is another";
}

}  // namespace
}  // namespace isobath
