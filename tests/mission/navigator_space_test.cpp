// The Navigator where a sonar tells height: over what closes the plan view, through water that was measured.
#include <gmock/gmock.h>
#include <isobath/mission/agents/navigator.hpp>
#include <isobath/mission/agents/way_keeping.hpp>
#include <tests/planning/measured_water.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::MeasuredWater;
using testing::HasSubstr;

/// A river between two banks with a berm across it: the plan view has no way.
class NavigatorInSpace : public testing::Test {
 protected:
  NavigatorInSpace()
      : agent(NavigatorConfig{.jump_m = 100}, RouteConfig{}, vehicle, SpaceRouteConfig{.decide_m = 20}), script(agent) {
    MissionPlan plan;
    plan.fence = {{-30, -20}, {120, -20}, {120, 20}, {-30, 20}};
    MissionOrder start;
    start.plan = std::make_shared<const MissionPlan>(plan);
    script.hear(start, now);
  }

  std::vector<Message> sail(double north, double depth, bool berm = true) {
    now += 1;
    here = {north, 0, depth};
    script.hear(fix(now, north, 0, 0, 0, depth), now);
    ObstacleScan scan;
    scan.time = at(now);
    scan.X_WL = {Rotation::from_heading({}), {north, 0, 0}};
    if (berm) {
      scan.hazards.push_back(
          {{{40 - north, -22}, {44 - north, -22}, {44 - north, 22}, {40 - north, 22}}, 0, HazardKind::kSeen, 1});
    }
    return script.hear(scan, now);
  }
  void see(const MeasuredWater& water) {
    script.hear(WorldSnapshot{.voxels = std::make_shared<const OccupancySnapshot>(water.grid())}, now);
  }
  std::vector<Message> ask(double depth) {
    RouteRequest request;
    request.id = 1;
    request.target.north_east = {80, 0};
    request.target.depth_m = depth;
    return script.hear(request, now);
  }
  static MeasuredWater river() {
    MeasuredWater water;
    water.clear({0, -8, 0}, {90, 8, 9});
    water.occupy({41, -8, 5}, {43, 8, 9});
    return water;
  }

  VehicleParameters vehicle;
  Navigator agent;
  Script script;
  double now = 1;
  Vector3d here = Vector3d::Zero();
};

// ledger: S5-34
TEST_F(NavigatorInSpace, HasNoWayInThePlane) {
  sail(0, 5);
  ask(5);
  const auto refused = only<RouteRefused>(script.said);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].reason, RouteRefused::Reason::kNoPath);
}

// ledger: S5-35 S5-39
TEST_F(NavigatorInSpace, LeadsOverIt) {
  see(river());
  sail(0, 5);
  ask(5);
  const auto planned = only<RoutePlanned>(script.said);
  ASSERT_EQ(planned.size(), 1u);
  EXPECT_THAT(planned[0].why, HasSubstr("of depth the clearance is"));
  double depth_from = 5, shallowest = 5;
  for (const Waypoint& w : planned[0].waypoints) {
    ASSERT_TRUE(w.from_depth) << "it rises along its legs";
    EXPECT_NEAR(*w.from_depth, depth_from, 1e-9);
    depth_from = w.depth;
    shallowest = std::min(shallowest, w.depth);
  }
  EXPECT_EQ(depth_from, 5);
  EXPECT_LT(shallowest, 5 - 1.4);
  EXPECT_TRUE(only<RouteRefused>(script.said).empty());
}

// ledger: S5-37
TEST_F(NavigatorInSpace, KeepsAWayThatLeadsOverItAnywayAndSaysSo) {
  sail(0, 3, false);
  ask(3);
  see(river());
  const auto said = sail(1, 3);
  EXPECT_TRUE(only<RoutePlanned>(said).empty());
  const auto kept = only<Decision>(said);
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].what, "keep");
  EXPECT_THAT(kept[0].reason, HasSubstr("was measured, and is clear at the depth of the route"));
  EXPECT_TRUE(sail(2, 3).empty()) << "once is enough";
}

// ledger: S5-37
TEST_F(NavigatorInSpace, LeavesAWayOverItThatTurnsOutToBeShut) {
  see(river());
  sail(0, 3);
  ask(3);
  ASSERT_EQ(only<RoutePlanned>(script.said).size(), 1u);
  MeasuredWater shut = river();
  shut.occupy({41, -8, 0}, {43, 8, 9});
  see(shut);
  EXPECT_TRUE(only<RouteRefused>(sail(2, 3)).empty()) << "beside what was measured there may be a way";
  const auto refused = only<RouteRefused>(sail(21, 3));
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].reason, RouteRefused::Reason::kNoPath);
}

// ledger: S5-45
TEST_F(NavigatorInSpace, LooksOnWhileItIsFarAndRefusesWhenItMustKnow) {
  MeasuredWater water;
  water.clear({0, -8, 0}, {15, 8, 9});
  see(water);
  sail(0, 3);
  ask(3);
  const auto planned = only<RoutePlanned>(script.said);
  ASSERT_EQ(planned.size(), 1u);
  EXPECT_THAT(planned[0].why, HasSubstr("known for 3"));
  EXPECT_TRUE(only<RouteRefused>(sail(10, 3)).empty());
  EXPECT_TRUE(only<RouteRefused>(sail(19, 3)).empty());
  EXPECT_EQ(only<RouteRefused>(sail(21, 3)).size(), 1u);
}

TEST_F(NavigatorInSpace, GoesRoundInThePlaneWhereThatIsNoDetour) {
  see(river());
  sail(0, 3, false);
  now += 1;
  ObstacleScan scan;
  scan.time = at(now);
  scan.X_WL = {Rotation::from_heading({}), {0, 0, 0}};
  scan.hazards.push_back({square(42, 1, 2), 0, HazardKind::kSeen, 1});
  see(MeasuredWater());
  ask(3);
  const auto planned = only<RoutePlanned>(script.hear(scan, now));
  ASSERT_EQ(planned.size(), 1u);
  for (const Waypoint& w : planned[0].waypoints) EXPECT_FALSE(w.from_depth);
}

}  // namespace
}  // namespace isobath
