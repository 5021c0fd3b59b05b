// The steering rules of the sea (COLREGs, rules 13 to 17): which role the vehicle has toward a body, how long, and what
// a plan does under it. ledger: S3-01 S3-03
#include <gtest/gtest.h>
#include <isobath/planning/traffic/traffic_planner.hpp>
#include <limits>
#include <numbers>

namespace isobath::rules_of_the_road {
namespace {

using Eigen::Vector2d;
using enum SteeringRole;

constexpr double kDeg = std::numbers::pi / 180;

Vector2d toward(double degrees) { return {std::cos(degrees * kDeg), std::sin(degrees * kDeg)}; }
Time after(double s) { return Time{} + seconds(s); }

MovingBody vessel(int number, const Vector2d& p, const Vector2d& velocity, double at_s = 0) {
  MovingBody body;
  body.number = number;
  body.p_W = p;
  body.velocity_W = velocity;
  body.radius_m = 0.5;
  body.time = after(at_s);
  return body;
}

/// A body at a bearing from the bow of a vehicle that goes north, which sees the vehicle at an aspect from its own bow.
PlaneMotion seen(double bearing_deg, double aspect_deg, double speed = 1) {
  return {30 * toward(bearing_deg), speed * toward(bearing_deg + 180 - aspect_deg)};
}

// Rules --------------------------------------------------------------------------------------------------------------

TEST(RulesOfTheRoad, RolesFollowTheSectorsOfRules13To17) {
  struct Row {
    double bearing_deg, aspect_deg;
    SteeringRole role;
  };
  for (const Row& row : {Row{0, 0, kHeadOn},
                         {9.9, 0, kHeadOn},
                         {10.1, 0, kGiveWay},
                         {-10.1, 0, kStandOn},
                         {5, -14.9, kHeadOn},
                         {5, -15.1, kGiveWay},
                         {-5, 15.1, kStandOn},
                         {90, -60, kGiveWay},
                         {-90, 60, kStandOn},
                         {112.4, -20, kGiveWay},
                         {112.6, -20, kOvertaken},
                         {-112.4, 20, kStandOn},
                         {-112.6, 20, kOvertaken},
                         {180, 0, kOvertaken},
                         {20, -112.4, kGiveWay},
                         {20, -112.6, kOvertaking},
                         {-20, 112.4, kStandOn},
                         {-20, 112.6, kOvertaking},
                         {0, 180, kOvertaking}}) {
    EXPECT_EQ(role_toward({{0, 0}, {1.5, 0}}, seen(row.bearing_deg, row.aspect_deg), 0.3), row.role)
        << row.bearing_deg << " from the bow, seen at " << row.aspect_deg;
  }
}

TEST(RulesOfTheRoad, ABodyWithoutACourseHasNoRole) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(role_toward({{0, 0}, {1.5, 0}}, seen(0, 0, 0.29), 0.3), kNone);
  EXPECT_EQ(role_toward({{0, 0}, {0.2, 0}}, seen(0, 0), 0.3), kNone);
  EXPECT_EQ(role_toward({{0, 0}, {1.5, 0}}, {{nan, 0}, {1, 0}}, 0.3), kNone);
  EXPECT_EQ(role_toward({{0, 0}, {1.5, 0}}, {{9, 0}, {-INFINITY, 0}}, 0.3), kNone);
}

// Roles over time ----------------------------------------------------------------------------------------------------

class Roles : public testing::Test {
 protected:
  /// The vehicle goes toward a heading at 1.5 m/s; it wants to go north.
  SteeringRole role(const MovingBody& body, const Vector2d& place = {0, 0}, double heading_deg = 0) {
    own = {place, heading_deg * kDeg, 1.5};
    now = body.time;
    rules.update(own, {1.5, 0}, now, std::span(&body, 1));
    for (const SteeringDuty& duty : rules.duties()) {
      if (duty.number == body.number) return duty.role;
    }
    return kNone;
  }
  SteeringRulesConfig config;
  RulesOfTheRoad rules{config, 0.5};
  MotionState own;
  Time now;
};

TEST_F(Roles, BeginOnlyWhereThereIsRiskOfCollision) {
  EXPECT_EQ(role(vessel(1, {30, 20}, {0, -1})), kGiveWay) << "both are there after 20 s";
  EXPECT_EQ(role(vessel(2, {30, 32}, {0, -1})), kNone) << "it passes 6 m off";
  EXPECT_EQ(role(vessel(3, {90, 60}, {0, -1})), kNone) << "after 60 s";
  EXPECT_EQ(role(vessel(4, {30, 20}, {0, 1})), kNone) << "it goes away";
}

// Rule 13 d: no later change of the bearing changes the role.
TEST_F(Roles, AreKeptUntilTheBodyIsPastAndClear) {
  ASSERT_EQ(role(vessel(1, {30, 20}, {0, -1}, 0)), kGiveWay);
  EXPECT_EQ(role(vessel(1, {30, 10}, {0, -1}, 10), {12, 6}, 40), kGiveWay) << "the vehicle has turned to starboard";
  EXPECT_EQ(role(vessel(1, {30, 6}, {0, -1}, 14), {17, 7}, 20), kGiveWay);
  EXPECT_EQ(role(vessel(1, {30, 3}, {0, -1}, 17), {24, 6}, 0), kGiveWay) << "it is to port now";
  EXPECT_EQ(role(vessel(1, {30, 1.5}, {0, -1}, 18.5), {26.2, 6}, 0), kGiveWay);
  EXPECT_EQ(role(vessel(1, {30, 0}, {0, -1}, 20), {28.5, 6}, 0), kGiveWay) << "past, but not for 2 s";
  EXPECT_EQ(role(vessel(1, {30, -1}, {0, -1}, 21), {30, 6}, 0), kNone) << "past and clear";
  EXPECT_EQ(role(vessel(1, {32, -4}, {1.5, 1}, 25), {36, 6}, 0), kStandOn) << "it comes back: a new encounter";
}

TEST_F(Roles, EndWhereTheBodyIsNotSeenOrJumps) {
  ASSERT_EQ(role(vessel(1, {30, 20}, {0, -1}, 0)), kGiveWay);
  EXPECT_EQ(role(vessel(1, {30, -20}, {0, 1}, 0.1)), kStandOn) << "40 m away at once: another body";
  role(vessel(2, {300, 0}, {0, 1}, 4));
  EXPECT_EQ(rules.duties().size(), 1u);
  role(vessel(2, {300, 0}, {0, 1}, 5.2));
  EXPECT_TRUE(rules.duties().empty()) << "not seen for 5 s";
}

TEST_F(Roles, EndWhereTheBodyStops) {
  ASSERT_EQ(role(vessel(1, {30, 20}, {0, -1}, 0)), kGiveWay);
  EXPECT_EQ(role(vessel(1, {30, 19}, {0, -0.1}, 1), {1.5, 0}), kGiveWay) << "it may go on";
  EXPECT_TRUE(rules.zones(own, now, 1).zones.empty());
  EXPECT_EQ(role(vessel(1, {30, 19}, {0, 0}, 5.1), {7.5, 0}), kNone);
}

TEST_F(Roles, AreNotChangedByWhatLiesStillUnderTheSameNumber) {
  ASSERT_EQ(role(vessel(1, {30, 20}, {0, -1}, 0)), kGiveWay);
  const std::vector<MovingBody> bodies = {vessel(1, {30, 19}, {0, -1}, 1), vessel(1, {90, -70}, {0, 0}, 1)};
  rules.update({{1.5, 0}, 0, 1.5}, {1.5, 0}, after(1), bodies);
  EXPECT_EQ(rules.duties(), (std::vector<SteeringDuty>{{1, kGiveWay, false}}));
}

TEST_F(Roles, StatesThatAreNotFiniteAreLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(role(vessel(1, {nan, 20}, {0, -1})), kNone);
  EXPECT_EQ(role(vessel(1, {30, 20}, {0, nan})), kNone);
  EXPECT_TRUE(rules.zones(own, now, 1).zones.empty());
}

// Rule 17 a ii.
TEST_F(Roles, TheVehicleStandsOnUntilTheTimeToAct) {
  for (const double t : {0.0, 4.0, 7.9}) {
    EXPECT_EQ(role(vessel(1, {30, -20 + t}, {0, 1}, t), {1.5 * t, 0}), kStandOn);
    EXPECT_TRUE(rules.stands_on_for(1)) << t;
  }
  role(vessel(1, {30, -11.9}, {0, 1}, 8.1), {12.15, 0});
  EXPECT_FALSE(rules.stands_on_for(1));
  EXPECT_TRUE(rules.acts_for(1));
}

// Zones --------------------------------------------------------------------------------------------------------------

TEST_F(Roles, ZonesTurnWithTheBody) {
  const auto zone_holds = [&](const Vector2d& p) {
    const RulesOfTheRoad::Zones all = rules.zones(own, now, 2);
    EXPECT_EQ(all.zones.size(), 1u);
    return !all.zones.empty() && distance_to(all.zones[0], p, 0) < 0;
  };
  role(vessel(1, {40, 26}, {0, -1}));
  EXPECT_TRUE(zone_holds({40, 7})) << "20 s of its way ahead";
  EXPECT_FALSE(zone_holds({40, 5}));
  EXPECT_FALSE(zone_holds({40, 27})) << "astern of it";
  role(vessel(1, {40, 26}, {-0.6, -0.8}));
  EXPECT_FALSE(zone_holds({40, 7}));
  EXPECT_TRUE(zone_holds({34, 18}));
}

TEST_F(Roles, TheZoneOfABodyMetHeadOnLiesOnItsStarboardSide) {
  ASSERT_EQ(role(vessel(1, {40, 0}, {-1, 0})), kHeadOn);
  const RulesOfTheRoad::Zones all = rules.zones(own, now, 2);
  ASSERT_EQ(all.zones.size(), 1u);
  EXPECT_LT(distance_to(all.zones[0], {31, -11}, 0), 0) << "it goes south: its starboard side is west";
  EXPECT_GT(distance_to(all.zones[0], {31, 1}, 0), 0);
  EXPECT_EQ(all.zones[0].number, 1);
}

TEST_F(Roles, AZoneThatWouldHoldTheVehicleIsShortenedOrLeftOut) {
  ASSERT_EQ(role(vessel(1, {12, 12}, {0, -1.5})), kGiveWay);
  const RulesOfTheRoad::Zones shorter = rules.zones({{12, -6}, 0, 1.5}, now, 2);
  ASSERT_EQ(shorter.zones.size(), 1u);
  EXPECT_GE(distance_to(shorter.zones[0], {12, -6}, 0), 2);
  EXPECT_LT(distance_to(shorter.zones[0], {12, 2}, 0), 0);
  const RulesOfTheRoad::Zones none = rules.zones({{12, 9}, 0, 1.5}, now, 2);
  EXPECT_TRUE(none.zones.empty());
  EXPECT_EQ(none.left_out, 1);
}

// Plans --------------------------------------------------------------------------------------------------------------

/// A vehicle that goes north to a goal 120 m away, at 1.5 m/s, among bodies that keep their velocities.
struct Passage120 {
  Passage120(bool rules, std::vector<MovingBody> bodies_of) : bodies(std::move(bodies_of)) {
    TrafficConfig config;
    config.margin_m = 1;
    config.rules.on = rules;
    planner.emplace(config, TrafficVehicle{});
    planner->set_goal({120, 0}, 1);
  }
  const TrafficPlan& step() {
    const TrafficPlan& plan = planner->step(own, now, bodies);
    own = plan.trajectory.at(to_seconds(now - plan.start) + 0.1);
    now += seconds(0.1);
    for (MovingBody& body : bodies) {
      body.p_W += 0.1 * body.velocity_W;
      body.time = now;
      gap_m = std::min(gap_m, distance_to(body, own.p_W, 0) - 0.5);
    }
    return plan;
  }
  /// Steps until the closest approach to the first body; the vehicle's place from it.
  Vector2d place_at_closest() {
    double least = std::numeric_limits<double>::infinity();
    Vector2d place(0, 0);
    while (to_seconds(now - Time{}) < 90 && own.p_W.x() < 118) {
      step();
      const Vector2d from = own.p_W - bodies[0].p_W;
      if (from.norm() < least) {
        least = from.norm();
        place = from;
      }
    }
    EXPECT_GE(own.p_W.x(), 118) << "it arrives";
    return place;
  }
  std::vector<MovingBody> bodies;
  std::optional<TrafficPlanner> planner;
  MotionState own{{0, 0}, 0, 1.5};
  Time now;
  double gap_m = std::numeric_limits<double>::infinity();
};

// Rule 14, also where the shorter way leads past the other side.
TEST(PlansByTheRules, AHeadOnBodyIsPassedPortToPort) {
  for (const double east_m : {-1.5, 0.0, 1.5}) {
    Passage120 ruled(true, {vessel(1, {60, east_m}, {-1, 0})});
    EXPECT_GT(ruled.place_at_closest().y(), 0) << "east of a body that goes south is its port side; " << east_m;
    EXPECT_GE(ruled.gap_m, 1) << east_m;
  }
  Passage120 free(false, {vessel(1, {60, 1.5}, {-1, 0})});
  EXPECT_LT(free.place_at_closest().y(), 0) << "without rules the nearer side is taken";
}

// Rules 15 and 16, also where the vehicle would be the first to pass.
TEST(PlansByTheRules, ABodyFromStarboardIsPassedAstern) {
  for (const double start_m : {36.0, 40.0, 43.5}) {
    Passage120 ruled(true, {vessel(1, {60, start_m}, {0, -1})});
    EXPECT_GT(ruled.place_at_closest().y(), 0) << "east of a body that goes west; " << start_m;
    EXPECT_GE(ruled.gap_m, 1) << start_m;
  }
  Passage120 free(false, {vessel(1, {60, 43.5}, {0, -1})});
  EXPECT_LT(free.place_at_closest().y(), 0) << "without rules it passes ahead";
}

// Rule 17 a i, a ii and c.
TEST(PlansByTheRules, TheVehicleStandsOnAndThenDoesNotTurnToPort) {
  for (const double start_m : {-36.0, -40.0, -43.0}) {
    Passage120 ruled(true, {vessel(1, {60, start_m}, {0, 1})});
    double acts_s = -1, to_port_deg = 0;
    while (ruled.own.p_W.x() < 75 && to_seconds(ruled.now - Time{}) < 80) {
      const TrafficPlan& plan = ruled.step();
      const bool acts = !plan.duties.empty() && plan.duties[0].acts;
      if (!acts && acts_s < 0) {
        EXPECT_NEAR(ruled.own.heading, 0, 1e-6) << start_m;
        EXPECT_NEAR(ruled.own.speed, 1.5, 1e-6) << start_m;
      }
      if (acts && acts_s < 0) acts_s = to_seconds(ruled.now - Time{});
      if (acts && ruled.own.p_W.x() < 60) to_port_deg = std::min(to_port_deg, ruled.own.heading / kDeg);
    }
    EXPECT_GT(acts_s, 40 - 12 - 3) << start_m;
    EXPECT_LT(acts_s, 40 - 12 + 3) << start_m;
    EXPECT_GT(to_port_deg, -5) << start_m << ": it slows down, or turns to starboard";
    EXPECT_GE(ruled.gap_m, 1) << start_m;
  }
}

// Rule 17: a body that overtakes keeps clear, until it is clear that it does not.
TEST(PlansByTheRules, TheVehicleKeepsItsCourseAheadOfABodyThatOvertakes) {
  Passage120 ruled(true, {vessel(1, {-36, -0.5}, {2.4, 0})});
  while (to_seconds(ruled.now - Time{}) < 27) {
    const TrafficPlan& plan = ruled.step();
    ASSERT_EQ(plan.duties.size(), 1u);
    EXPECT_EQ(plan.duties[0], (SteeringDuty{1, kOvertaken, false}));
    EXPECT_NEAR(ruled.own.p_W.y(), 0, 1e-6);
  }
  ruled.place_at_closest();
  EXPECT_GE(ruled.gap_m, 1);
}

// Rule 2 b: in a channel that is too narrow for rule 14.
TEST(PlansByTheRules, DepartFromThemWhereNoMotionFollowsThem) {
  std::vector<MovingBody> bodies = {vessel(1, {60, -0.5}, {-1, 0}), vessel(2, {35, 11.5}, {0, 0}),
                                    vessel(3, {35, -20}, {0, 0})};
  for (MovingBody& wall : std::span(bodies).last(2)) {
    wall.radius_m = 0;
    wall.outline = {{-40, -10}, {40, -10}, {40, 10}, {-40, 10}};
  }
  Passage120 ruled(true, bodies);
  ruled.own.p_W.y() = -1.5;
  bool departs = false;
  while (ruled.own.p_W.x() < 40 && to_seconds(ruled.now - Time{}) < 90) departs = ruled.step().departs || departs;
  EXPECT_TRUE(departs);
  EXPECT_GE(ruled.own.p_W.x(), 40);
  EXPECT_GE(ruled.gap_m, 0.9);
}

// What the vehicle must do for one body must not bring it near another that it stands on for.
TEST(PlansByTheRules, CountABodyThatTheVehicleStandsOnForWhenItManoeuvresForAnother) {
  Passage120 ruled(true, {vessel(1, {60, 0}, {-1, 0}), vessel(2, {-18, 4}, {2.1, 0})});
  ruled.place_at_closest();
  EXPECT_GE(ruled.gap_m, 1);
}

TEST(PlansByTheRules, AreTheSameAsWithoutThemWhereNoRuleApplies) {
  const auto plans = [](bool on) {
    Passage120 drive(on, {vessel(1, {30, -0.5}, {0, 0.1}), vessel(2, {70, 40}, {0, 1})});
    std::vector<double> all;
    for (int i = 0; i < 600; ++i) {
      const TrafficPlan& plan = drive.step();
      EXPECT_TRUE(plan.duties.empty());
      EXPECT_FALSE(plan.departs);
      all.insert(all.end(), {drive.own.p_W.x(), drive.own.p_W.y(), drive.own.speed, 1.0 * plan.number});
    }
    return all;
  };
  EXPECT_EQ(plans(false), plans(true));
}

TEST(PlansByTheRules, PassagesAreOfBodiesNotOfZones) {
  Passage120 ruled(true, {vessel(1, {60, 40}, {0, -1}), vessel(2, {60, -40}, {0, 1})});
  while (to_seconds(ruled.now - Time{}) < 25) ruled.step();
  int first = 0;
  for (const Passage& passage : ruled.planner->passages(ruled.now, 30)) first += passage.number == 1;
  EXPECT_EQ(first, 1) << "not of its zone";
}

}  // namespace
}  // namespace isobath::rules_of_the_road
