// What a device makes of echoes: noise laws, disturbances, quantisation, ranges, truth; against closed forms.
#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <tests/sim/worlds.hpp>

namespace isobath::simulated_sonar_test {
namespace {

using namespace test;

constexpr const char* kEmpty = "[water]\nsound_speed = [[0, 1500]]\nabsorption = \"none\"\n";

/// A fan that hears nothing but its own receiver, in samples that nothing rounds.
SonarConfig silent_fan(int beams, int bins) {
  SonarConfig c = clean_beam(1, 20);
  c.beams = beams;
  c.sector = Angle::degrees(90);
  c.bins = bins;
  c.rays = 1;
  c.samples = SampleType::kF32;
  c.blanking_m = 0;
  return c;
}

std::vector<double> samples(const Ping& ping) {
  std::vector<double> all;
  for (int b = 0; b < ping.intensity.beams(); ++b) {
    for (int k = 0; k < ping.intensity.bins(); ++k) all.push_back(static_cast<double>(ping.intensity(b, k)));
  }
  return all;
}

struct Heard {
  std::vector<double> samples;
  EchoTruth truth;
  Ping ping;
};
Heard hear(const Tank& tank, const SonarConfig& sonar, const Pose& X_WB = at_depth(10), std::uint64_t number = 0,
           std::uint64_t seed = 1, int threads = 1) {
  SimulatedSonar device(sonar, *tank.world, *tank.water, seed, threads);
  SimulatedSonar::Output out = device.ping(Time{}, X_WB, number);
  return {samples(*out.ping), out.truth, *out.ping};
}

double mean(const std::vector<double>& x) {
  double sum = 0;
  for (const double v : x) sum += v;
  return sum / static_cast<double>(x.size());
}

/// Kolmogorov and Smirnov: the largest distance between both distributions, times sqrt(n); 1.95 is met by chance once
/// in a thousand times.
double distance_of_laws(std::vector<double> x, const std::function<double(double)>& law) {
  std::sort(x.begin(), x.end());
  const double n = static_cast<double>(x.size());
  double most = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double expected = law(x[i]);
    most = std::max(
        {most, std::abs(expected - static_cast<double>(i) / n), std::abs(expected - static_cast<double>(i + 1) / n)});
  }
  return most * std::sqrt(n);
}
constexpr double kOnceInAThousand = 1.95;

// Background --------------------------------------------------------------------------------------------------------

// ledger: S6-02 S6-D01
TEST(Background, GaussianNoiseIsGaussianOfTheStatedMeanAndSpread) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(100, 400);
  sonar.noise = BackgroundLaw::kGaussian;
  sonar.noise_level = 40;
  sonar.noise_sigma = 8;
  const Heard h = hear(tank, sonar);
  EXPECT_LT(distance_of_laws(h.samples, [](double x) { return 0.5 * std::erfc(-(x - 40) / (8 * std::sqrt(2.0))); }),
            kOnceInAThousand);
  EXPECT_NEAR(mean(h.samples) / 40, 1, 0.01);
}

// ledger: S6-02
TEST(Background, RayleighNoiseIsRayleighOfTheStatedMean) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(100, 400);
  sonar.noise = BackgroundLaw::kRayleigh;
  sonar.noise_level = 12;
  const Heard h = hear(tank, sonar);
  EXPECT_LT(
      distance_of_laws(h.samples, [](double x) { return 1 - std::exp(-std::numbers::pi * x * x / (4 * 12 * 12)); }),
      kOnceInAThousand);
  EXPECT_NEAR(mean(h.samples) / 12, 1, 0.01);
}

TEST(Background, GaussianNoiseMayHaveNoMean) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(100, 400);
  sonar.noise = BackgroundLaw::kGaussian;
  sonar.noise_level = 0;
  sonar.noise_sigma = 8;
  EXPECT_NEAR(mean(hear(tank, sonar).samples), 8 / std::sqrt(2 * std::numbers::pi), 0.05);  // half of it is below zero
}

TEST(Background, IsIndependentBetweenBinsBeamsAndPings) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(100, 200);
  sonar.noise = BackgroundLaw::kRayleigh;
  const std::vector<double> now = hear(tank, sonar, at_depth(10), 4).samples;
  const std::vector<double> next = hear(tank, sonar, at_depth(10), 5).samples;
  const std::vector<double> other = hear(tank, sonar, at_depth(10), 4, 2).samples;
  const auto correlation = [](const std::vector<double>& a, const std::vector<double>& b, std::size_t shift) {
    const double m = mean(a), n = static_cast<double>(a.size() - shift);
    double cross = 0, squares = 0;
    for (std::size_t i = 0; i + shift < a.size(); ++i) {
      cross += (a[i] - m) * (b[i + shift] - m);
      squares += (a[i] - m) * (a[i] - m);
    }
    return cross / squares * std::sqrt(n);  // standard normal where they are independent
  };
  EXPECT_LT(std::abs(correlation(now, now, 1)), 4);
  EXPECT_LT(std::abs(correlation(now, now, 200)), 4);
  EXPECT_LT(std::abs(correlation(now, next, 0)), 4);
  EXPECT_LT(std::abs(correlation(now, other, 0)), 4);
}

// Jakeman and Pusey 1976: P(> x) = 2 / Gamma(v) (b x / 2)^v K_v(b x), whose mean is sqrt(pi) Gamma(v + 1/2) / (Gamma(v)
// b). Here the mean is 12.
std::function<double(double)> k_law(double v) {
  const double b = std::sqrt(std::numbers::pi) * std::tgamma(v + 0.5) / (std::tgamma(v) * 12);
  return [v, b](double x) {
    if (x < 1e-9) return 0.0;
    return 1 - 2 / std::tgamma(v) * std::pow(b * x / 2, v) * std::cyl_bessel_k(v, b * x);
  };
}

// ledger: S6-02
TEST(Background, KNoiseIsKOfTheStatedMeanAndShape) {
  const Tank tank(kEmpty);
  for (const double v : {0.6, 2.0, 8.0}) {
    SonarConfig sonar = silent_fan(100, 200);
    sonar.noise = BackgroundLaw::kK;
    sonar.noise_level = 12;
    sonar.noise_shape = v;
    sonar.correlated = false;
    const Heard h = hear(tank, sonar);
    EXPECT_LT(distance_of_laws(h.samples, k_law(v)), kOnceInAThousand) << v;
    EXPECT_NEAR(mean(h.samples) / 12, 1, v < 1 ? 0.02 : 0.01) << v;
  }
}

// A ping meets few patches of texture: the law is that of samples far from each other.
TEST(Background, KNoiseOfACorrelatedFanIsKFromPlaceToPlace) {
  const Tank tank(kEmpty);
  for (const double v : {0.6, 2.0}) {
    SonarConfig sonar = silent_fan(1, 6);
    sonar.sector = Angle{};
    sonar.range_m = 60;
    sonar.noise = BackgroundLaw::kK;
    sonar.noise_level = 12;
    sonar.noise_shape = v;
    SimulatedSonar device(sonar, *tank.world, *tank.water, 3, 1);
    std::vector<double> all;
    for (std::uint64_t n = 0; n < 800; ++n) {
      const double t = 100.0 * static_cast<double>(n);
      const auto out = device.ping(Time(seconds(t)), {Rotation{}, {t, 0, 10}}, n);
      const std::vector<double> heard = samples(*out.ping);
      all.insert(all.end(), heard.begin(), heard.end());
    }
    EXPECT_LT(distance_of_laws(all, k_law(v)), kOnceInAThousand) << v;
    EXPECT_NEAR(mean(all) / 12, 1, 0.04) << v;
  }
}

TEST(Background, GammaTextureHasMeanOneAndVarianceOfTheInverseShape) {
  for (const double shape : {0.3, 1.0, 4.0}) {
    Random random(7);
    double sum = 0, squares = 0;
    constexpr int kCount = 50000;
    for (int i = 0; i < kCount; ++i) {
      const double g = unit_mean_gamma(random, shape);
      sum += g;
      squares += g * g;
    }
    const double variance = squares / kCount - sum * sum / kCount / kCount;
    EXPECT_NEAR(sum / kCount, 1, 4 * std::sqrt(1 / shape / kCount)) << shape;
    EXPECT_NEAR(variance * shape, 1, 0.08) << shape;
  }
}

// ledger: S5-21
TEST(Background, FollowsRangeAndBearingAsStated) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(91, 600);  // 1 degree, 0.1 m
  sonar.noise = BackgroundLaw::kRayleigh;
  sonar.noise_level = 20;
  sonar.noise_by_range = {0, 1, 20, 1, 40, 3};
  sonar.noise_by_bearing = {-10, 0.5, 10, 1.5};
  const Heard h = hear(tank, sonar);
  const auto level = [&](int beam_0, int beam_1, int bin_0, int bin_1) {
    double sum = 0;
    for (int b = beam_0; b < beam_1; ++b) {
      for (int k = bin_0; k < bin_1; ++k) sum += h.samples[static_cast<std::size_t>(b * 600 + k)];
    }
    return sum / ((beam_1 - beam_0) * (bin_1 - bin_0));
  };
  EXPECT_NEAR(level(0, 35, 0, 200), 20 * 0.5, 0.2);
  EXPECT_NEAR(level(56, 91, 0, 200), 20 * 1.5, 0.6);
  EXPECT_NEAR(level(0, 35, 400, 600), 20 * 0.5 * 3, 0.6);
  EXPECT_NEAR(level(0, 35, 290, 310), 20 * 0.5 * 2, 0.8);
  EXPECT_NEAR(level(45, 46, 0, 200), 20, 2.5);
}

// ledger: S5-21
TEST(Background, OfAScanningHeadFollowsTheDirectionThatItLooksIn) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(1, 2000);
  sonar.kind = SonarKind::kScanning;
  sonar.noise = BackgroundLaw::kRayleigh;
  sonar.noise_level = 20;
  sonar.noise_by_bearing = {-45, 0.5, 45, 1.5};
  EXPECT_NEAR(mean(hear(tank, sonar, at_depth(10), 0).samples), 10, 0.5);
  EXPECT_NEAR(mean(hear(tank, sonar, at_depth(10), 15).samples), 20, 1);
  EXPECT_NEAR(mean(hear(tank, sonar, at_depth(10), 30).samples), 30, 1.5);
}

// Echoes in it ------------------------------------------------------------------------------------------------------

/// A bottom under a fan that looks down and ahead: echoes of every strength.
struct OverBottom {
  Tank tank{std::string(kEmpty) + "[bottom]\nkind = \"flat\"\ndepth = 20\n"};
  Pose pose = at_depth(5, 0, -30);
  static SonarConfig sonar() {
    SonarConfig c = silent_fan(64, 300);
    c.height = Angle::degrees(40);
    c.rays = 32;
    c.bottom_reverberation = true;
    c.source_level_db = 190;
    return c;
  }
};

// Rice 1945: the mean is s sqrt(pi / 2) L(-A^2 / 2 s^2), L the Laguerre polynomial of order 1/2; the mean square is
// A^2 + 2 s^2.
// ledger: S6-02
TEST(Echoes, InRayleighNoiseAreRice) {
  const OverBottom over;
  SonarConfig sonar = OverBottom::sonar();
  const std::vector<double> clean = hear(over.tank, sonar, over.pose).samples;
  sonar.noise = BackgroundLaw::kRayleigh;
  sonar.noise_level = 10;
  const std::vector<double> noisy = hear(over.tank, sonar, over.pose).samples;
  const double s = 10 / std::sqrt(std::numbers::pi / 2);
  double sum = 0, squares = 0, variance = 0;
  int count = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    const double A = clean[i];
    if (A < 2 || A > 60) continue;
    const double y = A * A / (4 * s * s);
    const double expected = s * std::sqrt(std::numbers::pi / 2) * std::exp(-y) *
                            ((1 + 2 * y) * std::cyl_bessel_i(0, y) + 2 * y * std::cyl_bessel_i(1, y));
    sum += noisy[i] - expected;
    variance += A * A + 2 * s * s - expected * expected;
    squares += noisy[i] * noisy[i] / (A * A + 2 * s * s);
    ++count;
  }
  ASSERT_GT(count, 2000);
  EXPECT_LT(std::abs(sum) / std::sqrt(variance), 3);
  EXPECT_NEAR(squares / count, 1, 3 / std::sqrt(count));
}

// Goodman 1975.
TEST(Echoes, OfARoughBottomHaveExponentialPower) {
  const OverBottom over;
  SonarConfig sonar = OverBottom::sonar();
  const std::vector<double> clean = hear(over.tank, sonar, over.pose).samples;
  sonar.speckle = true;
  const std::vector<double> speckled = hear(over.tank, sonar, over.pose).samples;
  std::vector<double> ratio;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    if (clean[i] > 2) ratio.push_back(speckled[i] * speckled[i] / (clean[i] * clean[i]));
  }
  ASSERT_GT(ratio.size(), 2000u);
  EXPECT_LT(distance_of_laws(ratio, [](double x) { return 1 - std::exp(-x); }), kOnceInAThousand);
}

TEST(Echoes, OfASmallBodyDoNotFluctuate) {
  const Tank tank(std::string(kEmpty) + "[[sphere]]\ncentre = [20, 0, 10]\nradius = 0.1\n");
  SonarConfig sonar = silent_fan(1, 600);
  sonar.sector = Angle{};
  const double clean = mean(hear(tank, sonar).samples);
  sonar.speckle = true;
  EXPECT_GT(clean, 0);
  EXPECT_EQ(mean(hear(tank, sonar).samples), clean);
}

// Sample = full scale 10^((SL + power + TVG - saturation) / 20).
TEST(Echoes, HaveTheSampleThatTheReceiverEquationSays) {
  const Tank tank(std::string("[water]\nsound_speed = [[0, 1500]]\nabsorption = \"francois_garrison\"\n"));
  SonarConfig sonar = silent_fan(1, 600);
  sonar.source_level_db = 200;
  sonar.saturation_db = 150;
  sonar.tvg_spreading = 20;
  const SimulatedSonar device(sonar, *tank.world, *tank.water, 1, 1);
  const double r = 30.05, a = tank.water->absorption_db(sonar.frequency, 0);
  EXPECT_NEAR(20 * std::log10(device.gain(300) / 255), 200 + 20 * std::log10(r) + 2 * a * r - 150, 1e-9);
  sonar.samples = SampleType::kU16;
  EXPECT_NEAR(SimulatedSonar(sonar, *tank.world, *tank.water, 1, 1).gain(300) / device.gain(300), 1, 1e-9)
      << "counts are those of a scale of 255, whatever the samples";
}

// Disturbances ------------------------------------------------------------------------------------------------------

int count_path(const EchoTruth& truth, EchoPath path) {
  return static_cast<int>(
      std::count_if(truth.labels.begin(), truth.labels.end(), [&](EchoLabel l) { return l.path() == path; }));
}

// ledger: S6-02
TEST(Disturbances, SpuriousEchoesComeInTheStatedShareOfPingsBeyondTheBlindZone) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(4, 60);
  sonar.spurious_share = 0.3;
  sonar.spurious_level = 80;
  sonar.blanking_m = 5;
  sonar.ringing_level = 0;
  SimulatedSonar device(sonar, *tank.world, *tank.water, 3, 1);
  int pings = 0;
  std::set<int> beams, bins;
  constexpr int kPings = 3000;
  for (std::uint64_t n = 0; n < kPings; ++n) {
    const auto out = device.ping(Time{}, at_depth(10), n);
    const int found = count_path(out.truth, EchoPath::kSpurious);
    ASSERT_LE(found, 1);
    pings += found;
    for (std::size_t i = 0; found && i < out.truth.labels.size(); ++i) {
      if (out.truth.labels[i].path() != EchoPath::kSpurious) continue;
      const int beam = static_cast<int>(i / 60), bin = static_cast<int>(i % 60);
      ASSERT_GE(bin, 5);
      ASSERT_EQ(out.ping->intensity(beam, bin), 80.f);
      beams.insert(beam);
      bins.insert(bin);
    }
  }
  EXPECT_NEAR(pings, 0.3 * kPings, 4 * std::sqrt(0.21 * kPings));
  EXPECT_EQ(beams.size(), 4u);
  EXPECT_GT(bins.size(), 50u);
}

// ledger: S5-22
TEST(Disturbances, AStreakIsOneBeamARingOneRangeABurstTheWholeImage) {
  const Tank tank(kEmpty);
  struct Case {
    double SonarConfig::*share;
    int cells;
  };
  for (const Case& c : {Case{&SonarConfig::streak_share, 60}, Case{&SonarConfig::ring_share, 32},
                        Case{&SonarConfig::burst_share, 32 * 60}}) {
    SonarConfig sonar = silent_fan(32, 60);
    sonar.disturbance_level = 60;
    sonar.*c.share = 1;
    SimulatedSonar device(sonar, *tank.world, *tank.water, 5, 1);
    double sum = 0;
    for (std::uint64_t n = 0; n < 40; ++n) {
      const auto out = device.ping(Time{}, at_depth(10), n);
      ASSERT_EQ(count_path(out.truth, EchoPath::kDisturbance), c.cells);
      const std::vector<double> all = samples(*out.ping);
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (out.truth.labels[i].path() != EchoPath::kDisturbance) {
          ASSERT_EQ(all[i], 0);
        } else {
          ASSERT_TRUE(all[i] >= 30 && all[i] <= 90);
          sum += all[i];
        }
      }
      const auto first = std::find_if(out.truth.labels.begin(), out.truth.labels.end(),
                                      [](EchoLabel l) { return l.path() == EchoPath::kDisturbance; }) -
                         out.truth.labels.begin();
      const auto label = [&](int beam, int bin) { return out.truth.labels[static_cast<std::size_t>(beam * 60 + bin)]; };
      for (int i = 0; i < c.cells && c.cells == 60; ++i)
        ASSERT_EQ(label(static_cast<int>(first / 60), i).path(), EchoPath::kDisturbance);
      for (int i = 0; i < c.cells && c.cells == 32; ++i)
        ASSERT_EQ(label(i, static_cast<int>(first % 60)).path(), EchoPath::kDisturbance);
    }
    EXPECT_NEAR(sum / (40 * c.cells), 60, 3);
  }
}

// ledger: S5-22
TEST(Disturbances, DroppedPingsNeverCome) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(1, 10);
  sonar.dropout_share = 0.25;
  SimulatedSonar device(sonar, *tank.world, *tank.water, 5, 1);
  int missing = 0;
  for (std::uint64_t n = 0; n < 4000; ++n) missing += !device.ping(Time{}, at_depth(10), n).ping;
  EXPECT_NEAR(missing, 1000, 4 * std::sqrt(750));
}

TEST(Disturbances, TheTransmissionRingsThroughTheBlindZoneAndNoFurther) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(3, 600);
  sonar.blanking_m = 8;
  sonar.ringing_level = 200;
  const Heard h = hear(tank, sonar);
  EXPECT_EQ(h.ping.blanking_m, 8);
  for (int k = 0; k < 600; ++k) {
    const double r = (k + 0.5) * 0.1, expected = r < 8 ? 200 * std::exp(-3 * r / 8) : 0;
    ASSERT_NEAR(h.samples[static_cast<std::size_t>(k)], expected, 1e-4) << r;
    ASSERT_EQ(h.truth.labels[static_cast<std::size_t>(k)].path(), r < 8 ? EchoPath::kRinging : EchoPath::kNoise);
  }
}

TEST(Disturbances, TheLabelIsThatOfTheStrongestOfThem) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(1, 100);
  sonar.blanking_m = 30;
  sonar.ringing_level = 200;
  sonar.burst_share = 1;
  sonar.disturbance_level = 60;
  const Heard h = hear(tank, sonar);
  EXPECT_EQ(h.truth.labels[0].path(), EchoPath::kRinging);       // 194 against 30 .. 90
  EXPECT_EQ(h.truth.labels[48].path(), EchoPath::kDisturbance);  // 11
  EXPECT_EQ(h.truth.labels[90].path(), EchoPath::kDisturbance);
}

// Truth -------------------------------------------------------------------------------------------------------------

TEST(Truth, EveryWayOfAnEchoIsLabelledAndCanBeSwitchedOff) {
  struct Case {
    const char* name;
    std::string scene;
    EchoPath path;
    int target;
    bool SonarConfig::*its_switch;
  };
  const std::string ball = "[[sphere]]\ncentre = [30, 0, 8]\nradius = 0.3\nmaterial = \"rock\"\n";
  const std::string wall = "[[wall]]\nline = [[20, -20], [20, 20]]\ntop = 0\nbottom = 30\nmaterial = \"steel\"\n";
  const std::string side = "[[wall]]\nline = [[-5, 6], [40, 6]]\ntop = 0\nbottom = 30\nmaterial = \"steel\"\n";
  const std::string flat = "[bottom]\nkind = \"flat\"\ndepth = 10\nmaterial = \"rock\"\n";
  const Case cases[] = {
      {"direct", ball, EchoPath::kDirect, kFirstBody, nullptr},
      {"bottom", flat, EchoPath::kDirect, kBottom, &SonarConfig::bottom_reverberation},
      {"surface", "", EchoPath::kDirect, kSurface, &SonarConfig::surface_reverberation},
      {"side lobe", ball, EchoPath::kSideLobe, kFirstBody, nullptr},
      {"surface bounce", ball, EchoPath::kSurfaceBounce, kFirstBody, &SonarConfig::surface_bounce},
      {"bottom bounce", flat + ball, EchoPath::kBottomBounce, kFirstBody, &SonarConfig::bottom_bounce},
      {"body bounce", wall + side, EchoPath::kBodyBounce, kFirstBody, &SonarConfig::body_bounce},
      {"multiple", wall, EchoPath::kMultiple, kFirstBody, &SonarConfig::multiple},
      {"volume", "", EchoPath::kVolume, kNothing, &SonarConfig::volume_reverberation},
  };
  for (const Case& c : cases) {
    const Tank tank(kEmpty + std::string("volume_scattering_db = -60\n") + c.scene);
    for (const bool on : {true, false}) {
      SonarConfig sonar = silent_fan(45, 600);
      sonar.pattern = sonar.height_pattern = PatternKind::kLine;
      sonar.side_lobe_db = 13.3;
      sonar.height = Angle::degrees(60);
      sonar.rays = 32;
      sonar.source_level_db = 220;
      if (c.its_switch) sonar.*c.its_switch = on;
      const Heard h = hear(tank, sonar, at_depth(5));
      const bool found =
          std::find(h.truth.labels.begin(), h.truth.labels.end(), EchoLabel(c.target, c.path)) != h.truth.labels.end();
      EXPECT_EQ(found, on || !c.its_switch) << c.name << (on ? " on" : " off");
    }
  }
}

TEST(Truth, SamplesOfBackgroundAloneAreNoise) {
  const Tank tank(kEmpty);
  SonarConfig sonar = silent_fan(10, 100);
  sonar.noise = BackgroundLaw::kRayleigh;
  const Heard h = hear(tank, sonar);
  EXPECT_EQ(count_path(h.truth, EchoPath::kNoise), 1000);
  EXPECT_EQ(h.truth.sonar, "sonar");
  EXPECT_EQ(h.truth.beams, 10);
  EXPECT_EQ(h.truth.bins, 100);
}

// Samples -----------------------------------------------------------------------------------------------------------

TEST(Samples, AreRoundedToTheNearestCountAndSaturate) {
  const OverBottom over;
  SonarConfig sonar = OverBottom::sonar();
  sonar.saturation_db = 130;
  const std::vector<double> exact = hear(over.tank, sonar, over.pose).samples;
  sonar.samples = SampleType::kU8;
  const Heard bytes = hear(over.tank, sonar, over.pose);
  sonar.samples = SampleType::kU16;
  const Heard words = hear(over.tank, sonar, over.pose);
  EXPECT_EQ(bytes.ping.full_scale, 255);
  EXPECT_EQ(words.ping.full_scale, 65535);
  int saturated = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    ASSERT_NEAR(bytes.samples[i], std::min(exact[i], 255.0), 0.5001);
    ASSERT_NEAR(words.samples[i], std::min(exact[i] * 257, 65535.0), 0.51 + 1e-6 * exact[i] * 257);
    saturated += bytes.samples[i] == 255;
  }
  EXPECT_GT(saturated, 10);
  EXPECT_EQ(check(bytes.ping), PingFault::kNone);
  EXPECT_EQ(check(words.ping), PingFault::kNone);
}

TEST(Samples, AreTheSameOnAnyNumberOfThreadsAndForTheSameSeedOnly) {
  const OverBottom over;
  SonarConfig sonar = OverBottom::sonar();
  sonar.noise = BackgroundLaw::kK;
  sonar.speckle = true;
  sonar.spurious_share = sonar.streak_share = 0.5;
  const Heard one = hear(over.tank, sonar, over.pose, 4, 9, 1);
  const Heard two = hear(over.tank, sonar, over.pose, 4, 9, 2);
  const Heard three = hear(over.tank, sonar, over.pose, 4, 9, 3);
  EXPECT_EQ(one.samples, two.samples);
  EXPECT_EQ(one.samples, three.samples);
  EXPECT_EQ(one.truth.labels, two.truth.labels);
  EXPECT_NE(one.samples, hear(over.tank, sonar, over.pose, 4, 10).samples);
  EXPECT_NE(one.samples, hear(over.tank, sonar, over.pose, 5, 9).samples);
}

TEST(Samples, DoNotDependOnWhatElseWasHeard) {
  const OverBottom over;
  SonarConfig sonar = OverBottom::sonar(), other = silent_fan(7, 50);
  sonar.noise = BackgroundLaw::kRayleigh;
  sonar.speckle = true;
  sonar.correlated = false;
  SimulatedSonar alone(sonar, *over.tank.world, *over.tank.water, 9, 1);
  SimulatedSonar beside(sonar, *over.tank.world, *over.tank.water, 9, 1);
  SimulatedSonar neighbour(other, *over.tank.world, *over.tank.water, 9, 1);
  for (std::uint64_t n = 0; n < 3; ++n) {
    (void)neighbour.ping(Time{}, over.pose, n);
    const auto a = alone.ping(Time{}, over.pose, n), b = beside.ping(Time{}, over.pose, n);
    EXPECT_EQ(samples(*a.ping), samples(*b.ping));
  }
  // Where nothing is shared between pings, any of them can be made without those before it.
  SimulatedSonar late(sonar, *over.tank.world, *over.tank.water, 9, 1);
  EXPECT_EQ(samples(*late.ping(Time{}, over.pose, 2).ping), samples(*alone.ping(Time{}, over.pose, 2).ping));
}

// Whatever the settings and wherever it is: above the water, in the ground, inside a body.
TEST(Samples, AreFiniteAndTheSameOnAnyNumberOfThreadsForAnySonarAnywhere) {
  const Tank tank(
      "[water]\nsound_speed = [[0, 1480], [8, 1500]]\n[bottom]\nkind = \"terrain\"\ndepth = 15\nextent_m = 60\n"
      "[[sphere]]\ncentre = [10, 0, 6]\nradius = 1\n[[cylinder]]\ncentre = [5, 5, 8]\naxis = [0, 1, 0.2]\n"
      "[[box]]\ncentre = [-5, 3, 9]\nsize = [3, 3, 3]\n[[wall]]\nline = [[20, -20], [20, 20], [-20, 20]]\n");
  Random random(17);
  const auto chance = [&] { return random.uniform() < 0.5; };
  const auto pattern = [&] { return static_cast<PatternKind>(random.index(3)); };
  const auto share = [&] { return random.uniform() < 0.3 ? 1.0 : 0.0; };
  for (int i = 0; i < 60; ++i) {
    SonarConfig c;
    c.kind = chance() ? SonarKind::kFan : SonarKind::kScanning;
    c.beams = 1 + static_cast<int>(random.index(24));
    c.sector = Angle::degrees(random.uniform(1, 359));
    c.width = Angle::degrees(random.uniform(0.05, 120));
    c.height = Angle::degrees(random.uniform(0.05, 120));
    c.pattern = pattern();
    c.height_pattern = pattern();
    c.side_lobe_db = random.uniform(13.3, 60);
    c.rays = 1 + static_cast<int>(random.index(32));
    c.rays_across = 1 + static_cast<int>(random.index(3));
    c.range_m = random.uniform(1, 100);
    c.bins = 1 + static_cast<int>(random.index(200));
    c.resolution_m = chance() ? 0 : random.uniform(0, 3);
    c.noise = static_cast<BackgroundLaw>(random.index(4));
    c.surface_bounce = chance();
    c.bottom_bounce = chance();
    c.body_bounce = chance();
    c.multiple = chance();
    c.streak_share = share();
    c.ring_share = share();
    c.burst_share = share();
    c.spurious_share = share();
    c.samples = SampleType::kF32;
    c.blanking_m = random.uniform(0, 0.5 * c.range_m);
    ASSERT_NO_THROW(check(c));
    const Pose X_WB{Rotation::from_heading_pitch_roll(Angle::degrees(random.uniform(-180, 180)),
                                                      Angle::degrees(random.uniform(-90, 90)),
                                                      Angle::degrees(random.uniform(-180, 180))),
                    {random.uniform(-15, 15), random.uniform(-15, 15), random.uniform(-2, 18)}};
    const Heard one = hear(tank, c, X_WB, 3, 5, 1), three = hear(tank, c, X_WB, 3, 5, 3);
    ASSERT_EQ(one.samples, three.samples) << i;
    ASSERT_EQ(one.truth.labels, three.truth.labels) << i;
    ASSERT_EQ(check(one.ping), PingFault::kNone) << i;
    for (const double v : one.samples) ASSERT_TRUE(std::isfinite(v) && v >= 0) << i;
  }
}

// Scanning ----------------------------------------------------------------------------------------------------------

// ledger: S6-01
TEST(Scanning, AMicronLooksFromSideToSideInThirtyOnePings) {
  const Tank tank(kEmpty);
  SimulatedSonar head(sonar_preset("micron"), *tank.world, *tank.water, 1, 1);
  EXPECT_GE(std::chrono::duration<double>(head.interval()).count(), 2 * 50 / 1500.0);
  for (std::uint64_t n = 0; n < 130; ++n) {
    const auto out = head.ping(Time{}, at_depth(10), n);
    const int i = static_cast<int>(n % 60), step = i <= 30 ? i : 60 - i;
    ASSERT_EQ(out.ping->fan->beams(), 1);
    ASSERT_NEAR(out.ping->fan->azimuth[0].degrees(), -45 + 3 * step, 1e-9) << n;
    ASSERT_EQ(out.ping->window.bins, 44);
    ASSERT_NEAR(out.ping->window.bin_m, 50.0 / 44, 1e-12);
    ASSERT_EQ(check(*out.ping), PingFault::kNone);
  }
}

TEST(Scanning, StaysWithinItsSectorWhateverTheStep) {
  const Tank tank(kEmpty);
  struct Case {
    double sector, step, first;
    std::uint64_t steps;
  };
  for (const Case& c : {Case{90, 7, -42, 13}, Case{10, 30, 0, 1}, Case{60, 0.9, -29.7, 67}, Case{0, 3, 0, 1}}) {
    SonarConfig sonar = silent_fan(1, 10);
    sonar.kind = SonarKind::kScanning;
    sonar.sector = Angle::degrees(c.sector);
    sonar.step = Angle::degrees(c.step);
    SimulatedSonar head(sonar, *tank.world, *tank.water, 1, 1);
    const auto azimuth = [&](std::uint64_t n) {
      return head.ping(Time{}, at_depth(10), n).ping->fan->azimuth[0].degrees();
    };
    EXPECT_NEAR(azimuth(0), c.first, 1e-9);
    EXPECT_NEAR(azimuth(c.steps - 1), -c.first, 1e-9);
    if (c.steps > 1) {
      EXPECT_NEAR(azimuth(c.steps), -c.first - c.step, 1e-9);  // and back
    }
  }
}

TEST(Scanning, APing360TurnsRoundAndRound) {
  const Tank tank(kEmpty);
  SonarConfig sonar = sonar_preset("ping360");
  sonar.bins = 10;
  SimulatedSonar head(sonar, *tank.world, *tank.water, 1, 1);
  for (const std::uint64_t n : {0, 1, 200, 399, 400, 801}) {
    const double expected = 0.9 * static_cast<double>(n % 400);
    EXPECT_NEAR(head.ping(Time{}, at_depth(10), n).ping->fan->azimuth[0].degrees(), expected, 1e-9) << n;
  }
}

// ledger: S6-01
TEST(Scanning, TheHeadHearsWhatStandsWhereItLooks) {
  const Tank tank(std::string(kEmpty) + "[[sphere]]\ncentre = [20, 11.547, 10]\nradius = 0.3\n");  // 30 degrees
  SonarConfig sonar = sonar_preset("micron");
  sonar.samples = SampleType::kF32;
  sonar.noise = BackgroundLaw::kNone;
  sonar.speckle = sonar.surface_reverberation = sonar.volume_reverberation = sonar.surface_bounce = false;
  sonar.blanking_m = sonar.spurious_share = 0;
  SimulatedSonar head(sonar, *tank.world, *tank.water, 1, 1);
  std::map<double, double> level;
  for (std::uint64_t n = 0; n < 31; ++n) {
    const auto out = head.ping(Time{}, at_depth(10), n);
    const std::vector<double> all = samples(*out.ping);
    level[*std::max_element(all.begin(), all.end())] = out.ping->fan->azimuth[0].degrees();
  }
  EXPECT_NEAR(level.rbegin()->second, 30, 1e-6);
}

TEST(Scanning, WithoutAnIntervalPingsComeAsFastAsSoundAllows) {
  const Tank tank(kEmpty);
  const SonarConfig sonar = silent_fan(1, 10);
  EXPECT_NEAR(std::chrono::duration<double>(SimulatedSonar(sonar, *tank.world, *tank.water, 1, 1).interval()).count(),
              2 * 60 / 1500.0 + 0.005, 1e-9);
}

// Ranges ------------------------------------------------------------------------------------------------------------

TEST(Ranges, AnAltimeterReadsTheHeightOverAFlatBottomWithinHalfABin) {
  for (const double height : {3.02, 7.55, 14.33, 40.0}) {
    const Tank tank("[bottom]\nkind = \"flat\"\ndepth = " + std::to_string(5 + height) + "\n");
    SonarConfig sonar = sonar_preset("altimeter");
    sonar.sound_speed = tank.water->mean_sound_speed(5, 5 + height);
    sonar.speckle = false;
    SimulatedSonar device(sonar, *tank.world, *tank.water, 1, 1);
    const auto out = device.ping(Time{}, at_depth(5), 0);
    ASSERT_FALSE(out.ping);
    ASSERT_EQ(out.ranges.size(), 1u);
    ASSERT_TRUE(out.ranges[0].range_m) << height;
    EXPECT_NEAR(*out.ranges[0].range_m, height, 0.05 + 1e-6);
    EXPECT_NEAR(out.ranges[0].width.degrees(), 30, 1e-9);
    EXPECT_EQ(out.ranges[0].max_range_m, 100);
  }
}

TEST(Ranges, NoEchoIsAReadingWithoutARange) {
  const Tank tank(kEmpty);
  SonarConfig sonar = sonar_preset("altimeter");
  sonar.surface_reverberation = sonar.surface_bounce = false;
  SimulatedSonar device(sonar, *tank.world, *tank.water, 1, 1);
  const auto out = device.ping(Time{}, at_depth(5), 0);
  ASSERT_EQ(out.ranges.size(), 1u);
  EXPECT_FALSE(out.ranges[0].range_m);
}

// ledger: S4-32
TEST(Ranges, TheNearestOrTheStrongestEchoIsReported) {
  const Tank tank(std::string(kEmpty) +
                  "[[sphere]]\ncentre = [15, 0, 10]\nradius = 0.1\n"
                  "[[wall]]\nline = [[40, -20], [40, 20]]\ntop = 0\nbottom = 20\nmaterial = \"steel\"\n");
  SonarConfig sonar = silent_fan(1, 600);
  sonar.kind = SonarKind::kRanges;
  sonar.sector = Angle{};
  sonar.height = Angle::degrees(10);
  sonar.rays = 64;
  sonar.pick_level = 10;
  const auto range = [&](RangePick pick, double level) {
    sonar.pick = pick;
    sonar.pick_level = level;
    SimulatedSonar device(sonar, *tank.world, *tank.water, 1, 1);
    return device.ping(Time{}, at_depth(10), 0).ranges[0].range_m.value_or(-1);
  };
  EXPECT_NEAR(range(RangePick::kNearest, 1), 14.9, 0.15);
  EXPECT_NEAR(range(RangePick::kStrongest, 1), 40, 0.15);
  EXPECT_EQ(range(RangePick::kNearest, 1e9), -1);
}

/// Depths that the echo sounder reads, less those of the bottom there; by beam.
std::vector<double> depth_errors(const Tank& tank, const SonarConfig& sonar, const Pose& X_WB) {
  SimulatedSonar device(sonar, *tank.world, *tank.water, 1, 1);
  std::vector<double> errors;
  for (const RangeReading& r : device.ping(Time{}, X_WB, 0).ranges) {
    if (!r.range_m) continue;
    const Eigen::Vector3d p = X_WB * (r.X_BS * Eigen::Vector3d(*r.range_m, 0, 0));
    errors.push_back(p.z() - tank.world->bottom_depth(p.x(), p.y()).value());
  }
  return errors;
}

TEST(Ranges, AMultibeamEchoSounderLooksAcrossTheTrackFromPortToStarboard) {
  const Tank tank("[bottom]\nkind = \"flat\"\ndepth = 25\n");
  SimulatedSonar device(sonar_preset("multibeam_echo_sounder"), *tank.world, *tank.water, 1, 1);
  const auto ranges = device.ping(Time{}, at_depth(2), 0).ranges;
  ASSERT_EQ(ranges.size(), 256u);
  const Eigen::Vector3d port = ranges.front().X_BS.rotation * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d starboard = ranges.back().X_BS.rotation * Eigen::Vector3d::UnitX();
  EXPECT_LT((port - Eigen::Vector3d(0, -std::sin(60 * kDegree), 0.5)).norm(), 0.01);
  EXPECT_LT((starboard - Eigen::Vector3d(0, std::sin(60 * kDegree), 0.5)).norm(), 0.01);
}

TEST(Ranges, AMultibeamEchoSounderReadsTheDepthsOfAFlatAndOfASlopingBottom) {
  const std::string water = "[water]\nsound_speed = [[0, 1500]]\n";
  for (const char* bottom : {"kind = \"flat\"\ndepth = 25\n",
                             "kind = \"terrain\"\ndepth = 25\nrelief_m = 0\nslope = [0.05, 0.15]\ncell_m = 5\n"}) {
    const Tank tank(water + "[bottom]\n" + bottom);
    SonarConfig sonar = sonar_preset("multibeam_echo_sounder");
    sonar.speckle = false;
    std::vector<double> errors = depth_errors(tank, sonar, at_depth(2, 30));
    EXPECT_GE(errors.size(), 250u);
    double worst = 0;
    for (const double e : errors) worst = std::max(worst, std::abs(e));
    EXPECT_LT(worst, 0.6);
    std::nth_element(errors.begin(), errors.begin() + static_cast<long>(errors.size()) / 2, errors.end());
    EXPECT_NEAR(errors[errors.size() / 2], 0, 0.1);
  }
}

}  // namespace
}  // namespace isobath::simulated_sonar_test
