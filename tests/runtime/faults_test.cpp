// The table of faults in a closed loop: each scenario in scenarios/faults breaks something, and the vehicle with its
// whole crew notices it within the limit, does what the table says, and touches nothing.
#include <algorithm>
#include <gmock/gmock.h>
#include <isobath/mission/fault_table.hpp>
#include <tests/runtime/mission_runs.hpp>

namespace isobath {
namespace {

using testing::HasSubstr;

struct FaultCase {
  Fault fault;
  double at_s;         ///< from when on it can be noticed
  double within_s;     ///< and until when it must be
  const char* action;  ///< what is decided when it is raised
  bool ends = true;    ///< whether the mission is aborted: not where it was over, or the run is, before that is due
};

void PrintTo(const FaultCase& c, std::ostream* out) { *out << to_text(c.fault); }

std::string file_of(Fault fault) { return "faults/" + file_name_of(row_of(fault)); }

/// The map is blinded: what is to be seen is seen by the Safety Officer alone.
bool without_map(Fault fault) { return fault == Fault::kCollisionAhead || fault == Fault::kCollisionUnavoidable; }

class FaultsInTheLoop : public testing::TestWithParam<FaultCase> {};

TEST_P(FaultsInTheLoop, AreNoticedAndActedOnWithinTheirLimit) {
  const FaultCase& expected = GetParam();
  const FaultRow& row = row_of(expected.fault);
  const Scenario scenario = test::scenario_of(file_of(expected.fault));
  LoopRequest request;
  if (without_map(expected.fault)) request.configuration.grid.threshold = 9;
  const test::Sailed sailed = test::sail(scenario, request);
  const std::vector<Decision>& decisions = sailed.result.decisions;
  const auto found = std::find_if(decisions.begin(), decisions.end(), [&](const Decision& d) {
    return d.agent == "safety officer" && d.reason.starts_with(std::string(row.name) + ":");
  });
  ASSERT_NE(found, decisions.end()) << sailed.all();
  EXPECT_GE(to_seconds(found->time), expected.at_s) << sailed.all();
  EXPECT_LE(to_seconds(found->time), expected.at_s + expected.within_s) << sailed.all();
  EXPECT_EQ(found->what, expected.action) << found->reason;
  EXPECT_EQ(sailed.result.report.phase == MissionPhase::kAborted, expected.ends) << sailed.all();
  EXPECT_LT(sailed.result.contact_s, 0) << "touched " << sailed.result.nearest_body << "\n" << sailed.all();
}

constexpr double kCycle = 0.25;  // s: a cycle, and the way of a reading

// ledger: S6-39 S2-28 S1-43 S1-44
INSTANTIATE_TEST_SUITE_P(
    EveryRow, FaultsInTheLoop,
    testing::Values(
        FaultCase{Fault::kSonarSilent, 21, 1 + kCycle, "stop"},
        FaultCase{Fault::kSonarFrozen, 20, 0.5 + kCycle, "stop"},
        FaultCase{Fault::kSonarSaturated, 20, 0.5 + kCycle, "stop"}, FaultCase{Fault::kSonarDeaf, 25, kCycle, "stop"},
        FaultCase{Fault::kSonarBlindSide, 20, 6.2 + kCycle, "slow", false},
        FaultCase{Fault::kSonarGarbled, 20, 0.6 + kCycle, "stop"},
        FaultCase{Fault::kNavigationSilent, 21, kCycle, "stop"},
        FaultCase{Fault::kNavigationJump, 20, kCycle, "stop", false},
        FaultCase{Fault::kNavigationDrift, 20, 40, "abort"}, FaultCase{Fault::kDepthLost, 20, 1 + kCycle, "stop"},
        FaultCase{Fault::kAltitudeLost, 20, 2 + kCycle, "slow"}, FaultCase{Fault::kTooDeep, 20, 6.5, "surface"},
        FaultCase{Fault::kAgentDead, 20, 1, "surface"}, FaultCase{Fault::kLeak, 20, 1 + kCycle, "abort"},
        FaultCase{Fault::kBatteryLow, 20, 1 + kCycle, "abort"}, FaultCase{Fault::kThrusterLost, 20, kCycle, "slow"},
        FaultCase{Fault::kLinkLost, 49, 2, "report", false}, FaultCase{Fault::kClockJump, 614, 2, "slow", false},
        FaultCase{Fault::kDiskFull, 20, kCycle, "report", false}, FaultCase{Fault::kMissionTooLong, 42, 1, "abort"},
        FaultCase{Fault::kFenceBreach, 1, 30, "abort"}, FaultCase{Fault::kWayNotFollowed, 10, 50, "slow"},
        FaultCase{Fault::kNoPath, 1, 90, "stop", false}, FaultCase{Fault::kCollisionAhead, 20, 50, "stop", false},
        FaultCase{Fault::kCollisionUnavoidable, 20, 30, "turn", false}, FaultCase{Fault::kTooLow, 5, 75, "turn"}),
    [](const auto& one) { return file_name_of(row_of(one.param.fault)); });

// What a scenario injects is what the table says that it injects.
TEST(FaultScenarios, InjectWhatTheTableSays) {
  for (const FaultRow& row : fault_table()) {
    const std::string injected = row.injected;
    const auto colon = injected.find(": ");
    if (colon == std::string::npos) continue;
    const Scenario scenario = test::scenario_of(file_of(row.fault));
    ASSERT_EQ(scenario.scene.faults.size(), 1u) << row.name;
    EXPECT_EQ(scenario.scene.faults[0].source, injected.substr(0, colon)) << row.name;
    EXPECT_STREQ(to_text(scenario.scene.faults[0].kind), injected.substr(colon + 2).c_str()) << row.name;
  }
}

}  // namespace
}  // namespace isobath
