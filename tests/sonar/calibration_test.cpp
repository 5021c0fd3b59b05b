#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/sonar/calibration.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <nlohmann/json.hpp>
#include <numeric>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

/// The sonar of the thesis: 31 beams, 44 bins to 50 m, the first 9 in the blind zone; noise falls with range.
struct ThesisSonar {
  static constexpr double kBin = 50.0 / 44;
  static constexpr int kBins = 44;
  static constexpr int kBlind = 9;
  test::Background law;
  double amplitude_over_sigma = 0;  ///< of targets
  Random random{1};
  std::shared_ptr<const BeamFan> fan = test::fan_of(31, Angle::degrees(-45), Angle::degrees(3));

  static double level(int k) { return 1 - 0.012 * k; }
  double noise(int k) { return k < kBlind ? 200 + 30 * random.uniform() : level(k) * law(random); }
  template <class Sample>
  Ping background(double full_scale = 255) {
    return test::ping_of<Sample>(
        fan, {0, kBin, kBins}, [&](int, int k) { return noise(k); }, static_cast<float>(full_scale));
  }
};

// ledger: S6-07
TEST(TheoreticalRoc, HasTheValuesOfEquation41) {
  const auto snr = [](double decibel) { return std::pow(10, decibel / 10); };
  EXPECT_NEAR(theoretical_detection(0.01, snr(11.15)), 0.9, 1e-3);
  EXPECT_NEAR(theoretical_detection(0.02, snr(10.46)), 0.9, 1e-3);
  EXPECT_NEAR(theoretical_detection(0.03, snr(10.00)), 0.9, 1e-3);
  EXPECT_NEAR(theoretical_detection(0.04, snr(9.64)), 0.9, 1e-3);
  EXPECT_NEAR(theoretical_detection(0.02, snr(9)), 0.778, 1e-3);
  EXPECT_NEAR(normal_threshold(0.02), 2.054, 1e-3);
  for (double f : {0.01, 0.02, 0.5, 0.9}) EXPECT_NEAR(theoretical_detection(f, 0), f, 1e-14);
}

// ledger: S6-07
TEST(TheoreticalRoc, AgreesWithMonteCarlo) {
  Random random(7);
  constexpr int kRuns = 200000;
  for (double f : {0.01, 0.02, 0.04}) {
    const double amplitude = std::sqrt(std::pow(10, 0.9));
    const double threshold = normal_threshold(f);
    int hits = 0;
    for (int i = 0; i < kRuns; ++i) hits += amplitude + random.normal() >= threshold;
    const double p = theoretical_detection(f, amplitude * amplitude);
    EXPECT_NEAR(hits / double(kRuns), p, 3 * std::sqrt(p * (1 - p) / kRuns));
  }
}

CalibrationConfig at(double false_alarm) {
  CalibrationConfig config;
  config.false_alarm = false_alarm;
  config.blanking_m = 9 * ThesisSonar::kBin;
  config.range_groups = 35;  // a fit for every bin
  config.noise.bootstraps = 0;
  return config;
}

// Thresholds from 1000 scans of background, tried on fresh noise. The rate of a bin errs by the quantile's own error
// and by the fresh sample's, both binomial. ledger: S6-06
TEST(Calibration, KeepsTheFalseAlarmRateInEveryBinOnFreshNoise) {
  for (double f : {0.02, 0.03}) {
    ThesisSonar sonar{test::gaussian(100, 12)};
    Calibration calibration(at(f));
    constexpr int kScans = 400;
    for (int i = 0; i < kScans; ++i) calibration.add_background(sonar.background<float>());
    const SensorModel model = calibration.finish("lake").model;
    EchoDetector detector({}, model);
    EchoDecisions out;
    std::vector<int> alarms(44, 0);
    for (int i = 0; i < kScans; ++i) {
      detector.detect(sonar.background<float>(), out);
      for (int b = 0; b < 31; ++b) {
        for (int k = 0; k < 44; ++k) alarms[k] += out.hit(b, k);
      }
    }
    constexpr double kTrials = kScans * 31;
    for (int k = 9; k < 44; ++k) EXPECT_NEAR(alarms[k] / kTrials, f, 4 * std::sqrt(2 * f * (1 - f) / kTrials)) << k;
  }
}

// ledger: S6-04
TEST(Calibration, OfWholeSamplesStaysAtOrBelowTheRate) {
  ThesisSonar sonar{test::gaussian(100, 12)};
  Calibration calibration(at(0.02));
  for (int i = 0; i < 200; ++i) calibration.add_background(sonar.background<std::uint8_t>());
  const CalibrationResult result = calibration.finish("lake");
  for (const RangeGroup& group : result.groups) {
    const EchoCounts& c = group.counts;
    const double f = static_cast<double>(c.false_alarms) / static_cast<double>(c.false_alarms + c.correct_rejections);
    EXPECT_LE(f, 0.02);
    EXPECT_GT(f, 0.01);
    EXPECT_EQ(c.hits + c.misses, 0U) << "nothing was marked";
  }
  EXPECT_DOUBLE_EQ(result.model.bins[20].p_detect, 0.8);
  EXPECT_TRUE(result.comparison.empty());
}

// Lake f = 0.02, sea f = 0.03, first 9 of 44 bins blind; the curve of each lake bin is that of equation 4.1.
// ledger: S6-07 S6-D01 S6-D02 S6-D03 S6-09 S6-E05
TEST(Calibration, ReproducesTheLakeAndTheSea) {
  const auto calibrate = [](ThesisSonar sonar, double f, double sigma, double snr) {
    CalibrationConfig config = at(f);
    config.noise.bootstraps = 99;
    config.range_groups = 12;
    Calibration calibration(config);
    const double amplitude = sigma * std::sqrt(snr);
    std::vector<std::uint8_t> mask(31 * 44);
    for (int i = 0; i < 100; ++i) {
      calibration.add_background(sonar.background<float>());
      for (auto& m : mask) m = sonar.random.uniform() < 0.3;
      const Ping marked = test::ping_of<float>(sonar.fan, {0, ThesisSonar::kBin, 44}, [&](int b, int k) {
        return sonar.noise(k) + (mask[b * 44 + k] ? ThesisSonar::level(k) * amplitude : 0);
      });
      calibration.add_marked(marked, mask);
    }
    return calibration.finish("field");
  };
  const double snr = std::pow(10, 0.9);
  const CalibrationResult lake = calibrate({test::gaussian(100, 12)}, 0.02, 12, snr);
  const CalibrationResult sea = calibrate({test::sea_mixture(12)}, 0.03, 30, snr);
  int lake_gaussian = 0, sea_any = 0;
  for (int g = 0; g < 12; ++g) {
    lake_gaussian += lake.groups[g].fits[0].p_value > 0.01;
    EXPECT_LE(lake.groups[g].fits[1].p_value, 0.01) << "the lake is not Rayleigh";
    sea_any += sea.groups[g].fits[0].p_value > 0.01 || sea.groups[g].fits[1].p_value > 0.01;
    for (double f : {0.01, 0.02, 0.03, 0.04}) {
      EXPECT_NEAR(lake.groups[g].roc->at_false_alarm(f).p, theoretical_detection(f, snr), 0.09) << g;
    }
  }
  EXPECT_GE(lake_gaussian, 11);
  EXPECT_EQ(sea_any, 0) << "neither Gaussian nor Rayleigh";
  for (int k = 0; k < 44; ++k) {
    const SensorModel::Bin& bin = lake.model.bins[k];
    EXPECT_EQ(bin.blind, k < 9);
    EXPECT_EQ(sea.model.bins[k].blind, k < 9);
    if (k < 9) continue;
    const double wanted = ThesisSonar::level(k) * (100 + 12 * normal_threshold(0.02));
    EXPECT_NEAR(bin.threshold / wanted, 1, 0.015);
    EXPECT_NEAR(bin.p_detect, theoretical_detection(0.02, snr), 0.06);
    EXPECT_GT(sea.model.bins[k].threshold, bin.threshold * 0.1);
    EXPECT_GT(sea.model.bins[k].p_detect, 0.03);
  }
}

// Noise and targets fall with range alike: one threshold is too high far away and too low near by. (Where targets are
// as strong everywhere, equal rates a bin need not be the best use of a given total of false alarms.)
TEST(Calibration, ThresholdsABinDetectMoreThanOneForAll) {
  ThesisSonar sonar{test::rayleigh(30)};
  Calibration calibration(at(0.02));
  std::vector<std::uint8_t> mask(31 * 44);
  for (int i = 0; i < 60; ++i) {
    calibration.add_background(sonar.background<std::uint8_t>());
    for (auto& m : mask) m = sonar.random.uniform() < 0.2;
    calibration.add_marked(
        test::ping_of<std::uint8_t>(
            sonar.fan, {0, ThesisSonar::kBin, 44},
            [&](int b, int k) { return mask[b * 44 + k] ? 95 * ThesisSonar::level(k) : sonar.noise(k); }),
        mask);
  }
  const CalibrationResult result = calibration.finish("sloping");
  ASSERT_EQ(result.comparison.size(), 4u);
  for (const ThresholdComparison& c : result.comparison) {
    EXPECT_NEAR(c.false_alarm.value, c.nominal_false_alarm, 0.1 * c.nominal_false_alarm);
    EXPECT_GT(c.per_bin.interval.low, c.global.interval.high);
  }
}

// ledger: S6-09
TEST(Calibration, MarksBinsBlindThatDetectNothing) {
  ThesisSonar sonar{test::gaussian(100, 12)};
  CalibrationConfig config = at(0.02);
  config.min_targets = 40;
  Calibration calibration(config);
  std::vector<std::uint8_t> mask(31 * 44, 1);
  for (int i = 0; i < 50; ++i) {
    calibration.add_background(sonar.background<std::uint8_t>());
    calibration.add_marked(test::ping_of<std::uint8_t>(sonar.fan, {0, ThesisSonar::kBin, 44},
                                                       [](int, int k) { return k == 30 ? 10 : 200; }),
                           mask);
  }
  const SensorModel model = calibration.finish("hole").model;
  for (int k = 9; k < 44; ++k) EXPECT_EQ(model.bins[k].blind, k == 30) << k;
}

TEST(Calibration, RefusesWhatIsTooLittleOrMixed) {
  ThesisSonar sonar{test::gaussian(100, 12)};
  CalibrationConfig config = at(0.0001);
  Calibration few(config);
  EXPECT_THROW(static_cast<void>(few.finish("nothing")), Error);
  few.add_background(sonar.background<std::uint8_t>());
  EXPECT_THROW(static_cast<void>(few.finish("one ping")), Error);
  EXPECT_THROW(few.add_background(sonar.background<float>()), Error);
}

// ledger: S6-04
TEST(Calibration, SaysMissingForRatesOfNothing) {
  ThesisSonar sonar{test::gaussian(100, 12)};
  Calibration calibration(at(0.02));
  for (int i = 0; i < 50; ++i) calibration.add_background(sonar.background<std::uint8_t>());
  const auto json = nlohmann::json::parse(to_json(calibration.finish("lake")));
  EXPECT_TRUE(json["groups"][0]["p"].is_null());
  EXPECT_TRUE(json["groups"][0]["roc"].is_null());
  EXPECT_EQ(json["groups"][0]["f"]["interval"].size(), 2u);
  EXPECT_EQ(json["background_pings"], 50);
}

}  // namespace
}  // namespace isobath
