// The last word: which order reaches the vehicle, and what it does when those who should speak are silent.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/mission/command/command_arbiter.hpp>
#include <limits>
#include <rapidcheck/gtest.h>
#include <tests/mission/scripted_agent.hpp>

namespace isobath {
namespace {

using test::at;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

VehicleParameters hoverer() { return {}; }
VehicleParameters torpedo() {
  VehicleParameters parameters;
  parameters.min_speed = 0.8;
  return parameters;
}

Setpoint set(double heading_deg, double depth, double speed) { return {Angle::degrees(heading_deg), depth, speed, 0}; }
HelmOrder order(double heading_deg, double depth, double speed) { return {set(heading_deg, depth, speed)}; }
SafetyAction action(SafetyActionKind kind, Setpoint setpoint = {}) { return {kind, setpoint, "sonar silent", "blind"}; }
Navigation here(double heading_deg, double depth) {
  Navigation n;
  n.X_WB.rotation = Rotation::from_heading(Angle::degrees(heading_deg));
  n.X_WB.translation.z() = depth;
  return n;
}

void expect_setpoint(const Setpoint& s, double heading_deg, double depth, double speed) {
  EXPECT_NEAR(s.heading.degrees(), heading_deg, 1e-9);
  EXPECT_NEAR(s.depth, depth, 1e-9);
  EXPECT_NEAR(s.speed, speed, 1e-9);
  EXPECT_EQ(s.sway_speed, 0);
}

TEST(CommandArbiter, AnOrderPassesAsItIs) {
  CommandArbiter arbiter({}, torpedo());
  arbiter.on_message(order(30, 5, 1.5), at(0));
  expect_setpoint(arbiter.steer(at(0)), 30, 5, 1.5);
  EXPECT_EQ(arbiter.state(), HelmState::kOrders);
}

MissionOrder start(double max_depth_m) {
  MissionPlan plan;
  plan.limits.max_depth_m = max_depth_m;
  return {MissionOrder::Kind::kStart, std::make_shared<const MissionPlan>(plan), MissionEnd::kHold, ""};
}

// Whoever orders it: an agent from a library may.
// ledger: S5-01 S6-37 S6-42
TEST(CommandArbiter, NothingGoesOutThatVehicleOrMissionDoNotAllow) {
  VehicleParameters parameters = hoverer();
  parameters.limits.max_depth = 40;
  parameters.limits.max_speed = 2;
  CommandArbiter arbiter({2, ""}, parameters);
  arbiter.on_message(order(30, 39, 2), at(0));
  expect_setpoint(arbiter.steer(at(0)), 30, 39, 2);
  EXPECT_EQ(arbiter.limited(), 0u);
  arbiter.on_message(order(30, 50, 5), at(0));
  expect_setpoint(arbiter.steer(at(0)), 30, 40, 2);
  arbiter.on_message(order(30, -3, -5), at(0));
  expect_setpoint(arbiter.steer(at(0)), 30, 0, -2);
  arbiter.on_message(start(10), at(1));
  arbiter.on_message(order(30, 39, 1), at(1));
  expect_setpoint(arbiter.steer(at(1)), 30, 10, 1);
  arbiter.on_message(action(SafetyActionKind::kTurn, set(90, 39, 1)), at(1));
  expect_setpoint(arbiter.steer(at(1)), 90, 10, 1);
  EXPECT_EQ(arbiter.limited(), 4u);
  arbiter.on_message(action(SafetyActionKind::kNone), at(1));
  arbiter.on_message(HelmOrder{{Angle::degrees(30), 5, 1.2, 4}}, at(1));
  const Setpoint s = arbiter.steer(at(1));
  EXPECT_NEAR(std::hypot(s.speed, s.sway_speed), 2, 1e-9) << "sway gives way";
  EXPECT_EQ(s.speed, 1.2);
}

TEST(CommandArbiter, WaitsWhereItIsForTheFirstOrder) {
  CommandArbiter arbiter({}, torpedo());
  arbiter.on_message(here(40, 3), at(0));
  expect_setpoint(arbiter.steer(at(1)), 40, 3, 0);
  EXPECT_EQ(arbiter.state(), HelmState::kWaiting);
  EXPECT_FALSE(arbiter.take_change());
}

// Whoever orders from a back seat has the vehicle while he speaks, and again when he speaks again. ledger: S5-01
TEST(CommandArbiter, StopsWhenOrdersAreOlderThanItsPatience) {
  CommandArbiter arbiter({2, ""}, hoverer());
  arbiter.on_message(order(30, 5, 1.5), at(10));
  arbiter.on_message(here(50, 4), at(11.5));
  arbiter.steer(at(12));
  EXPECT_EQ(arbiter.state(), HelmState::kOrders);
  expect_setpoint(arbiter.steer(at(12) + Duration(1)), 50, 4, 0);
  EXPECT_EQ(arbiter.state(), HelmState::kStop);
  arbiter.on_message(here(70, 2), at(13));  // what it keeps is what it had when it was stopped
  expect_setpoint(arbiter.steer(at(13)), 50, 4, 0);
  arbiter.on_message(order(30, 5, 1.5), at(14));
  expect_setpoint(arbiter.steer(at(14)), 30, 5, 1.5);
}

TEST(CommandArbiter, StopsAlsoWhereNoOrderEverCame) {
  CommandArbiter arbiter({2, ""}, hoverer());
  arbiter.steer(at(50));
  arbiter.on_message(OperatorCommand{OperatorCommand::Kind::kStart, nullptr}, at(100));
  arbiter.steer(at(102));
  EXPECT_EQ(arbiter.state(), HelmState::kWaiting);
  arbiter.steer(at(102.1));
  EXPECT_EQ(arbiter.state(), HelmState::kStop);
}

// Its propeller stems what comes from ahead or from astern (200 degrees); nothing stems what comes from the side.
// ledger: S2-28
TEST(CommandArbiter, AVehicleThatStopsTurnsItsBowToTheCurrent) {
  for (const double from_deg : {10.0, 95.0, 170.0, 200.0, 275.0}) {
    CommandArbiter arbiter({}, hoverer());
    const Angle from = Angle::degrees(from_deg);
    const Eigen::Vector2d current = -0.3 * Eigen::Vector2d(cos(from), sin(from));
    Angle heading = Angle::degrees(20);
    Eigen::Vector2d bow = Eigen::Vector2d::Zero(), drift = Eigen::Vector2d::Zero();
    for (int tick = 0; tick < 1200; ++tick) {
      bow = {cos(heading), sin(heading)};
      drift = current - current.dot(bow) * bow;
      Navigation fix = here(heading.degrees(), 5);
      fix.v_WB.emplace(drift.x(), drift.y(), 0);
      arbiter.on_message(fix, at(tick));
      arbiter.on_message(action(SafetyActionKind::kStop), at(tick));
      const Setpoint s = arbiter.steer(at(tick));
      EXPECT_EQ(s.speed, 0);
      const double turn = (s.heading - heading).wrapped().radians();
      heading = (heading + Angle::radians(std::clamp(turn, -0.01, 0.01))).wrapped();  // at most 6 degrees a second
    }
    EXPECT_LT(drift.norm(), 0.04) << from_deg;
    EXPECT_TRUE(current.dot(bow) < 0 || from_deg == 200) << "the current comes from ahead: " << from_deg;
  }
}

// ledger: S2-28 S2-E10
TEST(CommandArbiter, AVehicleThatNeedsWayOnSurfacesInsteadOfStopping) {
  for (const bool by_silence : {true, false}) {
    CommandArbiter arbiter({2, ""}, torpedo());
    arbiter.on_message(order(30, 5, 1.5), at(0));
    arbiter.on_message(here(25, 6), at(0));
    arbiter.steer(at(0));
    if (!by_silence) arbiter.on_message(action(SafetyActionKind::kStop), at(1));
    expect_setpoint(arbiter.steer(at(by_silence ? 3 : 1)), 25, 0, 0.8);
    EXPECT_EQ(arbiter.state(), HelmState::kStop);
  }
}

// ledger: S2-28
TEST(CommandArbiter, TheSafetyOfficerStandsAboveTheOrderAtOnce) {
  CommandArbiter arbiter({}, hoverer());
  arbiter.on_message(order(30, 5, 1.5), at(0));
  arbiter.on_message(here(25, 6), at(0));
  arbiter.on_message(action(SafetyActionKind::kSlow, set(0, 0, 0.4)), at(0));
  expect_setpoint(arbiter.steer(at(0)), 30, 5, 0.4);
  arbiter.on_message(action(SafetyActionKind::kTurn, set(90, 2, -0.5)), at(0));
  expect_setpoint(arbiter.steer(at(0)), 90, 2, -0.5);
  arbiter.on_message(action(SafetyActionKind::kStop), at(0));
  expect_setpoint(arbiter.steer(at(0)), 25, 6, 0);
  arbiter.on_message(action(SafetyActionKind::kSurface, set(70, 0, 0)), at(0));  // away from what stands ahead
  expect_setpoint(arbiter.steer(at(0)), 70, 0, 0);
  arbiter.on_message(order(31, 5, 1.5), at(0.5));  // orders do not lift it
  expect_setpoint(arbiter.steer(at(0.5)), 70, 0, 0);
  arbiter.on_message(action(SafetyActionKind::kNone), at(1));
  expect_setpoint(arbiter.steer(at(1)), 31, 5, 1.5);
}

TEST(CommandArbiter, SlowsAsternAndSidewaysToo) {
  CommandArbiter arbiter({}, hoverer());
  arbiter.on_message(HelmOrder{{Angle(), 1, -1, 0.9}}, at(0));
  arbiter.on_message(action(SafetyActionKind::kSlow, set(0, 0, 0.3)), at(0));
  const Setpoint s = arbiter.steer(at(0));
  EXPECT_EQ(s.speed, -0.3);
  EXPECT_EQ(s.sway_speed, 0.3);
}

// ledger: S2-E10
TEST(CommandArbiter, NeverSlowsOrTurnsAVehicleBelowItsLeastSpeed) {
  CommandArbiter arbiter({}, torpedo());
  arbiter.on_message(order(30, 5, 1.5), at(0));
  arbiter.on_message(action(SafetyActionKind::kSlow, set(0, 0, 0.4)), at(0));
  expect_setpoint(arbiter.steer(at(0)), 30, 5, 0.8);
  arbiter.on_message(action(SafetyActionKind::kTurn, set(90, 2, 0.1)), at(0));
  expect_setpoint(arbiter.steer(at(0)), 90, 2, 0.8);
  arbiter.on_message(action(SafetyActionKind::kSurface), at(0));
  EXPECT_EQ(arbiter.steer(at(0)).speed, 0.8);
}

TEST(CommandArbiter, SilenceOfThePilotOutweighsALimitOfSpeedButNoTurn) {
  CommandArbiter arbiter({2, ""}, hoverer());
  arbiter.on_message(order(30, 5, 1.5), at(0));
  arbiter.on_message(action(SafetyActionKind::kSlow, set(0, 0, 0.4)), at(0));
  arbiter.steer(at(3));
  EXPECT_EQ(arbiter.state(), HelmState::kStop);
  arbiter.on_message(action(SafetyActionKind::kTurn, set(90, 2, 1)), at(3));
  expect_setpoint(arbiter.steer(at(9)), 90, 2, 1);
}

// ledger: S6-33
TEST(CommandArbiter, SurfacesForGoodWhenTheSafetyOfficerIsLost) {
  CommandArbiter arbiter({2, "safety officer"}, hoverer());
  arbiter.on_message(order(30, 5, 1.5), at(0));
  arbiter.on_message(here(25, 6), at(0));
  arbiter.on_message(AgentLost{"navigator", false, "bad leg"}, at(0));
  expect_setpoint(arbiter.steer(at(0)), 30, 5, 1.5);
  arbiter.on_message(AgentLost{"safety officer", true, "no answer"}, at(0));
  expect_setpoint(arbiter.steer(at(0)), 25, 0, 0);
  arbiter.on_message(action(SafetyActionKind::kNone), at(1));
  arbiter.on_message(order(30, 5, 1.5), at(1));
  expect_setpoint(arbiter.steer(at(1)), 25, 0, 0);
  EXPECT_EQ(arbiter.take_change()->reason, "the safety officer is lost: no answer");
}

TEST(CommandArbiter, SaysEachChangeOnceAndWhy) {
  CommandArbiter arbiter({2, ""}, hoverer());
  arbiter.on_message(order(30, 5, 1.5), at(0));
  arbiter.steer(at(0));
  EXPECT_EQ(arbiter.take_change()->what, "follow orders");
  arbiter.on_message(order(31, 5, 1.5), at(1));
  arbiter.steer(at(1));
  EXPECT_FALSE(arbiter.take_change());
  arbiter.steer(at(4));
  const auto stopped = arbiter.take_change();
  ASSERT_TRUE(stopped);
  EXPECT_EQ(stopped->agent, "helm gate");
  EXPECT_EQ(stopped->what, "stop");
  EXPECT_EQ(stopped->reason, "no order for the vehicle for 2 s");
  EXPECT_EQ(stopped->time, at(4));
  arbiter.on_message(action(SafetyActionKind::kStop), at(4));  // the same act for another reason
  arbiter.steer(at(4));
  EXPECT_EQ(arbiter.take_change()->reason, "blind");
}

TEST(CommandArbiter, RefusesWhatIsNotFinite) {
  CommandArbiter arbiter({2, ""}, hoverer());
  arbiter.on_message(order(30, 5, 1.5), at(0));
  arbiter.on_message(order(kNan, 5, 1.5), at(1));
  arbiter.on_message(order(30, std::numeric_limits<double>::infinity(), 1.5), at(1));
  arbiter.on_message(here(10, kNan), at(1));
  expect_setpoint(arbiter.steer(at(1)), 30, 5, 1.5);
  EXPECT_EQ(arbiter.refused(), 2u);
  arbiter.steer(at(2.5));
  EXPECT_EQ(arbiter.state(), HelmState::kStop);  // those were no orders
  for (const SafetyActionKind kind : {SafetyActionKind::kSlow, SafetyActionKind::kTurn}) {
    arbiter.on_message(order(30, 5, 1.5), at(3));
    arbiter.on_message(action(kind, set(0, 0, kNan)), at(3));
    arbiter.steer(at(3));
    EXPECT_EQ(arbiter.state(), HelmState::kStop);
  }
  EXPECT_EQ(arbiter.refused(), 4u);
}

/// A number or none at all.
double any_number(int draw) { return draw % 7 == 0 ? kNan : 0.1 * draw; }

// ledger: S2-E10
RC_GTEST_PROP(CommandArbiter, WhateverItHearsTheSetpointIsFiniteAndFitsItsState, ()) {
  const VehicleParameters parameters = *rc::gen::arbitrary<bool>() ? torpedo() : hoverer();
  CommandArbiter arbiter({2, "safety officer"}, parameters);
  double t = 0;
  const auto draws = *rc::gen::container<std::vector<std::vector<int>>>(
      rc::gen::container<std::vector<int>>(5, rc::gen::inRange(-100, 100)));
  for (const auto& d : draws) {
    t += 0.02 * std::abs(d[0]);
    const Setpoint s = set(any_number(d[2]), any_number(d[3]), any_number(d[4]));
    switch (std::abs(d[1]) % 5) {
      case 0: arbiter.on_message(HelmOrder{s}, at(t)); break;
      case 1: arbiter.on_message(action(static_cast<SafetyActionKind>(std::abs(d[2]) % 5), s), at(t)); break;
      case 2: arbiter.on_message(here(s.heading.degrees(), s.depth), at(t)); break;
      case 3: arbiter.on_message(AgentLost{d[2] > 95 ? "safety officer" : "pilot", false, ""}, at(t)); break;
      default: break;
    }
    const Setpoint out = arbiter.steer(at(t));
    RC_ASSERT(std::isfinite(out.heading.radians()));
    RC_ASSERT(std::isfinite(out.depth));
    RC_ASSERT(std::isfinite(out.speed));
    RC_ASSERT(out.depth >= 0.0 && out.depth <= parameters.limits.max_depth);
    RC_ASSERT(std::abs(out.speed) <= parameters.limits.max_speed);
    const bool stopped = arbiter.state() == HelmState::kStop;
    const bool surfacing = arbiter.state() == HelmState::kSurface;
    if (stopped) RC_ASSERT(out.speed == parameters.min_speed);
    if (surfacing) RC_ASSERT(out.speed >= parameters.min_speed);  // a vehicle that cannot stop may be on its way out
    if (surfacing && parameters.min_speed == 0) RC_ASSERT(out.speed == 0.0);
    const bool rises = surfacing || (stopped && parameters.min_speed > 0);
    if (rises) RC_ASSERT(out.depth == 0.0);
  }
}

}  // namespace
}  // namespace isobath
