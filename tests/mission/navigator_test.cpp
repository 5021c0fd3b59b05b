// The Navigator under a script: what it says to scans, fixes and requests, and what it keeps to itself.
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/mission/agents/navigator.hpp>
#include <isobath/mission/agents/way_keeping.hpp>
#include <isobath/mission/plan/planner_budget.hpp>
#include <tests/support/sanitized.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

using Eigen::Vector2d;
using Reason = RouteRefused::Reason;
using testing::Test;

// Not by the code under test: points 0.01 m apart on the way, and a distance by the sides of the outline.
double sampled_distance(const std::vector<Vector2d>& way, const Polygon& outline) {
  double least = INFINITY;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const int n = std::max(1, static_cast<int>((way[i] - way[i - 1]).norm() / 0.01));
    for (int k = 0; k <= n; ++k) {
      const Vector2d p = way[i - 1] + (way[i] - way[i - 1]) * (static_cast<double>(k) / n);
      least = std::min(least, (p - nearest_point(outline, p)).norm());
    }
  }
  return least;
}

class NavigatorTest : public Test {
 protected:
  NavigatorTest() {
    vehicle.half_width_m = 0.25;
    config.drop_distance_m = 10;
  }

  void make() {
    agent = std::make_unique<Navigator>(config, route, vehicle);
    script = std::make_unique<Script>(*agent);
  }
  void sail_from(double north, double east, double heading_deg = 0) {
    if (!agent) make();
    here = {north, east};
    psi = heading_deg;
    script->hear(fix(now, north, east, heading_deg), now);
  }
  std::vector<Message> ask(const MissionPoint& target) {
    return script->hear(RouteRequest{++request, 0, target, false}, now);
  }
  /// A scan of outlines in W, as the vehicle at its place sees them.
  std::vector<Message> scan(const std::vector<Polygon>& outlines, HazardKind kind = HazardKind::kSeen,
                            int obstacle = 0) {
    now += 1;
    ObstacleScan s;
    s.time = at(now);
    s.X_WL = {Rotation::from_heading(Angle::degrees(psi)), {here.x(), here.y(), 0}};
    const PlanFrame frame = PlanFrame::of(s.X_WL);
    for (const Polygon& o : outlines) s.hazards.push_back({to_local(frame, o), 0, kind, 0, obstacle});
    return script->hear(s, now);
  }
  /// Of the last way that it has planned, from the vehicle on.
  [[nodiscard]] std::vector<Vector2d> way() const {
    std::vector<Vector2d> result{here};
    const auto planned = only<RoutePlanned>(script->said);
    if (planned.empty()) return result;
    for (const Waypoint& w : planned.back().waypoints) result.emplace_back(w.north, w.east);
    return result;
  }
  [[nodiscard]] std::vector<std::string> modes() const {
    std::vector<std::string> result;
    for (const Decision& d : only<Decision>(script->said)) {
      if (d.what == "emergency" || d.what == "normal") result.push_back(d.what);
    }
    return result;
  }
  void order(MissionPlan plan) {
    MissionOrder start;
    start.plan = std::make_shared<const MissionPlan>(std::move(plan));
    script->hear(start, now);
  }

  NavigatorConfig config;
  RouteConfig route;
  VehicleParameters vehicle;
  std::unique_ptr<Navigator> agent;
  std::unique_ptr<Script> script;
  Vector2d here = Vector2d::Zero();
  double psi = 0;
  double now = 1;
  std::uint32_t request = 0;
};

// ledger: S6-36 S6-50
TEST_F(NavigatorTest, LeadsStraightToAPointWhereNothingIsInTheWayAsSoonAsItHasLooked) {
  sail_from(5, -3);
  const auto before = ask(point(200, 40));
  ASSERT_EQ(only<RouteRefused>(before).size(), 1u);
  EXPECT_EQ(only<RouteRefused>(before)[0].reason, Reason::kNoMap);
  const auto routes = only<RoutePlanned>(scan({}));  // the point is far outside anything that was seen
  ASSERT_EQ(routes.size(), 1u);
  ASSERT_EQ(routes[0].waypoints.size(), 1u);
  EXPECT_EQ(routes[0].request, request);
  EXPECT_FALSE(routes[0].avoiding);
  EXPECT_EQ(Vector2d(routes[0].waypoints[0].north, routes[0].waypoints[0].east), Vector2d(200, 40));
}

// Which way is taken depends on what the mission weighs, and the decision states what it costs. ledger: S2-14
TEST_F(NavigatorTest, WeighsTimeAgainstTheRiskOfBeingDetected) {
  for (const double stealth : {0.0, 200.0}) {
    make();
    script->said.clear();
    MissionPlan plan;
    plan.speed = 1;
    plan.priorities.stealth = stealth;
    plan.risks = {{.centre_W = {100, 10}, .radius_m = 50, .per_minute = 2}};
    order(plan);
    sail_from(0, 0);
    scan({});
    ask(point(200, 0));
    const std::string why = only<Decision>(script->said).back().reason;
    if (stealth == 0) {
      EXPECT_EQ(way().size(), 2u);
      EXPECT_NE(why.find("straight"), std::string::npos);
      EXPECT_NE(why.find("cost 200 s: 200 s, detected with 7"), std::string::npos) << why;
    } else {
      EXPECT_GT(way().size(), 2u);
      EXPECT_GT(sampled_distance(way(), square(100, 10, 0.01)), 40);
      EXPECT_NE(why.find("going round"), std::string::npos);
      EXPECT_NE(why.find("detected with "), std::string::npos);
    }
  }
}

// ledger: S2-15 S2-17
TEST_F(NavigatorTest, ReachesAPointWithinItsDeviationOrSaysThatItCannot) {
  const Polygon wall = {{49, -12}, {51, -12}, {51, 60}, {49, 60}};
  MissionPoint target = point(100, 0);
  target.deviation_m = 20;
  sail_from(0, 0);
  scan({wall});
  ask(target);
  ASSERT_GT(way().size(), 2u);
  for (const Vector2d& p : way()) EXPECT_LE(std::abs(p.y()), 20.01);
  target.deviation_m = 10;
  const auto refused = only<RouteRefused>(ask(target));
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_NE(refused[0].why.find("no path within 10 m of the straight line"), std::string::npos) << refused[0].why;
}

// ledger: S3-21
TEST_F(NavigatorTest, LeavesBodiesThatMoveToTheGoalSelectorWhileItSteersPastThem) {
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  ASSERT_EQ(way().size(), 2u);
  const auto crossing = [&] { return scan({square(30, 0, 2), square(60, 30, 2)}, HazardKind::kMoving); };
  const auto first = crossing();
  EXPECT_TRUE(only<RoutePlanned>(first).empty()) << "the Goal Selector is given the time to begin";
  ASSERT_EQ(only<StillHazards>(first).size(), 1u);
  EXPECT_TRUE(only<StillHazards>(first)[0].hazards->empty()) << "none lies still";
  script->hear(MotionOrder{1, 0, at(now + 1), {3.5, 0}, {1.5, 0}, at(now + 2)}, now + 1);
  EXPECT_TRUE(only<RoutePlanned>(crossing()).empty());
  EXPECT_EQ(only<RoutePlanned>(crossing()).size(), 1u) << "it does not steer any more";
  EXPECT_GT(way().size(), 2u);
}

// Whether it waits for a route, or has reached its point. ledger: S3-21
TEST_F(NavigatorTest, TellsTheGoalSelectorWhatLiesStillWhileTheVehicleHoldsItsPosition) {
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  const auto told = [&] { return only<StillHazards>(scan({square(30, 40, 2)})); };
  EXPECT_TRUE(told().empty()) << "nothing moves";
  script->hear(FollowOrder{0, {}, {}, false}, now);
  auto still = told();
  ASSERT_EQ(still.size(), 1u);
  ASSERT_EQ(still[0].hazards->size(), 1u);
  EXPECT_NEAR(still[0].hazards->at(0).outline[0].y(), 38, 1e-9) << "in W";
  script->hear(FollowOrder{1, {{100, 0, 2, 1.5}}, {}, false}, now);
  EXPECT_TRUE(told().empty());
  script->hear(WaypointPassed{1, 0, true, true}, now);
  EXPECT_EQ(told().size(), 1u) << "without a request, too";
}

// One that is seen at the point may not be known to move yet.
TEST_F(NavigatorTest, AmongBodiesThatMoveAPointIsGivenUpLater) {
  for (const bool traffic : {false, true}) {
    make();
    sail_from(90, 0);
    scan({});
    ask(point(100, 0));
    int scans = 0;
    if (traffic) scan({square(60, 40, 2)}, HazardKind::kMoving);
    while (only<RouteRefused>(script->said).empty() && scans < 60) {
      scan({square(107, 2, 1)});
      ++scans;
    }
    EXPECT_EQ(scans, traffic ? 15 * config.sure_scans : config.sure_scans);
    agent.reset();
  }
}

// ledger: S6-54 S6-E18
TEST_F(NavigatorTest, ChangesNothingForWhatStandsBesideTheWayAndReplansAtTheNextMapWhenItStandsOnIt) {
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  const auto beside = scan({square(50, 20, 2)});
  EXPECT_TRUE(only<RoutePlanned>(beside).empty());
  EXPECT_TRUE(only<Decision>(beside).empty());

  const Polygon rock = square(50, 0.5, 2);
  const auto on_it = scan({rock});
  ASSERT_EQ(only<RoutePlanned>(on_it).size(), 1u);
  EXPECT_TRUE(only<RoutePlanned>(on_it)[0].avoiding);
  EXPECT_GE(sampled_distance(way(), rock), route.clearance_m + vehicle.half_width_m - 1e-3);
  EXPECT_EQ(way().back(), Vector2d(100, 0));
}

// ledger: S6-56
TEST_F(NavigatorTest, SaysWhichObstacleWhichLegAndHowNear) {
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  const auto said = scan({square(50, 3.65, 2)});  // its near side at 1.65 m, 1.4 m from the hull
  ASSERT_EQ(only<Decision>(said).size(), 1u);
  const Decision d = only<Decision>(said)[0];
  EXPECT_EQ(d.agent, "navigator");
  EXPECT_EQ(d.what, "replan");
  ASSERT_TRUE(d.obstacle && d.leg && d.margin_m);
  EXPECT_NEAR(d.obstacle->y(), 1.65, 1e-9);
  EXPECT_EQ(*d.leg, 1);
  EXPECT_NEAR(*d.margin_m, 1.4, 1e-9);
  EXPECT_EQ(d.way.back(), Vector2d(100, 0));
  EXPECT_EQ(d.reason.substr(0, d.reason.find(" at ")), "leg 1 would pass 1.4 m from an obstacle");
  EXPECT_NE(d.reason.find("(3.0 m wanted); going round by"), std::string::npos) << d.reason;
  EXPECT_EQ(only<RoutePlanned>(said)[0].why, d.reason);
}

// ledger: S6-56
TEST_F(NavigatorTest, NamesTheObstacleByItsNumberAndSaysWhereItLies) {
  sail_from(0, 0, 30);
  scan({});
  ask(point(100, 0));
  const auto said = scan({square(50, 3.65, 2)}, HazardKind::kSeen, 3);
  ASSERT_EQ(only<Decision>(said).size(), 1u);
  const Decision d = only<Decision>(said)[0];
  EXPECT_EQ(d.obstacle_number, 3);
  EXPECT_EQ(d.reason.find("leg 1 would pass 1.4 m from obstacle 3 at north "), 0u) << d.reason;
  EXPECT_NE(d.reason.find(" m ahead to port (3.0 m wanted)"), std::string::npos) << d.reason;

  make();
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  const auto again = only<Decision>(scan({square(50, 3.65, 2)}, HazardKind::kRemembered, 8));
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0].obstacle_number, 8);
  EXPECT_NE(again[0].reason.find("from remembered obstacle 8 at"), std::string::npos) << again[0].reason;
}

TEST_F(NavigatorTest, ARefusalNamesTheObstacleAtThePoint) {
  sail_from(0, 0);
  std::vector<Decision> refusals;
  ask(point(30, 0));
  for (int i = 0; i < 5; ++i) {
    for (const Decision& d : only<Decision>(scan({square(30, 4, 2)}, HazardKind::kSeen, 12))) {
      if (d.what == "refuse") refusals.push_back(d);
    }
  }
  ASSERT_FALSE(refusals.empty());
  EXPECT_EQ(refusals.back().obstacle_number, 12);
  EXPECT_NE(refusals.back().reason.find("obstacle 12 is 2.0 m from it"), std::string::npos) << refusals.back().reason;
}

// ledger: S6-51
TEST_F(NavigatorTest, RefusesAPointWithAnObstacleNearerThanTenMetres) {
  for (const auto& [distance, dropped] : {std::pair{10.1, false}, std::pair{9.9, true}, std::pair{-1.0, true}}) {
    make();
    sail_from(0, 0);
    scan({square(100, 3 + distance, 3)}, HazardKind::kInjected);
    const auto said = ask(point(100, 0));
    EXPECT_EQ(only<RouteRefused>(said).size(), dropped ? 1u : 0u) << distance;
    EXPECT_EQ(only<RoutePlanned>(said).size(), dropped ? 0u : 1u) << distance;
    if (dropped) {
      EXPECT_EQ(only<RouteRefused>(said)[0].reason, Reason::kGoalBlocked);
    }
  }
}

// ledger: S6-51
TEST_F(NavigatorTest, LetsAVehicleThatCanHoverGoToAPointByAWall) {
  config.drop_distance_m = 0;
  const double wanted = route.clearance_m + vehicle.half_width_m;
  for (const auto& [min_speed, least] : {std::pair{0.0, wanted}, std::pair{0.8, 10.0}}) {
    vehicle.min_speed = min_speed;
    for (const double more : {0.1, -0.1}) {
      make();
      sail_from(0, 0);
      scan({square(100, 3 + least + more, 3)}, HazardKind::kInjected);
      EXPECT_EQ(only<RouteRefused>(ask(point(100, 0))).size(), more > 0 ? 0u : 1u) << min_speed;
    }
  }
}

// ledger: S6-51
TEST_F(NavigatorTest, BelievesAnObstacleAtThePointWhenThreeScansAgreeAndKeepsClearOfANearOneAtOnce) {
  const Polygon rock = square(100, 5, 2);
  sail_from(75, 0);
  scan({});
  ask(point(100, 0));
  EXPECT_TRUE(scan({rock}).empty());
  EXPECT_TRUE(scan({}).empty());
  EXPECT_TRUE(scan({rock}).empty());
  EXPECT_TRUE(scan({rock}).empty());
  EXPECT_EQ(only<RouteRefused>(scan({rock})).size(), 1u);

  make();
  sail_from(85, 0);
  scan({});
  ask(point(100, 0));
  const Polygon on_the_way = square(94, 0, 1);
  EXPECT_EQ(only<RoutePlanned>(scan({on_the_way})).size(), 1u);
  EXPECT_TRUE(only<RouteRefused>(scan({on_the_way})).empty());
  EXPECT_EQ(only<RouteRefused>(scan({on_the_way})).size(), 1u);
}

// A vehicle far away goes on and looks again; near the point it decides.
// ledger: S6-51
TEST_F(NavigatorTest, PutsAnObstacleAtAPointOffUntilItIsNear) {
  const Polygon rock = square(100, 5, 2);
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(only<RouteRefused>(scan({rock})).empty()) << i;
  sail_from(75, 0);
  EXPECT_EQ(only<RouteRefused>(scan({rock})).size(), 1u) << "30 m, and seen for long enough";
}

// ledger: S6-65
TEST_F(NavigatorTest, NamesTheNearestPlaceThatTheRulesAllowForAPointThatIsBlocked) {
  sail_from(0, 0);
  const Polygon rock = square(100, 2, 3);
  scan({rock}, HazardKind::kInjected);
  MissionPoint target = point(100, 0);
  target.move_m = 20;
  const auto refused = only<RouteRefused>(ask(target));
  ASSERT_EQ(refused.size(), 1u);
  ASSERT_TRUE(refused[0].safe_nearby);
  const Vector2d place = *refused[0].safe_nearby;
  const auto allowed = [&](const Vector2d& p) { return (p - nearest_point(rock, p)).norm() >= 10 + config.slack_m; };
  EXPECT_TRUE(allowed(place));
  double best = INFINITY;
  for (double x = 80; x <= 120; x += 0.1) {
    for (double y = -20; y <= 20; y += 0.1) {
      if (allowed({x, y})) best = std::min(best, (Vector2d(x, y) - target.north_east).norm());
    }
  }
  EXPECT_LE((place - target.north_east).norm(), best + 0.7);  // rings and places on them stand 0.5 m apart

  target.move_m = 5;
  EXPECT_FALSE(only<RouteRefused>(ask(target))[0].safe_nearby);
}

// ledger: S6-55
TEST_F(NavigatorTest, StaysOnTheSideThatItHasChosenHoweverTheOutlineShakes) {
  ISOBATH_NOT_SANITIZED();
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  scan({square(50, 0, 3)});
  const double side = way()[1].y() > 0 ? 1 : -1;
  Random random(7);
  for (int i = 0; i < 60; ++i) {
    here.x() += 0.3;
    script->hear(fix(now + 0.5, here.x(), 0), now + 0.5);
    const double dx = random.uniform(-0.5, 0.5);
    const double dy = random.uniform(-1, 1);
    const Polygon rock = square(50 + dx, dy, 3);
    scan({rock});
    EXPECT_GE(sampled_distance(way(), rock), route.clearance_m + vehicle.half_width_m - config.slack_m - 1e-3);
    for (std::size_t c = 1; c + 1 < way().size(); ++c) EXPECT_GT(side * way()[c].y(), 0) << "scan " << i;
  }
  EXPECT_LE(only<RoutePlanned>(script->said).size(), 15u);  // most of them found the way clear
}

// ledger: S6-55
TEST_F(NavigatorTest, LeavesADetourWhenThreeScansShowThatItGoesRoundNothing) {
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  const Polygon wall = {{48, -12}, {52, -12}, {52, 12}, {48, 12}};
  scan({wall});
  ASSERT_GT(way().size(), 2u);
  EXPECT_TRUE(scan({}).empty());
  EXPECT_TRUE(scan({wall}).empty());
  EXPECT_TRUE(scan({}).empty());
  EXPECT_TRUE(scan({}).empty());
  const auto said = scan({});
  ASSERT_EQ(only<RoutePlanned>(said).size(), 1u);
  EXPECT_EQ(only<RoutePlanned>(said)[0].waypoints.size(), 1u);
}

// ledger: S6-53
TEST_F(NavigatorTest, PlansTheSameWayPastWhatItSeesWhateverTheErrorOfItsPosition) {
  const Polygon rock = square(41.3, 1.7, 3);  // as it stands relative to the start
  std::vector<Vector2d> reference;
  for (const double travelled : {0.0, 350.0, 5000.0}) {
    const Vector2d error = travelled == 0 ? Vector2d(0, 0) : Vector2d(80 + 0.01 * travelled, -60);
    make();
    here = error;
    psi = 20;
    now = 1;
    script->hear(fix(now, here.x(), here.y(), psi), now);
    Polygon seen = rock;
    for (Vector2d& p : seen) p += error;
    scan({seen});
    ask(point(90.2 + error.x(), 3.1 + error.y()));
    std::vector<Vector2d> relative = way();
    for (Vector2d& p : relative) p -= error;
    ASSERT_GT(relative.size(), 2u);
    if (reference.empty()) reference = relative;
    ASSERT_EQ(relative.size(), reference.size());
    for (std::size_t i = 0; i < reference.size(); ++i) EXPECT_LT((relative[i] - reference[i]).norm(), 1e-6);
  }
}

// ledger: S6-53
TEST_F(NavigatorTest, MovesTheCornersWithAFixThatJumpsAndLeavesThePointWhereItIs) {
  sail_from(0, 0);
  scan({square(60, 0, 3)});
  ask(point(150, 0));
  const std::vector<Vector2d> before = way();
  ASSERT_GT(before.size(), 2u);
  const Vector2d jump(4, -9);
  now += 0.1;
  here += jump;
  const auto said = script->hear(fix(now, here.x(), here.y()), now);
  ASSERT_GE(only<RoutePlanned>(said).size(), 1u);
  const RoutePlanned moved = only<RoutePlanned>(said)[0];
  ASSERT_EQ(moved.waypoints.size(), before.size() - 1);
  for (std::size_t i = 1; i + 1 < before.size(); ++i) {
    const Waypoint& w = moved.waypoints[i - 1];
    EXPECT_LT((Vector2d(w.north, w.east) - (before[i] + jump)).norm(), 1e-6);
  }
  EXPECT_EQ(Vector2d(moved.waypoints.back().north, moved.waypoints.back().east), Vector2d(150, 0));
  // What was seen has moved along: the way still keeps clear of it where it is now.
  Polygon rock = square(60, 0, 3);
  for (Vector2d& p : rock) p += jump;
  EXPECT_GE(sampled_distance(way(), rock), route.clearance_m + vehicle.half_width_m - config.slack_m - 1e-3);
}

// ledger: S6-39
TEST_F(NavigatorTest, RefusesAPointOutsideTheFenceAndKeepsItsWaysInside) {
  sail_from(0, 0);
  MissionPlan plan;
  plan.fence = {{-10, -9}, {120, -9}, {120, 30}, {-10, 30}};
  order(plan);
  scan({});
  EXPECT_EQ(only<RouteRefused>(ask(point(100, -12))).at(0).reason, Reason::kOutsideFence);
  scan({square(50, -3, 3)});  // the shorter way round it would lead out of the fence
  ask(point(100, 0));
  ASSERT_GT(way().size(), 2u);
  for (const Vector2d& p : way()) EXPECT_GT(p.y(), -9 + vehicle.half_width_m + config.fence_clearance_m - 1e-6);
  EXPECT_GE(sampled_distance(way(), square(50, -3, 3)), 3.25 - 1e-3);
  EXPECT_EQ(only<RoutePlanned>(ask(point(118, 0))).size(), 1u) << "nearer to the fence than to an obstacle";
}

// ledger: S6-50
TEST_F(NavigatorTest, SaysThatItIsInsideAnObstacleAndGoesOnWhenThatIsGone) {
  sail_from(0, 0);
  scan({square(0, 0, 2)});
  const auto refused = only<RouteRefused>(ask(point(100, 0)));
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].reason, Reason::kStartBlocked);
  EXPECT_TRUE(only<RouteRefused>(scan({square(0, 0, 2)})).empty()) << "said once";
  EXPECT_EQ(only<RoutePlanned>(scan({})).size(), 1u);
}

// ledger: S6-50
TEST_F(NavigatorTest, LeavesAPlaceThatIsNearerToAnObstacleThanItMayGo) {
  sail_from(0, 0);
  const Polygon rock = square(-3.2, 0, 2);  // 1.2 m behind
  scan({rock});
  ask(point(100, 0));
  ASSERT_EQ(only<RoutePlanned>(script->said).size(), 1u);
  EXPECT_TRUE(scan({rock}).empty()) << "and does not plan anew at each scan";
}

// ledger: S6-48 S2-29 S2-31
TEST_F(NavigatorTest, HoldsWithoutAWayLooksAgainAndReturnsToNormalWhenItIsPast) {
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  // A ring round the point, far enough from it that the point itself can stay.
  const std::vector<Polygon> ring = {{{75, -30}, {78, -30}, {78, 30}, {75, 30}},
                                     {{122, -30}, {125, -30}, {125, 30}, {122, 30}},
                                     {{75, -33}, {125, -33}, {125, -30}, {75, -30}},
                                     {{75, 30}, {125, 30}, {125, 33}, {75, 33}}};
  const auto refused = only<RouteRefused>(scan(ring));
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].reason, Reason::kNoPath);
  EXPECT_NE(refused[0].why.find("leg 1 would run into an obstacle at north 75.0"), std::string::npos) << refused[0].why;
  EXPECT_TRUE(only<RouteRefused>(scan(ring)).empty());
  const auto resumed = only<RoutePlanned>(scan({ring[0]}));
  ASSERT_EQ(resumed.size(), 1u);
  EXPECT_EQ(modes(), std::vector<std::string>{"emergency"});
  script->tick(now);
  EXPECT_EQ(modes().size(), 1u) << "the wall is still ahead";
  const std::size_t corners = resumed[0].waypoints.size() - 1;
  ASSERT_GT(corners, 0u);
  script->hear(WaypointPassed{resumed[0].version, corners - 1, true, false}, now);
  script->tick(now);
  EXPECT_EQ(modes(), (std::vector<std::string>{"emergency", "normal"}));
}

// ledger: S2-29
TEST_F(NavigatorTest, SearchesFurtherInAnEmergency) {
  route.max_expanded = 20;
  route.smooth = true;
  config.emergency_factor = 1000;
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  const auto refused = only<RouteRefused>(scan({{{48, -25}, {52, -25}, {52, 25}, {48, 25}}}));
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].reason, Reason::kOutOfBudget);
  EXPECT_EQ(modes(), std::vector<std::string>{"emergency"});
  EXPECT_EQ(only<RoutePlanned>(script->tick(now + 0.1)).size(), 1u) << "at the next tick, without another scan";
}

// ledger: S6-39
TEST_F(NavigatorTest, HasTheShareOfItsBudgetThatAnOverloadedComputerLeavesIt) {
  const Polygon wall{{48, -25}, {52, -25}, {52, 25}, {48, 25}};
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  script->hear(planner_report(at(now), 1e-4), now);
  script->hear(Health{at(now), "disk", HealthState::kLost, 1, false, "full"}, now);
  const auto refused = only<RouteRefused>(scan({wall}));
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].reason, Reason::kOutOfBudget);
  EXPECT_NE(refused[0].why.find("of which the computer leaves a share of 0.0001"), std::string::npos) << refused[0].why;
  EXPECT_TRUE(only<RoutePlanned>(scan({wall})).empty()) << "four times as much is not enough either";
  script->hear(planner_report(at(now), 1), now);
  EXPECT_EQ(only<RoutePlanned>(scan({wall})).size(), 1u);
}

// A computer that leaves the planner no time takes no plan away that is still good. ledger: S2-42
TEST_F(NavigatorTest, KeepsItsRouteWhileTheBudgetIsTooSmallForAnother) {
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  script->hear(planner_report(at(now), 1e-4), now);
  const std::size_t plans = only<RoutePlanned>(script->said).size();
  for (int i = 0; i < 20; ++i) {
    const auto said = scan({{{40, 9.0 + i}, {44, 9.0 + i}, {44, 30}, {40, 30}}});
    EXPECT_TRUE(only<RouteRefused>(said).empty()) << i;
    script->tick(now);
  }
  EXPECT_EQ(only<RoutePlanned>(script->said).size(), plans);
  EXPECT_TRUE(only<RouteRefused>(script->said).empty());
}

TEST(PlannerBudget, IsReadFromWhatTheHostReports) {
  for (const double share : {0.0, 0.001, 0.5, 1.0, 2.5}) {
    const Health report = planner_report(at(3), share);
    EXPECT_EQ(budget_share(report), share);
    EXPECT_EQ(report.state, share < 1 ? HealthState::kDegraded : HealthState::kOk);
  }
  Health report = planner_report(at(3), 0.5);
  for (const char* note : {"", "busy", "nan", "inf of it", "-0.5 of it"}) {
    report.note = note;
    EXPECT_EQ(budget_share(report), 1) << note;
  }
  report.source = "vehicle";
  EXPECT_EQ(budget_share(report), std::nullopt);
}

// ledger: S2-28 S2-29 S2-31
TEST_F(NavigatorTest, LooksAnewWhenTheSafetyOfficerHasStoppedTheVehicle) {
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  SafetyAction stop;
  stop.kind = SafetyActionKind::kStop;
  stop.why = "an echo 4 m ahead";
  script->hear(stop, now);
  script->tick(now + 0.1);
  EXPECT_EQ(modes(), std::vector<std::string>{"emergency"});
  script->hear(SafetyAction{}, now + 5);
  script->tick(now + 5.1);
  EXPECT_EQ(modes(), (std::vector<std::string>{"emergency", "normal"}));
  EXPECT_EQ(only<RoutePlanned>(script->said).size(), 1u) << "the way was clear all along";
}

TEST_F(NavigatorTest, HasNoWayWhenItHasSeenNothingForTooLong) {
  sail_from(0, 0);
  scan({});
  ask(point(100, 0));
  script->tick(now + 20);
  EXPECT_TRUE(only<RouteRefused>(script->said).empty());
  const auto refused = only<RouteRefused>(script->tick(now + 20.1));
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].reason, Reason::kNoMap);
  now += 25;
  EXPECT_EQ(only<RoutePlanned>(scan({})).size(), 1u);
}

// A vehicle with range sonars alone has no scans: it plans on the depth map that they make. ledger: S1-03 S1-41
TEST_F(NavigatorTest, PlansOnTheDepthMapWhereThereIsNoScan) {
  const Polygon reef = square(50, 0, 15);
  const auto tell = [&](const std::vector<Hazard>& hazards) {
    now += 1;
    script->hear(fix(now, 0, 0), now);
    return script->hear(
        ChartedHazards{std::make_shared<const std::vector<Hazard>>(hazards), Time(std::chrono::seconds(long(now)))},
        now);
  };
  sail_from(0, 0);
  EXPECT_EQ(only<RouteRefused>(ask(point(100, 0))).size(), 1u) << "nothing has been seen yet";
  EXPECT_EQ(only<RoutePlanned>(tell({})).size(), 1u);
  const auto replanned = only<RoutePlanned>(tell({{reef, 0, HazardKind::kMapped, 0}}));
  ASSERT_EQ(replanned.size(), 1u);
  EXPECT_TRUE(replanned[0].avoiding);
  EXPECT_GE(sampled_distance(way(), reef), route.clearance_m);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(only<RoutePlanned>(tell({})).empty()) << "not yet sure";
  EXPECT_EQ(only<RoutePlanned>(tell({})).size(), 1u) << "three maps in a row without it";
  EXPECT_EQ(only<RouteRefused>(script->tick(now + config.map_age_s + 1)).size(), 1u) << "the sonars are silent";
}

TEST_F(NavigatorTest, KeepsFurtherFromChartedObstaclesTheLessItKnowsWhereItIs) {
  const Polygon wreck = square(50, 8, 3);  // 5 m from the straight way
  for (const double sigma : {0.5, 2.0, 4.0}) {
    make();
    sail_from(0, 0);
    Navigation n = fix(now, 0, 0);
    n.covariance = Eigen::Matrix<double, 6, 6>::Zero();
    (*n.covariance)(1, 1) = sigma * sigma;
    n.time = at(now + 0.01);
    script->hear(n, now + 0.01);
    ChartedHazards chart;
    chart.hazards =
        std::make_shared<const std::vector<Hazard>>(std::vector<Hazard>{{wreck, 0, HazardKind::kCharted, 1}});
    script->hear(chart, now);
    scan({});
    ask(point(100, 0));
    const auto planned = only<RoutePlanned>(script->said);
    ASSERT_EQ(planned.size(), 1u);
    EXPECT_GE(sampled_distance(way(), wreck), 3.25 + 2 * sigma - 1e-3);
  }
}

// ledger: S6-35
TEST_F(NavigatorTest, ForgetsWhatLiesBehind) {
  sail_from(0, 0);
  scan({square(50, 0, 3)});
  ask(point(100, 0));
  const RoutePlanned planned = only<RoutePlanned>(script->said).at(0);
  ASSERT_GE(planned.waypoints.size(), 2u);
  script->hear(WaypointPassed{planned.version, planned.waypoints.size() - 2, true, false}, now);
  sail_from(75, 0);
  EXPECT_TRUE(scan({square(50, 0, 3)}).empty());
  EXPECT_TRUE(only<RoutePlanned>(scan({square(50, 3, 12)})).empty()) << "an obstacle behind the vehicle";
}

}  // namespace
}  // namespace isobath
