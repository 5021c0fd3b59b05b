// A run in the noise of the sea: which obstacles it makes of the spikes.
#include <gtest/gtest.h>
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

}  // namespace
}  // namespace isobath
