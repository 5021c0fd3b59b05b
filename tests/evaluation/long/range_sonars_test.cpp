// A vehicle that has six range sonars and no other eyes crosses seeded clutter on the depth map that it makes.
#include <gtest/gtest.h>
#include <isobath/evaluation/evaluation.hpp>
#include <isobath/run/closed_loop.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

bool arrived_at_goal(const LoopResult& result) {
  return result.report.phase == MissionPhase::kFinished && result.report.reached == 1 && result.report.dropped == 0;
}

// The map that it makes is the map that it asks: without it, no run arrives. ledger: S1-03 S1-41 S1-56 S6-67
TEST(RangeSonars, CrossClutterOnTheDepthMapThatTheyMakeAndOnlyOnIt) {
  const Suite suite = load_suite(test::source_folder() / "suites" / "ranges-low.toml");
  const std::vector<Scenario> scenes = load_scenes(suite);
  int arrived = 0, arrived_blind = 0;
  for (std::uint64_t seed = 70001; seed < 70005; ++seed) {
    const SuiteRun run = make_run(suite, scenes, seed);
    LoopRequest request;
    request.stop_at_contact = true;
    const LoopResult seen = run_closed_loop(run.scenario, request);
    EXPECT_EQ(seen.contact_s, -1) << "seed " << seed;
    arrived += arrived_at_goal(seen);
    request.configuration.mission.chart_room.live_s = 0;
    arrived_blind += arrived_at_goal(run_closed_loop(run.scenario, request));
  }
  EXPECT_EQ(arrived, 4);
  EXPECT_EQ(arrived_blind, 0);
}

}  // namespace
}  // namespace isobath
