// The Executive Officer under a script: the order of its messages.
#include <gtest/gtest.h>
#include <isobath/mission/agents/executive_officer.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

using Reason = RouteRefused::Reason;

class ExecutiveOfficerTest : public testing::Test {
 protected:
  ExecutiveOfficerTest() {
    plan.title = "test";
    plan.points = {point(100, 0), point(100, 100), point(0, 100)};
  }
  std::vector<Message> start() {
    agent = std::make_unique<ExecutiveOfficer>(config);
    script = std::make_unique<Script>(*agent);
    script->hear(fix(0, 1, 2), 0);
    MissionOrder order;
    order.plan = std::make_shared<const MissionPlan>(plan);
    return script->hear(order, 0);
  }
  [[nodiscard]] RouteRequest asked() const { return only<RouteRequest>(script->said).back(); }
  [[nodiscard]] MissionReport report() const { return only<MissionReport>(script->said).back(); }
  std::vector<Message> planned(std::vector<Waypoint> waypoints = {{100, 0, 1, 1}}) {
    const bool avoiding = waypoints.size() > 1;
    return script->hear(RoutePlanned{asked().id, ++version, std::move(waypoints), avoiding, "because"}, now);
  }
  std::vector<Message> refused(Reason reason, std::optional<Eigen::Vector2d> safe = {}) {
    return script->hear(RouteRefused{reason, asked().id, asked().point, safe, "a rock on it"}, now);
  }
  std::vector<Message> passed(bool reached = true) {
    return script->hear(
        WaypointPassed{version, only<FollowOrder>(script->said).back().waypoints.size() - 1, reached, true}, now);
  }
  void wait(double s) {
    for (int i = 0; i < static_cast<int>(s * 10 + 0.5); ++i) script->tick(now += 0.1);
  }

  ExecutiveConfig config;
  MissionPlan plan;
  std::unique_ptr<ExecutiveOfficer> agent;
  std::unique_ptr<Script> script;
  std::uint32_t version = 0;
  double now = 0;
};

// ledger: S6-35 S2-06 S2-07
TEST_F(ExecutiveOfficerTest, AsksForEachPointHandsTheWayOnAndReportsItReached) {
  start();
  EXPECT_EQ(report().phase, MissionPhase::kUnderWay);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(asked().point, i);
    EXPECT_EQ(asked().target.north_east, plan.points[i].north_east);
    EXPECT_EQ(asked().last, i == 2);
    const auto follow = only<FollowOrder>(planned());
    ASSERT_EQ(follow.size(), 1u);
    EXPECT_EQ(follow[0].version, version);
    const auto said = passed();
    ASSERT_EQ(only<PointReport>(said).at(0).kind, PointReport::Kind::kReached);
    EXPECT_EQ(only<PointReport>(said).at(0).point, i);
    EXPECT_EQ(only<RouteRequest>(said).size(), i < 2 ? 1u : 0u) << "in the same turn";
  }
  EXPECT_EQ(report().phase, MissionPhase::kFinished);
  EXPECT_EQ(report().reached, 3u);
  EXPECT_TRUE(only<FollowOrder>(script->said).back().waypoints.empty()) << "it holds at the end";
}

// The route to a point names the next one, so that the corner between them can be taken in time; but not where the
// vehicle stops. ledger: S2-41 S2-46
TEST_F(ExecutiveOfficerTest, NamesThePointToWhichItGoesOnWithoutAStop) {
  plan.points[1].hold_s = 20;
  start();
  ASSERT_TRUE(asked().then_W);
  EXPECT_EQ(*asked().then_W, plan.points[1].north_east);
  const auto follow = only<FollowOrder>(
      script->hear(RoutePlanned{asked().id, ++version, {{100, 0, 1, 1}}, false, "", Eigen::Vector2d(100, 40)}, now));
  EXPECT_EQ(*follow.at(0).then_W, Eigen::Vector2d(100, 40)) << "the corner that the Navigator has found";
  passed();
  EXPECT_EQ(asked().point, 1u);
  EXPECT_FALSE(asked().then_W) << "it stays there";
}

// Derived anew each minute, the plan of an unchanged mission repeats and skips nothing. ledger: S2-24 S2-25
TEST_F(ExecutiveOfficerTest, PlansEachMinuteAndGoesOnAsBefore) {
  plan.points[0].hold_s = 90;
  start();
  planned();
  const std::size_t requests = only<RouteRequest>(script->said).size();
  wait(150);
  EXPECT_EQ(only<RouteRequest>(script->said).size(), requests);
  EXPECT_EQ(only<LevelPlan>(script->said).size(), 3u);
  passed();
  wait(89);
  EXPECT_EQ(asked().point, 0u) << "a new plan does not begin the stay anew";
  wait(2);
  EXPECT_EQ(asked().point, 1u);
  const auto plans = only<LevelPlan>(script->said);
  EXPECT_EQ(plans.back().level, CommandLevel::kVehicle);
  EXPECT_GT(plans.back().horizon_s, 0);
}

// ledger: S6-35 S6-56
TEST_F(ExecutiveOfficerTest, ReplacesTheRestOfTheWayByAChangedOneAndTellsTheCaptain) {
  start();
  planned();
  const std::vector<Waypoint> detour = {{40, 8, 1, 1}, {60, 8, 1, 1}, {100, 0, 1, 1}};
  const auto said = planned(detour);
  ASSERT_EQ(only<FollowOrder>(said).size(), 1u);
  EXPECT_EQ(only<FollowOrder>(said)[0].waypoints.size(), 3u);
  ASSERT_EQ(only<PointReport>(said).size(), 1u);
  EXPECT_EQ(only<PointReport>(said)[0].kind, PointReport::Kind::kAvoiding);
  EXPECT_EQ(only<PointReport>(said)[0].why, "because");
  EXPECT_TRUE(script->hear(WaypointPassed{version - 1, 0, true, true}, now).empty()) << "of the way that was replaced";
  EXPECT_TRUE(script->hear(RoutePlanned{asked().id + 7, 99, detour, true, ""}, now).empty()) << "nobody asked";
}

// ledger: S6-51 S6-56
TEST_F(ExecutiveOfficerTest, DropsPointsThatAreBlockedSeveralInARow) {
  start();
  auto said = refused(Reason::kGoalBlocked);
  EXPECT_EQ(only<PointReport>(said).at(0).kind, PointReport::Kind::kDropped);
  EXPECT_EQ(only<PointReport>(said).at(0).why, "a rock on it");
  EXPECT_EQ(asked().point, 1u);
  said = refused(Reason::kGoalBlocked);
  EXPECT_EQ(asked().point, 2u);
  planned();
  passed();
  EXPECT_EQ(report().phase, MissionPhase::kFinished);
  EXPECT_EQ(report().reached, 1u);
  EXPECT_EQ(report().dropped, 2u);
}

// ledger: S6-51 S6-E21
TEST_F(ExecutiveOfficerTest, EndsTheMissionInADefinedWayWhenTheLastPointIsDropped) {
  plan.points.resize(1);
  plan.at_end = MissionEnd::kReturn;
  start();
  refused(Reason::kGoalBlocked);
  EXPECT_EQ(report().phase, MissionPhase::kFinished);
  EXPECT_EQ(report().dropped, 1u);
  EXPECT_TRUE(only<FollowOrder>(script->said).back().waypoints.empty()) << "default: hold";

  plan.if_dropped = MissionEnd::kSurface;
  start();
  refused(Reason::kOutsideFence);
  EXPECT_TRUE(only<FollowOrder>(script->said).back().surface);
  EXPECT_NE(report().phase, MissionPhase::kFinished) << "it is still below";
  script->hear(fix(1, 0, 0, 0, 0, 0.2), 1);
  EXPECT_EQ(report().phase, MissionPhase::kFinished);
}

// ledger: S6-65
TEST_F(ExecutiveOfficerTest, WaitsForTheCaptainToMoveAPointThatHasASafePlaceNearIt) {
  start();
  EXPECT_TRUE(only<PointReport>(refused(Reason::kGoalBlocked, Eigen::Vector2d(100, 14))).empty());
  script->hear(PointMoved{0, {100, 14}}, now += 0.1);
  EXPECT_EQ(asked().point, 0u);
  EXPECT_EQ(asked().target.north_east, Eigen::Vector2d(100, 14));
  refused(Reason::kGoalBlocked, Eigen::Vector2d(100, 30));
  wait(1.9);
  EXPECT_EQ(asked().point, 0u);
  wait(0.2);
  EXPECT_EQ(asked().point, 1u) << "the Captain said nothing";
}

// ledger: S6-48
TEST_F(ExecutiveOfficerTest, HoldsWithoutAWayGoesOnWithOneAndLosesPatienceInTheEnd) {
  config.route_timeout_s = 10;
  start();
  planned();
  const auto said = refused(Reason::kNoPath);
  ASSERT_EQ(only<FollowOrder>(said).size(), 1u);
  EXPECT_TRUE(only<FollowOrder>(said)[0].waypoints.empty());
  EXPECT_EQ(report().phase, MissionPhase::kHolding);
  wait(6);
  planned();
  EXPECT_EQ(report().phase, MissionPhase::kUnderWay);
  EXPECT_EQ(only<FollowOrder>(script->said).back().waypoints.size(), 1u);
  wait(20);
  refused(Reason::kOutOfBudget);
  wait(3.5);
  EXPECT_EQ(report().dropped, 0u);
  EXPECT_EQ(asked().point, 0u);
  wait(1);
  EXPECT_EQ(asked().point, 1u) << "10 s without a way, all told";
  EXPECT_EQ(only<PointReport>(script->said).back().kind, PointReport::Kind::kTaken);
}

// ledger: S6-37
TEST_F(ExecutiveOfficerTest, ApproachesAPointAgainThatWasPassedAbeamAndDropsItTheSecondTime) {
  start();
  planned();
  passed(false);
  EXPECT_EQ(asked().point, 0u);
  EXPECT_EQ(only<RouteRequest>(script->said).size(), 2u);
  planned();
  passed(false);
  EXPECT_EQ(asked().point, 1u);
}

// ledger: S2-07
TEST_F(ExecutiveOfficerTest, StaysAtAPointAsLongAsItIsAskedTo) {
  plan.points[0].hold_s = 5;
  start();
  planned();
  passed();
  wait(4.9);
  EXPECT_EQ(asked().point, 0u);
  wait(0.2);
  EXPECT_EQ(asked().point, 1u);
}

// ledger: S6-41
TEST_F(ExecutiveOfficerTest, LeavesATaskToItsDriverAndLeadsItFromPlaceToPlace) {
  plan.points[0].task = "survey";
  start();
  planned();
  EXPECT_EQ(only<PointReport>(passed()).back().kind, PointReport::Kind::kTask);
  script->hear(TaskCall{1, "survey", {}}, now);
  script->hear(TaskAward{1, "mower"}, now);
  script->hear(TaskPlan{1, "mower", {{110, 0, 2, 1}, {110, 10, 2, 1}}}, now);
  EXPECT_EQ(asked().target.north_east, Eigen::Vector2d(110, 0)) << "by way of the Navigator, like any other place";
  planned();
  passed();
  EXPECT_EQ(asked().target.north_east, Eigen::Vector2d(110, 10));
  refused(Reason::kGoalBlocked);
  EXPECT_EQ(asked().point, 1u) << "what was blocked is left out, and the task is done";
  EXPECT_EQ(report().dropped, 0u);

  start();
  planned();
  passed();
  script->hear(TaskCall{1, "survey", {}}, now);
  script->hear(TaskAward{1, ""}, now);
  EXPECT_EQ(asked().point, 1u) << "no driver";
}

// The driver is asked once the vehicle has stayed as long as it is to: one that was asked before would have planned for
// nothing. ledger: S6-41
TEST_F(ExecutiveOfficerTest, AsksForADriverAfterTheStay) {
  plan.points[0].hold_s = 5;
  plan.points[0].task = "survey";
  start();
  planned();
  EXPECT_EQ(only<PointReport>(passed()).back().kind, PointReport::Kind::kReached);
  wait(5.1);
  EXPECT_EQ(only<PointReport>(script->said).back().kind, PointReport::Kind::kTask);
}

// Before a passage the vehicle holds its position, drops nothing meanwhile, and asks for a route once it is its turn.
// ledger: S2-17
TEST_F(ExecutiveOfficerTest, WaitsBeforeAPassageAndGoesOnByANewRoute) {
  start();
  planned();
  const auto waits = script->hear(PassageWait{true, "not yet"}, now);
  EXPECT_TRUE(only<FollowOrder>(waits).at(0).waypoints.empty());
  EXPECT_EQ(report().phase, MissionPhase::kHolding);
  EXPECT_TRUE(only<FollowOrder>(planned()).empty()) << "the Navigator plans on";
  refused(Reason::kNoPath);
  wait(200);
  EXPECT_EQ(only<PointReport>(script->said).size(), 1u) << "nothing is dropped";
  const auto goes = script->hear(PassageWait{false, "its turn"}, now);
  EXPECT_EQ(report().phase, MissionPhase::kUnderWay);
  ASSERT_EQ(only<RouteRequest>(goes).size(), 1u);
  EXPECT_EQ(only<FollowOrder>(planned()).size(), 1u);
}

// ledger: S2-17
TEST_F(ExecutiveOfficerTest, SaysWhetherAPointWasDroppedForWantOfAWay) {
  start();
  refused(Reason::kNoPath);
  wait(61);
  EXPECT_TRUE(only<PointReport>(script->said).at(1).no_way);
  refused(Reason::kGoalBlocked);
  const PointReport blocked = only<PointReport>(script->said).at(3);
  EXPECT_EQ(blocked.kind, PointReport::Kind::kDropped);
  EXPECT_FALSE(blocked.no_way);
}

TEST_F(ExecutiveOfficerTest, HoldsAndResumesOnOrder) {
  start();
  planned();
  MissionOrder hold;
  hold.kind = MissionOrder::Kind::kHold;
  script->hear(hold, now);
  EXPECT_EQ(report().phase, MissionPhase::kHolding);
  EXPECT_TRUE(planned().empty());
  hold.kind = MissionOrder::Kind::kResume;
  script->hear(hold, now);
  EXPECT_EQ(report().phase, MissionPhase::kUnderWay);
  EXPECT_EQ(asked().point, 0u);
  EXPECT_EQ(only<RouteRequest>(script->said).size(), 2u);
}

// ledger: S6-34
TEST_F(ExecutiveOfficerTest, EndsTheMissionOnOrderAndOnTheLossOfTheCaptain) {
  start();
  planned();
  MissionOrder abort;
  abort.kind = MissionOrder::Kind::kAbort;
  abort.end = MissionEnd::kReturn;
  abort.why = "leak";
  script->hear(abort, now);
  EXPECT_EQ(report().phase, MissionPhase::kAborted);
  EXPECT_EQ(report().why, "leak");
  EXPECT_EQ(asked().target.north_east, Eigen::Vector2d(1, 2)) << "where the mission started";
  planned();
  passed();
  EXPECT_EQ(report().phase, MissionPhase::kAborted);

  start();
  const auto said = script->hear(AgentLost{"captain", false, "out of memory"}, now);
  EXPECT_TRUE(only<FollowOrder>(said).back().surface);
  EXPECT_EQ(report().phase, MissionPhase::kAborted);
}

// Names of points may be those of nodes, and the same twice. ledger: S2-06
TEST_F(ExecutiveOfficerTest, NamesNodesByPointsWhateverTheseAreCalled) {
  plan.points[0].name = "end";
  plan.points[1].name = "end";
  plan.points[2].name = "point 1";
  plan.points[1].hold_s = 5;
  const PlanGraph graph = mission_graph(plan, config);
  check_plan_graph(graph);
  EXPECT_EQ(graph.nodes[0].name, "end (point 1)");
}

// Page and recording are told of each node, and of each other graph once. ledger: S2-24 S2-52
TEST_F(ExecutiveOfficerTest, TellsWhereItIsInItsPlanGraph) {
  plan.points[1].hold_s = 3;
  const auto first = only<PlanStep>(start());
  ASSERT_EQ(first.size(), 1u);
  EXPECT_TRUE(first[0].other_graph);
  EXPECT_EQ(*first[0].graph, mission_graph(plan, config));
  EXPECT_EQ(first[0].graph->nodes[first[0].node].name, "point 1");
  EXPECT_EQ(read_plan_graph(write_plan_graph(*first[0].graph), "told.json"), *first[0].graph);
  planned();
  EXPECT_TRUE(only<PlanStep>(script->tick(now += 0.1)).empty());
  const auto second = only<PlanStep>(passed());
  ASSERT_EQ(second.size(), 1u);
  EXPECT_FALSE(second[0].other_graph);
  EXPECT_EQ(second[0].graph, first[0].graph);
  EXPECT_EQ(text_of_step(second[0]),
            "\"point 2\" (node 3 of 9); next \"point 2, drop\" on waited above 60, \"point 2, hold\" on point reached, "
            "\"point 3\" on point dropped");
}

// In a group the Commodore orders the points. Before its first order the vehicle waits, and after one that is not the
// last; a point that it is on its way to stays. ledger: S2-24 S2-26 S2-50
TEST_F(ExecutiveOfficerTest, VisitsThePointsThatTheCommodoreOrders) {
  plan.search.length_m = 100;
  plan.group = {{"alpha", {0, 0}}, {"bravo", {0, 50}}};
  plan.points.push_back(point(0, 200));
  start();
  EXPECT_TRUE(only<RouteRequest>(script->said).empty());
  script->hear(VisitOrder{1, {2, 0}, false, "first"}, now);
  EXPECT_EQ(asked().point, 2u);
  planned();
  EXPECT_TRUE(only<RouteRequest>(script->hear(VisitOrder{2, {2, 3}, false, "goes on"}, now)).empty());
  const auto next = only<RouteRequest>(passed());
  ASSERT_EQ(next.size(), 1u);
  EXPECT_EQ(next[0].point, 3u);
  planned();
  passed();
  EXPECT_EQ(report().phase, MissionPhase::kUnderWay) << "it waits";
  wait(1);
  EXPECT_EQ(only<RouteRequest>(script->hear(VisitOrder{3, {2}, true, "once more"}, now)).size(), 1u);
  planned();
  passed();
  EXPECT_EQ(report().phase, MissionPhase::kFinished);
  EXPECT_EQ(report().reached, 3u);
}

// An order that has the present point, but not first, skips no other. ledger: S2-24
TEST_F(ExecutiveOfficerTest, SkipsNoPointOfAnOrderThatHasThePresentOneLater) {
  plan.search.length_m = 100;
  plan.group = {{"alpha", {0, 0}}, {"bravo", {0, 50}}};
  start();
  script->hear(VisitOrder{1, {2, 0}, false, "first"}, now);
  planned();
  const auto turned = only<RouteRequest>(script->hear(VisitOrder{2, {1, 2}, false, "another lane first"}, now));
  ASSERT_EQ(turned.size(), 1u);
  EXPECT_EQ(turned[0].point, 1u);
  planned();
  const auto next = only<RouteRequest>(passed());
  ASSERT_EQ(next.size(), 1u);
  EXPECT_EQ(next[0].point, 2u);
}

// A vehicle on its way to its waiting place turns back when it gets another lane. ledger: S2-24 S2-50
TEST_F(ExecutiveOfficerTest, LeavesTheWayToItsWaitingPlaceForAnotherLane) {
  plan.search.length_m = plan.search.breadth_m = 10;
  plan.search.run_out_m = 0;
  ASSERT_EQ(plan.search.all_stations(), 2u) << "the points behind them are waiting places";
  plan.group = {{"alpha", {0, 0}}, {"bravo", {0, 50}}};
  start();
  script->hear(VisitOrder{1, {2}, false, "it waits"}, now);
  EXPECT_EQ(asked().point, 2u);
  planned();
  const auto turned = only<RouteRequest>(script->hear(VisitOrder{2, {1, 0, 2}, false, "a lane"}, now));
  ASSERT_EQ(turned.size(), 1u);
  EXPECT_EQ(turned[0].point, 1u);
  for (const std::size_t next : {0, 2}) {
    planned();
    const auto asked_for = only<RouteRequest>(passed());
    ASSERT_EQ(asked_for.size(), 1u);
    EXPECT_EQ(asked_for[0].point, next);
  }
}

// The operator holds the vehicle while its points change: it resumes with the new ones. ledger: S2-32
TEST_F(ExecutiveOfficerTest, ResumesWithThePointsThatWereOrderedMeanwhile) {
  plan.search.length_m = 100;
  plan.group = {{"alpha", {0, 0}}, {"bravo", {0, 50}}};
  start();
  script->hear(VisitOrder{1, {0, 1}, false, "first"}, now);
  planned();
  script->hear(MissionOrder{MissionOrder::Kind::kHold, nullptr, MissionEnd::kHold, "wait"}, now);
  EXPECT_TRUE(only<RouteRequest>(script->hear(VisitOrder{2, {2}, true, "another"}, now)).empty());
  const auto asked_for = only<RouteRequest>(
      script->hear(MissionOrder{MissionOrder::Kind::kResume, nullptr, MissionEnd::kHold, "go"}, now));
  ASSERT_EQ(asked_for.size(), 1u);
  EXPECT_EQ(asked_for[0].point, 2u);
  planned();
  passed();
  EXPECT_EQ(report().phase, MissionPhase::kFinished);
}

// ledger: S2-50
TEST_F(ExecutiveOfficerTest, RefusesOrdersThatAreNone) {
  plan.search.length_m = 100;
  plan.group = {{"alpha", {0, 0}}};
  start();
  script->hear(VisitOrder{1, {0, 7}, false, "no such point"}, now);
  script->hear(VisitOrder{2, {1, 1}, false, "twice"}, now);
  EXPECT_TRUE(only<RouteRequest>(script->said).empty());
}

// Without its Commodore the vehicle sails what was ordered, and then ends its mission. ledger: S2-50
TEST_F(ExecutiveOfficerTest, EndsAfterTheLastOrderOfALostCommodore) {
  plan.search.length_m = 100;
  plan.group = {{"alpha", {0, 0}}, {"bravo", {0, 50}}};
  start();
  script->hear(VisitOrder{1, {1}, false, "first"}, now);
  planned();
  script->hear(AgentLost{"commodore", false, "a fault"}, now);
  passed();
  EXPECT_EQ(report().phase, MissionPhase::kFinished);
}

}  // namespace
}  // namespace isobath
