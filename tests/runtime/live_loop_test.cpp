// Mapping and agents in threads of their own: what must hold whoever is faster. Under the thread sanitizer these are
// the missions that show races; $ISOBATH_LIVE_SECONDS lengthens the voyage.
#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <isobath/runtime/live_loop.hpp>
#include <isobath/runtime/mission_run.hpp>
#include <tests/runtime/mission_runs.hpp>

namespace isobath {
namespace {

double voyage_s() {
  const char* wished = std::getenv("ISOBATH_LIVE_SECONDS");
  return wished ? std::atof(wished) : 60;
}

/// Lanes to and fro between poles, as long as is asked for.
Scenario lanes(double duration_s) {
  std::string text = fmt::format(R"(
[scene]
title = "lanes between poles"
duration_s = {}
[bottom]
kind = "flat"
depth = 12
[vehicle]
start = [0, 0, 4]
speed = 1.5
[mission]
title = "lanes"
speed = 1.5
[[sonar]]
preset = "micron"
[[cylinder]]
name = "pole"
centre = [40, 3, 6]
radius = 0.3
length = 12
)",
                                 duration_s);
  for (int i = 0; i < static_cast<int>(duration_s / 60) + 1; ++i) {
    for (const auto& [north, east] : {std::pair(80, 0), {80, 20}, {0, 20}, {0, 0}}) {
      text += fmt::format("[[mission_point]]\nname = \"{}-{}-{}\"\nnorth = {}\neast = {}\ndepth_m = 4\n", i, north,
                          east, north, east);
    }
  }
  return parse_scenario(text, "lanes");
}

// ledger: S2-12 S6-31 S6-42
TEST(LiveLoop, SailsItsLanesAndKeepsClearOfThePole) {
  const Scenario scenario = lanes(voyage_s());
  const MissionSetup setup = test::setup_of(scenario);
  const Configuration configuration;
  const LoopResult result = run_live_loop(scenario, whole_crew(setup, configuration), setup.vehicle, configuration);
  EXPECT_LT(result.contact_s, 0) << result.contact_with;
  EXPECT_EQ(result.report.phase, MissionPhase::kUnderWay) << result.report.why;
  EXPECT_GT(result.counts.pings, 8 * voyage_s());
  EXPECT_GT(result.length_m, 0.8 * 1.5 * (voyage_s() - 25));
  EXPECT_TRUE(std::none_of(result.decisions.begin(), result.decisions.end(), [](const Decision& d) {
    return d.what.find("lost") != std::string::npos;
  })) << "no agent is taken for hung that is merely slower";
}

// ledger: S6-33
TEST(LiveLoop, EndsWhileAllAreAtWork) {
  const Scenario scenario = lanes(10);
  const MissionSetup setup = test::setup_of(scenario);
  const Configuration configuration;
  SimulatedSource source(scenario.scene, {}, 1);
  LiveLoop loop(whole_crew(setup, configuration), setup.vehicle, std::make_shared<const MissionPlan>(scenario.mission),
                configuration);
  for (int i = 0; i < 200; ++i) {
    auto event = source.next();
    ASSERT_TRUE(event);
    loop.take(std::move(*event));
  }
}

}  // namespace
}  // namespace isobath
