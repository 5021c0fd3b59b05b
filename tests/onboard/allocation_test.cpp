// Real time is proved here: what the pipeline does to every ping allocates nothing once it has warmed up.
#include <gtest/gtest.h>
#include <isobath/perception/grid_mapper.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <isobath/sonar/sweep.hpp>
#include <tests/support/count_allocations.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

constexpr int kBeams = 128, kBins = 300, kWarmUp = 60, kSteady = 120;

/// A multibeam sonar that looks at a wall 9 m ahead over a noisy ground.
std::vector<Ping> wall_ahead(int count) {
  const auto fan = test::fan_of(kBeams, Angle::degrees(-60), Angle::degrees(120.0 / (kBeams - 1)));
  Random random(3);
  std::vector<Ping> pings;
  for (int i = 0; i < count; ++i) {
    pings.push_back(test::ping_of<std::uint8_t>(fan, {0.1, 0.05, kBins}, [&](int beam, int bin) {
      const double forward = (0.1 + (bin + 0.5) * 0.05) * cos(fan->azimuth[beam]);
      return 15 + 8 * std::abs(random.normal()) + (std::abs(forward - 9) < 0.1 ? 150 : 0);
    }));
  }
  return pings;
}

/// Ahead at 1 m/s, weaving and rolling: the grid scrolls, turns and diffuses.
Pose weaving(double t) {
  return {Rotation::from_heading_pitch_roll(Angle::radians(0.3 * std::sin(t)), Angle::degrees(2 * std::sin(3 * t)),
                                            Angle::degrees(5 * std::cos(2 * t))),
          {t, 0.3 * std::sin(t), 2}};
}

// ledger: S6-15 S6-20 S6-25 S6-69
TEST(SteadyState, DetectingAndMappingAllocateNothing) {
  EchoDetectorConfig echoes;
  echoes.noise.memory_profiles = 300;
  EchoDetector detector(echoes);
  EchoDecisions decisions;
  SweepSegmenter sweeps;
  GridMapper mapper({.cell_m = 0.2, .cells_x = 161, .cells_y = 161}, {});
  std::vector<Ping> pings = wall_ahead(8);
  std::uint64_t before = 0;
  for (int i = 0; i < kWarmUp + kSteady; ++i) {
    Ping& ping = pings[i % pings.size()];
    ping.time = Time(seconds(0.1 * i));
    if (i == kWarmUp) before = test::allocations();
    detector.detect(ping, decisions, {weaving(0.1 * i).rotation, 4, 2});
    mapper.update(ping, decisions, weaving(0.1 * i), {.position_fix = true});
    sweeps.add(ping);
  }
  EXPECT_EQ(test::allocations() - before, 0u) << "in " << kSteady << " pings";
  EXPECT_EQ(detector.state(), DetectorState::kReady);
  double most = 0;
  for (const double l : mapper.grid().log_odds()) most = std::max(most, probability_of(l));
  EXPECT_GT(most, 0.9) << "the wall was mapped meanwhile";
}

}  // namespace
}  // namespace isobath
