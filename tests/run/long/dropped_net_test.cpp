// A net that is dropped before the vehicle: reflex, emergency plan, passage, and the mission as ordered.
#include <array>
#include <gtest/gtest.h>
#include <isobath/io/mcap/mcap_index.hpp>
#include <isobath/recording/run_recorder.hpp>
#include <isobath/run/run.hpp>
#include <limits>
#include <nlohmann/json.hpp>
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

/// How often an agent's messages of this type were sent from one time to the other, 1/s.
double rate_of(const std::filesystem::path& recording, const std::string& type, double from_s, double to_s) {
  McapIndex index(recording);
  const std::array<std::uint16_t, 1> channels = {index.channel_of(kMessagesTopic).value()};
  int count = 0;
  index.visit(channels, 0, std::numeric_limits<std::uint64_t>::max(), [&](const McapMessage& message) {
    const auto json = nlohmann::json::parse(message.data.begin(), message.data.end());
    const double at_s = 1e-9 * json["time_ns"].get<double>();
    count += json["type"] == type && at_s >= from_s && at_s < to_s;
    return true;
  });
  return count / (to_s - from_s);
}

// The foot of the net passes the vehicle's depth at 39.6 s. Sonar, maps and detection go on as before.
// ledger: S2-28 S2-29 S2-30 S2-31 S2-D05
TEST(DroppedNet, IsStoppedForWithinACycleAndPassedByAnEmergencyPlan) {
  RunRequest request;
  request.input = test::source_folder() / "scenarios" / "dropped_net.toml";
  request.out = test::scratch_folder() / "out";
  request.record = test::scratch_folder() / "run.mcap";
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
  const double normal_s = decided_s(mission, "navigator", "normal");
  EXPECT_GT(normal_s, decided_s(mission, "navigator", "replan"));
  for (const char* type : {"sweep", "obstacle scan", "world"}) {
    const double before = rate_of(request.record, type, 10, 35);
    const double during = rate_of(request.record, type, reflex_s, normal_s);
    EXPECT_NEAR(during, before, 0.1 * before + 1 / (normal_s - reflex_s)) << type;
  }
}

}  // namespace
}  // namespace isobath
