#include <gmock/gmock.h>
#include <isobath/sonar/echo_detector.hpp>
#include <isobath/sonar/sweep.hpp>
#include <tests/support/count_allocations.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

class SteadyState : public testing::TestWithParam<DetectionMethod> {};

TEST_P(SteadyState, AllocatesNothing) {
  EchoDetectorConfig config;
  config.method = GetParam();
  config.noise.memory_profiles = 300;
  EchoDetector detector(config);
  EchoDecisions out;
  SweepSegmenter sweeps;
  Random random(1);
  std::vector<Ping> pings;
  for (int i = 0; i < 5; ++i) {
    pings.push_back(test::ping_of<std::uint8_t>(test::fan_of(32), {0, 0.02, 300},
                                                [&](int, int) { return random.uniform() * 100; }));
  }
  for (int i = 0; i < 100; ++i) detector.detect(pings[i % 5], out);
  const std::uint64_t before = test::allocations();
  for (int i = 0; i < 100; ++i) {
    detector.detect(pings[i % 5], out);
    sweeps.add(pings[i % 5]);
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_EQ(detector.state(), DetectorState::kReady);
}

INSTANTIATE_TEST_SUITE_P(OfEachMethod, SteadyState,
                         testing::Values(DetectionMethod::kAutomatic, DetectionMethod::kGlobal,
                                         DetectionMethod::kCellAveraging, DetectionMethod::kOrderedStatistic));

}  // namespace
}  // namespace isobath
