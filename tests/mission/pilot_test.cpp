// The Pilot under a script.
#include <gtest/gtest.h>
#include <isobath/mission/agents/pilot.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

class PilotTest : public testing::Test {
 protected:
  void make() {
    agent = std::make_unique<Pilot>(PilotConfig{}, GuidanceConfig{}, StationConfig{}, DepthKeeperConfig{}, vehicle);
    script = std::make_unique<Script>(*agent);
  }
  /// What it says at a tick, the vehicle being there.
  std::vector<Message> at_place(double north, double east, double heading_deg = 0, double speed = 1, double depth = 1) {
    now += 0.1;
    script->hear(fix(now, north, east, heading_deg, speed, depth), now);
    return script->tick(now);
  }
  Setpoint setpoint() { return only<HelmOrder>(script->said).back().setpoint; }

  VehicleParameters vehicle;
  std::unique_ptr<Pilot> agent;
  std::unique_ptr<Script> script;
  double now = 0;
};

// ledger: S6-37
TEST_F(PilotTest, ReachesAMissionPointWithinFiveMetres) {
  for (const auto& [distance, reached] : {std::pair{5.01, false}, std::pair{4.99, true}}) {
    make();
    at_place(0, 0);
    script->hear(FollowOrder{3, {{100, 0, 1, 1.5}}, {}, false}, now);
    at_place(50, 0);
    const auto passed = only<WaypointPassed>(at_place(100 - distance, 0));
    ASSERT_EQ(passed.size(), reached ? 1u : 0u);
    if (!reached) continue;
    EXPECT_EQ(passed[0].version, 3u);
    EXPECT_TRUE(passed[0].reached && passed[0].last);
    EXPECT_TRUE(only<WaypointPassed>(at_place(99, 0)).empty()) << "once";
  }
}

// ledger: S6-37
TEST_F(PilotTest, PassesAWaypointAbeamAndGoesOn) {
  make();
  at_place(0, 0);
  script->hear(FollowOrder{1, {{50, 0, 1, 1.5}, {50, 100, 1, 1.5}}, {}, false}, now);
  at_place(0, 0);  // the first leg starts here
  at_place(30, 8);
  EXPECT_TRUE(only<WaypointPassed>(at_place(49.9, 8)).empty());
  const auto passed = only<WaypointPassed>(at_place(50.1, 8));
  ASSERT_EQ(passed.size(), 1u);
  EXPECT_EQ(passed[0].index, 0u);
  EXPECT_FALSE(passed[0].reached);
  EXPECT_FALSE(passed[0].last);
  EXPECT_NEAR(setpoint().heading.degrees(), 90, 45) << "to the next one, not round this one";
  const auto missed = only<WaypointPassed>(at_place(57, 100.1));
  ASSERT_EQ(missed.size(), 1u);
  EXPECT_TRUE(missed[0].last);
  EXPECT_FALSE(missed[0].reached);
}

// ledger: S6-37
TEST_F(PilotTest, AsksForBearingSpeedAndDepthOfTheWaypointAhead) {
  make();
  at_place(0, 0);
  script->hear(FollowOrder{1, {{200, 200, 7, 1.2}}, {}, false}, now);
  at_place(0, 0, 45);
  EXPECT_NEAR(setpoint().heading.degrees(), 45, 1e-6);
  EXPECT_NEAR(setpoint().speed, 1.2, 1e-9);
  EXPECT_NEAR(setpoint().depth, 7, 1e-9);
}

// The order of the Goal Selector holds for half a second; then the line to the way-point begins where the vehicle is.
// ledger: S3-21
TEST_F(PilotTest, FollowsAMotionWhileItIsOrdered) {
  make();
  at_place(0, 0);
  script->hear(FollowOrder{4, {{100, 0, 2, 1.5}}, {}, false}, now);
  at_place(0, 0);
  MotionOrder motion{4, 0, at(now), {0, 0}, {0, 1.2}, at(now + 1)};
  script->hear(motion, now);
  at_place(0, 0);
  EXPECT_NEAR(setpoint().heading.degrees(), 90, 1e-6);
  EXPECT_NEAR(setpoint().speed, 1.2 + 0.1 * 1.2 / PilotConfig().motion_s, 1e-6) << "it is 0.1 s behind";
  EXPECT_NEAR(setpoint().depth, 2, 1e-9) << "of the way-point";
  motion.version = 3;
  motion.velocity_W = {0, -1.2};
  script->hear(motion, now);
  at_place(0, 0);
  EXPECT_GT(setpoint().heading.degrees(), 0) << "an order for another route does not count";
  for (int i = 0; i < 6; ++i) at_place(0, 20);
  EXPECT_NEAR(setpoint().heading.degrees(), -11.3, 2) << "from where it is, not back to the old line";
}

// Abeam is not enough among bodies that move: it may be far off the line.
TEST_F(PilotTest, UnderAMotionTheLastWaypointIsPassedWithinItsRadiusOnly) {
  make();
  at_place(0, 0);
  script->hear(FollowOrder{1, {{20, 0, 1, 1.5}, {50, 0, 1, 1.5}}, {}, false}, now);
  const auto steered = [&](double north, double east, std::size_t waypoint) {
    script->hear(MotionOrder{1, waypoint, at(now), {north, east}, {1.5, 0}, at(now + 1)}, now);
    return only<WaypointPassed>(at_place(north, east));
  };
  const auto skipped = steered(5, 12, 1);
  ASSERT_EQ(skipped.size(), 1u) << "the motion leads past the first way-point";
  EXPECT_FALSE(skipped[0].reached || skipped[0].last);
  EXPECT_TRUE(steered(52, 12, 1).empty());
  const auto passed = steered(48, 2, 1);
  ASSERT_EQ(passed.size(), 1u);
  EXPECT_TRUE(passed[0].reached && passed[0].last);
}

TEST_F(PilotTest, TakesANewWayFromWhereItIs) {
  make();
  at_place(0, 0);
  script->hear(FollowOrder{1, {{200, 0, 1, 1}}, {}, false}, now);
  at_place(20, 0);
  script->hear(FollowOrder{2, {{20, 100, 1, 1}}, {}, false}, now);
  at_place(20, 0, 90);
  EXPECT_NEAR(setpoint().heading.degrees(), 90, 1);
}

TEST_F(PilotTest, HoldsThePlaceWhereItComesToRest) {
  vehicle.braking = 0.25;
  make();
  at_place(0, 0, 0, 1);
  script->hear(FollowOrder{}, now);
  at_place(0, 0, 0, 1);
  EXPECT_GT(setpoint().speed, 0) << "that place is 1^2 / (2 x 0.25) = 2 m ahead: no turning back";
  at_place(2, 0, 0, 0);
  EXPECT_NEAR(setpoint().speed, 0, 0.05);
}

// ledger: S3-22
TEST_F(PilotTest, LeavesThePlaceThatItHoldsForAMotionAndComesBack) {
  make();
  at_place(0, 0, 0, 0);
  script->hear(FollowOrder{3, {}, {}, false}, now);
  at_place(0, 0, 0, 0);
  script->hear(MotionOrder{3, 0, at(now), {0, 0}, {0, 0.4}, at(now + 1)}, now);
  at_place(0, 0, 0, 0);
  EXPECT_NEAR(setpoint().heading.degrees(), 90, 1e-6);
  EXPECT_GT(setpoint().speed, 0.3);
  for (int i = 0; i < 8; ++i) at_place(0, 6, 0, 0);
  EXPECT_NEAR(setpoint().heading.degrees(), -90, 1) << "no motion is ordered any more";
}

TEST_F(PilotTest, HoldsByCirclingWhereTheVehicleCannotHover) {
  vehicle.min_speed = 0.8;
  vehicle.limits.turning_radius = 6;
  make();
  Eigen::Vector2d p(0, 0);
  Angle psi;
  at_place(0, 0, 0, 1);
  script->hear(FollowOrder{}, now);
  double farthest = 0, most_ahead = 0;
  for (int i = 0; i < 3000; ++i) {
    at_place(p.x(), p.y(), psi.degrees(), 0.8);
    const Angle turn = (setpoint().heading - psi).wrapped();
    const double most = setpoint().speed / vehicle.limits.turning_radius * 0.1;
    psi = (psi + Angle::radians(std::clamp(turn.radians(), -most, most))).wrapped();
    p += 0.1 * setpoint().speed * Eigen::Vector2d(cos(psi), sin(psi));
    farthest = std::max(farthest, p.norm());
    most_ahead = std::max(most_ahead, p.x());
    ASSERT_GE(setpoint().speed, 0.8);
  }
  EXPECT_LT(farthest, 30);
  EXPECT_LT(most_ahead, 12) << "on its circle of 10 m at once";
}

TEST_F(PilotTest, KeepsAnAltitudeByTheReadingsOfABeamThatLooksDown) {
  make();
  MissionPlan plan;
  MissionOrder start;
  start.plan = std::make_shared<const MissionPlan>(plan);
  at_place(0, 0, 0, 1, 6);
  script->hear(start, now);
  script->hear(FollowOrder{1, {{500, 0, 1, 1}}, 4.0, false}, now);
  RangeReading down;
  down.max_range_m = 50;
  down.width = Angle::degrees(10);
  down.X_BS.rotation = Rotation::from_heading_pitch_roll({}, Angle::degrees(-90), {});
  for (int i = 0; i < 100; ++i) {
    down.time = at(now);
    down.range_m = 9.0;  // the bottom lies at 15 m
    script->hear(down, now);
    at_place(i * 0.1, 0, 0, 1, 6);
  }
  EXPECT_NEAR(setpoint().depth, 11, 0.2);
}

TEST_F(PilotTest, StopsWithoutNavigationAndSurfacesWithoutAnExecutiveOfficer) {
  make();
  at_place(0, 0);
  script->hear(FollowOrder{1, {{200, 0, 5, 1}}, {}, false}, now);
  at_place(0, 0);
  EXPECT_GT(setpoint().speed, 0.5);
  script->tick(now + 3);
  EXPECT_GT(setpoint().speed, 0.5);
  script->tick(now + 3.2);
  EXPECT_EQ(setpoint().speed, 0);

  now += 4;
  at_place(0, 0, 0, 1, 5);
  script->hear(AgentLost{"executive officer", false, ""}, now);
  at_place(0, 0, 0, 1, 5);
  EXPECT_EQ(setpoint().depth, 0);
}

}  // namespace
}  // namespace isobath
