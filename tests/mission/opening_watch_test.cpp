// The Navigator before an opening between two pylons: it says how much of it the voxels know to be free, and flies a
// helix that looks round it.
#include <gmock/gmock.h>
#include <isobath/mission/agents/navigator.hpp>
#include <tests/planning/measured_water.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

using Eigen::Vector2d;
using test::MeasuredWater;
using testing::HasSubstr;

/// Pylons 26 m apart, 60 m ahead, in water 8 m deep of which only a strip is known.
class BeforeAnOpening : public testing::Test {
 protected:
  explicit BeforeAnOpening(OpeningConfig::Mode mode = OpeningConfig::Mode::kHelix)
      : agent(NavigatorConfig{.jump_m = 100}, RouteConfig{}, vehicle(), SpaceRouteConfig{}, opening(mode)),
        script(agent) {
    MissionPlan plan;
    plan.speed = 1.2;
    MissionOrder start;
    start.plan = std::make_shared<const MissionPlan>(plan);
    script.hear(start, now);
  }
  static OpeningConfig opening(OpeningConfig::Mode mode) {
    OpeningConfig config;
    config.mode = mode;
    return config;
  }
  static VehicleParameters vehicle() {
    VehicleParameters v;
    v.half_width_m = 0.2;
    v.limits.turning_radius = 4;
    v.limits.max_yaw_rate = Angle::degrees(20);
    v.limits.max_climb_rate = 0.3;
    return v;
  }

  static MeasuredWater water(double half_width_m) {
    MeasuredWater water;
    water.clear({0, -half_width_m, 0}, {70, half_width_m, 8});
    return water;
  }
  /// One scan from the line of approach. `aside`: of the pylons' faces; `more`: another obstacle, in L.
  std::vector<Message> sail(double north, double half_width_m, double aside = 12.5, const Polygon& more = {}) {
    script.hear(WorldSnapshot{.voxels = std::make_shared<const OccupancySnapshot>(water(half_width_m).grid())}, now);
    now += 1;
    script.hear(fix(now, north, 0, 0, 1.2, 3), now);
    ObstacleScan scan;
    scan.time = at(now);
    scan.X_WL = {Rotation::from_heading({}), {north, 0, 0}};
    for (const int side : {-1, 1}) {
      scan.hazards.push_back(
          {square(60 - north, side * (aside + 0.5), 0.5), 0, HazardKind::kSeen, 1, side < 0 ? 4 : 7});
    }
    if (!more.empty()) scan.hazards.push_back({more, 0, HazardKind::kSeen, 2, 9});
    return script.hear(scan, now);
  }
  void ask() {
    RouteRequest request;
    request.id = 1;
    request.target.north_east = {110, 0};
    request.target.depth_m = 3;
    script.hear(request, now);
  }
  static std::vector<std::string> kinds(const std::vector<Message>& messages) {
    std::vector<std::string> what;
    for (const Decision& d : only<Decision>(messages)) what.push_back(d.what);
    return what;
  }

  Navigator agent;
  Script script;
  double now = 1;
};

// ledger: S5-40 S5-41 S5-43 S5-44
TEST_F(BeforeAnOpening, TheNavigatorFliesAHelixThatSwingsToBothSidesAndThenThroughTheMiddle) {
  sail(0, 4);
  ask();
  const auto said = sail(1, 4);
  const auto decisions = only<Decision>(said);
  ASSERT_EQ(decisions.size(), 1u);
  EXPECT_EQ(decisions[0].what, "opening");
  EXPECT_THAT(decisions[0].reason, HasSubstr("the opening between obstacle 4 and obstacle 7, 59.0 m ahead, is 25.0 m "
                                             "wide and 8.0 m high (24 by 8 degrees)"));
  EXPECT_THAT(decisions[0].reason, HasSubstr("a helix looks round it"));
  const auto planned = only<RoutePlanned>(said);
  ASSERT_EQ(planned.size(), 1u);
  double port = 0, starboard = 0, last = 1;
  for (const Waypoint& w : planned[0].waypoints) {
    EXPECT_GT(w.north, last) << "ahead all the way";
    last = w.north;
    port = std::min(port, w.east);
    starboard = std::max(starboard, w.east);
    if (w.north > 57 && w.north < 63) {
      EXPECT_NEAR(w.east, 0, 0.1);
      EXPECT_NEAR(w.depth, 3, 0.1);
    }
  }
  EXPECT_GT(starboard, 0.5);
  EXPECT_LT(port, -0.5);
  EXPECT_EQ(planned[0].waypoints.back().north, 110);
}

// ledger: S5-40 S5-45
TEST_F(BeforeAnOpening, ItSaysOnceWhenTheOpeningIsKnownAndOnceWhenItIsNotInTime) {
  sail(0, 4);
  ask();
  sail(1, 4);
  EXPECT_TRUE(sail(5, 8).empty());
  const auto known = sail(10, 12);
  EXPECT_THAT(kinds(known), testing::ElementsAre("opening known"));
  EXPECT_THAT(only<Decision>(known)[0].reason, HasSubstr("50.0 m ahead"));
  EXPECT_THAT(only<Decision>(known)[0].reason, HasSubstr("100 % of it is known to be free"));
  EXPECT_TRUE(sail(50, 4).empty());
}

TEST_F(BeforeAnOpening, WhatStandsOnTheHelixReplacesItByARouteThatIsNotFlownForItsLook) {
  sail(0, 1);
  ask();
  sail(1, 1);
  const auto said = sail(5, 1, 12.5, square(10, 1.5, 0.5));
  ASSERT_THAT(kinds(said), testing::ElementsAre("replan"));
  EXPECT_LT(only<RoutePlanned>(said)[0].waypoints.size(), 5u);
  for (int i = 0; i < 5; ++i) EXPECT_THAT(kinds(sail(6 + i, 1)), testing::Not(testing::Contains("opening")));
}

TEST_F(BeforeAnOpening, ANarrowOpeningIsSeenWholeWithoutAHelix) {
  sail(0, 2, 3.4);
  ask();
  const auto said = sail(1, 2, 3.4);
  EXPECT_THAT(kinds(said), testing::ElementsAre("opening"));
  EXPECT_TRUE(only<RoutePlanned>(said).empty());
}

TEST_F(BeforeAnOpening, AnOpeningThatIsKnownAlreadyNeedsNone) {
  sail(0, 13);
  ask();
  const auto said = sail(1, 13);
  EXPECT_THAT(kinds(said), testing::ElementsAre("opening"));
  EXPECT_TRUE(only<RoutePlanned>(said).empty());
}

class WatchingAnOpening : public BeforeAnOpening {
 protected:
  WatchingAnOpening() : BeforeAnOpening(OpeningConfig::Mode::kWatch) {}
};

// ledger: S5-45
TEST_F(WatchingAnOpening, TheVehicleKeepsStraightOnAndSaysWhatItDoesNotKnow) {
  sail(0, 4);
  ask();
  EXPECT_TRUE(only<RoutePlanned>(sail(1, 4)).empty());
  std::vector<std::string> what;
  for (double north = 2; north < 60; north += 2) {
    const auto said = sail(north, 4);
    for (const Decision& d : only<Decision>(said)) {
      what.push_back(d.what);
      EXPECT_THAT(d.reason, HasSubstr("can turn away for the last time"));
    }
  }
  EXPECT_THAT(what, testing::ElementsAre("opening unknown"));
}

}  // namespace
}  // namespace isobath
