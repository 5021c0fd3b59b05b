// What samples of a fan have in common, against closed forms of the overlap of patterns, pulses and pings.
#include <array>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <isobath/sim/gamma_quantiles.hpp>
#include <tests/sim/worlds.hpp>

namespace isobath {
namespace {
using namespace test;

using Complex = std::complex<double>;
constexpr double kWavelength = 0.002;  // m, of 750 kHz

/// 65 beams a quarter of a degree apart, bins of 0.1 m.
SonarConfig fan(double width_deg, PatternKind pattern = PatternKind::kGaussian) {
  SonarConfig c;
  c.frequency = 750e3;
  c.beams = 65;
  c.sector = Angle::degrees(16);
  c.width = Angle::degrees(width_deg);
  c.pattern = pattern;
  c.range_m = 20;
  c.bins = 200;
  return c;
}

/// A device, and the field of its last ping: beams by bins.
struct Device {
  explicit Device(const SonarConfig& c, std::uint64_t seed = 5) : config(c), fluctuations(c, 6, seed) {
    image.resize(c.beams, c.bins);
  }
  void ping(const Pose& X_WS, double t = 0) {
    fluctuations.advance(number++, Time(seconds(t)), X_WS, image, 1);
    noise.clear();
    speckle.clear();
    texture.clear();
    FanFluctuations::Row row;
    for (int b = 0; b < config.beams; ++b) {
      fluctuations.read(b, row);
      for (std::size_t k = 0; k < static_cast<std::size_t>(config.bins); ++k) {
        noise.emplace_back(row.noise_re[k], row.noise_im[k]);
        speckle.emplace_back(row.speckle_re[k], row.speckle_im[k]);
      }
      texture.insert(texture.end(), row.texture.begin(), row.texture.end());
    }
  }
  SonarConfig config;
  FanFluctuations fluctuations;
  EchoImage image;
  std::uint64_t number = 0;
  std::vector<Complex> noise, speckle;
  std::vector<float> texture;
};

/// Of a with b, `beams` and `bins` further on; both of unit mean power.
double correlation(const Device& d, const std::vector<Complex>& a, const std::vector<Complex>& b, int beams, int bins) {
  Complex sum = 0;
  int count = 0;
  for (int i = 0; i + beams < d.config.beams; ++i) {
    for (int k = 0; k + bins < d.config.bins; ++k, ++count) {
      sum += a[static_cast<std::size_t>(i * d.config.bins + k)] *
             std::conj(b[static_cast<std::size_t>((i + beams) * d.config.bins + k + bins)]);
    }
  }
  return sum.real() / count;
}

/// The mean of many pings far from each other.
double correlation(const SonarConfig& config, int beams, int bins, bool of_noise) {
  Device d(config);
  double sum = 0;
  constexpr int kPings = 40;
  for (int i = 0; i < kPings; ++i) {
    d.ping({Rotation{}, {0, 100.0 * i, 5}});
    const auto& field = of_noise ? d.noise : d.speckle;
    sum += correlation(d, field, field, beams, bins) / kPings;
  }
  return sum;
}

TEST(FanFluctuations, HaveExponentialPowersOfMeanOne) {
  for (const double width : {0.05, 1.0, 4.0}) {
    Device d(fan(width));
    double mean = 0;
    std::array<int, 4> above{};
    const std::array<double, 4> levels{0.1, 1, 3, 7};
    int count = 0;
    for (int i = 0; i < 60; ++i) {
      d.ping({Rotation{}, {0, 100.0 * i, 5}});
      for (const auto* field : {&d.noise, &d.speckle}) {
        for (const Complex& z : *field) {
          mean += std::norm(z);
          for (std::size_t l = 0; l < levels.size(); ++l) above[l] += std::norm(z) > levels[l];
          ++count;
        }
      }
    }
    EXPECT_NEAR(mean / count, 1, 0.01) << width;
    for (std::size_t l = 0; l < levels.size(); ++l) {
      const double p = std::exp(-levels[l]), sigma = std::sqrt(p / count * std::max(1.0, width / 0.1));
      EXPECT_NEAR(static_cast<double>(above[l]) / count, p, 4 * sigma) << width << ' ' << levels[l];
    }
  }
}

// A Gaussian pattern overlaps with itself as exp2(-(d / w)^2), a top hat as a triangle.
TEST(FanFluctuations, CorrelateAcrossBeamsAsTheirPatternsOverlap) {
  for (const double width : {0.3, 0.6, 1.0, 2.0}) {
    for (const int beams : {1, 2, 4, 8}) {
      const double d = 0.25 * beams / width, expected = std::exp2(-d * d);
      for (const bool of_noise : {true, false}) {
        EXPECT_NEAR(correlation(fan(width), beams, 0, of_noise), expected, 0.03) << width << ' ' << beams;
      }
    }
  }
  for (const int beams : {1, 2, 3, 5}) {
    EXPECT_NEAR(correlation(fan(1.25, PatternKind::kIdeal), beams, 0, false), std::max(0.0, 1 - beams / 5.0), 0.02);
  }
  EXPECT_NEAR(correlation(fan(0.05), 1, 0, false), 0, 0.01) << "beams that have nothing in common";
}

TEST(FanFluctuations, CorrelateInRangeOverThePulse) {
  SonarConfig c = fan(1);
  EXPECT_NEAR(correlation(c, 0, 1, true), 0, 0.01) << "pulses of one bin";
  c.resolution_m = 0.3;
  for (int bins = 0; bins < 5; ++bins) {
    for (const bool of_noise : {true, false}) {
      EXPECT_NEAR(correlation(c, 0, bins, of_noise), std::max(0.0, 1 - bins / 3.0), 0.02) << bins;
    }
  }
}

TEST(FanFluctuations, NoiseIsNewWithEachPingSpeckleStaysWhereNothingMoves) {
  Device d(fan(1));
  d.ping(at_depth(5));
  const std::vector<Complex> noise = d.noise, speckle = d.speckle;
  d.ping(at_depth(5), 0.1);
  EXPECT_EQ(d.speckle, speckle);
  EXPECT_NEAR(correlation(d, d.noise, noise, 0, 0), 0, 0.03);
  EXPECT_NEAR(correlation(d, d.noise, d.speckle, 0, 0), 0, 0.03);
}

TEST(FanFluctuations, SpeckleIsForgottenOverHalfTheLengthOfTheAperture) {
  SonarConfig c = fan(1);
  c.beams = 9;  // all of them look north
  c.sector = Angle::degrees(2);
  c.bins = 2000;
  const double aperture = kWavelength / c.width.radians();
  for (const double share : {0.1, 0.5, 2.0}) {
    for (const int steps : {1, 5}) {  // however many pings are sent on the way
      Device d(c);
      d.ping(at_depth(5));
      const std::vector<Complex> first = d.speckle;
      for (int i = 1; i <= steps; ++i) d.ping({Rotation{}, {0, share * aperture * i / steps, 5}}, 0.1 * i);
      EXPECT_NEAR(correlation(d, d.speckle, first, 0, 0), std::exp(-2 * share), 0.03) << share << ' ' << steps;
    }
  }
}

TEST(FanFluctuations, SpeckleComesNearerAndTurnsWithItsScatterers) {
  SonarConfig c = fan(1);
  c.beams = 9;
  c.sector = Angle::degrees(2);
  c.bins = 2000;
  c.range_m = 200;
  Device d(c);
  d.ping(at_depth(5));
  std::vector<Complex> before = d.speckle;
  // Three bins ahead, in steps that are no whole bins.
  for (int i = 1; i <= 4; ++i) d.ping({Rotation{}, {0.075 * i, 0, 5}}, 0.1 * i);
  EXPECT_NEAR(correlation(d, d.speckle, before, 0, 3), 1, 0.1) << "but for what is a degree off the way";
  EXPECT_NEAR(correlation(d, d.speckle, before, 0, 0), 0, 0.05);

  Device turning(fan(1));
  turning.ping(at_depth(5));
  before = turning.speckle;
  turning.ping(at_depth(5, 1), 0.1);  // four beams to starboard
  EXPECT_NEAR(correlation(turning, turning.speckle, before, 4, 0), 1, 0.05);
  EXPECT_NEAR(correlation(turning, turning.speckle, before, 0, 0), 0.5, 0.05) << "two beams of one width's distance";
}

TEST(FanFluctuations, TheSurfacesSpeckleIsForgottenInMilliseconds) {
  SonarConfig c = fan(0.05);
  Device d(c);
  for (EchoLabel& label : d.image.labels) label = EchoLabel(kSurface, EchoPath::kDirect);
  d.ping(at_depth(5));
  const std::vector<Complex> first = d.speckle;
  const double tau = kWavelength / (4 * std::numbers::pi * 0.046 * 6);
  d.ping(at_depth(5), tau);
  EXPECT_NEAR(correlation(d, d.speckle, first, 0, 0), std::exp(-1), 0.03);
  d.ping(at_depth(5), 0.1);
  EXPECT_NEAR(correlation(d, d.speckle, first, 0, 0), 0, 0.03);
}

// Texture ------------------------------------------------------------------------------------------------------------

double normal_deviate(double above) {  // of P(> g)
  double low = -6, high = 6;
  for (int i = 0; i < 60; ++i) {
    const double g = 0.5 * (low + high);
    (0.5 * std::erfc(g / std::numbers::sqrt2) > above ? low : high) = g;
  }
  return low;
}

TEST(GammaQuantiles, AreThoseOfTheLawsThatHaveClosedForms) {
  const std::vector<float> one = gamma_quantiles(1), two = gamma_quantiles(2), half = gamma_quantiles(0.5);
  for (const double x : {0.01, 0.2, 1.0, 3.0, 9.0}) {
    EXPECT_NEAR(gamma_quantile(one, normal_deviate(std::exp(-x))), x, 2e-3 * x);
    EXPECT_NEAR(gamma_quantile(two, normal_deviate(std::exp(-2 * x) * (1 + 2 * x))), x, 2e-3 * x);
    EXPECT_NEAR(gamma_quantile(half, normal_deviate(std::erfc(std::sqrt(x / 2)))), x, 2e-3 * x);
  }
}

TEST(FanFluctuations, TextureIsGammaAndSmoothOverMetresAndSeconds) {
  SonarConfig c = fan(1);
  c.noise = BackgroundLaw::kK;
  c.noise_shape = 2;
  Device d(c);
  double sum = 0, squares = 0, near = 0, far = 0, soon = 0, late = 0;
  int count = 0, below = 0;
  constexpr int kPlaces = 600;
  std::vector<float> before;
  for (int i = 0; i < kPlaces; ++i) {
    const Pose X_WS{Rotation{}, {0, 100.0 * i, 5}};
    d.ping(X_WS, 100.0 * i);
    const auto at = [&d](int bin) { return static_cast<double>(d.texture[static_cast<std::size_t>(bin)]); };
    const double here = at(100);
    sum += here;
    squares += here * here;
    below += here < 0.5;
    near += (here - 1) * (at(105) - 1);  // half a metre
    far += (here - 1) * (at(190) - 1);   // nine metres
    d.ping(X_WS, 100.0 * i + 0.3);
    soon += (here - 1) * (at(100) - 1);
    d.ping(X_WS, 100.0 * i + 9);
    late += (here - 1) * (at(100) - 1);
    ++count;
  }
  EXPECT_NEAR(sum / count, 1, 0.1);
  EXPECT_NEAR(squares / count - 1, 0.5, 0.25);
  EXPECT_NEAR(static_cast<double>(below) / count, 1 - 2 * std::exp(-1), 0.07);
  EXPECT_GT(near / count, 0.35);
  EXPECT_GT(soon / count, 0.35);
  EXPECT_NEAR(far / count, 0, 0.1);
  EXPECT_NEAR(late / count, 0, 0.1);
}

// Pings of the device ------------------------------------------------------------------------------------------------

constexpr const char* kLake = "[bottom]\nkind = \"flat\"\ndepth = 8\nmaterial = \"gravel\"\n[water]\nwind = 4\n";

std::vector<float> heard(const SimulatedSonar::Output& out) {
  std::vector<float> all;
  for (int b = 0; b < out.ping->fan->beams(); ++b)
    for (int k = 0; k < out.ping->window.bins; ++k) all.push_back(out.ping->intensity(b, k));
  return all;
}

TEST(CorrelatedFan, IsTheSameOnAnyNumberOfThreadsAndAFunctionOfItsPings) {
  const Tank lake(kLake);
  SonarConfig c = fan(1);
  c.noise = BackgroundLaw::kK;
  std::vector<std::vector<float>> runs;
  for (const int threads : {1, 2, 3}) {
    SimulatedSonar sonar(c, *lake.world, *lake.water, 9, threads);
    runs.emplace_back();
    for (std::uint64_t n = 0; n < 4; ++n) {
      const double t = 0.1 * static_cast<double>(n);
      runs.back() = heard(sonar.ping(Time(seconds(t)), {Rotation::from_heading(Angle::degrees(9 * t)), {t, 0, 4}}, n));
    }
  }
  EXPECT_EQ(runs[0], runs[1]);
  EXPECT_EQ(runs[0], runs[2]);
}

// The mean of many samples has the spread that the number of independent ones says: with overlap, fewer of them.
TEST(CorrelatedFan, KeepsTheLevelOfEverySampleAndSpreadsTheMeanOfNeighbours) {
  const Tank empty("[water]\nabsorption = \"none\"\n");
  SonarConfig c = fan(1);
  c.noise = BackgroundLaw::kRayleigh;
  c.noise_level = 20;
  c.volume_reverberation = c.surface_reverberation = false;
  c.samples = SampleType::kF32;
  c.blanking_m = 0;
  c.ringing_level = 0;
  double spread[2] = {};
  for (const bool correlated : {false, true}) {
    c.correlated = correlated;
    SimulatedSonar sonar(c, *empty.world, *empty.water, 3, 1);
    double sum = 0, squares = 0, below = 0;
    constexpr int kPings = 60, kPooled = 5;
    int count = 0;
    for (std::uint64_t n = 0; n < kPings; ++n) {
      const std::vector<float> samples = heard(sonar.ping(Time{}, at_depth(5), n));
      for (int k = 0; k < c.bins; ++k) {
        double pooled = 0;
        for (int b = 30; b < 30 + kPooled; ++b) {
          const auto v = static_cast<double>(samples[static_cast<std::size_t>(b * c.bins + k)]);
          pooled += v / kPooled;
          below += v < 15;
        }
        sum += pooled;
        squares += pooled * pooled;
        ++count;
      }
    }
    EXPECT_NEAR(sum / count, 20, 0.3) << correlated;
    EXPECT_NEAR(below / (count * kPooled), 1 - std::exp(-std::numbers::pi / 4 * 0.75 * 0.75), 0.01) << correlated;
    spread[correlated] = std::sqrt(squares / count - sum / count * sum / count);
  }
  EXPECT_NEAR(spread[0], 20 * 0.5227 / std::sqrt(5), 0.2);
  EXPECT_GT(spread[1], 1.7 * spread[0]);
}

}  // namespace
}  // namespace isobath
