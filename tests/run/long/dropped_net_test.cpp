// A net that is dropped before the vehicle: reflex, emergency plan, passage, and the mission as ordered.
#include <gtest/gtest.h>
#include <isobath/run/run.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

/// When an agent first decides this, s; -1: never.
double decided_s(const MissionOutcome& mission, const char* agent, const char* what) {
  for (const Decision& d : mission.decisions) {
    if (d.agent == agent && d.what == what) return to_seconds(d.time.time_since_epoch());
  }
  return -1;
}

// The foot of the net passes the vehicle's depth at 39.6 s. ledger: S2-28 S2-29 S2-31 S2-D05
TEST(DroppedNet, IsStoppedForWithinACycleAndPassedByAnEmergencyPlan) {
  RunRequest request;
  request.input = test::source_folder() / "scenarios" / "dropped_net.toml";
  request.out = test::scratch_folder() / "out";
  const RunOutcome outcome = run(request);
  ASSERT_TRUE(outcome.mission && outcome.mission->truth);
  const MissionOutcome& mission = *outcome.mission;
  EXPECT_EQ(mission.failure(), "");
  EXPECT_GT(mission.truth->min_clearance_m, 0.3);
  const double reflex_s = decided_s(mission, "safety officer", "stop");
  EXPECT_GT(reflex_s, 39.6);
  EXPECT_LE(reflex_s, 39.6 + 0.6);
  const double emergency_s = decided_s(mission, "navigator", "emergency");
  EXPECT_GE(emergency_s, reflex_s);
  EXPECT_LE(emergency_s, reflex_s + 0.6) << "at the next cycle of the planner";
  EXPECT_GT(decided_s(mission, "navigator", "replan"), emergency_s);
  EXPECT_GT(decided_s(mission, "navigator", "normal"), decided_s(mission, "navigator", "replan"));
}

}  // namespace
}  // namespace isobath
