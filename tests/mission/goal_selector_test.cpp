// The Goal Selector under a script: sweeps with bodies that move, still hazards from the Navigator, and what it orders.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/mission/agents/goal_selector.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

using Eigen::Vector2d;

class GoalSelectorTest : public testing::Test {
 protected:
  GoalSelectorTest() {
    vehicle.hull_radius_m = 0.8;
    vehicle.limits.turning_radius = 4;
    vehicle.limits.max_speed = 2;
    make();
  }
  void make() {
    agent = std::make_unique<GoalSelector>(config, vehicle);
    script = std::make_unique<Script>(*agent);
    now = 0;
    place = {0, 0};
  }
  void order(const std::vector<Waypoint>& waypoints) { script->hear(FollowOrder{7, waypoints, {}, false}, now); }
  void still(const std::vector<Polygon>& outlines) {
    std::vector<Hazard> hazards;
    for (const Polygon& o : outlines) hazards.push_back({o, 0, HazardKind::kSeen});
    script->hear(StillHazards{at(now), std::make_shared<const std::vector<Hazard>>(std::move(hazards))}, now);
  }
  /// A square body of 2 m at a place of W; the vehicle's heading is north.
  void sweep(const Vector2d& at_W, const Vector2d& velocity_W) {
    auto map = std::make_shared<Detection>();
    map->time = at(now);
    map->X_WB = {Rotation(), {place.x(), place.y(), 0}};
    map->obstacles = {obstacle(square(at_W.x() - place.x(), at_W.y() - place.y(), 1), 0.99)};
    map->obstacles[0].number = 5;
    map->obstacles[0].motion = {.velocity_W = velocity_W, .track = 3};
    script->hear(Sweep{1, true, 0, map}, now);
  }
  std::vector<Message> go_to(const Vector2d& p_W, double speed = 1.5, Angle heading = {}) {
    now += 0.1;
    place = p_W;
    script->hear(fix(now, p_W.x(), p_W.y(), heading.degrees(), speed), now);
    return script->tick(now);
  }

  GoalSelectorConfig config;
  VehicleParameters vehicle;
  std::unique_ptr<GoalSelector> agent;
  std::unique_ptr<Script> script;
  double now = 0;
  Vector2d place;
};

TEST_F(GoalSelectorTest, IsSilentWithoutABodyThatMovesWithinReach) {
  order({{100, 0, 1, 1.5}});
  still({});
  EXPECT_TRUE(go_to({0, 0}).empty()) << "nothing moves";
  sweep({150, 0}, {0, 0.5});
  EXPECT_TRUE(go_to({0, 0}).empty()) << "it cannot be met within the horizon";
  sweep({30, 0}, {0, 0.5});
  EXPECT_EQ(only<MotionOrder>(go_to({0, 0})).size(), 1u);
}

// The places that it orders, one after the other, keep the margin from a body that crosses; straight ahead would meet
// it. A decision tells when it passes, and how near. ledger: S3-21 S3-22 S3-30
TEST_F(GoalSelectorTest, OrdersAMotionThatKeepsTheMarginFromABodyThatCrosses) {
  order({{60, 0, 1, 1.5}});
  const auto body_at = [](double s) { return Vector2d(24, -16 + s); };  // at 16 s it is in the way, where it is met
  Vector2d own(0, 0);
  double least = INFINITY, straight = INFINITY;
  while (own.x() < 50 && now < 60) {
    if (std::abs(std::remainder(now, 0.6)) < 0.05) {
      still({});
      sweep(body_at(now), {0, 1});
    }
    for (const MotionOrder& motion : only<MotionOrder>(go_to(own))) {
      EXPECT_EQ(motion.version, 7u);
      EXPECT_EQ(motion.at, at(now + vehicle.heading_lag_s));
      EXPECT_LT((motion.place_W - own).norm(), config.track_m);
      own += 0.1 * motion.velocity_W;
    }
    const auto gap = [&](const Vector2d& p) {
      return (p - nearest_point(square(body_at(now).x(), body_at(now).y(), 1), p)).norm() - vehicle.hull_radius_m;
    };
    least = std::min(least, gap(own));
    straight = std::min(straight, gap({1.5 * now, 0}));
  }
  EXPECT_LT(straight, 0);
  EXPECT_GE(own.x(), 50);
  EXPECT_GT(least, config.planner.margin_m - config.track_m);
  auto told = only<Decision>(script->said);
  std::erase_if(told, [](const Decision& d) { return d.what == "situation"; });
  ASSERT_GE(told.size(), 1u);
  EXPECT_EQ(told[0].obstacle_number, 5);
  ASSERT_TRUE(told[0].approach);
  EXPECT_GE(told[0].approach->gap_m, config.planner.margin_m - 0.01);
  EXPECT_GE(static_cast<double>(told[0].way.size()), told[0].approach->in_s) << "a place a second, until it is passed";
  EXPECT_LE(static_cast<double>(told.size()), 1 + now / GoalSelector::kTellAgain_s) << "once in a while";
}

// A body lies 6 m ahead of a vehicle that cannot stop and begins to hold its position, and drifts across its circle to
// starboard: it is steered past the body, and stays about its place. ledger: S3-22
TEST_F(GoalSelectorTest, SteersAVehicleThatHoldsItsPositionPastABody) {
  vehicle.min_speed = 0.8;
  make();
  go_to({0, 0});
  order({});
  const auto body_at = [](double s) { return Vector2d(7 - 0.05 * s, 3 + 0.2 * s); };
  const auto gap = [&](const Vector2d& p) {
    return (p - nearest_point(square(body_at(now).x(), body_at(now).y(), 1), p)).norm() - vehicle.hull_radius_m;
  };
  Vector2d own(0, 0);
  Angle heading;
  double least = INFINITY, circling = INFINITY, farthest = 0;
  for (int k = 0; k < 600; ++k) {
    if (k % 6 == 0) {
      still({});
      sweep(body_at(now), {-0.05, 0.2});
    }
    const auto orders = only<MotionOrder>(go_to(own, 0.85, heading));
    ASSERT_EQ(orders.size(), 1u) << now;
    own += 0.1 * orders[0].velocity_W;
    heading = Angle::radians(std::atan2(orders[0].velocity_W.y(), orders[0].velocity_W.x()));
    least = std::min(least, gap(own));
    const double turned = 0.8 * now / 5.2;  // on a circle of 1.3 times the turning radius
    circling = std::min(circling, gap({5.2 * std::sin(turned), 5.2 * (1 - std::cos(turned))}));
    farthest = std::max(farthest, own.norm());
  }
  EXPECT_LT(circling, 0);
  EXPECT_GT(least, config.planner.margin_m - config.track_m);
  EXPECT_LT(farthest, 20);
}

// A wall to starboard: the vehicle that cannot stop circles to port. One that hovers stays where it is.
TEST_F(GoalSelectorTest, SteersAVehicleThatCirclesPastWhatLiesStill) {
  for (const double min_speed : {0.0, 0.8}) {
    vehicle.min_speed = min_speed;
    make();
    go_to({0, 0});
    order({});
    Vector2d own(0, 0);
    Angle heading;
    double most_east = 0, most_west = 0;
    for (int k = 0; k < 600; ++k) {
      if (k % 6 == 0) still({{{-40, 4}, {40, 4}, {40, 6}, {-40, 6}}});
      const auto orders = only<MotionOrder>(go_to(own, 0.85, heading));
      ASSERT_EQ(orders.size(), min_speed > 0 ? 1u : 0u) << now;
      if (orders.empty()) continue;
      own += 0.1 * orders[0].velocity_W;
      heading = Angle::radians(std::atan2(orders[0].velocity_W.y(), orders[0].velocity_W.x()));
      most_east = std::max(most_east, own.y());
      most_west = std::min(most_west, own.y());
    }
    EXPECT_LT(most_east, 4 - vehicle.hull_radius_m - config.planner.margin_m + config.track_m);
    EXPECT_LE(most_west, min_speed > 0 ? -1.5 * vehicle.limits.turning_radius : 0);
  }
}

TEST_F(GoalSelectorTest, SteersNoVehicleThatSurfaces) {
  go_to({0, 0});
  script->hear(FollowOrder{8, {}, {}, true}, now);
  still({});
  sweep({10, 0}, {0, 0.3});
  EXPECT_TRUE(only<MotionOrder>(go_to({0, 0})).empty());
}

// A wall between the vehicle and the last way-point: the corner of the route is the goal until the point is in sight.
TEST_F(GoalSelectorTest, TakesTheLastWaypointThatIsInSight) {
  order({{20, 15, 1, 1.5}, {60, 0, 1, 1.5}});
  still({{{18, -20}, {22, -20}, {22, 8}, {18, 8}}});
  sweep({30, 24}, {0, 0.3});
  EXPECT_EQ(only<MotionOrder>(go_to({0, 0})).at(0).waypoint, 0u);
  EXPECT_EQ(only<MotionOrder>(go_to({20, 15})).at(0).waypoint, 1u);
}

// ledger: S3-03 S3-37
TEST_F(GoalSelectorTest, SaysInWhichSituationItIsAndChangesItsParametersWithIt) {
  const auto situations = [&] {
    std::vector<std::string> all;
    for (const Decision& d : only<Decision>(script->said)) {
      if (d.what == "situation") all.push_back(d.reason);
    }
    return all;
  };
  const auto speed_of_order = [&](const Vector2d& own) {
    const auto orders = only<MotionOrder>(go_to(own));
    return orders.empty() ? 0 : orders[0].velocity_W.norm();
  };
  vehicle.min_speed = 0.7;
  make();
  order({{100, 0, 1, 1.5}});
  still({});
  sweep({30, 15}, {0, -0.3});
  EXPECT_NEAR(speed_of_order({0, 0}), 1.5, 0.1);
  ASSERT_EQ(situations(), std::vector<std::string>{"crossing traffic: a body that moves is within reach"});
  // One comes from astern at 2 m/s. As long as it does, the plan may use more than the speed of the order.
  for (double t = 0; t < 3; t += 0.1) {
    still({});
    sweep({-9 + 2 * t, 0.5}, {2, 0});
    speed_of_order({1.5 * t, 0});
  }
  ASSERT_EQ(situations().size(), 2u);
  EXPECT_EQ(situations()[1], "pursued: obstacle 5 comes from astern at 2.0 m/s");
  EXPECT_GT(speed_of_order({4.5, 0}), 1.6);
  // Four walls stand round it: it can neither stop nor turn.
  still({{{9, -6}, {10, -6}, {10, 6}, {9, 6}},
         {{1, -6}, {2, -6}, {2, 6}, {1, 6}},
         {{1, 4}, {10, 4}, {10, 5}, {1, 5}},
         {{1, -5}, {10, -5}, {10, -4}, {1, -4}}});
  sweep({20, 4}, {-0.5, -0.5});
  go_to({4.6, 0});
  go_to({4.7, 0});
  ASSERT_EQ(situations().size(), 3u);
  EXPECT_EQ(situations()[2].substr(0, 9), "blocked: ");
  // The walls are gone, and then the body is: each less urgent situation begins after a while.
  still({});
  sweep({90, 90}, {0, 0.2});
  for (double t = 0; t < 20; t += 0.1) go_to({4.6, 0});
  EXPECT_EQ(situations().back(), "clear: no body that moves is within reach");
}

// ledger: S2-28
TEST_F(GoalSelectorTest, LeavesTheLastWordToTheSafetyOfficer) {
  order({{100, 0, 1, 1.5}});
  still({});
  sweep({30, 0}, {0, 0.5});
  SafetyAction turn;
  turn.kind = SafetyActionKind::kTurn;
  script->hear(turn, now);
  EXPECT_TRUE(go_to({0, 0}).empty());
  script->hear(SafetyAction{}, now);
  EXPECT_EQ(only<MotionOrder>(go_to({0, 0})).size(), 1u);
  config.on = false;
  make();
  order({{100, 0, 1, 1.5}});
  still({});
  sweep({30, 0}, {0, 0.5});
  EXPECT_TRUE(go_to({0, 0}).empty()) << "switched off";
}

// Its velocity is hardly known: by three sigma it could be anywhere in 20 s, and no water ahead would be free.
TEST_F(GoalSelectorTest, BoundsHowFarAnUnknownVelocityClosesTheWater) {
  order({{100, 0, 1, 1.5}});
  still({});
  for (int i = 0; i < 2; ++i) {
    auto map = std::make_shared<Detection>();
    map->time = at(now);
    for (const double east : {-8.0, 8.0}) {
      map->obstacles.push_back(obstacle(square(30, east, 1), 0.99));
      map->obstacles.back().motion = {.velocity_W = {0, 0},
                                      .velocity_covariance = 0.25 * Eigen::Matrix2d::Identity(),
                                      .track = static_cast<std::uint32_t>(3 + map->obstacles.size())};
    }
    script->hear(Sweep{1, true, 0, map}, now);
    const auto motion = only<MotionOrder>(go_to({0, 0}));
    ASSERT_EQ(motion.size(), 1u);
    EXPECT_NEAR(motion[0].velocity_W.y(), 0, 0.2) << "between them";
  }
}

/// A body of the rules of the road that keeps its velocity, from its place at 0 s, and what is said of it.
class GoalSelectorByRules : public GoalSelectorTest {
 protected:
  std::vector<std::string> told(const Vector2d& body_W, const Vector2d& velocity_W, double until_s) {
    config.planner.rules.on = true;
    make();
    order({{120, 0, 1, 1.5}});
    Vector2d own(0, 0);
    while (now < until_s) {
      if (std::abs(std::remainder(now, 0.5)) < 0.05) {
        still({});
        sweep(body_W + now * velocity_W, velocity_W);
      }
      for (const MotionOrder& motion : only<MotionOrder>(go_to(own))) {
        own += 0.1 * motion.velocity_W;
      }
    }
    std::vector<std::string> rules;
    for (const Decision& d : only<Decision>(script->said)) {
      if (d.what == "rule of the road") rules.push_back(d.reason);
    }
    aside_m = own.y();
    return rules;
  }
  double aside_m = 0;
};

// Rules 13 to 17. ledger: S3-01 S3-03
TEST_F(GoalSelectorByRules, NamesTheRuleTowardEachBody) {
  using Texts = std::vector<std::string>;
  EXPECT_EQ(told({50, 0}, {-1, 0}, 16), Texts{"obstacle 5 is met head-on, the vehicle turns to starboard (rule 14)"});
  EXPECT_GT(aside_m, 0.5) << "to starboard";
  EXPECT_EQ(told({45, 30}, {0, -1}, 20), Texts{"obstacle 5 crosses from starboard, the vehicle gives way (rule 15)"});
  EXPECT_EQ(told({45, -30}, {0, 1}, 24), (Texts{"obstacle 5 crosses from port, the vehicle stands on (rule 17)",
                                                "the vehicle acts, for obstacle 5 from port does not (rule 17 a ii)"}));
  EXPECT_EQ(told({20, 1}, {0.7, 0}, 5), Texts{"the vehicle overtakes obstacle 5 and keeps clear of it (rule 13)"});
  EXPECT_EQ(told({-25, 1}, {2.4, 0}, 5), Texts{"obstacle 5 overtakes, the vehicle stands on (rule 17)"});
}

// While the vehicle stands on, there is a plan: straight on, at the speed of its order. ledger: S3-21
TEST_F(GoalSelectorByRules, StandsOnWithAPlanAndAtTheSpeedOfItsOrder) {
  EXPECT_EQ(told({-20, -0.5}, {2.2, 0}, 12).size(), 1u);
  EXPECT_NEAR(aside_m, 0, 0.05);
  const auto orders = only<MotionOrder>(script->said);
  ASSERT_GT(orders.size(), 100u);
  EXPECT_NEAR((orders.back().place_W - orders[orders.size() - 2].place_W).norm(), 0.15, 0.01);
  for (const Decision& d : only<Decision>(script->said)) {
    EXPECT_EQ(d.reason.find("pursued"), std::string::npos);
    EXPECT_FALSE(d.approach) << "the plan leaves the body out, and does not pass it";
  }
}

}  // namespace
}  // namespace isobath
