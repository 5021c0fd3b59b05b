// A mission that a page watches: its speed changes nothing, and what an operator enters is avoided.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/report/mission_outcome.hpp>
#include <isobath/run/run.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

/// The outcome of a mission as text; of one that a page watches at a speed, a multiple of real time.
std::string mission_at(const std::optional<double>& speed, std::vector<Decision>& decisions) {
  DisplayState items;
  RunRequest request;
  request.input = test::source_folder() / "scenarios" / "obstacle_by_hand.toml";
  request.out = test::scratch_folder() / "out";
  request.configuration.simulation.duration_s = 20;
  if (speed) request.watch.emplace(RunWatch{&items, *speed, {}, {}});
  const RunOutcome outcome = run(request);
  EXPECT_TRUE(outcome.mission);
  if (outcome.mission) decisions = outcome.mission->decisions;
  return outcome.mission ? mission_text(*outcome.mission) : "";
}

// ledger: S2-43
TEST(Pace, OfARunChangesNothingThatItDoes) {
  std::vector<Decision> decisions, others;
  const std::string alone = mission_at({}, decisions);
  for (const double speed : {100.0, 1000.0}) {
    EXPECT_EQ(mission_at(speed, others), alone);
    ASSERT_EQ(others.size(), decisions.size());
    for (std::size_t i = 0; i < others.size(); ++i) EXPECT_EQ(to_text(others[i]), to_text(decisions[i]));
  }
}

// What an operator enters at 10 s is avoided by the next plan. ledger: S2-49 S2-D01
TEST(ObstacleByHand, IsAvoidedByTheNextPlan) {
  std::vector<Decision> decisions;
  mission_at({}, decisions);
  const auto replan = std::ranges::find(decisions, "replan", &Decision::what);
  ASSERT_NE(replan, decisions.end());
  EXPECT_NE(replan->reason.find("an injected obstacle"), std::string::npos);
  EXPECT_NEAR(to_seconds(replan->time.time_since_epoch()), 11.1, 0.7);
}

}  // namespace
}  // namespace isobath
