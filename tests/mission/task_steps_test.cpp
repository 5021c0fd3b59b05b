// Tasks that a mission describes step by step: what is refused, and which plan graph they make.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/mission/agents/executive_officer.hpp>
#include <isobath/mission/plan/mission_file.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kMission = R"([mission]
title = "a task in steps"
[[mission_point]]
north = 50
task = "inspect_pile"
[[mission_point]]
north = 90
[[task_step]]
task = "inspect_pile"
name = "look round"
sector_deg = 360
tell = "looks round"
until = "range below 4"
then = "up"
at_most_s = 40
[[task_step]]
task = "inspect_pile"
name = "circle"
pilot = "circle radius_m=8"
[[task_step]]
task = "inspect_pile"
name = "up"
pilot = "surface"
[[task_step]]
task = "inspect_pile"
name = "down"
pilot = "go"
)";

std::string with(const std::string& from, const std::string& to) {
  std::string text = kMission;
  text.replace(text.find(from), from.size(), to);
  return text;
}

std::string problem_of(const std::string& text) {
  try {
    (void)parse_mission(text, "m.toml");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// ledger: S2-16 S2-18
TEST(TaskSteps, OfAnUnknownActionOrEventAreRefusedWithTheirPlace) {
  EXPECT_EQ(problem_of(kMission), "");
  EXPECT_THAT(problem_of(with("circle radius_m=8", "dance")), HasSubstr("m.toml:"));
  EXPECT_THAT(problem_of(with("circle radius_m=8", "dance")), HasSubstr("an unknown action: \"dance\""));
  EXPECT_THAT(problem_of(with("range below 4", "range of 4")), HasSubstr("an unknown event"));
  EXPECT_THAT(problem_of(with("range below 4", "mood below 4")), HasSubstr("an unknown event"));
  EXPECT_THAT(problem_of(with("range below 4", "range below many")), HasSubstr("an unknown event"));
  EXPECT_THAT(problem_of(with("then = \"up\"", "then = \"away\"")), HasSubstr("inspect_pile has no step away"));
  EXPECT_THAT(problem_of(with("name = \"down\"", "name = \"up\"")), HasSubstr("two steps of inspect_pile"));
  EXPECT_THAT(problem_of(with("name = \"down\"", "name = \"end\"")), HasSubstr("another name"));
  EXPECT_THAT(problem_of(with("then = \"up\"", "then = \"up\"\nor_else = \"up\"")),
              HasSubstr("no step of inspect_pile leads to circle"));
  EXPECT_THAT(problem_of(with("pilot = \"go\"", "pilot = \"go\"\nthen = \"up\"\nor_else = \"up\"")),
              HasSubstr("never ends"));
  EXPECT_THAT(problem_of(with("task = \"inspect_pile\"\nname = \"look", "task = \"inspect it\"\nname = \"look")),
              HasSubstr("a name without blanks"));
}

// A mission travels to the vehicle as text. ledger: S2-18 S6-40
TEST(TaskSteps, ComeBackFromTheTextOfAMission) {
  const MissionPlan plan = parse_mission(kMission, "m.toml");
  const std::string text = write_mission(plan);
  EXPECT_EQ(write_mission(parse_mission(text, "again.toml")), text);
  EXPECT_EQ(parse_mission(text, "again.toml").steps.size(), 4u);
}

/// The names of the nodes that follow one, in the order of the arcs.
std::vector<std::string> after(const PlanGraph& graph, const std::string& name) {
  std::vector<std::string> next;
  for (const PlanArc& arc : graph.arcs) {
    if (graph.nodes[arc.from].name == name) next.push_back(graph.nodes[arc.to].name + " by " + to_text(arc.event));
  }
  return next;
}

// The schema decides what follows what; another one changes the plan and no code. ledger: S2-06 S2-16 S2-18 S2-21
TEST(TaskSteps, AreNodesOfThePlanGraph) {
  const PlanGraph graph = mission_graph(parse_mission(kMission, "m.toml"), {});
  check_plan_graph(graph);
  EXPECT_THAT(after(graph, "point 1"), testing::Contains("point 1: look round by point reached (0)"));
  EXPECT_THAT(after(graph, "point 1: look round"),
              ElementsAre("point 1: up by range below 4", "point 1: circle by timeout 40 s"));
  EXPECT_THAT(after(graph, "point 1: circle"),
              ElementsAre("point 1: up by task done (0)", "point 1: up by timeout 300 s"));
  EXPECT_THAT(after(graph, "point 1: up"),
              ElementsAre("point 1: down by depth below 0.5", "point 1: down by timeout 300 s"));
  EXPECT_THAT(after(graph, "point 1: down"), ElementsAre("point 2 by task done (0)", "point 2 by timeout 300 s"));
  const PlanGraph shorter = mission_graph(parse_mission(with("then = \"up\"", "then = \"end\""), "m.toml"), {});
  EXPECT_THAT(after(shorter, "point 1: look round"),
              ElementsAre("point 1: circle by timeout 40 s", "point 2 by range below 4"));
}

/// The Executive Officer with the mission above, at its first point.
class TaskStepsOnBoard : public testing::Test {
 protected:
  TaskStepsOnBoard() {
    script.hear(fix(0, 0, 0), 0);
    MissionOrder order;
    order.plan = std::make_shared<const MissionPlan>(parse_mission(kMission, "m.toml"));
    script.hear(order, 0);
    arrive();
  }
  [[nodiscard]] RouteRequest asked() const { return only<RouteRequest>(script.said).back(); }
  std::vector<Message> arrive() {
    script.hear(RoutePlanned{asked().id, ++version, {{50, 0, 1, 1}}, false, ""}, now);
    return script.hear(WaypointPassed{version, 0, true, true}, now);
  }
  std::vector<Message> wait(double s) {
    std::vector<Message> all;
    for (int i = 0; i < static_cast<int>(s * 10 + 0.5); ++i) {
      for (Message& one : script.tick(now += 0.1)) all.push_back(std::move(one));
    }
    return all;
  }
  ExecutiveOfficer agent{ExecutiveConfig{}};
  Script script{agent};
  std::uint32_t version = 0;
  double now = 0;
};

// Three jobs, one for each planner. ledger: S2-16 S2-19
TEST_F(TaskStepsOnBoard, GiveThePilotTheSonarAndTheLinkTheirParts) {
  EXPECT_TRUE(only<FollowOrder>(script.said).back().waypoints.empty()) << "the pilot holds";
  const auto sonar = only<SonarOrder>(script.said);
  ASSERT_EQ(sonar.size(), 1u) << "not before the vehicle is there";
  EXPECT_EQ(sonar[0].scan->sector, Angle::degrees(360));
  const PointReport told = only<PointReport>(script.said).back();
  EXPECT_EQ(told.kind, PointReport::Kind::kTold);
  EXPECT_EQ(told.why, "looks round");

  const auto circle = wait(40.1);
  ASSERT_EQ(only<SonarOrder>(circle).size(), 1u);
  EXPECT_FALSE(only<SonarOrder>(circle)[0].scan) << "it looks as configured again";
  EXPECT_EQ(only<PointReport>(circle).back().kind, PointReport::Kind::kTask);
  EXPECT_EQ(only<PointReport>(circle).back().why, "circle radius_m=8");
  script.hear(TaskCall{7, "circle radius_m=8", {}}, now);
  script.hear(TaskAward{7, "circle"}, now);
  script.hear(TaskPlan{6, "circle", {{60, 8, 1, 1}}}, now);
  EXPECT_EQ(only<RouteRequest>(script.said).size(), 1u) << "a plan for another call";
  script.hear(TaskPlan{7, "circle", {{50, 8, 1, 1}}}, now);
  EXPECT_EQ(asked().target.north_east, Eigen::Vector2d(50, 8));
  const auto up = arrive();
  EXPECT_TRUE(only<FollowOrder>(up).back().surface);
  const auto down = script.hear(fix(now, 50, 0, 0, 0, 0.2), now);
  ASSERT_EQ(only<RouteRequest>(down).size(), 1u);
  EXPECT_EQ(asked().target.north_east, Eigen::Vector2d(50, 0)) << "down again at the point";
  EXPECT_EQ(asked().point, 0u);
  EXPECT_EQ(only<RouteRequest>(arrive()).at(0).point, 1u);
}

// An event about the world, and one about the vehicle itself, end a step before its time. ledger: S2-07 S2-08
TEST_F(TaskStepsOnBoard, EndByAnEventOfTheWorld) {
  wait(5);
  ObstacleScan scan;
  scan.hazards = {{square(10, 0, 1), 0.5}};
  script.hear(scan, now);
  EXPECT_TRUE(only<PointReport>(script.said).back().why == "looks round") << "8.5 m away";
  scan.hazards = {{square(10, 0, 1), 0.5}, {square(4, 0, 1), 0}};
  const auto said = script.hear(scan, now);
  EXPECT_TRUE(only<FollowOrder>(said).back().surface) << "3 m away: `then`, not the next step";
}

// The hold of the operator stops a step, and its end begins it again. ledger: S2-32 S6-34
TEST_F(TaskStepsOnBoard, AreBegunAgainAfterAHold) {
  MissionOrder hold;
  hold.kind = MissionOrder::Kind::kHold;
  script.hear(hold, now);
  EXPECT_THAT(only<PointReport>(wait(50)), testing::IsEmpty());
  hold.kind = MissionOrder::Kind::kResume;
  script.hear(hold, now);
  EXPECT_EQ(only<PointReport>(script.said).back().why, "circle radius_m=8") << "the time of the first step is over";
  hold.kind = MissionOrder::Kind::kAbort;
  hold.end = MissionEnd::kHold;
  const auto said = script.hear(hold, now);
  EXPECT_EQ(only<MissionReport>(said).back().phase, MissionPhase::kAborted);
}

// No order about the sonar outlasts the task. ledger: S2-32
TEST_F(TaskStepsOnBoard, LeaveTheSonarAsConfiguredWhenTheMissionEnds) {
  MissionOrder abort;
  abort.kind = MissionOrder::Kind::kAbort;
  const auto said = script.hear(abort, now);
  ASSERT_EQ(only<SonarOrder>(said).size(), 1u);
  EXPECT_FALSE(only<SonarOrder>(said)[0].scan);
}

}  // namespace
}  // namespace isobath
