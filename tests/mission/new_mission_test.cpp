// A mission that the operator replaces: what the Captain takes and refuses, how it comes over the link, what a draft
// becomes, and how its way is previewed.
#include <gmock/gmock.h>
#include <isobath/mission/agents/captain.hpp>
#include <isobath/mission/agents/executive_officer.hpp>
#include <isobath/mission/agents/mission_preview.hpp>
#include <isobath/mission/messages/operator_link.hpp>
#include <isobath/mission/plan/mission_draft.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

using Eigen::Vector2d;
using Kind = OperatorCommand::Kind;
using testing::ElementsAre;
using testing::HasSubstr;

MissionPlan plan_to(std::vector<MissionPoint> points) {
  MissionPlan plan;
  plan.points = std::move(points);
  return plan;
}
std::shared_ptr<const MissionPlan> shared(const MissionPlan& plan) { return std::make_shared<const MissionPlan>(plan); }

class NewMission : public testing::Test {
 protected:
  NewMission() : script(captain) {
    script.hear(fix(0, 5, 7), 0);
    script.hear(OperatorCommand{Kind::kStart, shared(plan_to({point(100, 0)}))}, 0);
    script.hear(MissionReport{MissionPhase::kUnderWay, 0, 0, ""}, 0);
    script.hear(fix(10, 50, 0), 10);
  }
  std::vector<Message> replace(const MissionPlan& plan) {
    return script.hear(OperatorCommand{Kind::kNewMission, shared(plan), "the page at 10.0.0.1"}, 11);
  }

  Captain captain{CaptainConfig{}};
  Script script;
};

TEST_F(NewMission, IsTakenUnderWayAndTheLogNamesItsSender) {
  const auto said = replace(plan_to({point(0, 50), point(0, 60)}));
  const auto orders = only<MissionOrder>(said);
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_EQ(orders[0].kind, MissionOrder::Kind::kStart);
  EXPECT_TRUE(orders[0].replaces);
  EXPECT_EQ(orders[0].plan->points.size(), 2u);
  const Decision decision = only<Decision>(said).at(0);
  EXPECT_EQ(decision.what, "new mission");
  EXPECT_EQ(decision.reason, "2 points, sent by the page at 10.0.0.1");
}

TEST_F(NewMission, ThatTheChecksRefuseChangesNothing) {
  MissionPlan plan = plan_to({point(0, 50)});
  plan.fence = {{-10, -10}, {10, -10}, {10, 10}, {-10, 10}};
  const auto said = replace(plan);
  EXPECT_TRUE(only<MissionOrder>(said).empty());
  EXPECT_TRUE(only<MissionReport>(said).empty());
  EXPECT_EQ(only<Decision>(said).at(0).what, "refuse mission");
  EXPECT_THAT(only<Decision>(said).at(0).reason, HasSubstr("outside the fence"));
  EXPECT_THAT(only<Decision>(said).at(0).reason, HasSubstr("the mission under way goes on"));
}

TEST_F(NewMission, WhoseFenceDoesNotHoldTheVehicleIsRefused) {
  MissionPlan plan = plan_to({point(0, 50)});
  plan.fence = square(0, 50, 20);
  const auto said = replace(plan);
  EXPECT_TRUE(only<MissionOrder>(said).empty());
  EXPECT_THAT(only<Decision>(said).at(0).reason, HasSubstr("the vehicle is outside the fence"));
}

TEST_F(NewMission, IsRefusedWhileAFaultIsActive) {
  script.hear(SafetyReport{"leak", true, true, MissionEnd::kSurface, "water in the hull"}, 10.5);
  EXPECT_TRUE(only<MissionOrder>(replace(plan_to({point(0, 50)}))).empty());
}

TEST_F(NewMission, OfTheOrderToReturnLeadsToWhereTheFirstOneStarted) {
  replace(plan_to({point(0, 50)}));
  const auto said = script.hear(OperatorCommand{Kind::kReturn, nullptr, "the page at 10.0.0.1"}, 12);
  const auto orders = only<MissionOrder>(said);
  ASSERT_EQ(orders.size(), 1u);
  ASSERT_EQ(orders[0].plan->points.size(), 1u);
  EXPECT_EQ(orders[0].plan->points[0].north_east, Vector2d(5, 7));
  EXPECT_EQ(orders[0].plan->points[0].name, "the start");
}

TEST_F(NewMission, HandOverOfCommandIsADecision) {
  const auto said = script.hear(OperatorCommand{Kind::kHandOver, nullptr, "the page at 10.0.0.1 has command"}, 12);
  ASSERT_EQ(only<Decision>(said).size(), 1u);
  EXPECT_EQ(only<Decision>(said)[0].what, "command");
  EXPECT_EQ(only<Decision>(said)[0].reason, "the page at 10.0.0.1 has command");
}

TEST(NewMissionOfTheExecutiveOfficer, TakesThePlaceOfTheOldOneAndKeepsItsStart) {
  ExecutiveOfficer officer{ExecutiveConfig{}};
  Script script(officer);
  script.hear(fix(0, 5, 7), 0);
  MissionPlan first = plan_to({point(100, 0)}), second = plan_to({point(0, 50)});
  second.at_end = MissionEnd::kReturn;
  script.hear(MissionOrder{MissionOrder::Kind::kStart, shared(first), MissionEnd::kHold, ""}, 0);
  script.hear(fix(10, 50, 0), 10);
  EXPECT_TRUE(only<RouteRequest>(
                  script.hear(MissionOrder{MissionOrder::Kind::kStart, shared(second), MissionEnd::kHold, ""}, 10))
                  .empty());
  const auto said =
      script.hear(MissionOrder{MissionOrder::Kind::kStart, shared(second), MissionEnd::kHold, "", true}, 11);
  ASSERT_EQ(only<RouteRequest>(said).size(), 1u);
  const RouteRequest request = only<RouteRequest>(said)[0];
  EXPECT_EQ(request.target.north_east, Vector2d(0, 50));
  script.hear(RoutePlanned{request.id, 1, {{0, 50, 1, 1}}, false, ""}, 12);
  const auto back = only<RouteRequest>(script.hear(WaypointPassed{1, 0, true, true}, 13));
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].target.north_east, Vector2d(5, 7));
}

TEST(OperatorLink, CarriesANewMissionAndItsSender) {
  for (const Kind kind : {Kind::kNewMission, Kind::kReturn, Kind::kHandOver}) {
    OperatorCommand command{kind, nullptr, "the page at 10.0.0.1"};
    if (kind == Kind::kNewMission) command.plan = shared(plan_to({point(0, 50)}));
    const OperatorCommand received = command_of(to_bytes(command));
    EXPECT_EQ(received.kind, kind);
    EXPECT_EQ(received.by, command.by);
    EXPECT_EQ(received.plan != nullptr, kind == Kind::kNewMission);
  }
  FrameBytes cut = to_bytes(OperatorCommand{Kind::kReturn, nullptr, "the page"});
  cut.resize(6);
  EXPECT_THROW((void)command_of(cut), Error);
  EXPECT_THROW((void)command_of(to_bytes(OperatorCommand{Kind::kNewMission})), Error);
  const FrameBytes old = to_bytes(OperatorCommand{Kind::kHold});
  EXPECT_EQ(old.size(), 2u) << "older commands go as they always did";
}

TEST(MissionDraft, KeepsOfItsPointsWhatItDoesNotState) {
  MissionPlan mission = plan_to({point(10, 0), point(20, 0)});
  mission.points[1].name = "buoy";
  mission.points[1].hold_s = 30;
  mission.fence = square(0, 0, 100);
  mission.injected.resize(1);
  MissionDraft draft;
  draft.points = {{1, {25, 1}, 4, {}, 0.5}, {{}, {30, 2}, 5, {}, 0}};
  const MissionPlan plan = plan_of(draft, mission);
  ASSERT_EQ(plan.points.size(), 2u);
  EXPECT_EQ(plan.points[0].name, "buoy");
  EXPECT_EQ(plan.points[0].hold_s, 30);
  EXPECT_EQ(plan.points[0].north_east, Vector2d(25, 1));
  EXPECT_EQ(plan.points[0].depth_m, 4);
  EXPECT_EQ(plan.points[0].speed, 0.5);
  EXPECT_EQ(plan.points[1].name, "point 2");
  EXPECT_EQ(plan.fence.size(), 4u);
  EXPECT_TRUE(plan.injected.empty());
  draft.fence = Polygon{};
  EXPECT_TRUE(plan_of(draft, mission).fence.empty());
}

TEST(MissionDraft, GetsTheChecksOfAMissionFile) {
  const MissionPlan mission = plan_to({point(10, 0)});
  const auto problem = [&](const MissionDraft& draft) {
    try {
      (void)plan_of(draft, mission);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  MissionDraft draft;
  EXPECT_THAT(problem(draft), HasSubstr("no points"));
  draft.points = {{{}, {50, 0}, 1, {}, 0}};
  EXPECT_EQ(problem(draft), "");
  draft.fence = square(0, 0, 20);
  EXPECT_THAT(problem(draft), HasSubstr("point 1 at 50.00, 0.00 lies 30.00 m outside the fence"));
  draft.fence = Polygon{{0, 0}, {9, 9}};
  EXPECT_THAT(problem(draft), HasSubstr("fewer than 3 corners"));
  draft.fence.reset();
  draft.points[0].depth_m = 200;
  EXPECT_THAT(problem(draft), HasSubstr("at 200 m of depth"));
}

/// What the agents know of a wall across the way to the north.
class Preview : public testing::Test {
 protected:
  Preview() {
    known.on_message(fix(1, 0, 0), at(1));
    ObstacleScan scan;
    scan.time = at(2);
    scan.X_WL = fix(2, 0, 0).X_WB;
    scan.hazards = {{{{38, -20}, {42, -20}, {42, 20}, {38, 20}}, 0, HazardKind::kSeen, 1, 4}};
    known.on_message(scan, at(2));
  }
  std::vector<PreviewLeg> legs(const std::vector<MissionPoint>& points) {
    return preview_of(known, shared(plan_to(points)), config, vehicle, [] { return false; });
  }

  MissionKnowledge known;
  MissionConfig config;
  VehicleParameters vehicle;
};

TEST_F(Preview, LeadsRoundWhatStandsThereAndSaysHowNear) {
  const auto way = legs({point(80, 0), point(80, 40)});
  ASSERT_EQ(way.size(), 2u);
  EXPECT_GT(way[0].way.size(), 2u);
  EXPECT_GT(way[0].length_m, 80);
  EXPECT_GE(way[0].clearance_m, config.route.clearance_m - 0.05);
  EXPECT_THAT(way[0].nearest, HasSubstr("obstacle 4 at north"));
  EXPECT_NEAR(way[0].unknown_m, way[0].length_m, 1) << "no map has looked there";
  EXPECT_EQ(way[1].way, (std::vector<Vector2d>{{80, 0}, {80, 40}}));
}

TEST_F(Preview, SaysWhyThereIsNoWayAndGoesOnFromThePointBefore) {
  const auto way = legs({point(40, 0), point(0, 30)});
  EXPECT_TRUE(way[0].way.empty());
  EXPECT_EQ(way[0].why, "obstacle 4 stands on the point");
  EXPECT_FALSE(way[1].way.empty());
}

TEST_F(Preview, NeedsAPositionAndStopsWhenItIsToldTo) {
  const MissionKnowledge nothing;
  const auto plan = shared(plan_to({point(80, 0)}));
  EXPECT_THROW((void)preview_of(nothing, plan, config, vehicle, [] { return false; }), Error);
  const auto way = preview_of(known, plan, config, vehicle, [] { return true; });
  ASSERT_EQ(way.size(), 1u);
  EXPECT_TRUE(way[0].way.empty());
  EXPECT_THAT(way[0].why, HasSubstr("run out"));
}

TEST_F(Preview, WithoutAnyScanSaysThatNothingHasBeenSeen) {
  MissionKnowledge blind;
  blind.on_message(fix(1, 0, 0), at(1));
  const auto way = preview_of(blind, shared(plan_to({point(80, 0)})), config, vehicle, [] { return false; });
  EXPECT_TRUE(way.at(0).way.empty());
  EXPECT_THAT(way.at(0).why, HasSubstr("nothing has been seen yet"));
}

}  // namespace
}  // namespace isobath
