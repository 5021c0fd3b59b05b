// The demonstrations of Ganesan 2015, chapter 6, sailed from their scenario files by all agents: the story of each,
// told from its decisions and the truth.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/geometry/polygon.hpp>
#include <limits>
#include <tests/support/mission_runs.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using test::find_decision;
using test::Sailed;

constexpr const char* kNavigator = "navigator";

double distance_to(const Polygon& outline, const Vector2d& p) { return (nearest_point(outline, p) - p).norm(); }

/// Of the true way of the hull's middle from an outline.
double nearest_pass(const Sailed& sailed, const Polygon& outline) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const TrueMotion& m : sailed.result.track) {
    nearest = std::min(nearest, distance_to(outline, m.state.X_WB.translation.head<2>()));
  }
  return nearest;
}

double nearest_pass(const Sailed& sailed, const Vector2d& place) { return nearest_pass(sailed, Polygon{place}); }

/// When a scan first showed, or last showed, something within `reach_m` of a place; -1: never.
struct SeenFor {
  double first_s = -1, last_s = -1;
};
SeenFor seen_at(const Sailed& sailed, const Vector2d& place, double reach_m) {
  SeenFor seen;
  for (const auto& [time, obstacles] : sailed.scans) {
    const bool here = std::any_of(obstacles.begin(), obstacles.end(),
                                  [&](const SeenObstacle& o) { return distance_to(o.outline, place) <= reach_m; });
    if (!here) continue;
    if (seen.first_s < 0) seen.first_s = to_seconds(time);
    seen.last_s = to_seconds(time);
  }
  return seen;
}

/// The first way that goes round something within `reach_m` of a place.
std::size_t way_round(const std::vector<Decision>& decisions, const Vector2d& place, double reach_m) {
  std::size_t i = 0;
  while (i < decisions.size() && !(decisions[i].agent == kNavigator && decisions[i].way.size() > 1 &&
                                   decisions[i].obstacle && (*decisions[i].obstacle - place).norm() <= reach_m)) {
    ++i;
  }
  return i;
}

void expect_all_is_well(const Sailed& sailed, std::size_t reached, std::size_t dropped) {
  EXPECT_EQ(sailed.result.report.phase, MissionPhase::kFinished) << sailed.all();
  EXPECT_EQ(sailed.result.report.reached, reached) << sailed.all();
  EXPECT_EQ(sailed.result.report.dropped, dropped) << sailed.all();
  EXPECT_EQ(sailed.result.contact_s, -1) << "contact with " << sailed.result.contact_with;
}

// ledger: S6-58 S6-D05
TEST(Missions, Simulated1TheInjectedMapIsForeseenAndPassed) {
  const Scenario scenario = test::scenario_of("simulated_mission_1");
  const Sailed sailed = test::sail(scenario);
  expect_all_is_well(sailed, 3, 0);
  const std::vector<Decision>& decisions = sailed.result.decisions;
  const std::size_t replan = find_decision(decisions, kNavigator, "replan");
  ASSERT_LT(replan, decisions.size()) << sailed.all();
  const Decision& d = decisions[replan];
  const std::size_t start = find_decision(decisions, "captain", "start");
  ASSERT_LT(start, decisions.size());
  EXPECT_NEAR(to_seconds(d.time - decisions[start].time), 10, 0.15) << "at once when the map is there";
  EXPECT_LT(d.margin_m.value_or(1), 0) << "the old way led through it";
  EXPECT_EQ(d.leg.value_or(0), 1);
  EXPECT_GT(d.way.size(), 1u);
  EXPECT_NE(d.reason.find("injected"), std::string::npos) << d.reason;
  const Polygon& outline = scenario.mission.injected[0].outlines[0];
  EXPECT_GT(nearest_pass(sailed, outline), 2.5) << "half a cell of the paper's coarse map";
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(nearest_pass(sailed, scenario.mission.points[i].north_east), 6.0);
}

// ledger: S6-51 S6-56 S6-58 S6-D06
TEST(Missions, Simulated2ThePointUnderTheObstacleIsDroppedAndTheNextOnePlanned) {
  const Scenario scenario = test::scenario_of("simulated_mission_2");
  const Sailed sailed = test::sail(scenario);
  expect_all_is_well(sailed, 2, 1);
  const std::vector<Decision>& decisions = sailed.result.decisions;
  const std::size_t drop = find_decision(decisions, "executive officer", "drop point");
  ASSERT_LT(drop, decisions.size()) << sailed.all();
  EXPECT_NE(decisions[drop].reason.find("B"), std::string::npos) << decisions[drop].reason;
  const std::size_t next = find_decision(decisions, kNavigator, "plan", drop);
  ASSERT_LT(next, decisions.size()) << sailed.all();
  EXPECT_LT(to_seconds(decisions[next].time - decisions[drop].time), 3.0) << "the next one is planned";
  EXPECT_NEAR((decisions[next].way.back() - scenario.mission.points[2].north_east).norm(), 0, 1e-9);
  EXPECT_GT(nearest_pass(sailed, scenario.mission.injected[0].outlines[0]), 2.5);
  EXPECT_LT(nearest_pass(sailed, scenario.mission.points[2].north_east), 6.0);
}

// ledger: S6-54 S6-D07
TEST(Missions, Field1TheBuoyIsSeenEarlyWithoutConflictThenPassed) {
  const Sailed sailed = test::sail(test::scenario_of("field_mission_1"));
  expect_all_is_well(sailed, 3, 0);
  const Vector2d buoy(72, 1);
  const SeenFor seen = seen_at(sailed, buoy, 4);
  ASSERT_GT(seen.first_s, 0) << "the buoy was never seen";
  const std::vector<Decision>& decisions = sailed.result.decisions;
  const std::size_t round = way_round(decisions, buoy, 5);
  ASSERT_LT(round, decisions.size()) << sailed.all();
  const double decided_s = to_seconds(decisions[round].time);
  int scans = 0;
  for (const auto& [time, obstacles] : sailed.scans) {
    const double t = to_seconds(time);
    scans += t >= seen.first_s && t < decided_s ? 1 : 0;
  }
  EXPECT_GE(scans, 2) << "seen at " << seen.first_s << " s, gone round at " << decided_s << " s";
  EXPECT_EQ(sailed.result.nearest_body, "buoy");
  EXPECT_GT(sailed.result.min_clearance_m, 1);
}

// ledger: S6-55 S6-D08
TEST(Missions, Field2ReplansAsSoonAsTheBuoyIsDetected) {
  const Scenario scenario = test::scenario_of("field_mission_2");
  const Sailed sailed = test::sail(scenario);
  expect_all_is_well(sailed, 3, 0);
  const Vector2d buoy(60, 1);
  const SeenFor seen = seen_at(sailed, buoy, 4);
  ASSERT_GT(seen.first_s, 0);
  const std::vector<Decision>& decisions = sailed.result.decisions;
  const std::size_t round = way_round(decisions, buoy, 5);
  ASSERT_LT(round, decisions.size()) << sailed.all();
  EXPECT_LT(to_seconds(decisions[round].time) - seen.first_s, 12.5) << "when the fourth scan confirms it";
  EXPECT_EQ(decisions[round].what, "replan");
  EXPECT_GT(sailed.result.min_clearance_m, 1);
}

// What the vehicle believes of its place says nothing of where it is: the buoy is passed all the same.
// ledger: S6-53
TEST(Missions, ABiasOfPositionChangesNoPassing) {
  Scenario scenario = test::scenario_of("field_mission_2");
  const Sailed straight = test::sail(scenario);
  for (const double bias : {-3.0, 3.0}) {
    FaultConfig jump;
    jump.source = "navigation";
    jump.kind = FaultKind::kJump;
    jump.amount = bias;
    scenario.scene.faults = {jump};
    const Sailed biased = test::sail(scenario);
    EXPECT_EQ(biased.result.contact_s, -1);
    EXPECT_GT(biased.result.min_clearance_m, 1) << "bias " << bias;
  }
}

}  // namespace
}  // namespace isobath
