// The table of faults in a closed loop: each scenario in scenarios/faults breaks something, and the vehicle with its
// Safety Officer notices it by its deadline, does what the table says, and touches nothing.
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/evaluation/evaluation_suite.hpp>
#include <isobath/evaluation/fault_injection_check.hpp>
#include <tests/support/mission_runs.hpp>

namespace isobath {
namespace {

using testing::HasSubstr;

std::string file_of(const FaultRow& row) { return "faults/" + file_name_of(row); }

class FaultsInTheLoop : public testing::TestWithParam<std::size_t> {};

// ledger: S6-39 S2-27 S2-28 S1-43 S1-44
TEST_P(FaultsInTheLoop, AreNoticedAndActedOnByTheirDeadline) {
  const FaultRow& row = fault_table()[GetParam()];
  const Scenario scenario = test::scenario_of(file_of(row));
  LoopRequest request;
  request.configuration = proving(row, request.configuration);
  const test::Sailed sailed = test::sail(scenario, request);
  EXPECT_EQ(prove(row, scenario, request.configuration.safety, sailed.result).failure, "") << sailed.all();
}

INSTANTIATE_TEST_SUITE_P(EveryRow, FaultsInTheLoop, testing::Range<std::size_t>(0, kFaults),
                         [](const auto& one) { return file_name_of(fault_table()[one.param]); });

// What a scenario injects is what the table says that it injects.
TEST(FaultScenarios, InjectWhatTheTableSays) {
  for (const FaultRow& row : fault_table()) {
    const std::string injected = row.injected;
    const auto colon = injected.find(": ");
    const Scenario scenario = test::scenario_of(file_of(row));
    ASSERT_EQ(scenario.scene.faults.size(), colon == std::string::npos ? 0u : 1u) << row.name;
    if (colon == std::string::npos) continue;
    EXPECT_EQ(scenario.scene.faults[0].source, injected.substr(0, colon)) << row.name;
    EXPECT_STREQ(to_text(scenario.scene.faults[0].kind), injected.substr(colon + 2).c_str()) << row.name;
  }
}

// What a proof asks for ----------------------------------------------------------------------------------------------

class FaultInjectionChecks : public testing::Test {
 protected:
  FaultInjectionChecks() {
    scenario.scene.faults.resize(1);
    scenario.scene.faults[0].at_s = 20;
    scenario.mission.fence = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
    scenario.mission.limits.max_duration_s = 30;
    result.duration_s = 60;
    result.report.phase = MissionPhase::kUnderWay;
    say(10, "captain", "start", "the operator asks for it");
  }
  void say(double at_s, const std::string& agent, const std::string& what, const std::string& reason) {
    Decision& d = result.decisions.emplace_back();
    d.time = Time(seconds(at_s));
    d.agent = agent;
    d.what = what;
    d.reason = reason;
  }
  void officer(double at_s, const std::string& what, Fault fault) {
    say(at_s, "safety officer", what, std::string(to_text(fault)) + ": as it is");
    if (gate_obeys) say(at_s, "helm gate", what == "abort" ? "surface" : what, "as it is");
  }
  void be_at(double at_s, double north, double east) {
    TrueMotion& motion = result.track.emplace_back();
    motion.time = Time(seconds(at_s));
    motion.state.X_WB.translation = {north, east, 2};
  }
  [[nodiscard]] std::string failure(Fault fault) const {
    return prove(row_of(fault), scenario, config, result).failure;
  }

  Scenario scenario;
  SafetyConfig config;
  LoopResult result;
  bool gate_obeys = true;
};

TEST_F(FaultInjectionChecks, ARowMustBeRaisedByItsOwnName) {
  officer(20.2, "report", Fault::kLinkLost);
  say(20.2, "navigator", "report", "disk full: as it is");
  EXPECT_EQ(failure(Fault::kDiskFull), "not raised");
  officer(20.2, "report", Fault::kDiskFull);
  EXPECT_EQ(failure(Fault::kDiskFull), "");
  EXPECT_NEAR(prove(row_of(Fault::kDiskFull), scenario, config, result).after_s, 0.2, 1e-9);
}

TEST_F(FaultInjectionChecks, NeitherLateNorBeforeItsCause) {
  const double deadline = row_of(Fault::kDiskFull).deadline.value;
  for (const auto& [after_s, problem] :
       {std::pair{deadline - 0.01, ""}, {deadline + 0.01, "allowed"}, {-0.01, "before its cause"}}) {
    result.decisions.clear();
    officer(20 + after_s, "report", Fault::kDiskFull);
    EXPECT_THAT(failure(Fault::kDiskFull), HasSubstr(problem)) << after_s;
    EXPECT_EQ(failure(Fault::kDiskFull).empty(), *problem == 0) << after_s;
  }
}

// The executor makes up for some of the time that it lost: what the agents say then bears times between.
TEST_F(FaultInjectionChecks, AJumpOfTheClockIsDatedByThatClock) {
  scenario.scene.faults[0].kind = FaultKind::kClockJump;
  scenario.scene.faults[0].amount = 600;
  const double deadline_s = 620 + row_of(Fault::kClockJump).deadline.value;
  for (const auto& [at_s, right] : {std::pair{19.9, false}, {20.1, true}, {615.0, true}, {deadline_s + 0.1, false}}) {
    result.decisions.clear();
    officer(at_s, "slow", Fault::kClockJump);
    EXPECT_EQ(failure(Fault::kClockJump).empty(), right) << at_s;
  }
}

TEST_F(FaultInjectionChecks, OthersCountFromTheStartTheLongestTimeARefusalOrTheFence) {
  officer(40.2, "abort", Fault::kMissionTooLong);
  officer(30.2, "stop", Fault::kNoPath);
  officer(10.2, "stop", Fault::kInsideObstacle);
  officer(15, "abort", Fault::kFenceBreach);
  result.report.phase = MissionPhase::kAborted;
  EXPECT_EQ(failure(Fault::kMissionTooLong), "");
  EXPECT_EQ(failure(Fault::kInsideObstacle), "");
  EXPECT_THAT(failure(Fault::kNoPath), HasSubstr("did not occur")) << "nothing was refused";
  say(30, "navigator", "refuse", "there is no way");
  EXPECT_EQ(failure(Fault::kNoPath), "");
  EXPECT_THAT(failure(Fault::kFenceBreach), HasSubstr("did not occur")) << "the fence was not crossed";
  be_at(14, 5, 9);
  be_at(14.5, 5, 11);
  EXPECT_EQ(failure(Fault::kFenceBreach), "");
}

TEST_F(FaultInjectionChecks, AFenceAheadIsSeenBeforeItIsCrossed) {
  officer(15, "slow", Fault::kFenceAhead);
  EXPECT_EQ(failure(Fault::kFenceAhead), "") << "it need not be crossed";
  be_at(14.5, 5, 11);
  EXPECT_THAT(failure(Fault::kFenceAhead), HasSubstr("allowed"));
}

TEST_F(FaultInjectionChecks, TheActionIsThatOfTheRowOrWhatStandsForIt) {
  result.duration_s = 30;
  result.report.phase = MissionPhase::kAborted;
  for (const auto& [what, right] : {std::pair{"stop", true}, {"surface", true}, {"slow", false}, {"abort", false}}) {
    result.decisions.clear();
    officer(20.2, what, Fault::kNavigationJump);
    EXPECT_EQ(failure(Fault::kNavigationJump), right ? "" : std::string("wrong action: ") + what);
  }
}

TEST_F(FaultInjectionChecks, TheActionIsInForceAtTheHelmWithTheNextCycle) {
  result.duration_s = 30;
  gate_obeys = false;
  officer(20.2, "stop", Fault::kNavigationJump);
  EXPECT_EQ(failure(Fault::kNavigationJump), "not in force at the helm: stop");
  say(20.4, "helm gate", "slow", "something else");
  EXPECT_EQ(failure(Fault::kNavigationJump), "not in force at the helm: stop");
  say(20.4, "helm gate", "turn", "something worse");
  EXPECT_EQ(failure(Fault::kNavigationJump), "") << "the strongest holds";
  say(20.4, "helm gate", "follow orders", "nothing stands against the order");
  EXPECT_EQ(failure(Fault::kNavigationJump), "not in force at the helm: stop");
}

TEST_F(FaultInjectionChecks, TheMissionEndsWhereTheRowLastsUntilThatIsDue) {
  const double due_s = 20.2 + config.jump_abort_s;
  officer(20.2, "stop", Fault::kNavigationJump);
  EXPECT_EQ(failure(Fault::kNavigationJump), "mission end not requested");
  result.duration_s = due_s - 1;
  EXPECT_EQ(failure(Fault::kNavigationJump), "") << "the run was over before";
  result.duration_s = due_s + 20;
  officer(due_s, "abort", Fault::kNavigationJump);
  EXPECT_THAT(failure(Fault::kNavigationJump), HasSubstr("mission end requested, but"));
  result.report.phase = MissionPhase::kAborted;
  EXPECT_EQ(failure(Fault::kNavigationJump), "");
  result.decisions[result.decisions.size() - 2].time += seconds(5);
  EXPECT_THAT(failure(Fault::kNavigationJump), HasSubstr("5.00 s late"));
  result.decisions.resize(result.decisions.size() - 2);
  officer(30, "over", Fault::kNavigationJump);
  result.report.phase = MissionPhase::kUnderWay;
  EXPECT_EQ(failure(Fault::kNavigationJump), "") << "it was over before";
}

TEST_F(FaultInjectionChecks, NothingMayBeTouched) {
  officer(20.2, "report", Fault::kDiskFull);
  officer(20.2, "turn", Fault::kTooLow);
  result.min_altitude_m = 0.9;
  EXPECT_EQ(failure(Fault::kDiskFull), "");
  EXPECT_THAT(failure(Fault::kTooLow), HasSubstr("0.90 m away")) << "the bottom is what that row is about";
  result.min_clearance_m = 0.9;
  result.nearest_body = "quay";
  EXPECT_EQ(failure(Fault::kDiskFull), "came within 0.90 m of quay");
  result.contact_s = 31;
  result.contact_with = "quay";
  EXPECT_EQ(failure(Fault::kDiskFull), "touched quay at 31.0 s");
}

// The suite ----------------------------------------------------------------------------------------------------------

TEST(FaultSuite, SailsEveryRowInTurnUnderOtherConditions) {
  const Suite suite = load_suite(test::source_folder() / "suites/faults.toml");
  const std::vector<Scenario> scenes = load_scenes(suite);
  ASSERT_EQ(scenes.size(), kFaults);
  EXPECT_GE(suite.about.runs, 2 * static_cast<int>(kFaults));
  std::vector<int> sailed(kFaults);
  for (int k = 0; k < suite.about.runs; ++k) {
    const auto seed = static_cast<std::uint64_t>(suite.about.seed + k);
    const SuiteRun run = make_run(suite, scenes, seed);
    ASSERT_NE(run.row, nullptr);
    ++sailed[static_cast<std::size_t>(run.row->fault)];
    EXPECT_THAT(run.conditions, testing::StartsWith(run.row->name));
    const Scenario own = test::scenario_of(file_of(*run.row));
    EXPECT_EQ(run.scenario.scene.about.title, own.scene.about.title);
    EXPECT_EQ(run.scenario.scene.about.duration_s, own.scene.about.duration_s);
    EXPECT_NE(run.scenario.scene.vehicle.start, own.scene.vehicle.start);
    EXPECT_NE(run.scenario.scene.water.current, own.scene.water.current);
  }
  EXPECT_THAT(sailed, testing::Each(suite.about.runs / static_cast<int>(kFaults)));
}

TEST(FaultSuite, TheDrawnCurrentComesOnTopOfTheOneThatIsAtFault) {
  const Suite suite = load_suite(test::source_folder() / "suites/faults.toml");
  const auto row = static_cast<std::uint64_t>(Fault::kFenceBreach);
  const SuiteRun run = make_run(suite, load_scenes(suite), row);
  const std::vector<double> own = test::scenario_of(file_of(*run.row)).scene.water.current;
  const std::vector<double>& current = run.scenario.scene.water.current;
  ASSERT_EQ(current.size(), own.size());
  for (std::size_t i = 0; i < own.size(); i += 3) {
    EXPECT_EQ(current[i], own[i]);
    EXPECT_LE(std::hypot(current[i + 1] - own[i + 1], current[i + 2] - own[i + 2]), suite.vary.current);
  }
}

}  // namespace
}  // namespace isobath
