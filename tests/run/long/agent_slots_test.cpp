// Slots that a configuration or a scenario fills: chart room, back-seat drivers, Signaling Officer, agents of
// libraries; each in the closed loop, doing what it is there for.
#include <algorithm>
#include <gmock/gmock.h>
#include <isobath/display/decision_json.hpp>
#include <isobath/mission/agents/shoal_outlines.hpp>
#include <isobath/onboard/onboard.hpp>
#include <isobath/scenario/mission_chart.hpp>
#include <limits>
#include <tests/support/mission_runs.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using test::find_decision;
using testing::HasSubstr;

/// A chart of the scenario's place alone is read sooner.
Configuration small_chart() {
  Configuration configuration;
  configuration.depth_map.area_m = 512;
  return configuration;
}

test::Sailed sail(const Scenario& scenario) {
  LoopRequest request;
  request.configuration = small_chart();
  return test::sail(scenario, request);
}

double min_distance(const test::Sailed& sailed, const Vector2d& place) {
  double least = std::numeric_limits<double>::infinity();
  for (const TrueMotion& m : sailed.result.track) {
    least = std::min(least, (m.state.X_WB.translation.head<2>() - place).norm());
  }
  return least;
}

/// Outlines of the water of the scenario's chart that is shallower than this.
std::vector<Polygon> shoals(const Scenario& scenario, double depth_m) {
  const WorldSnapshot chart = chart_of(scenario, small_chart());
  const PixelGrid grid = chart.depths->grid();
  const Pixel first = grid.at({200, -80});
  const Pixel last = grid.at({-60, 80});
  return shoal_outlines(*chart.depths,
                        {first.column, first.row, last.column - first.column + 1, last.row - first.row + 1},
                        {depth_m, false, 1, 1000})
      .charted;
}

/// Of the truth.
double nearest_pass(const test::Sailed& sailed, const std::vector<Polygon>& outlines) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const TrueMotion& m : sailed.result.track) {
    for (const Polygon& outline : outlines) {
      nearest = std::min(nearest, signed_distance(outline, m.state.X_WB.translation.head<2>()));
    }
  }
  return nearest;
}

// ledger: S6-32 S6-36 S1-41
TEST(Slots, TheChartRoomLeadsTheVehicleRoundShoalsThatItHasNotYetSeen) {
  const Scenario scenario = test::scenario_of("charted_shoals");
  const test::Sailed sailed = sail(scenario);
  EXPECT_EQ(sailed.result.report.phase, MissionPhase::kFinished) << sailed.all();
  EXPECT_LT(sailed.result.contact_s, 0) << sailed.result.contact_with;
  const std::vector<Decision>& decisions = sailed.result.decisions;

  const std::size_t shallow = find_decision(decisions, "chart room", "leg too shallow");
  ASSERT_LT(shallow, decisions.size()) << sailed.all();
  EXPECT_EQ(decisions[shallow].leg.value_or(0), 1);

  const std::size_t plan = find_decision(decisions, "navigator", "plan");
  ASSERT_LT(plan, decisions.size()) << sailed.all();
  ASSERT_GT(decisions[plan].way.size(), 1u) << sailed.all();
  EXPECT_THAT(decisions[plan].reason, HasSubstr("charted")) << sailed.all();
  const std::vector<Polygon> all = shoals(scenario, 3);  // at the depth of the mission
  ASSERT_FALSE(all.empty());
  for (const auto& [time, obstacles] : sailed.scans) {
    if (time > decisions[plan].time) break;
    for (const SeenObstacle& o : obstacles) {
      for (const Vector2d& p : o.outline) {
        for (const Polygon& shoal : all) EXPECT_GT(signed_distance(shoal, p), 5) << "already seen at " << p.transpose();
      }
    }
  }
  EXPECT_GT(nearest_pass(sailed, all), scenario.mission.limits.min_altitude_m);
}

// Without the chart the same vehicle knows nothing of them when it sets out.
// ledger: S6-32
TEST(Slots, WithoutAChartTheFirstWayIsStraight) {
  Scenario scenario = test::scenario_of("charted_shoals");
  scenario.prior = {};
  const test::Sailed sailed = sail(scenario);
  const std::vector<Decision>& decisions = sailed.result.decisions;
  const std::size_t plan = find_decision(decisions, "navigator", "plan");
  ASSERT_LT(plan, decisions.size()) << sailed.all();
  EXPECT_EQ(decisions[plan].way.size(), 1u) << sailed.all();
}

// ledger: S6-41
TEST(Slots, ABackSeatDriverSurveysWhereTheMissionAsksForIt) {
  const test::Sailed sailed = sail(test::scenario_of("charted_shoals"));
  const std::vector<Decision>& decisions = sailed.result.decisions;
  const std::size_t award = find_decision(decisions, "captain", "award task");
  ASSERT_LT(award, decisions.size()) << sailed.all();
  EXPECT_THAT(decisions[award].reason, HasSubstr("survey does survey"));
  ASSERT_LT(find_decision(decisions, "executive officer", "task", award), decisions.size()) << sailed.all();
  // Three lanes 10 m apart, 40 m long, about B: their ends are visited.
  for (const double east : {35.0, 45.0, 55.0}) {
    for (const double north : {130.0, 170.0}) {
      EXPECT_LT(min_distance(sailed, {north, east}), PilotConfig{}.point_radius + 2) << north << " " << east;
    }
  }
}

/// Range of the wreck of closer_look.toml from the vehicle, and the angle of its nearest point off the bow.
std::pair<double, double> view_of_wreck(const TrueMotion& m) {
  const Polygon wreck{{52.5, 1}, {57.5, 1}, {57.5, 15}, {52.5, 15}};
  const Vector2d p = m.state.X_WB.translation.head<2>(), to = nearest_point(wreck, p) - p;
  const Angle bearing = Angle::radians(std::atan2(to.y(), to.x()));
  return {to.norm(), std::abs((bearing - m.state.X_WB.rotation.heading()).wrapped().degrees())};
}

// On seeds: at the end of the task the true vehicle stands within the camera's range, its bow to the wreck, and has
// come no nearer than its clearance allows. ledger: S4-53 S6-41
TEST(Slots, ACloserLookAtAWreckIsTakenWithinRangeOfTheCamera) {
  Scenario scenario = test::scenario_of("closer_look");
  for (int seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    scenario.scene.about.seed = seed;
    LoopRequest request;
    request.configuration.simulation.seed = seed;
    const test::Sailed sailed = test::sail(scenario, request);
    const std::vector<Decision>& decisions = sailed.result.decisions;
    const std::size_t task = find_decision(decisions, "executive officer", "task");
    ASSERT_LT(task, decisions.size()) << sailed.all();
    EXPECT_EQ(sailed.result.report.phase, MissionPhase::kFinished) << sailed.all();
    EXPECT_LT(sailed.result.contact_s, 0) << sailed.result.contact_with;
    double nearest = std::numeric_limits<double>::infinity(), off_bow = 180;
    for (const TrueMotion& m : sailed.result.track) {
      if (m.time < decisions[task].time) continue;
      const auto [range, off] = view_of_wreck(m);
      nearest = std::min(nearest, range);
      if (range <= 8) off_bow = std::min(off_bow, off);
    }
    EXPECT_LT(nearest, 8);
    EXPECT_GT(nearest, RouteConfig{}.clearance_m);
    EXPECT_LT(off_bow, 20) << "degrees";
  }
}

/// When the first of these decisions was made; -1: never.
double time_of_decision(const test::Sailed& sailed, const std::string& agent, const std::string& what) {
  const std::vector<Decision>& all = sailed.result.decisions;
  const std::size_t i = find_decision(all, agent, what);
  return i < all.size() ? to_seconds(all[i].time) : -1;
}

// ledger: S6-40 S6-34
TEST(Slots, TheOperatorLeadsOverALinkThatLosesFrames) {
  const Scenario scenario = test::scenario_of("operator_on_the_link");
  const test::Sailed sailed = sail(scenario);
  EXPECT_EQ(sailed.result.report.phase, MissionPhase::kFinished) << sailed.all();
  const double start = time_of_decision(sailed, "captain", "start");
  const double hold = time_of_decision(sailed, "captain", "hold");
  const double resume = time_of_decision(sailed, "captain", "resume");
  EXPECT_GE(start, scenario.orders[0].at_s) << "it waits for him";
  EXPECT_GE(hold, scenario.orders[1].at_s);
  EXPECT_GE(resume, scenario.orders[2].at_s);
  EXPECT_LT(resume, scenario.orders[2].at_s + 20) << "sent again until it arrives";
  for (const TrueMotion& m : sailed.result.track) {
    if (to_seconds(m.time) < hold + 8 || to_seconds(m.time) > resume) continue;
    EXPECT_LT(m.state.v_B.norm(), 0.6) << "it holds at " << to_seconds(m.time);
  }
  // What he knows of it: each phase, in order, as status reports that came through.
  std::vector<MissionPhase> phases;
  for (const OperatorAnswer& answer : sailed.result.answers) {
    if (phases.empty() || phases.back() != answer.status.phase) phases.push_back(answer.status.phase);
  }
  using Phase = MissionPhase;
  EXPECT_THAT(phases, testing::ElementsAre(Phase::kUnderWay, Phase::kHolding, Phase::kUnderWay, Phase::kFinished));
}

// ledger: S6-40 S6-57
TEST(Slots, FramesOfTheOperatorAreReplayedFromTheEvents) {
  const Scenario scenario = test::scenario_of("operator_on_the_link");
  const test::Sailed sailed = sail(scenario);
  const auto helm = make_serial_helm(setup_of(scenario), small_chart());
  DepthModel depths(small_chart());
  Onboard onboard(small_chart(), depths, {.helm = helm.get(), .voxels = false});
  for (const Event& event : sailed.events) {
    onboard.on_event(event);
    (void)onboard.steer();
  }
  EXPECT_EQ(decisions_text(helm->decisions()), decisions_text(sailed.result.decisions));
}

// ledger: S6-40
TEST(Slots, WithoutTheOperatorsOrderNothingStarts) {
  Scenario scenario = test::scenario_of("operator_on_the_link");
  scenario.scene.about.duration_s = 40;
  scenario.scene.faults[0].kind = FaultKind::kOff;
  scenario.scene.faults[0].amount = 0;
  const test::Sailed sailed = sail(scenario);
  EXPECT_EQ(sailed.result.report.phase, MissionPhase::kWaiting) << sailed.all();
  EXPECT_TRUE(sailed.result.answers.empty());
}

// ledger: S6-33
TEST(Slots, AgentsOfLibrariesAreNamedByConfiguration) {
  Configuration configuration = small_chart();
  Schema all = schema(configuration);
  read_toml("[[agent]]\nname = \"lookout\"\nlibrary = \"" LOOKOUT_LIBRARY "\"\n", "isobath.toml", all);
  Configuration again;
  Schema read = schema(again);
  read_toml(to_toml(configuration, false), "again.toml", read);
  ASSERT_EQ(again.agents.size(), 1u) << "the configuration in force says who is aboard";
  EXPECT_EQ(again.agents[0].library, LOOKOUT_LIBRARY);

  const Scenario scenario = test::scenario_of("charted_shoals");
  const auto helm = make_serial_helm(setup_of(scenario), again);
  helm->on_event(Navigation{});
  EXPECT_TRUE(helm->executor().has("lookout"));
  EXPECT_FALSE(helm->executor().lost("lookout"));
  again.agents.push_back(again.agents[0]);
  EXPECT_THROW(make_serial_helm(setup_of(scenario), again), Error) << "two on one seat";
}

}  // namespace
}  // namespace isobath
