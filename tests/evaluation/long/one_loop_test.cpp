// One loop: what is run, served, evaluated and replayed decides the same.
#include <gtest/gtest.h>
#include <isobath/display/decision_json.hpp>
#include <isobath/display/display_state.hpp>
#include <isobath/evaluation/evaluation.hpp>
#include <isobath/run/run.hpp>
#include <tests/support/mission_runs.hpp>

namespace isobath {
namespace {

/// Decisions of `isobath run` (or `serve`, where there are items to be shown) of an input.
std::string decided_by_run(RunRequest request, const std::filesystem::path& out, DisplayState* shown = nullptr) {
  request.out = out;
  if (shown) request.watch.emplace().display = shown;
  const RunOutcome outcome = run(request);
  EXPECT_TRUE(outcome.mission.has_value());
  return outcome.mission ? decisions_text(outcome.mission->decisions) : "";
}

std::string decided_by_evaluation(const Scenario& scenario, const Configuration& configuration) {
  Suite suite;
  const auto methods = methods_of(suite, configuration);
  SuiteRun of_suite;
  of_suite.scenario = scenario;
  of_suite.seed = static_cast<std::uint64_t>(configuration.simulation.seed);
  const VehicleParameters vehicle = setup_of(scenario).vehicle;
  return decisions_text(run_method(methods.front(), of_suite, vehicle).decisions);
}

class OneLoop : public testing::TestWithParam<const char*> {};

// A mission with an altimeter and a charted shoal, so that depth map and chart have a say; one with a vertical fan, so
// that the voxels have. ledger: S6-57 S6-D09
TEST_P(OneLoop, DecidesTheSameHoweverItIsRun) {
  RunRequest request;
  request.input = test::source_folder() / "scenarios" / (std::string(GetParam()) + ".toml");
  Scenario scenario = test::scenario_of(GetParam());
  scenario.scene.about.duration_s = 15;
  request.configuration.simulation.duration_s = 15;
  request.configuration.simulation.seed = 5;
  const auto folder = test::scratch_folder();
  request.record = folder / "run.mcap";
  const std::string run = decided_by_run(request, folder / "run");
  ASSERT_GT(run.size(), 200u);
  EXPECT_EQ(decided_by_evaluation(scenario, request.configuration), run);
  request.record.clear();
  DisplayState items;
  EXPECT_EQ(decided_by_run(request, folder / "served", &items), run);
  RunRequest replay;
  replay.input = folder / "run.mcap";
  replay.mission = request.input;
  replay.configuration = request.configuration;
  EXPECT_EQ(decided_by_run(replay, folder / "replayed"), run);
}

INSTANTIATE_TEST_SUITE_P(Scenarios, OneLoop, testing::Values("charted_shoals", "bridge"),
                         [](const auto& scenario) { return std::string(scenario.param); });

}  // namespace
}  // namespace isobath
