#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

EchoDetectorConfig global_at(double share) {
  EchoDetectorConfig config;
  config.method = DetectionMethod::kGlobal;
  config.global_threshold = share;
  config.blanking_m = 0;
  return config;
}

// ledger: S6-03
TEST(EchoDetector, EqualityIsAnEcho) {
  const auto check_type = [](auto sample, float full_scale) {
    using Sample = decltype(sample);
    EchoDetector detector(global_at(0.4));
    const double t = 0.4f * full_scale;
    const double values[] = {t - 1, std::ceil(t), t + 1, 0, full_scale};
    const Ping ping = test::ping_of<Sample>(
        test::fan_of(1), {0, 0.1, 5}, [&](int, int k) { return values[k]; }, full_scale);
    EchoDecisions out;
    detector.detect(ping, out);
    for (int k = 0; k < 5; ++k) EXPECT_EQ(out.hit(0, k), k == 1 || k == 2 || k == 4) << k;
  };
  check_type(std::uint8_t{}, 255);
  check_type(std::uint16_t{}, 4095);
  check_type(float{}, 2);
}

/// A model with thresholds of all kinds: reachable or not, whole or not, blind.
SensorModel odd_model(int bins) {
  SensorModel model;
  model.window = {0, 0.1, bins};
  Random random(5);
  for (int k = 0; k < bins; ++k) {
    const double t = k % 17 == 0 ? 256 : k % 5 == 0 ? random.uniform(1, 255) : std::round(random.uniform(1, 255));
    model.bins.push_back({t, 0.9, 10, 3, k % 23 == 3});
  }
  return model;
}

// Each memory layout that has a path of its own, and those that have none, against the definition.
// ledger: S6-03 S6-09 S6-E05
TEST(EchoDetector, AllLayoutsDecideAsDefined) {
  constexpr int kBeams = 37;
  constexpr int kBins = 131;
  std::vector<std::uint8_t> samples(kBeams * kBins * 2);
  Random random(9);
  for (auto& z : samples) z = static_cast<std::uint8_t>(random.bits());
  const SensorModel model = odd_model(kBins);
  EchoDetectorConfig config;
  config.blanking_m = 0.35;
  const std::ptrdiff_t layouts[][2] = {{kBins, 1}, {1, kBeams}, {2 * kBins, 2}, {2, 2 * kBeams}};
  for (const auto& [beam_stride, bin_stride] : layouts) {
    Ping ping;
    ping.fan = test::fan_of(kBeams);
    ping.window = model.window;
    ping.intensity = Intensities(samples.data(), SampleType::kU8, kBeams, kBins, beam_stride, bin_stride);
    EchoDetector detector(config, model);
    EchoDecisions out;
    detector.detect(ping, out);
    for (int k = 0; k < kBins; ++k) {
      const bool usable = k >= 4 && !model.bins[k].blind;
      ASSERT_EQ(out.usable(k), usable) << k;
      ASSERT_FLOAT_EQ(out.p_detect[k], usable ? 0.9f : 0.0f);
      for (int b = 0; b < kBeams; ++b) {
        ASSERT_EQ(out.hit(b, k), usable && ping.intensity(b, k) >= model.bins[k].threshold) << b << " " << k;
      }
    }
    EXPECT_DOUBLE_EQ(out.false_alarm, model.false_alarm);
  }
}

/// Beams of different noise; objects above all of it.
std::shared_ptr<const LikelihoodRatios> steered_ratios(Random& random, std::shared_ptr<const BeamFan> fan,
                                                       RangeWindow window) {
  HistogramLearner learner(HistogramConfig{});
  const auto noise = [&](int b, int) { return (4.0 + 5 * b) * std::hypot(random.normal(), random.normal()); };
  for (int i = 0; i < 60; ++i) learner.add_background(test::ping_of<std::uint8_t>(fan, window, noise));
  const auto bright = [&](int, int) { return 120 + 30 * random.normal(); };
  const std::vector<std::uint8_t> all(static_cast<std::size_t>(fan->beams() * window.bins), 1);
  for (int i = 0; i < 5; ++i) learner.add_marked(test::ping_of<std::uint8_t>(fan, window, bright), all);
  return std::make_shared<const LikelihoodRatios>(std::make_shared<const HistogramModel>(learner.model("steered")));
}

// ledger: S5-21 S5-25 S5-26
TEST(EchoDetector, DecidesByTheRatioOfEachPixelAndPassesItOn) {
  Random random(6);
  const auto fan = test::fan_of(6);
  const RangeWindow window{0, 0.1, 40};
  const auto ratios = steered_ratios(random, fan, window);
  EchoDetectorConfig config;
  config.blanking_m = 0.35;
  EchoDetector detector(config, std::nullopt, ratios);
  EXPECT_EQ(detector.method(), DetectionMethod::kHistogram) << "auto: the model that is given";
  const Ping ping = test::ping_of<std::uint8_t>(fan, window, [&](int, int) { return 140 * random.uniform(); });
  EchoDecisions out;
  detector.detect(ping, out);
  ASSERT_EQ(detector.state(), DetectorState::kReady);
  const auto point = ratios->operating_point(config.false_alarm, 4);
  int echoes = 0, dimmer_than_noise_elsewhere = 0;
  for (int b = 0; b < 6; ++b) {
    for (int k = 0; k < 40; ++k) {
      EXPECT_EQ(out.usable(k), k >= 4);
      const int level = ratios->model().level(ping.intensity(b, k));
      const double increment = ratios->log_ratio(b, k, level);
      const bool echo = k >= 4 && increment >= point.threshold * LikelihoodRatios::kUnit;
      ASSERT_EQ(out.hit(b, k), echo) << b << " " << k;
      ASSERT_NEAR(static_cast<double>(out.ratios(b)[k]), echo ? std::exp(increment) : 1, 1e-4);
      echoes += echo ? 1 : 0;
      dimmer_than_noise_elsewhere += echo && ping.intensity(b, k) < 60 ? 1 : 0;
    }
  }
  EXPECT_GT(echoes, 100);
  EXPECT_GT(dimmer_than_noise_elsewhere, 0) << "no single threshold";

  const auto other =
      test::ping_of<std::uint8_t>(test::fan_of(6, Angle::degrees(30)), window, [](int, int) { return 9; });
  detector.detect(other, out);
  EXPECT_EQ(detector.state(), DetectorState::kHistogramOfOther);
  for (int k = 0; k < 40; ++k) EXPECT_FALSE(out.usable(k));
  detector.detect(ping, out);
  EXPECT_EQ(detector.state(), DetectorState::kReady) << "what fits is served again";
  config.method = DetectionMethod::kHistogram;
  EXPECT_THROW(EchoDetector{config}, Error);
}

// Beyond the last sample of a beam nobody has listened: neither an echo nor free water, by any method; and a level that
// CFAR takes from there would be zero.
TEST(EchoDetector, BinsThatWereNotSampledTellNothing) {
  constexpr int kBins = 100;
  Ping ping = test::ping_of<float>(
      test::fan_of(2), {0, 0.1, kBins}, [](int b, int k) { return b == 1 && k >= 60 ? 0.0
                                                                  : k == 30         ? 9.0
                                                                                    : 1.0; }, 10);
  ping.sampled = std::make_shared<std::vector<BinSpan>>(std::vector<BinSpan>{{0, kBins}, {10, 60}});
  ASSERT_EQ(check(ping), PingFault::kNone);
  for (const DetectionMethod method :
       {DetectionMethod::kGlobal, DetectionMethod::kCellAveraging, DetectionMethod::kOrderedStatistic}) {
    EchoDetectorConfig config = global_at(0.05);
    config.method = method;
    config.false_alarm = 1e-3;
    EchoDetector detector(config);
    EchoDecisions out;
    detector.detect(ping, out);
    for (int k = 0; k < kBins; ++k) {
      EXPECT_TRUE(out.tells(0, k)) << k;
      EXPECT_EQ(out.tells(1, k), k >= 10 && k < 60) << k;
      const bool all = method == DetectionMethod::kGlobal;
      EXPECT_EQ(out.hit(1, k), k >= 10 && k < 60 && (all || k == 30)) << k << " method " << static_cast<int>(method);
    }
  }
  ping.sampled = std::make_shared<std::vector<BinSpan>>(std::vector<BinSpan>{{0, kBins}, {10, kBins + 1}});
  EXPECT_EQ(check(ping), PingFault::kSizeMismatch);
  ping.sampled = std::make_shared<std::vector<BinSpan>>(std::vector<BinSpan>{{0, kBins}});
  EXPECT_EQ(check(ping), PingFault::kSizeMismatch);
}

TEST(EchoDetector, SaysWhyAModelDoesNotServe) {
  EchoDetector detector(EchoDetectorConfig{}, odd_model(100));
  EchoDecisions out;
  const auto ping = [](RangeWindow w) {
    return test::ping_of<std::uint8_t>(test::fan_of(2), w, [](int, int) { return 200; });
  };
  detector.detect(ping({0, 0.1, 200}), out);
  EXPECT_EQ(detector.state(), DetectorState::kModelRange);
  for (int k = 0; k < 200; ++k) EXPECT_FALSE(out.usable(k));
  detector.detect(ping({0, 0.1, 100}), out);
  EXPECT_EQ(detector.state(), DetectorState::kReady) << "a window that fits is served again";
  detector.detect(ping({0, 0.01, 100}), out);
  EXPECT_EQ(detector.state(), DetectorState::kModelBinLength);
}

TEST(EchoDetector, RefusesWhatCannotWork) {
  EchoDetectorConfig config;
  config.method = DetectionMethod::kModel;
  EXPECT_THROW(EchoDetector{config}, Error);
  config.method = DetectionMethod::kAutomatic;
  config.p_detect = config.false_alarm;
  EXPECT_THROW(EchoDetector{config}, Error);
}

/// Share of usable decisions that are hits, over `pings` fresh pings after learning.
struct Trial {
  int beams = 32;
  int bins = 200;
  int learn = 60;
  int judge = 40;
  double full_scale = 255;
  template <class Sample, class Value>
  double rate(EchoDetector& detector, Value value) const {
    EchoDecisions out;
    double hits = 0, all = 0;
    const auto fan = test::fan_of(beams);
    for (int i = 0; i < learn + judge; ++i) {
      const Ping ping = test::ping_of<Sample>(fan, {0, 0.05, bins}, value, static_cast<float>(full_scale));
      detector.detect(ping, out);
      for (int b = 0; b < beams && i >= learn; ++b) {
        for (int k = 0; k < bins; ++k) {
          if (!out.usable(k)) continue;
          ++all;
          hits += out.hit(b, k);
        }
      }
    }
    return hits / all;
  }
};

EchoDetectorConfig plain_learnt() {
  EchoDetectorConfig config;
  config.method = DetectionMethod::kLearnt;
  config.skirt_share = 0;
  config.noise.contrast = 0;
  return config;
}

// The law is not told: its shape is found. Level falls with range as spreading does.
// ledger: S6-06 S6-70
TEST(LearntThresholds, KeepTheRateUnderEachLaw) {
  const std::pair<const char*, test::Background> laws[] = {
      {"Gaussian", test::gaussian(80, 8)}, {"Rayleigh", test::rayleigh(20)}, {"exponential", test::exponential(12)}};
  for (const auto& [name, law] : laws) {
    Random random(21);
    EchoDetector whole(plain_learnt());
    const auto at_range = [&, &noise = law](int, int k) { return noise(random) * (1.0 - 0.003 * k); };
    EXPECT_NEAR(Trial{}.rate<std::uint8_t>(whole, at_range), 0.02, 0.006) << name;
    EchoDetector real(plain_learnt());
    EXPECT_NEAR(Trial{}.rate<float>(real, at_range), 0.02, 0.006) << name;
  }
}

// A scanning head whose bins are twenty times shorter than a cell has a twentieth of the rate in each, but only where
// the method is left open.
// ledger: S6-06
TEST(LearntThresholds, ShareTheRateOfACellAmongTheShortBinsOfAHead) {
  Random random(22);
  const auto background = test::rayleigh(20);
  const auto noise = [&](int, int) { return background(random); };
  EchoDetectorConfig config = plain_learnt();
  config.method = DetectionMethod::kAutomatic;
  config.false_alarm_m = 1;
  const Trial head{.beams = 1, .learn = 400, .judge = 1000};
  EchoDetector shared(config);
  const double rate = head.rate<float>(shared, noise);
  EXPECT_DOUBLE_EQ(shared.false_alarm(), 0.02 * 0.05) << "what the map is told";
  config.false_alarm_m = 0;
  EchoDetector each(config);
  const double whole = head.rate<float>(each, noise);
  EXPECT_NEAR(whole, 0.02, 0.008) << "one beam teaches the thresholds less than a fan";
  EXPECT_LT(rate, whole / 10);
  EXPECT_GT(rate, whole / 40);
  EchoDetector named(plain_learnt());
  EXPECT_NEAR(head.rate<float>(named, noise), 0.02, 0.008);
}

// ledger: S6-70
TEST(LearntThresholds, FollowTheNoiseFromLakeToSea) {
  Random random(22);
  EchoDetectorConfig config = plain_learnt();
  config.noise.memory_profiles = 400;
  EchoDetector detector(config);
  const auto lake = [&, law = test::gaussian(60, 6)](int, int) { return law(random); };
  EXPECT_NEAR(Trial{}.rate<float>(detector, lake), 0.02, 0.006);
  const auto sea = [&, law = test::rayleigh(30)](int, int) { return law(random); };
  Trial after_50_scans;
  after_50_scans.learn = 50;
  EXPECT_NEAR(after_50_scans.rate<float>(detector, sea), 0.02, 0.006);
}

TEST(LearntThresholds, SeeTargetsThatFillAThirdOfTheBearings) {
  Random random(23);
  EchoDetector detector(plain_learnt());
  EchoDecisions out;
  const auto noise = test::rayleigh(15);
  const auto fan = test::fan_of(30);
  for (int i = 0; i < 100; ++i) {
    detector.detect(test::ping_of<std::uint8_t>(fan, {0, 0.05, 200},
                                                [&](int b, int k) {
                                                  const bool wall = b < 10 && k >= 80 && k < 140;
                                                  return wall ? 120 : noise(random);
                                                }),
                    out);
  }
  for (int b = 0; b < 10; ++b) EXPECT_TRUE(out.hit(b, 100)) << b;
}

TEST(LearntThresholds, SeeAWallThatFillsAllBearingsButIsThin) {
  Random random(24);
  EchoDetector detector(plain_learnt());
  EchoDecisions out;
  const auto noise = test::rayleigh(15);
  const auto fan = test::fan_of(30);
  for (int i = 0; i < 200; ++i) {
    detector.detect(test::ping_of<std::uint8_t>(fan, {0, 0.05, 200},
                                                [&](int, int k) { return k >= 100 && k < 108 ? 130 : noise(random); }),
                    out);
  }
  for (int b = 0; b < 30; ++b) EXPECT_TRUE(out.hit(b, 103)) << b;
}

TEST(LearntThresholds, DecideNothingBeforeTheyHaveLearnt) {
  EchoDetectorConfig config = plain_learnt();
  config.noise.warmup_profiles = 100;
  EchoDetector detector(config);
  EchoDecisions out;
  Random random(25);
  const auto noise = test::rayleigh(15);
  const Ping ping =
      test::ping_of<std::uint8_t>(test::fan_of(1), {0, 0.05, 90}, [&](int, int) { return noise(random); });
  for (int i = 0; i < 100; ++i) {
    detector.detect(ping, out);
    EXPECT_EQ(detector.state() == DetectorState::kReady, i == 99);
    EXPECT_EQ(out.usable(60), i == 99);
    EXPECT_FALSE(out.usable(11)) << "blind zone of 0.6 m";
  }
}

/// A fan in Rayleigh noise whose beams 20 to 23 hear all of it louder.
Ping loud_in_the_middle(Random& random, double gain) {
  const auto noise = test::rayleigh(15);
  return test::ping_of<std::uint8_t>(test::fan_of(48), {0, 0.05, 400},
                                     [&](int b, int) { return (b >= 20 && b < 24 ? gain : 1) * noise(random); });
}

double rate_of(const EchoDecisions& out, int from, int upto) {
  double hits = 0, all = 0;
  for (int b = from; b < upto; ++b) {
    for (int k = 0; k < out.bins(); ++k) {
      hits += out.hit(b, k);
      all += out.usable(k);
    }
  }
  return hits / std::max(1.0, all);
}

// A log of two pings, shorter than any warm-up.
TEST(LearntThresholds, DecideTheFirstPingOfALogThatWasListenedTo) {
  Random random(31);
  const Ping first = loud_in_the_middle(random, 1), second = loud_in_the_middle(random, 1);
  EchoDetectorConfig config = plain_learnt();
  EchoDetector ahead(config), causal(config);
  EXPECT_FALSE(ahead.listen(first));
  EXPECT_FALSE(ahead.listen(second)) << "96 beams of 100";
  ahead.end_learning();
  EchoDecisions out;
  ahead.detect(first, out);
  EXPECT_EQ(ahead.state(), DetectorState::kReady);
  EXPECT_NEAR(rate_of(out, 0, 48), config.false_alarm, 0.5 * config.false_alarm);
  ahead.detect(second, out);
  EXPECT_NEAR(rate_of(out, 0, 48), config.false_alarm, 0.5 * config.false_alarm);
  causal.detect(first, out);
  EXPECT_EQ(causal.state(), DetectorState::kWarmingUp) << "who does not listen ahead decides nothing";
}

TEST(LearntThresholds, AreNotLearntFromAFewBeams) {
  Random random(32);
  const auto noise = test::rayleigh(15);
  EchoDetector detector(plain_learnt());
  const auto fan = test::fan_of(1);
  EchoDecisions out;
  Ping ping;
  for (int i = 0; i < 15; ++i) {
    ping = test::ping_of<std::uint8_t>(fan, {0, 0.05, 90}, [&](int, int) { return noise(random); });
    EXPECT_FALSE(detector.listen(ping));
  }
  detector.end_learning();
  detector.detect(ping, out);
  EXPECT_EQ(detector.state(), DetectorState::kWarmingUp);
}

TEST(LearntThresholds, RiseInABeamThatIsLouderThanTheOthers) {
  Random random(33);
  EchoDetectorConfig config = plain_learnt();
  EchoDetector ahead(config), causal(config);
  EchoDecisions with, without;
  const Ping first = loud_in_the_middle(random, 1.3);
  ahead.listen(first);
  ahead.end_learning();
  for (int i = 0; i < 20; ++i) {
    const Ping ping = loud_in_the_middle(random, 1.3);
    ahead.detect(ping, with);
    causal.detect(ping, without);
  }
  EXPECT_GT(rate_of(without, 20, 24), 0.06) << "(0.02 ^ (1 / 1.69) is 0.1)";
  EXPECT_LT(rate_of(with, 20, 24), 0.03);
  EXPECT_NEAR(rate_of(with, 0, 20), rate_of(without, 0, 20), 0.004) << "the others stay";
}

TEST(SkirtRule, KeepsAnEchoThatStandsApartAndDropsAFoot) {
  EchoDetectorConfig config;
  config.blanking_m = 0;
  EchoDetector detector(config);
  EchoDecisions out;
  std::vector<int> beam(100, 0);
  const auto ping = [&] {
    return test::ping_of<std::uint8_t>(test::fan_of(1), {0, 0.02, 100}, [&](int, int k) { return beam[k]; });
  };
  for (int i = 0; i < 200; ++i) detector.detect(ping(), out);  // silence
  const auto put = [&](int from, std::vector<int> values) {
    std::copy(values.begin(), values.end(), beam.begin() + from);
  };
  put(20, {40, 60, 80, 100, 160, 170, 150, 60});  // a foot that rises to its echo
  put(60, {90, 0, 0, 170});                       // a small echo, a dip, a strong echo
  detector.detect(ping(), out);
  std::vector<int> hits;
  for (int k = 0; k < 100; ++k) {
    if (out.hit(0, k)) hits.push_back(k);
  }
  EXPECT_THAT(hits, testing::ElementsAre(24, 25, 26, 27, 60, 63));
}

TEST(EchoDetectorConfig, IsSetByName) {
  EchoDetectorConfig config;
  std::vector<Section> sections = {{"detector", "", fields(config)}};
  read_toml("[detector]\nmethod = \"os_cfar\"\nfalse_alarm = 0.03\ncfar_law = \"exponential\"\n", "c.toml", sections);
  EXPECT_EQ(config.method, DetectionMethod::kOrderedStatistic);
  EXPECT_DOUBLE_EQ(config.false_alarm, 0.03);
  EXPECT_EQ(config.cfar.law, CfarLaw::kExponential);
  EXPECT_THROW(set_from_text("detector.contrast=2", sections), Error);
}

}  // namespace
}  // namespace isobath
