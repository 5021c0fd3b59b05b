// A run in the noise of the sea: which obstacles it makes of the spikes.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/run/closed_loop.hpp>
#include <isobath/scenario/scenario.hpp>
#include <tests/support/straight_helm.hpp>

namespace isobath {
namespace {

/// Two poles ahead of a vehicle, in K-distributed noise.
constexpr const char* kPolesInSpikyNoise = R"(
[scene]
title = "Two poles in the noise of the sea"
duration_s = 12
[vehicle]
start = [0, 0, 12]
speed = 0.8
[navigation]
kind = "truth"
[[cylinder]]
name = "near"
centre = [35, 8, 12]
radius = 0.5
length = 24
[[cylinder]]
name = "far"
centre = [50, -10, 12]
radius = 0.5
length = 24
[[sonar]]
preset = "p450_horizontal"
range_m = 60
bins = 400
noise = "k"
)";

TruthScore judged_in_spiky_noise(DetectionMethod method) {
  test::StraightHelm helm({Angle{}, 12, 0.8});
  LoopRequest request;
  request.judge = true;
  request.configuration.echoes.method = method;
  return run_closed_loop(parse_scenario(kPolesInSpikyNoise, "spiky.toml"), helm, request).sight;
}

// The statistics of the fan's own cells, against the mean of the neighbours under the Rayleigh law of a lake. Both find
// the poles in nearly every scan. ledger: S6-64
TEST(SeaNoise, MakesNoObstaclesWhereTheLawOfALakeMakesManyAtEqualDetection) {
  const TruthScore cells = judged_in_spiky_noise(DetectionMethod::kAutomatic);
  const TruthScore neighbours = judged_in_spiky_noise(DetectionMethod::kCellAveraging);
  ASSERT_EQ(cells.bodies.size(), 2u);
  ASSERT_EQ(neighbours.bodies.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GE(cells.bodies[i].scans_found, cells.scans - 5) << cells.bodies[i].name;
    EXPECT_GE(cells.bodies[i].scans_found, neighbours.bodies[i].scans_found - 5) << cells.bodies[i].name;
  }
  EXPECT_LE(cells.false_alarms, 2);
  EXPECT_GT(neighbours.false_alarms, 20 * cells.scans);
}

/// Share of the decided bins of a run that hold an echo, from a scan on.
class EchoShare : public ResultSink {
 public:
  void on_ping(const PosedPing& posed) override {
    if (scans_ < from_) return;
    const EchoDecisions& d = posed.decisions;
    for (int b = 0; b < d.beams(); ++b) {
      for (int k = 0; k < d.bins(); ++k) {
        if (!d.usable(k)) continue;
        ++bins_;
        hits_ += d.hit(b, k) ? 1 : 0;
      }
    }
  }
  void on_scan(const ScanResult&) override { ++scans_; }
  /// Counts anew after this many further scans.
  void restart_after(int scans) {
    from_ = scans_ + scans;
    hits_ = bins_ = 0;
  }
  [[nodiscard]] double share() const { return hits_ / bins_; }

 private:
  int scans_ = 0, from_ = 0;
  double hits_ = 0, bins_ = 0;
};

/// A fan over water without a target, whose beams and bins are its resolution cells.
Scene open_water(const char* noise) {
  const std::string text = fmt::format(
      "[scene]\ntitle = \"Open water\"\n[vehicle]\nstart = [0, 0, 60]\nspeed = 0\n[[sonar]]\n"
      "preset = \"p450_horizontal\"\nspurious_share = 0\nbeams = 45\nbins = 200\nrange_m = 50\n{}",
      noise);
  return parse_scenario(text, "water.toml").scene;
}

// From the Gaussian noise of a lake into the K-distributed noise of the sea, which is louder: 50 scans later as many
// cells in a thousand report an echo as are asked for. ledger: S6-70 S6-64
TEST(SeaNoise, KeepsTheFalseAlarmRateFromLakeToSea) {
  constexpr double kRate = 1e-3;
  OnboardConfiguration configuration;
  configuration.echoes.fan.false_alarm = kRate;
  EchoShare echoes;
  Pipeline pipeline(configuration, echoes);
  const auto sail = [&](const char* noise, double from_s, double duration_s) {
    SimulatedSource source(open_water(noise), {.duration_s = duration_s}, 1);
    while (auto event = source.next()) {
      std::visit([&](auto& e) { e.time += seconds(from_s); }, *event);
      pipeline.on_event(std::move(*event));
    }
  };
  sail("noise = \"gaussian\"\n", 0, 25);
  EXPECT_NEAR(echoes.share(), kRate, 0.2 * kRate) << "lake";
  echoes.restart_after(50);
  sail("noise = \"k\"\nnoise_level = 30\nnoise_shape = 1.5\n", 25, 50);
  EXPECT_NEAR(echoes.share(), kRate, 0.2 * kRate) << "sea";
}

}  // namespace
}  // namespace isobath
