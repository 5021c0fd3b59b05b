// The Captain under a script.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/mission/agents/captain.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

class CaptainTest : public testing::Test {
 protected:
  CaptainTest() : script(agent) { plan.points = {point(100, 0), point(100, 100)}; }

  std::vector<Message> command(OperatorCommand::Kind kind) {
    OperatorCommand c;
    c.kind = kind;
    if (kind == OperatorCommand::Kind::kStart) c.plan = std::make_shared<const MissionPlan>(plan);
    return script.hear(c, 0);
  }
  void start() {
    command(OperatorCommand::Kind::kStart);
    script.hear(MissionReport{MissionPhase::kUnderWay, 0, 0, ""}, 0);
  }
  static SafetyReport leak(MissionEnd end = MissionEnd::kSurface) {
    return {"leak", true, true, end, "water in the hull"};
  }

  MissionPlan plan;
  Captain agent{CaptainConfig{}};
  Script script;
};

// ledger: S6-34
TEST_F(CaptainTest, StartsASoundMissionAndRefusesAnother) {
  const auto orders = only<MissionOrder>(command(OperatorCommand::Kind::kStart));
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_EQ(orders[0].kind, MissionOrder::Kind::kStart);
  EXPECT_EQ(orders[0].plan->points.size(), 2u);
  script.hear(MissionReport{MissionPhase::kUnderWay, 0, 0, ""}, 0);
  const auto again = command(OperatorCommand::Kind::kStart);
  EXPECT_TRUE(only<MissionOrder>(again).empty());
  EXPECT_EQ(only<Decision>(again).at(0).reason, "a mission is under way");
}

// ledger: S2-13 S6-34 S6-39
TEST_F(CaptainTest, RefusesAMissionThatIsNotSoundAndSaysWhy) {
  plan.fence = {{-10, -10}, {110, -10}, {110, 50}, {-10, 50}};
  const auto said = command(OperatorCommand::Kind::kStart);
  EXPECT_TRUE(only<MissionOrder>(said).empty());
  ASSERT_EQ(only<MissionReport>(said).size(), 1u);
  EXPECT_EQ(only<MissionReport>(said)[0].phase, MissionPhase::kAborted);
  EXPECT_NE(only<MissionReport>(said)[0].why.find("outside the fence"), std::string::npos);
  plan.fence.clear();
  plan.points.clear();
  EXPECT_TRUE(only<MissionOrder>(command(OperatorCommand::Kind::kStart)).empty());
}

// ledger: S6-34
TEST_F(CaptainTest, EndsTheMissionInTheTurnInWhichItHearsOfAFault) {
  start();
  const auto said = script.hear(leak(), 12.3);
  ASSERT_EQ(only<MissionOrder>(said).size(), 1u);
  const MissionOrder order = only<MissionOrder>(said)[0];
  EXPECT_EQ(order.kind, MissionOrder::Kind::kAbort);
  EXPECT_EQ(order.end, MissionEnd::kSurface);
  EXPECT_EQ(order.why, "leak: water in the hull");
  EXPECT_TRUE(only<MissionOrder>(script.hear(leak(), 12.4)).empty()) << "once";
}

// ledger: S6-34
TEST_F(CaptainTest, AFaultThatMendsDoesNotRaiseAMissionButLetsTheNextOneStart) {
  start();
  SafetyReport harmless = leak();
  harmless.abort = false;
  EXPECT_TRUE(only<MissionOrder>(script.hear(harmless, 1)).empty());
  script.hear(leak(MissionEnd::kHold), 2);
  script.hear(MissionReport{MissionPhase::kAborted, 0, 0, ""}, 2);
  const auto refused = command(OperatorCommand::Kind::kStart);
  EXPECT_TRUE(only<MissionOrder>(refused).empty());
  EXPECT_EQ(only<Decision>(refused).at(0).reason, "a fault is active: leak");
  const auto worse = only<MissionOrder>(script.hear(leak(MissionEnd::kSurface), 3));
  EXPECT_EQ(worse.size(), 1u) << "holding becomes surfacing";
  SafetyReport over = leak();
  over.active = false;
  script.hear(over, 4);
  EXPECT_EQ(only<MissionOrder>(command(OperatorCommand::Kind::kStart)).size(), 1u);
}

// ledger: S6-33 S6-34
TEST_F(CaptainTest, EndsTheMissionWhenAnAgentIsLostThatMattersAndGoesOnWithoutOthers) {
  for (const char* name : {"navigator", "pilot", "executive officer", "fls detector", "safety officer"}) {
    Captain captain{CaptainConfig{}};
    Script s(captain);
    OperatorCommand go;
    go.kind = OperatorCommand::Kind::kStart;
    go.plan = std::make_shared<const MissionPlan>(plan);
    s.hear(go, 0);
    const auto orders = only<MissionOrder>(s.hear(AgentLost{name, true, "no answer"}, 1));
    ASSERT_EQ(orders.size(), 1u) << name;
    EXPECT_EQ(orders[0].end, MissionEnd::kSurface);
  }
  start();
  const auto said = script.hear(AgentLost{"chart room", false, "no disk"}, 1);
  EXPECT_TRUE(only<MissionOrder>(said).empty());
  EXPECT_EQ(only<Decision>(said).at(0).what, "go on");
}

TEST_F(CaptainTest, HoldsResumesAndEndsOnTheOperatorsWord) {
  start();
  EXPECT_EQ(only<MissionOrder>(command(OperatorCommand::Kind::kHold)).at(0).kind, MissionOrder::Kind::kHold);
  script.hear(MissionReport{MissionPhase::kHolding, 0, 0, ""}, 1);
  EXPECT_EQ(only<MissionOrder>(command(OperatorCommand::Kind::kResume)).at(0).kind, MissionOrder::Kind::kResume);
  EXPECT_EQ(only<MissionOrder>(command(OperatorCommand::Kind::kAbort)).at(0).end, MissionEnd::kHold);
}

TEST_F(CaptainTest, EndsAMissionThatLastsTooLong) {
  plan.limits.max_duration_s = 60;
  start();
  script.tick(60);
  EXPECT_EQ(only<MissionOrder>(script.said).size(), 1u);
  script.tick(60.1);
  EXPECT_EQ(only<MissionOrder>(script.said).back().kind, MissionOrder::Kind::kAbort);
}

// ledger: S6-65
TEST_F(CaptainTest, MovesABlockedPointWithinWhatTheMissionAllowsForThatPoint) {
  plan.points[1].move_m = 20;
  start();
  const auto refused = [&](std::size_t p, const Eigen::Vector2d& safe) {
    return only<PointMoved>(
        script.hear(RouteRefused{RouteRefused::Reason::kGoalBlocked, 1, p, safe, "a rock stands on it"}, 1));
  };
  EXPECT_TRUE(refused(0, {110, 0}).empty());
  EXPECT_TRUE(refused(1, {100, 120.1}).empty());
  const auto moved = refused(1, {100, 119.9});
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_EQ(moved[0].point, 1u);
  EXPECT_EQ(moved[0].north_east, Eigen::Vector2d(100, 119.9));
  EXPECT_NE(only<Decision>(script.said).back().reason.find("it moves by 19.9 m"), std::string::npos);
}

// ledger: S6-56
TEST_F(CaptainTest, TellsTheOperatorOfAvoidanceAndOfDroppedPoints) {
  start();
  script.hear(PointReport{PointReport::Kind::kAvoiding, 0, "a rock"}, 1);
  EXPECT_EQ(only<StatusReport>(script.said).back().text, "avoiding on the way to point 1: a rock");
  script.hear(PointReport{PointReport::Kind::kDropped, 1, "a rock on it"}, 1);
  EXPECT_EQ(only<StatusReport>(script.said).back().text, "point 2 is dropped: a rock on it");
}

// ledger: S6-34 S6-41
TEST_F(CaptainTest, GivesATaskToTheMostSuitableDriverInWhateverOrderTheyBid) {
  std::vector<TaskBid> bids = {{1, "mower", 0.5}, {1, "spiral", 0.9}, {1, "zigzag", 0.9},
                               {2, "late", 1.0},  {1, "broken", -1},  {1, "wild", NAN}};
  std::sort(bids.begin(), bids.end(), [](const TaskBid& a, const TaskBid& b) { return a.driver < b.driver; });
  do {
    Captain captain{CaptainConfig{}};
    Script s(captain);
    OperatorCommand go;
    go.kind = OperatorCommand::Kind::kStart;
    go.plan = std::make_shared<const MissionPlan>(plan);
    s.hear(go, 0);
    EXPECT_TRUE(only<TaskCall>(s.hear(PointReport{PointReport::Kind::kReached, 0, ""}, 5)).empty());
    const auto called = only<TaskCall>(s.hear(PointReport{PointReport::Kind::kTask, 0, "survey"}, 5));
    ASSERT_EQ(called.size(), 1u);
    EXPECT_EQ(called[0].task, "survey");
    for (const TaskBid& bid : bids) s.hear(bid, 5.5);
    EXPECT_TRUE(only<TaskAward>(s.tick(5.9)).empty());
    const auto awards = only<TaskAward>(s.tick(6));
    ASSERT_EQ(awards.size(), 1u);
    ASSERT_EQ(awards[0].driver, "spiral");
    const auto next = only<TaskAward>(s.hear(AgentLost{"spiral", false, ""}, 7));
    ASSERT_EQ(next.size(), 1u);
    ASSERT_EQ(next[0].driver, "zigzag");
  } while (std::next_permutation(bids.begin(), bids.end(),
                                 [](const TaskBid& a, const TaskBid& b) { return a.driver < b.driver; }));
}

// ledger: S6-41
TEST_F(CaptainTest, SaysThatNoDriverIsThere) {
  start();
  script.hear(PointReport{PointReport::Kind::kTask, 0, "survey"}, 5);
  script.tick(6);
  EXPECT_EQ(only<TaskAward>(script.said).back().driver, "");
  EXPECT_EQ(only<Decision>(script.said).back().reason, "no driver bids for survey; the mission goes on");
}

// No vehicle of the group finds a way: the mission goes on with its other goal. ledger: S2-17
TEST_F(CaptainTest, EndsTheMissionAsAfterADroppedPointWhereTheGroupFindsNoWay) {
  plan.if_dropped = MissionEnd::kReturn;
  start();
  const auto orders = only<MissionOrder>(script.hear(VisitOrder{3, {}, false, "no vehicle finds a way", true}, 9));
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_EQ(orders[0].kind, MissionOrder::Kind::kAbort);
  EXPECT_EQ(orders[0].end, MissionEnd::kReturn);
  EXPECT_EQ(orders[0].why, "no vehicle finds a way");
}

// ledger: S2-16 S6-40
TEST_F(CaptainTest, TellsTheOperatorWhatAStepSays) {
  start();
  script.hear(PointReport{PointReport::Kind::kTold, 0, "looks round at the pile"}, 1);
  EXPECT_EQ(only<StatusReport>(script.said).back().text, "looks round at the pile");
}

// A mission of 800 s at 1 m/s may last 500 s and is to end at its start: the vehicle turns back while the way there
// takes what is left, with a tenth and 10 s in reserve. ledger: S2-15 S2-17
TEST_F(CaptainTest, TurnsBackWhileTheWayToTheStartTakesTheTimeThatIsLeft) {
  plan.points = {point(400, 0), point(800, 0)};
  plan.speed = 1;
  plan.at_end = MissionEnd::kReturn;
  plan.limits.max_duration_s = 500;
  script.hear(fix(0, 0, 0), 0);
  start();
  for (double s = 1; s <= 232; ++s) {
    script.hear(fix(s, s, 0), s);
    EXPECT_TRUE(only<MissionOrder>(script.tick(s)).empty()) << s;
  }
  script.hear(fix(234, 234, 0), 234);
  const auto orders = only<MissionOrder>(script.tick(234));
  ASSERT_EQ(orders.size(), 1u);
  EXPECT_EQ(orders[0].end, MissionEnd::kReturn);
  EXPECT_EQ(orders[0].why, "266 s are left, and the way back takes 234 s; 2 points will not be visited");
  EXPECT_TRUE(only<MissionOrder>(script.tick(235)).empty()) << "once";
}

// ledger: S2-25 S2-38
TEST_F(CaptainTest, TellsEachHalfHourHowFarItsPlanReaches) {
  plan.speed = 0.1;
  script.hear(fix(0, 0, 0), 0);
  start();
  std::vector<double> at_s, horizon_s;
  for (double s = 0.1; s < 3700; s += 0.1) {
    script.tick(s);
    const auto plans = only<LevelPlan>(script.said);
    if (plans.size() == at_s.size()) continue;
    EXPECT_EQ(plans.back().level, CommandLevel::kMission);
    at_s.push_back(s);
    horizon_s.push_back(plans.back().horizon_s);
  }
  ASSERT_EQ(at_s.size(), 3u);
  EXPECT_NEAR(at_s[1] - at_s[0], 1800, 0.11);
  EXPECT_NEAR(at_s[2] - at_s[1], 1800, 0.11);
  EXPECT_EQ(horizon_s[0], 2000) << "two legs of 100 m";
}

// An order of the Commodore is another plan, told at once. ledger: S2-25 S2-52
TEST_F(CaptainTest, TellsHowFarItsPlanReachesOnceTheGroupHasOrderedPoints) {
  plan.speed = 1;
  plan.search.length_m = 100;
  script.hear(fix(0, 0, 0), 0);
  start();
  script.hear(MissionReport{MissionPhase::kUnderWay, 0, 0, ""}, 0.1);
  EXPECT_EQ(only<LevelPlan>(script.said).back().horizon_s, 0);
  script.hear(VisitOrder{1, {0, 1}, false, "the first plan"}, 0.2);
  EXPECT_TRUE(only<LevelPlan>(script.said).back().changed);
  EXPECT_EQ(only<LevelPlan>(script.said).back().horizon_s, 200);
}

}  // namespace
}  // namespace isobath
