// The calibration job: what it writes of histograms, from frames that somebody annotated.
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/io/frames/gray_image.hpp>
#include <isobath/io/frames/marked_frames.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/studies/calibrate.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;

constexpr int kBeams = 16, kBins = 64;

/// 40 frames of background whose noise grows to starboard, and 8 with a hull that is drawn round in LabelMe.
fs::path annotated_frames(const fs::path& folder) {
  fs::create_directories(folder);
  std::ofstream(folder / "geometry.json") << fmt::format(
      R"({{"beams": {}, "bins": {}, "range_min_m": 1, "range_max_m": 9, "fov_deg": 16, "height_deg": 10}})", kBeams,
      kBins);
  Random random(2);
  for (int i = 0; i < 48; ++i) {
    const bool hull = i % 6 == 5;
    GrayImage image{kBeams, kBins, 1, {}};
    for (int row = 0; row < kBins; ++row) {
      for (int column = 0; column < kBeams; ++column) {
        const double noise = (3 + column) * std::hypot(random.normal(), random.normal());
        const bool echo = hull && row >= 20 && row < 24 && column >= 2 && column < 14;
        const double value = echo ? 110 + 25 * random.normal() : noise;
        image.samples.push_back(static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0)));
      }
    }
    write_gray_png(folder / fmt::format("{}.png", 1'000'000 + 100'000 * i), image);
    if (!hull) continue;
    std::ofstream(folder / fmt::format("{}.json", 1'000'000 + 100'000 * i))
        << R"({"shapes": [{"label": "hull", "points": [[2, 20], [14, 20], [14, 24], [2, 24]], "shape_type": "polygon"}]})";
  }
  return folder;
}

CalibrateRequest request_of(const fs::path& input, const fs::path& out) {
  CalibrateRequest request;
  request.input = input;
  request.out = out;
  request.configuration.calibration.noise.bootstraps = 0;
  return request;
}

struct Pings : ResultSink {
  int echoes = 0, on_hull = 0;
  void on_ping(const PosedPing& ping) override {
    for (int b = 0; b < kBeams; ++b) {
      for (int k = 0; k < kBins; ++k) {
        if (!ping.decisions.usable(k) || !ping.decisions.hit(b, k)) continue;
        EXPECT_NE(ping.decisions.ratios(b), nullptr);
        ++echoes;
        on_hull += k >= 20 && k < 24 && b >= 2 && b < 14 ? 1 : 0;
      }
    }
  }
  void on_scan(const ScanResult&) override {}
};

// ledger: S5-18 S5-23 S5-24 S5-26 S5-D02 S5-D03
TEST(Calibrate, WritesAHistogramModelThatARunDetectsWith) {
  const fs::path scratch = test::scratch_folder();
  const fs::path frames = annotated_frames(scratch / "frames");
  const CalibrateOutcome outcome = calibrate(request_of(frames, scratch / "out"));
  ASSERT_TRUE(outcome.histograms);
  const HistogramModel& model = outcome.histograms->model;
  EXPECT_EQ(model.background_pings, 40);
  EXPECT_EQ(model.marked_pings, 8);
  std::uint64_t objects = 0;
  for (const std::uint64_t n : model.object) objects += n;
  EXPECT_EQ(objects, 8u * 12 * 4) << "the pixels inside the polygons";
  EXPECT_EQ(model.config.level_width, std::round(model.config.level_width)) << "whole samples, whole levels";
  EXPECT_LT(model.config.level_width, 255 / 25.0) << "by the noise, not by the full scale";
  for (const auto& worth : outcome.histograms->worth) {
    EXPECT_GT(worth.detected.value, 0.9) << worth.false_alarm;
    EXPECT_EQ(worth.detected.trials, objects);
  }
  for (const char* name : {"histogram_model.bin", "noise_histograms.png", "object_histogram.png"}) {
    EXPECT_THAT(outcome.files, testing::Contains(fs::path(name)));
    EXPECT_GT(fs::file_size(scratch / "out" / name), 1000u) << name;
  }
  EXPECT_EQ(load_histogram_model(scratch / "out" / "histogram_model.bin").noise, model.noise);

  Configuration configuration;
  configuration.sensor.histogram = (scratch / "out" / "histogram_model.bin").string();
  Pings pings;
  Pipeline pipeline(configuration, pings);
  for (const MarkedFrame& frame : read_marked_frames(frames, {})) pipeline.on_event(frame.ping);
  pipeline.finish();
  EXPECT_EQ(pipeline.undecided(), "");
  EXPECT_GT(pings.on_hull, 8 * 12 * 4 * 0.9);
  const double noise_pixels = 48.0 * kBeams * kBins - 8 * 12 * 4;
  EXPECT_NEAR((pings.echoes - pings.on_hull) / noise_pixels, 0.02, 0.01);
}

TEST(Calibrate, WithoutMarksLearnsNoHistograms) {
  const fs::path scratch = test::scratch_folder();
  const fs::path frames = annotated_frames(scratch / "frames");
  for (const auto& entry : fs::directory_iterator(frames)) {
    if (entry.path().extension() == ".json" && entry.path().filename() != "geometry.json") fs::remove(entry.path());
  }
  const CalibrateOutcome outcome = calibrate(request_of(frames, scratch / "out"));
  EXPECT_FALSE(outcome.histograms);
  EXPECT_THAT(outcome.files, testing::Not(testing::Contains(fs::path("histogram_model.bin"))));
}

// Objects look alike at any setting: background of another range window makes a model with them. ledger: S5-23 S5-26
TEST(Calibrate, TakesObjectsOfAnotherModel) {
  const fs::path scratch = test::scratch_folder();
  calibrate(request_of(annotated_frames(scratch / "frames"), scratch / "out"));
  const HistogramModel known = load_histogram_model(scratch / "out" / "histogram_model.bin");
  const fs::path water = scratch / "water";
  fs::create_directories(water);
  std::ofstream(water / "geometry.json")
      << R"({"beams": 16, "bins": 64, "range_min_m": 2, "range_max_m": 18, "fov_deg": 16, "height_deg": 10})";
  for (const auto& entry : fs::directory_iterator(scratch / "frames")) {
    const fs::path annotation = fs::path(entry.path()).replace_extension(".json");
    if (entry.path().extension() == ".png" && !fs::exists(annotation)) {
      fs::copy_file(entry.path(), water / entry.path().filename());
    }
  }
  CalibrateRequest request = request_of(water, scratch / "again");
  request.objects = scratch / "out" / "histogram_model.bin";
  for (const bool as_log : {false, true}) {
    if (as_log) request.background_below = 300;
    const CalibrateOutcome outcome = calibrate(request);
    ASSERT_TRUE(outcome.histograms);
    const HistogramModel& model = outcome.histograms->model;
    EXPECT_EQ(model.object, known.object);
    EXPECT_EQ(model.noise, known.noise) << "the same water";
    EXPECT_NEAR(model.window.end_m(), 18, 1e-9);
    EXPECT_EQ(model.config.level_width, known.config.level_width);
  }
}

// Held-out frames of a DIDSON, 443 pixels marked by hand. Where few false alarms are allowed, each pixel's own noise
// helps; at many, one threshold does as well: there the intervals are wider than the difference. ledger: S5-21
TEST(Calibrate, OfTheDidsonDetectsMoreByHistogramsThanByOneThreshold) {
  ISOBATH_NEEDS_DATA(folder, "didson-hull");
  const CalibrateOutcome outcome = calibrate(request_of(folder, test::scratch_folder()));
  ASSERT_TRUE(outcome.histograms);
  const auto& thresholds = outcome.result.comparison;
  ASSERT_EQ(outcome.histograms->worth.size(), thresholds.size());
  for (std::size_t i = 0; i < thresholds.size(); ++i) {
    const double by_histograms = outcome.histograms->worth[i].detected.value, by_one = thresholds[i].global.value;
    if (thresholds[i].nominal_false_alarm < 0.025) {
      EXPECT_GT(by_histograms, by_one + 0.01) << thresholds[i].nominal_false_alarm;
    } else {
      EXPECT_GT(by_histograms, by_one - 0.01) << thresholds[i].nominal_false_alarm;
    }
  }
}

}  // namespace
}  // namespace isobath
