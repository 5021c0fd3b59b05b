// Histograms of noise and objects against laws that are known in closed form, against the equations written out, and
// against one threshold for all; files against damage.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/io/frames/marked_frames.hpp>
#include <isobath/sonar/histogram_model.hpp>
#include <isobath/sonar/roc.hpp>
#include <numeric>
#include <tests/support/data.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

using test::fan_of;
using test::ping_of;

const RangeWindow kModelWindow{1, 0.0508, 30};

/// A frequency-steered array: Rayleigh noise whose level varies with bearing, counts of 0 to 4000 (ledger S5-E11).
struct SteeredSonar {
  static constexpr int kBeams = 24;
  std::shared_ptr<const BeamFan> fan = fan_of(kBeams, Angle::degrees(-11.5));
  Random random{5};

  static double sigma(int beam) { return 150 + 350 * std::pow(std::sin(0.27 * beam), 2); }
  double noise(int beam) { return sigma(beam) * std::hypot(random.normal(), random.normal()); }
  /// An object shines alike everywhere, as the paper takes it to (S5-23).
  double echo() {
    const double a = 900 + 300 * random.normal();
    return std::hypot(a, 300 * random.normal());
  }
  /// `share` of the pixels are objects; marks says which.
  Ping ping(double share = 0, std::vector<std::uint8_t>* marks = nullptr) {
    if (marks) marks->clear();
    return ping_of<std::uint16_t>(
        fan, kModelWindow,
        [&](int b, int) {
          const bool object = share > 0 && random.uniform() < share;
          if (marks) marks->push_back(object ? 1 : 0);
          return object ? echo() : noise(b);
        },
        4000);
  }
};

HistogramConfig own_pixels() {
  HistogramConfig config;
  config.pool_bins = 0;
  return config;
}

std::shared_ptr<const HistogramModel> shared(HistogramModel model) {
  return std::make_shared<const HistogramModel>(std::move(model));
}

HistogramModel learnt(SteeredSonar& sonar, const HistogramConfig& config, int background = 300, int marked = 40,
                      double contamination = 0) {
  HistogramLearner learner(config);
  std::vector<std::uint8_t> marks;
  for (int i = 0; i < background; ++i) learner.add_background(sonar.ping(contamination));
  for (int i = 0; i < marked; ++i) {
    const Ping ping = sonar.ping(0.1, &marks);
    learner.add_marked(ping, marks);
  }
  return learner.model("test");
}

/// Samples of noise and of objects by some score, and what share of objects lies above where a share f of noise does.
struct Scores {
  std::vector<double> noise, object;
  double detected_at(double f) {
    std::sort(noise.begin(), noise.end(), std::greater<>());
    const double threshold = noise[static_cast<std::size_t>(f * static_cast<double>(noise.size()))];
    const auto above = std::count_if(object.begin(), object.end(), [&](double x) { return x > threshold; });
    return static_cast<double>(above) / static_cast<double>(object.size());
  }
};

// ledger: S5-18
TEST(HistogramModel, ApproachesTheTrueNoiseOfEachPixel) {
  SteeredSonar sonar;
  HistogramConfig config = own_pixels();
  config.drop_share = 0;
  const HistogramModel model = learnt(sonar, config, 300, 1);
  ASSERT_EQ(model.config.levels, 25);
  ASSERT_DOUBLE_EQ(model.config.level_width, 160);
  int accepted = 0, pixels = 0;
  for (int beam = 0; beam < SteeredSonar::kBeams; ++beam) {
    for (int bin = 0; bin < kModelWindow.bins; ++bin) {
      // Chi-square over levels of five and more expected samples, the rest as one. Counts are rounded to whole numbers.
      double statistic = 0, rest_expected = 0, rest_seen = 0;
      int classes = 0;
      for (int level = 0; level < 25; ++level) {
        const auto beyond = [&](double z) {
          return z <= 0 ? 1.0 : std::exp(-z * z / (2 * std::pow(SteeredSonar::sigma(beam), 2)));
        };
        const double low = beyond(160.0 * level - 0.5), high = level == 24 ? 0 : beyond(160.0 * level + 159.5);
        const double expected = 300 * (low - high), seen = model.counts(beam, bin)[static_cast<std::size_t>(level)];
        if (expected >= 5) {
          statistic += (seen - expected) * (seen - expected) / expected;
          ++classes;
        } else {
          rest_expected += expected;
          rest_seen += seen;
        }
      }
      if (rest_expected > 1) {
        statistic += (rest_seen - rest_expected) * (rest_seen - rest_expected) / rest_expected;
        ++classes;
      }
      // Wilson and Hilferty: the cube root of chi-square over its degrees is nearly normal.
      const double degrees = classes - 1, scale = 2 / (9 * degrees);
      const double normal = (std::cbrt(statistic / degrees) - (1 - scale)) / std::sqrt(scale);
      accepted += normal < 2.326 ? 1 : 0;
      ++pixels;
    }
  }
  EXPECT_GE(accepted, 0.95 * pixels) << "at the 1 % level";
}

// ledger: S5-18
TEST(HistogramModel, OfThePapersImageTakesNineMegabytes) {
  const Ping ping = ping_of<std::uint8_t>(fan_of(90), {0, 0.0508, 1968}, [](int, int) { return 7; });
  HistogramLearner learner(HistogramConfig{});
  learner.add_background(ping);
  EXPECT_EQ(learner.model("one").noise.size() * sizeof(std::uint16_t), 8'856'000u);
}

// ledger: S5-19
TEST(HistogramModel, WhatWasNeverSeenIsUnlikelyNotImpossible) {
  SteeredSonar sonar;
  const HistogramModel model = learnt(sonar, own_pixels(), 300);
  const auto noise = model.noise_shares(0, 0);
  EXPECT_NEAR(noise[24], 0.5 / (300 * 0.99 + 12.5), 1e-12) << "1 % of the samples dropped";
  HistogramConfig all = own_pixels();
  all.drop_share = 0;
  EXPECT_NEAR(learnt(sonar, all, 300).noise_shares(0, 0)[24], 0.0016, 1e-12) << "0.5 of 312.5";
  EXPECT_NEAR(std::accumulate(noise.begin(), noise.end(), 0.0), 1, 1e-12);
  HistogramConfig clamped = own_pixels();
  clamped.max_log_odds = 2.5;
  const LikelihoodRatios ratios(shared(learnt(sonar, clamped, 300)));
  for (int beam = 0; beam < SteeredSonar::kBeams; ++beam) {
    for (int level = 0; level < 25; ++level) EXPECT_LE(std::abs(ratios.log_ratio(beam, 3, level)), 2.5);
  }
  EXPECT_EQ(ratios.log_ratio(0, 0, 8), 2.5) << "noise of 150 counts never reaches 1280: the clamp";
}

// ledger: S5-20
TEST(HistogramModel, ObjectsInTheNoiseSetCostLessThanTwoPoints) {
  for (const bool masked : {false, true}) {
    SteeredSonar sonar;
    HistogramConfig config;
    config.pool_bins = 2;
    const HistogramModel clean = learnt(sonar, config, 150);
    HistogramModel spoilt = learnt(sonar, config, 150, 40, 0.01);
    if (masked) {
      HistogramLearner learner(config);
      std::vector<std::uint8_t> marks;
      for (int i = 0; i < 150; ++i) {
        const Ping ping = sonar.ping(0.01, &marks);
        learner.add_background(ping, marks);
      }
      for (int i = 0; i < 40; ++i) {
        const Ping ping = sonar.ping(0.1, &marks);
        learner.add_marked(ping, marks);
      }
      spoilt = learner.model("masked");
    }
    const auto detection = [&](HistogramModel model) {
      const LikelihoodRatios ratios(shared(std::move(model)));
      Scores scores;
      SteeredSonar fresh;
      fresh.random = Random(77);
      std::vector<std::uint8_t> marks;
      std::vector<std::int16_t> out(SteeredSonar::kBeams * static_cast<std::size_t>(kModelWindow.bins));
      for (int i = 0; i < 100; ++i) {
        const Ping ping = fresh.ping(0.1, &marks);
        ratios.look_up(ping, out);
        for (std::size_t j = 0; j < out.size(); ++j) (marks[j] ? scores.object : scores.noise).push_back(out[j]);
      }
      return scores.detected_at(0.02);
    };
    const double without = detection(clean), with = detection(spoilt);
    EXPECT_GT(without, 0.5);
    EXPECT_NEAR(with, without, 0.02) << (masked ? "masked" : "the brightest left out");
  }
}

// ledger: S5-21
TEST(HistogramModel, DetectsMoreThanTheBestThresholdWhereNoiseVariesWithBearing) {
  SteeredSonar sonar;
  const LikelihoodRatios ratios(shared(learnt(sonar, HistogramConfig{})));
  Scores by_ratio, by_brightness;
  std::vector<std::uint8_t> marks;
  std::vector<std::int16_t> out(SteeredSonar::kBeams * static_cast<std::size_t>(kModelWindow.bins));
  for (int i = 0; i < 150; ++i) {
    const Ping ping = sonar.ping(0.1, &marks);
    ratios.look_up(ping, out);
    for (std::size_t j = 0; j < out.size(); ++j) {
      const int beam = static_cast<int>(j) / kModelWindow.bins, bin = static_cast<int>(j) % kModelWindow.bins;
      const auto brightness = static_cast<double>(ping.intensity(beam, bin));
      (marks[j] ? by_ratio.object : by_ratio.noise).push_back(out[j]);
      (marks[j] ? by_brightness.object : by_brightness.noise).push_back(brightness);
    }
  }
  for (const double f : {0.01, 0.02, 0.05}) {
    EXPECT_GT(by_ratio.detected_at(f), by_brightness.detected_at(f) + 0.1) << "false alarms " << f;
  }
}

// ledger: S5-23
TEST(HistogramModel, ObjectsHaveOneHistogramForAllPixels) {
  SteeredSonar sonar;
  std::vector<std::uint8_t> marks;
  HistogramLearner learner(own_pixels());
  learner.add_background(sonar.ping());
  std::vector<double> counted(25, 0);
  for (int i = 0; i < 200; ++i) {
    const Ping ping = sonar.ping(0.05, &marks);
    learner.add_marked(ping, marks);
    for (int b = 0; b < SteeredSonar::kBeams; ++b) {
      for (int k = 0; k < kModelWindow.bins; ++k) {
        if (!marks[static_cast<std::size_t>(b * kModelWindow.bins + k)]) continue;
        ++counted[static_cast<std::size_t>(std::min(24, static_cast<int>(ping.intensity(b, k)) / 160))];
      }
    }
  }
  const HistogramModel model = learner.model("objects");
  EXPECT_EQ(std::vector<double>(model.object.begin(), model.object.end()), counted);
  const auto shares = model.object_shares();
  EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1, 1e-12);
  EXPECT_EQ(shares.size(), model.noise_shares(0, 0).size()) << "the same levels as the noise";
}

// ledger: S5-25
TEST(LikelihoodRatios, TableIsTheEquation) {
  SteeredSonar sonar;
  HistogramConfig config;
  config.pool_bins = 3;
  config.pool_beams = 1;
  const auto model = shared(learnt(sonar, config, 20));
  const LikelihoodRatios ratios(model);
  const Ping ping = sonar.ping(0.1);
  std::vector<std::int16_t> out(SteeredSonar::kBeams * static_cast<std::size_t>(kModelWindow.bins));
  ratios.look_up(ping, out);
  const double objects = std::accumulate(model->object.begin(), model->object.end(), 0.0);
  for (int b = 0; b < SteeredSonar::kBeams; ++b) {
    for (int k = 0; k < kModelWindow.bins; ++k) {
      std::vector<double> n(25, 0);
      double all = 0;
      for (int i = std::max(0, b - 1); i <= std::min(SteeredSonar::kBeams - 1, b + 1); ++i) {
        for (int j = std::max(0, k - 3); j <= std::min(kModelWindow.bins - 1, k + 3); ++j) {
          for (int level = 0; level < 25; ++level) {
            n[static_cast<std::size_t>(level)] += model->counts(i, j)[static_cast<std::size_t>(level)];
            all += model->counts(i, j)[static_cast<std::size_t>(level)];
          }
        }
      }
      double drop = 0.01 * all;
      for (std::size_t level = 25; level-- > 0;) {
        const double taken = std::min(drop, n[level]);
        n[level] -= taken;
        drop -= taken;
      }
      const int level = std::min(24, static_cast<int>(ping.intensity(b, k) / 160));
      const double e = (n[static_cast<std::size_t>(level)] + 0.5) / (0.99 * all + 12.5);
      const double h = (static_cast<double>(model->object[static_cast<std::size_t>(level)]) + 0.5) / (objects + 12.5);
      const double expected = std::clamp(std::log(h / e), -4.0, 4.0);
      ASSERT_NEAR(ratios.log_ratio(b, k, level), expected, LikelihoodRatios::kUnit);
      ASSERT_EQ(out[static_cast<std::size_t>(b * kModelWindow.bins + k)],
                std::lround(ratios.log_ratio(b, k, level) / LikelihoodRatios::kUnit));
    }
  }
}

// ledger: S5-25
TEST(LikelihoodRatios, OfWholeSamplesOfAnyOrderAreThoseOfFloats) {
  Random random(4);
  HistogramLearner learner(HistogramConfig{});
  const auto fan = fan_of(8);
  const RangeWindow window{0, 0.1, 16};
  const auto bytes = ping_of<std::uint8_t>(fan, window, [&](int, int) { return 255 * random.uniform(); });
  learner.add_background(bytes);
  learner.add_marked(bytes, std::vector<std::uint8_t>(128, 1));
  const LikelihoodRatios ratios(shared(learner.model("bytes")));
  std::vector<std::int16_t> own(128), other(128), turned(128);
  ratios.look_up(bytes, own);
  ratios.look_up(ping_of<float>(fan, window, [&](int b, int k) { return bytes.intensity(b, k); }), other);
  EXPECT_EQ(own, other);
  std::vector<std::uint8_t> rows;
  for (int k = 0; k < 16; ++k) {
    for (int b = 7; b >= 0; --b) rows.push_back(static_cast<std::uint8_t>(bytes.intensity(b, k)));
  }
  Ping mirrored = bytes;
  mirrored.intensity = Intensities(rows.data() + 7, SampleType::kU8, 8, 16, -1, 8);
  ratios.look_up(mirrored, turned);
  EXPECT_EQ(own, turned);
}

// On noise that it has not seen; a quarter more is what the training's own scatter leaves.
TEST(LikelihoodRatios, OperatingPointKeepsItsRateOnFreshNoise) {
  SteeredSonar sonar;
  const LikelihoodRatios ratios(shared(learnt(sonar, HistogramConfig{})));
  std::vector<std::int16_t> out(SteeredSonar::kBeams * static_cast<std::size_t>(kModelWindow.bins));
  for (const double f : {0.005, 0.02, 0.05}) {
    const auto point = ratios.operating_point(f, 4);
    EXPECT_LE(point.false_alarm, f);
    EXPECT_GT(point.false_alarm, 0.8 * f);
    EXPECT_EQ(point.p_detect[3], 0);
    double alarms = 0, noise = 0, hits = 0, objects = 0;
    std::vector<std::uint8_t> marks;
    for (int i = 0; i < 100; ++i) {
      const Ping ping = sonar.ping(0.1, &marks);
      ratios.look_up(ping, out);
      for (std::size_t j = 0; j < out.size(); ++j) {
        if (static_cast<int>(j) % kModelWindow.bins < 4) continue;
        (marks[j] ? objects : noise) += 1;
        if (out[j] >= point.threshold) (marks[j] ? hits : alarms) += 1;
      }
    }
    EXPECT_NEAR(alarms / noise, f, 0.25 * f);
    EXPECT_NEAR(hits / objects, static_cast<double>(point.p_detect[10]), 0.05);
  }
}

TEST(HistogramModel, PoolsRangesWhereImagesAreFew) {
  SteeredSonar sonar;
  const auto reach = [&](int images) {
    HistogramLearner learner(HistogramConfig{});
    const Ping ping = ping_of<std::uint8_t>(fan_of(4), {0, 0.05, 640}, [](int, int) { return 3; });
    for (int i = 0; i < images; ++i) learner.add_background(ping);
    return learner.model("").config.pool_bins;
  };
  EXPECT_EQ(reach(1000), 0);
  EXPECT_EQ(reach(300), 2) << "5 bins of 300 samples are 1500, 3 are 900";
  EXPECT_EQ(reach(87), 6);
  EXPECT_EQ(reach(3), 20) << "1/32 of the window at most";
}

// ledger: S5-26
TEST(HistogramModel, FileKeepsItAndRefusesOtherSettings) {
  SteeredSonar sonar;
  const HistogramModel model = learnt(sonar, own_pixels(), 5);
  const HistogramModel again = read_histogram_model(write_histogram_model(model), "model");
  EXPECT_EQ(again.noise, model.noise);
  EXPECT_EQ(again.object, model.object);
  EXPECT_EQ(again.config, model.config);
  EXPECT_EQ(again.window, model.window);
  EXPECT_EQ(again.source, "test");
  EXPECT_EQ(again.background_pings, 5);

  Ping ping = sonar.ping();
  EXPECT_EQ(mismatch(again, ping), std::nullopt);
  ping.window.start_m += 0.2 * ping.window.bin_m;
  EXPECT_EQ(mismatch(again, ping), std::nullopt) << "the sound speed drifts";
  ping.window.start_m += 0.2 * ping.window.bin_m;
  EXPECT_EQ(mismatch(again, ping), HistogramMismatch::kRange);
  ping = sonar.ping();
  ping.window.bin_m *= 2;
  EXPECT_EQ(mismatch(again, ping), HistogramMismatch::kRange);
  ping = sonar.ping();
  ping.window.bins -= 1;
  EXPECT_EQ(mismatch(again, ping), HistogramMismatch::kImageSize);
  ping = sonar.ping();
  ping.fan = fan_of(24, Angle::degrees(-11));
  EXPECT_EQ(mismatch(again, ping), HistogramMismatch::kBearings);
  ping = sonar.ping();
  ping.fan = fan_of(25, Angle::degrees(-11.5));
  EXPECT_EQ(mismatch(again, ping), HistogramMismatch::kImageSize);
  ping = sonar.ping();
  ping.full_scale = 255;
  EXPECT_EQ(mismatch(again, ping), HistogramMismatch::kLevels);
}

// ledger: S5-26
TEST(HistogramLearner, AddsRecordingsOfOneSettingOnly) {
  SteeredSonar sonar;
  const HistogramModel first = learnt(sonar, own_pixels(), 5), second = learnt(sonar, own_pixels(), 7);
  HistogramLearner learner(own_pixels());
  learner.add(first);
  learner.add(second);
  const HistogramModel sum = learner.model("both");
  EXPECT_EQ(sum.background_pings, 12);
  EXPECT_EQ(sum.noise[100], first.noise[100] + second.noise[100]);
  EXPECT_EQ(sum.object[6], first.object[6] + second.object[6]);
  HistogramConfig other = own_pixels();
  other.level_width = 100;
  EXPECT_THROW(learner.add(learnt(sonar, other, 5)), Error) << "other edges";
  other = own_pixels();
  other.levels = 20;
  EXPECT_THROW(learner.add(learnt(sonar, other, 5)), Error);
  Ping ping = sonar.ping();
  ping.window.bin_m *= 1.5;
  EXPECT_THROW(learner.add_background(ping), Error);
  EXPECT_THROW(static_cast<void>(HistogramLearner(own_pixels()).model("nothing")), Error);
  EXPECT_THROW(learner.add_objects(learnt(sonar, other, 5)), Error) << "in other levels";
  EXPECT_THROW(HistogramLearner(own_pixels()).add_objects(first), Error) << "objects without noise";
  learner.add_objects(first);
  EXPECT_EQ(learner.model("").object[6], sum.object[6] + first.object[6]);
  EXPECT_EQ(learner.model("").background_pings, 12);
  HistogramLearner noise_only(own_pixels());
  noise_only.add_background(sonar.ping());
  EXPECT_THROW(LikelihoodRatios(shared(noise_only.model("noise"))), Error);
}

// ledger: S5-26
TEST(HistogramModel, DamagedFilesAreRefused) {
  SteeredSonar sonar;
  HistogramLearner learner(own_pixels());
  learner.add_background(ping_of<std::uint8_t>(fan_of(3), {0, 0.1, 4}, [](int, int) { return 9; }));
  const std::string good = write_histogram_model(learner.model("small"));
  EXPECT_NO_THROW(read_histogram_model(good, "good"));
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_THROW(read_histogram_model(good.substr(0, size), "cut"), Error) << size;
  }
  for (std::size_t at = 0; at < good.size(); ++at) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    EXPECT_THROW(read_histogram_model(bad, "changed"), Error) << at;
  }
  EXPECT_THROW(load_histogram_model("/nowhere/model.histograms"), Error);
}

}  // namespace
}  // namespace isobath
