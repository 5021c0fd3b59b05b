// Every row of the fault table on a stream of messages: noticed within its limit, acted on, reported, and over when its
// cause is gone; and nothing of the kind on a healthy stream.
#include <gmock/gmock.h>
#include <isobath/geometry/polygon.hpp>
#include <tests/mission/safety_stream.hpp>

namespace isobath {
namespace {

using Act = SafetyActionKind;
using test::SafetyStream;
using testing::HasSubstr;

constexpr double kBegin = 20, kCycle = 0.11;  // s
const SafetyConfig kLimits;

// A quarter of an hour with an operator who comes and goes within the limits, and nothing to say.
// ledger: S6-39
TEST(SafetyOfficer, SaysNothingOfAHealthyVehicle) {
  SafetyStream stream;
  stream.beats = true;
  stream.run_to(600);
  EXPECT_EQ(stream.said.size(), 0u);
  EXPECT_EQ(stream.officer.action().kind, Act::kNone);
}

TEST(SafetyOfficer, BeforeAMissionNoSensorIsMissed) {
  SafetyOfficer officer({}, test::hovering());
  Outbox out;
  for (int i = 0; i < 600; ++i) officer.tick(Time(seconds(0.1 * i)), out);
  EXPECT_EQ(out.said().size(), 0u);
}

TEST(SafetyOfficer, SensorsThatNeverSpokeAreMissedAfterTheStart) {
  SafetyStream stream;
  stream.pings = stream.fixes = stream.reports = false;
  stream.run_to(kLimits.startup_s + 2);
  for (const Fault fault : {Fault::kSonarSilent, Fault::kNavigationSilent, Fault::kHealthSilent}) {
    EXPECT_NEAR(stream.raised(fault), kLimits.startup_s + 0.1, kCycle) << to_text(fault);
  }
  EXPECT_EQ(stream.officer.action().kind, Act::kStop);
}

/// A row with its limit: the cause holds from kBegin on for `held_s`, and the stream is run for a minute after it.
struct Expected {
  double within_s = kCycle;
  Act action = Act::kStop;
  double abort_after_s = -1;  ///< from when it was raised; -1: not within the time held
  double over_after_s = kLimits.clear_after_s;
};

void expect_row(SafetyStream& stream, Fault fault, double held_s, const std::function<void()>& begin,
                const std::function<void()>& end, const Expected& expected) {
  stream.run_to(kBegin);
  ASSERT_EQ(stream.count_reports(), 0u);
  begin();
  stream.run_to(kBegin + held_s);
  const double raised = stream.raised(fault);
  ASSERT_GE(raised, kBegin) << to_text(fault);
  EXPECT_LE(raised, kBegin + expected.within_s + kCycle);
  if (expected.action != Act::kNone) {
    EXPECT_EQ(stream.acted(expected.action), raised) << "in the same cycle";
  }
  if (expected.abort_after_s >= 0) {
    EXPECT_NEAR(stream.aborted(fault), raised + expected.abort_after_s, kCycle);
  } else {
    EXPECT_EQ(stream.aborted(fault), -1);
  }
  EXPECT_FALSE(stream.reason(fault).empty());
  EXPECT_EQ(stream.over(fault), -1) << "while the cause lasts";
  end();
  stream.run_to(kBegin + held_s + 60);
  EXPECT_NEAR(stream.over(fault), kBegin + held_s + expected.over_after_s, 1.6);
  EXPECT_FALSE(stream.officer.raised(fault));
  EXPECT_EQ(stream.officer.action().kind, Act::kNone);
  EXPECT_EQ(stream.raised(fault, raised + 0.05), stream.aborted(fault) > raised ? stream.aborted(fault) : -1)
      << "raised once";
}

void expect_sonar(Fault fault, double within_s, const std::function<void(SonarHealthSample&)>& spoil,
                  Act action = Act::kStop, double abort_s = kLimits.sonar_abort_s, double slack_s = 1) {
  SafetyStream stream;
  expect_row(
      stream, fault, abort_s + within_s + 2, [&] { stream.on_look = spoil; }, [&] { stream.on_look = {}; },
      {within_s, action, abort_s, kLimits.clear_after_s + slack_s});
}

TEST(FaultsOfASonar, Silent) {
  SafetyStream stream;
  expect_row(
      stream, Fault::kSonarSilent, 30, [&] { stream.pings = false; }, [&] { stream.pings = true; },
      {kLimits.sonar_silent_s, Act::kStop, kLimits.sonar_abort_s});
  EXPECT_EQ(stream.end(), MissionEnd::kSurface);
  EXPECT_THAT(stream.reason(Fault::kSonarSilent), HasSubstr("no ping of sonar for 1."));
}

TEST(FaultsOfASonar, SilentByTheWordOfItsHostOrByPingsThatComeLate) {
  SafetyStream told;
  told.run_to(kBegin);
  told.tell(Health{told.now(), "sonar.2", HealthState::kLost, 1, false, {}});
  told.run_to(kBegin + 1);
  EXPECT_NEAR(told.raised(Fault::kSonarSilent), kBegin, kCycle);
  SafetyStream late;
  late.run_to(kBegin);
  late.on_look = [](SonarHealthSample& look) { look.time -= seconds(5); };
  late.run_to(kBegin + 3);
  EXPECT_NEAR(late.raised(Fault::kSonarSilent), kBegin + kLimits.sonar_silent_s, 0.3);
}

TEST(FaultsOfASonar, Frozen) {
  expect_sonar(Fault::kSonarFrozen, 0.1 * kLimits.frozen_looks, [](SonarHealthSample& look) { look.digest = 77; });
}

// A link may carry a ping twice.
TEST(FaultsOfASonar, TheSamePingTwiceIsNotFrozen) {
  SafetyStream stream;
  stream.on_look = [&](const SonarHealthSample& look) { stream.tell(look); };
  stream.run_to(60);
  EXPECT_EQ(stream.count_reports(), 0u);
}

TEST(FaultsOfASonar, Saturated) {
  expect_sonar(Fault::kSonarSaturated, 0.1 * kLimits.bad_looks, [](SonarHealthSample& look) { look.full_scale = 0.9; });
}

TEST(FaultsOfASonar, Deaf) {
  expect_sonar(
      Fault::kSonarDeaf, kLimits.deaf_s,
      [](SonarHealthSample& look) {
        look.silent = 1;
        look.mean = look.roughness = look.full_scale = 0;
        look.port = look.starboard = 0;
      },
      Act::kStop, kLimits.sonar_abort_s, 0);
}

// Noticed with the first pass over the side: 10 looks of at most 31 steps there and back.
TEST(FaultsOfASonar, BlindOnOneSide) {
  for (const bool port : {true, false}) {
    expect_sonar(
        Fault::kSonarBlindSide, 6.2,
        [port](SonarHealthSample& look) {
          if (port && look.port) look.port = 0;
          if (!port && look.starboard) look.starboard = 0;
        },
        Act::kSlow, kLimits.blind_abort_s, 2.5);
  }
}

TEST(FaultsOfASonar, Garbled) {
  expect_sonar(Fault::kSonarGarbled, 0.1 * kLimits.bad_looks,
               [](SonarHealthSample& look) { look.roughness = 1.0 / 3; });
}

// A bad ping now and then is noise, not a fault.
TEST(FaultsOfASonar, OneBadPingIsNone) {
  SafetyStream stream;
  int n = 0;
  stream.on_look = [&](SonarHealthSample& look) {
    if (++n % 6 != 0) return;
    look.full_scale = look.roughness = 1;
    look.port = look.starboard = 0;
  };
  stream.run_to(120);
  EXPECT_EQ(stream.count_reports(), 0u);
}

TEST(FaultsOfNavigation, Silent) {
  SafetyStream stream;
  expect_row(
      stream, Fault::kNavigationSilent, 15, [&] { stream.fixes = false; }, [&] { stream.fixes = true; },
      {kLimits.navigation_silent_s, Act::kStop, kLimits.navigation_surface_s});
  EXPECT_NEAR(stream.acted(Act::kSurface), stream.raised(Fault::kNavigationSilent) + kLimits.navigation_surface_s,
              kCycle);
}

TEST(FaultsOfNavigation, AFixThatRepeatsItselfIsSilence) {
  SafetyStream stream;
  stream.run_to(kBegin);
  std::optional<Navigation> held;
  stream.on_fix = [&](Navigation& fix) {
    if (!held) held = fix;
    const Time time = fix.time;
    fix = *held;
    fix.time = time;
  };
  stream.run_to(kBegin + 15);
  EXPECT_NEAR(stream.raised(Fault::kNavigationSilent), kBegin + kLimits.navigation_silent_s, 0.25);
  EXPECT_EQ(stream.officer.action().kind, Act::kSurface) << "it does not heal by standing still";
}

TEST(FaultsOfNavigation, Jump) {
  SafetyStream stream;
  stream.run_to(kBegin);
  stream.on_fix = [](Navigation& fix) { fix.X_WB.translation.y() += 12; };
  stream.run_to(kBegin + 20);
  EXPECT_NEAR(stream.raised(Fault::kNavigationJump), kBegin, kCycle);
  EXPECT_EQ(stream.acted(Act::kStop), stream.raised(Fault::kNavigationJump));
  EXPECT_NEAR(stream.over(Fault::kNavigationJump), kBegin + kLimits.clear_after_s, 0.3) << "the new place is believed";
  EXPECT_EQ(stream.aborted(Fault::kNavigationJump), -1);

  SafetyStream wild;
  wild.run_to(kBegin);
  int n = 0;
  wild.on_fix = [&](Navigation& fix) { fix.X_WB.translation.x() += ++n % 2 == 0 ? 50 : -50; };
  wild.run_to(kBegin + 30);
  EXPECT_NEAR(wild.aborted(Fault::kNavigationJump), kBegin + kLimits.jump_abort_s, 0.3);
}

// A fix by satellites after a long dive corrects by what the estimate owned up to.
TEST(FaultsOfNavigation, AnOwnedUpErrorMayBeCorrected) {
  SafetyStream stream;
  stream.sigma = 6;
  stream.run_to(kBegin);
  stream.sigma = 1;
  stream.on_fix = [](Navigation& fix) { fix.X_WB.translation.y() += 12; };
  stream.run_to(kBegin + 5);
  EXPECT_EQ(stream.raised(Fault::kNavigationJump), -1);
}

TEST(FaultsOfNavigation, Drift) {
  SafetyStream stream;
  expect_row(
      stream, Fault::kNavigationDrift, 5, [&] { stream.sigma = 10.5; }, [&] { stream.sigma = 2; },
      {kCycle, Act::kSlow, 0});
  EXPECT_THAT(stream.reason(Fault::kNavigationDrift), HasSubstr("10.5 m, 10.0 m allowed"));
}

TEST(FaultsOfNavigation, DepthLost) {
  SafetyStream stream;
  const auto say = [&](HealthState state) { stream.tell(Health{stream.now(), "depth", state, 1, false, {}}); };
  expect_row(
      stream, Fault::kDepthLost, 8, [&] { say(HealthState::kLost); }, [&] { say(HealthState::kOk); },
      {kCycle, Act::kStop, kLimits.depth_sensor_abort_s});
}

TEST(FaultsOfNavigation, AltitudeLost) {
  SafetyStream stream;
  expect_row(
      stream, Fault::kAltitudeLost, 40, [&] { stream.altimeter = false; }, [&] { stream.altimeter = true; },
      {kLimits.altitude_silent_s, Act::kSlow, kLimits.altitude_abort_s});
}

// Over deep water there is no echo; that matters only to who is to hold an altitude.
TEST(FaultsOfNavigation, NoEchoOfTheBottomIsAFaultWhereAnAltitudeIsHeld) {
  for (const bool held : {false, true}) {
    SafetyStream stream;
    stream.run_to(kBegin);
    FollowOrder follow;
    follow.version = 2;
    follow.waypoints = {{1000, 0, 5, 1.5}};
    if (held) follow.altitude_m = 4;
    stream.tell(follow);
    stream.on_range = [](RangeReading& reading) { reading.range_m.reset(); };
    stream.run_to(kBegin + 5);
    EXPECT_EQ(stream.raised(Fault::kAltitudeLost) > 0, held);
  }
}

TEST(FaultsOfTheWay, NotFollowed) {
  // Swept aside by a current across.
  SafetyStream aside;
  aside.run_to(kBegin);
  aside.current = {0, 0.6};
  aside.run_to(kBegin + 120);
  const double out_s = kBegin + (kLimits.cross_track_m + 2 * aside.parameters.limits.turning_radius) / 0.6;
  EXPECT_NEAR(aside.raised(Fault::kWayNotFollowed), out_s + kLimits.off_route_s, 0.5);
  EXPECT_NEAR(aside.acted(Act::kSlow), aside.raised(Fault::kWayNotFollowed), kCycle);
  EXPECT_NEAR(aside.aborted(Fault::kWayNotFollowed), aside.raised(Fault::kWayNotFollowed) + kLimits.route_abort_s,
              kCycle);

  // Held by a current ahead.
  SafetyStream held;
  held.run_to(kBegin);
  held.current = {-1.5, 0};
  held.run_to(kBegin + kLimits.progress_s + 5);
  EXPECT_NEAR(held.raised(Fault::kWayNotFollowed), kBegin + kLimits.progress_s, 2);
  EXPECT_THAT(held.reason(Fault::kWayNotFollowed), HasSubstr("no nearer to way-point 1"));
}

// Led past moving bodies the vehicle may make no progress for two minutes more. ledger: S3-26
TEST(FaultsOfTheWay, TrafficIsGivenTwoMinutes) {
  SafetyStream stream;
  stream.run_to(kBegin);
  stream.current = {-1.5, 0};
  for (double t = 0; t < 200; t += 0.2) {
    stream.tell(MotionOrder{});
    stream.run_to(kBegin + t);
  }
  EXPECT_NEAR(stream.raised(Fault::kWayNotFollowed), kBegin + kLimits.progress_s + 120, 3);
}

TEST(FaultsOfTheWay, PlanningTheSameWayAgainIsNoProgress) {
  SafetyStream stream;
  stream.run_to(kBegin);
  stream.current = {-1.5, 0};
  for (int i = 0; i < 10; ++i) {
    FollowOrder again;
    again.version = static_cast<std::uint32_t>(2 + i);
    again.waypoints = {{1000, 0, 5, 1.5}};
    stream.tell(again);
    stream.run_to(kBegin + 3 * (i + 1));
  }
  EXPECT_NEAR(stream.raised(Fault::kWayNotFollowed), kBegin + kLimits.progress_s, 2);
}

// Before the first sweep has ended there is no map, and that is no fault.
TEST(FaultsOfTheWay, TheFirstLookTakesItsTime) {
  SafetyOfficer officer({}, test::hovering());
  Outbox out;
  OperatorCommand start;
  start.kind = OperatorCommand::Kind::kStart;
  start.plan = std::make_shared<const MissionPlan>(test::plan_north());
  officer.on_message(start, Time{}, out);
  RouteRefused refused;
  refused.reason = RouteRefused::Reason::kNoMap;
  officer.on_message(refused, Time{}, out);
  double raised = -1;
  for (int i = 1; i < 150; ++i) {
    officer.tick(Time(seconds(0.1 * i)), out);
    if (raised < 0 && officer.raised(Fault::kNoPath)) raised = 0.1 * i;
  }
  EXPECT_NEAR(raised, kLimits.startup_s, kCycle);
}

TEST(FaultsOfTheWay, StayingWhereItIsToStayIsNoFault) {
  SafetyStream stream;
  stream.run_to(kBegin);
  stream.speed_ordered = 0;
  stream.run_to(kBegin + 120);
  EXPECT_EQ(stream.count_reports(), 0u);
}

void expect_refusal(Fault fault, RouteRefused::Reason reason, Act action, double abort_s) {
  SafetyStream stream;
  RouteRefused refused;
  refused.reason = reason;
  refused.why = "buoy A stands there";
  expect_row(
      stream, fault, abort_s + 5, [&] { stream.tell(refused); }, [&] { stream.tell(RoutePlanned{}); },
      {kCycle, action, abort_s, 0});
  EXPECT_THAT(stream.reason(fault), HasSubstr("buoy A stands there"));
}

TEST(FaultsOfTheWay, InsideAnObstacle) {
  expect_refusal(Fault::kInsideObstacle, RouteRefused::Reason::kStartBlocked, Act::kStop, kLimits.blocked_abort_s);
}

// ledger: S6-50
TEST(FaultsOfTheWay, InsideAnObstacleAtTheStartIsSeenBeforeAnyRoute) {
  SafetyOfficer officer({}, test::hovering());
  Outbox out;
  OperatorCommand start;
  start.kind = OperatorCommand::Kind::kStart;
  start.plan = std::make_shared<const MissionPlan>(test::plan_north());
  officer.on_message(start, Time{}, out);
  ObstacleScan scan;
  Hazard hazard;
  hazard.outline = {{-2, -2}, {3, -2}, {3, 2}, {-2, 2}};
  scan.hazards = {hazard};
  officer.on_message(scan, Time{}, out);
  officer.tick(Time(seconds(0.1)), out);
  EXPECT_TRUE(officer.raised(Fault::kInsideObstacle));
  EXPECT_EQ(officer.action().kind, Act::kStop);
  officer.on_message(RoutePlanned{}, Time(seconds(0.2)), out);
  officer.tick(Time(seconds(0.2)), out);
  EXPECT_FALSE(officer.raised(Fault::kInsideObstacle)) << "there is a way out";
  officer.on_message(scan, Time(seconds(0.3)), out);
  officer.tick(Time(seconds(0.3)), out);
  EXPECT_FALSE(officer.raised(Fault::kInsideObstacle)) << "and it may lead through what was taken for an obstacle";
}

TEST(FaultsOfTheWay, NoPath) {
  expect_refusal(Fault::kNoPath, RouteRefused::Reason::kNoPath, Act::kStop, kLimits.blocked_abort_s);
  expect_refusal(Fault::kNoPath, RouteRefused::Reason::kNoMap, Act::kStop, kLimits.blocked_abort_s);
}

RouteRefused no_path() {
  RouteRefused refused;
  refused.reason = RouteRefused::Reason::kNoPath;
  return refused;
}

// ledger: S2-17
TEST(FaultsOfTheWay, AVehicleThatWaitsForItsTurnNeedsNoPath) {
  SafetyStream stream;
  stream.run_to(kBegin);
  stream.tell(PassageWait{true, ""});
  stream.tell(no_path());
  stream.run_to(kBegin + 100);
  EXPECT_EQ(stream.raised(Fault::kNoPath), -1);
  stream.tell(PassageWait{false, ""});
  stream.run_to(kBegin + 101);
  EXPECT_NEAR(stream.raised(Fault::kNoPath), kBegin + 100, 0.2);
}

// After a dropped point the Executive Officer may have nowhere else to go. ledger: S2-17
TEST(FaultsOfTheWay, NoPathIsNoFaultWhereNoRouteIsAskedFor) {
  SafetyStream stream;
  stream.run_to(kBegin);
  stream.tell(no_path());
  stream.run_to(kBegin + 10);
  EXPECT_GE(stream.raised(Fault::kNoPath), kBegin);
  stream.tell(PointReport{PointReport::Kind::kDropped, 3, "", true});
  stream.run_to(kBegin + 100);
  EXPECT_EQ(stream.aborted(Fault::kNoPath), -1);
  stream.tell(RouteRequest{});
  stream.run_to(kBegin + 200);
  EXPECT_NEAR(stream.aborted(Fault::kNoPath), kBegin + 100 + kLimits.blocked_abort_s, 0.3);
}

// The levels of command try other points first; a point that is tried again is no other one. ledger: S2-17
TEST(FaultsOfTheWay, NoPathCountsAnewForEachPointThatIsTried) {
  SafetyStream stream;
  stream.run_to(kBegin);
  stream.tell(no_path());
  stream.run_to(kBegin + 60);
  stream.tell(PointReport{PointReport::Kind::kTaken, 7, ""});
  stream.run_to(kBegin + 130);
  EXPECT_EQ(stream.aborted(Fault::kNoPath), -1);
  stream.tell(PointReport{PointReport::Kind::kTaken, 7, ""});
  stream.run_to(kBegin + 136);
  EXPECT_NEAR(stream.aborted(Fault::kNoPath), kBegin + 60 + kLimits.blocked_abort_s, 0.3);
}

TEST(FaultsOfTheWay, PlannerOverBudget) {
  expect_refusal(Fault::kPlannerOverBudget, RouteRefused::Reason::kOutOfBudget, Act::kSlow, kLimits.budget_abort_s);
  SafetyStream stream;
  stream.run_to(kBegin);
  RouteRefused refused;
  refused.reason = RouteRefused::Reason::kOutOfBudget;
  stream.tell(refused);
  stream.run_to(kBegin + 10);
  EXPECT_NEAR(stream.acted(Act::kStop), stream.acted(Act::kSlow) + kLimits.budget_stop_s, kCycle);
}

TEST(FaultsOfTheWay, APointThatIsBlockedIsNoFaultOfTheWay) {
  SafetyStream stream;
  stream.run_to(kBegin);
  RouteRefused refused;
  refused.reason = RouteRefused::Reason::kGoalBlocked;
  stream.tell(refused);
  stream.run_to(kBegin + 10);
  EXPECT_EQ(stream.count_reports(), 0u);
}

// Abort within one cycle of crossing; and, beyond the paper, a warning before it.
// ledger: S6-39
TEST(Limits, FenceBreached) {
  MissionPlan plan = test::plan_north();
  // Not convex: a notch reaches in from the north.
  plan.fence = {{-50, -50}, {60, -50}, {60, -2}, {40, 0}, {60, 2}, {60, 50}, {-50, 50}};
  SafetyStream stream(test::hovering(), {}, plan);
  stream.obeys = false;
  stream.run_to(40);
  double out_s = -1;
  for (double t = 0; t < 40 && out_s < 0; t += 0.1) {
    if (!encloses(plan.fence, {1.5 * (t + 0.1), 0})) out_s = t;
  }
  EXPECT_NEAR(stream.raised(Fault::kFenceBreach), out_s, kCycle);
  EXPECT_EQ(stream.aborted(Fault::kFenceBreach), stream.raised(Fault::kFenceBreach));
  EXPECT_EQ(stream.acted(Act::kStop), stream.raised(Fault::kFenceBreach));
}

// ledger: S6-39
TEST(Limits, FenceAhead) {
  MissionPlan plan = test::plan_north();
  plan.fence = {{-50, -50}, {40, -50}, {40, 50}, {-50, 50}};
  SafetyStream stream(test::hovering(), {}, plan);
  stream.run_to(30);
  const double stop_m = 1.5 * kLimits.reaction_s + 1.5 * 1.5 / (2 * 0.5) + kLimits.collision_margin_m;
  EXPECT_NEAR(stream.raised(Fault::kFenceAhead), (40 - stop_m) / 1.5, 0.2);
  EXPECT_EQ(stream.acted(Act::kSlow), stream.raised(Fault::kFenceAhead));
  EXPECT_EQ(stream.raised(Fault::kFenceBreach), -1) << "yet";
}

// A vehicle that cannot stop would slow down and go over it.
// ledger: S6-39 S2-E10
TEST(Limits, AVehicleThatCannotStopTurnsBeforeTheFence) {
  MissionPlan plan = test::plan_north();
  plan.fence = {{-50, -50}, {60, -50}, {60, 50}, {-50, 50}};
  for (const bool surfaces : {false, true}) {
    SafetyStream stream(test::flying(), {}, plan);
    stream.current = {0.3, 0.1};
    if (surfaces) {
      stream.on_health = [&](Health& health) { health.leak = stream.time_s() > 10; };
    }
    double northmost = 0;
    for (double s = 1; s < 180; ++s) {
      stream.run_to(s);
      northmost = std::max(northmost, stream.place.x());
    }
    EXPECT_GT(stream.raised(Fault::kFenceAhead), 0) << surfaces;
    EXPECT_EQ(stream.raised(Fault::kFenceBreach), -1) << surfaces;
    EXPECT_GT(northmost, 40) << "not before it must: " << surfaces;
    if (!surfaces) {
      EXPECT_EQ(stream.acted(Act::kTurn), stream.raised(Fault::kFenceAhead));
    }
  }
}

TEST(Limits, AFenceOfAnySizeIsJudgedAtOnce) {
  for (const double m : {1e3, 1e9, 1e17, 1e200, 1e300}) {
    MissionPlan plan = test::plan_north();
    plan.fence = {{-m, -m}, {60, -m}, {60, m}, {-m, m}};
    SafetyStream stream(test::flying(), {}, plan);
    stream.run_to(20);
    EXPECT_EQ(stream.raised(Fault::kFenceBreach), -1) << m;
  }
}

// In open water it stays where it began to surface, carried by the current only.
TEST(Limits, AVehicleThatCannotStopSurfacesInACircle) {
  SafetyStream stream(test::flying());
  stream.on_health = [&](Health& health) { health.leak = stream.time_s() > 10; };
  stream.run_to(12);
  const Eigen::Vector2d begun = stream.place;
  for (double s = 13; s < 120; ++s) {
    stream.run_to(s);
    ASSERT_EQ(stream.officer.action().kind, Act::kSurface);
    EXPECT_LT((stream.place - begun).norm(), 15);
  }
}

TEST(Limits, TooDeep) {
  SafetyStream stream;
  stream.obeys = false;
  stream.run_to(kBegin);
  stream.depth = 20.4;
  stream.run_to(kBegin + 5);
  EXPECT_EQ(stream.count_reports(), 0u) << "within the slack";
  stream.depth = 21;
  stream.run_to(kBegin + 6);
  EXPECT_NEAR(stream.raised(Fault::kTooDeep), kBegin + 5, kCycle);
  EXPECT_EQ(stream.officer.action().kind, Act::kSurface);
  stream.run_to(kBegin + 30);
  EXPECT_NEAR(stream.aborted(Fault::kTooDeep), kBegin + 5 + kLimits.depth_abort_s, 0.2);
}

TEST(Limits, TooLow) {
  SafetyStream stream;
  stream.obeys = false;
  stream.run_to(kBegin);
  stream.altitude = 0.6;
  stream.run_to(kBegin + 1);
  EXPECT_NEAR(stream.raised(Fault::kTooLow), kBegin + 0.1, kCycle);
  ASSERT_EQ(stream.officer.action().kind, Act::kTurn);
  const double least = 1 / kLimits.clear_share;
  EXPECT_NEAR(stream.officer.action().setpoint.depth, 5 - (least - 0.6) - 0.5, 0.1) << "above what ends it";
  EXPECT_EQ(stream.officer.action().setpoint.speed, kLimits.slow_speed);
  stream.altitude = 1.3;
  stream.run_to(kBegin + 6);
  EXPECT_NEAR(stream.over(Fault::kTooLow), kBegin + 1 + kLimits.clear_after_s, 0.3);
}

// A vehicle that cannot rise any more must not go on towards a bottom that does.
TEST(Limits, TooLowAtTheSurfaceStops) {
  SafetyStream stream;
  stream.obeys = false;
  stream.depth = 0;
  stream.run_to(kBegin);
  stream.altitude = 0.6;
  stream.run_to(kBegin + 1);
  ASSERT_EQ(stream.officer.action().kind, Act::kTurn);
  EXPECT_NEAR(stream.officer.action().setpoint.depth, 0, 1e-9);
  EXPECT_EQ(stream.officer.action().setpoint.speed, 0);
}

TEST(Limits, MissionTooLong) {
  MissionPlan plan = test::plan_north();
  plan.limits.max_duration_s = 30;
  plan.at_end = MissionEnd::kReturn;
  SafetyStream stream(test::hovering(), {}, plan);
  stream.run_to(60);
  EXPECT_NEAR(stream.aborted(Fault::kMissionTooLong), 30, 0.2);
  EXPECT_EQ(stream.end(), MissionEnd::kReturn);
  EXPECT_EQ(stream.officer.action().kind, Act::kNone);
}

// ledger: S6-33
TEST(FaultsOfTheVehicle, AgentDead) {
  for (const char* name : {"navigator", "FLSDetector", "executive officer", "executive_officer", "pilot", "Captain"}) {
    SafetyStream stream;
    stream.run_to(kBegin);
    stream.tell(AgentLost{name, false, "a test killed it"});
    stream.run_to(kBegin + 10);
    EXPECT_NEAR(stream.raised(Fault::kAgentDead), kBegin, kCycle) << name;
    EXPECT_EQ(stream.acted(Act::kStop), stream.raised(Fault::kAgentDead));
    EXPECT_EQ(stream.aborted(Fault::kAgentDead), stream.raised(Fault::kAgentDead));
    EXPECT_NEAR(stream.acted(Act::kSurface), kBegin + kLimits.agent_surface_s, 0.2) << "whoever is left to do it";
  }
  SafetyStream other;
  other.run_to(kBegin);
  other.tell(AgentLost{"back-seat driver 2", true, "no answer"});
  other.run_to(kBegin + 10);
  EXPECT_EQ(other.count_reports(), 0u) << "the vehicle can do without";
}

// ledger: S1-43
TEST(FaultsOfTheVehicle, Leak) {
  SafetyStream stream;
  stream.run_to(kBegin);
  stream.on_health = [](Health& health) { health.leak = true; };
  stream.run_to(kBegin + 5);
  stream.on_health = {};
  stream.run_to(kBegin + 60);
  EXPECT_NEAR(stream.acted(Act::kSurface), kBegin, kCycle);
  EXPECT_EQ(stream.aborted(Fault::kLeak), stream.raised(Fault::kLeak));
  EXPECT_EQ(stream.end(), MissionEnd::kSurface);
  EXPECT_EQ(stream.over(Fault::kLeak), -1) << "stays known when the float swims up again";
}

TEST(FaultsOfTheVehicle, BatteryLow) {
  MissionPlan plan = test::plan_north();
  plan.at_end = MissionEnd::kReturn;
  for (const bool hold : {false, true}) {
    if (hold) plan.at_end = MissionEnd::kHold;
    SafetyStream stream(test::hovering(), {}, plan);
    stream.run_to(kBegin);
    stream.on_health = [](Health& health) { health.battery_share = 0.14F; };
    stream.run_to(kBegin + 5);
    EXPECT_NEAR(stream.aborted(Fault::kBatteryLow), kBegin, kCycle);
    EXPECT_EQ(stream.end(), hold ? MissionEnd::kSurface : MissionEnd::kReturn);
  }
}

TEST(FaultsOfTheVehicle, ThrusterLost) {
  SafetyStream stream;
  const auto say = [&](HealthState state) { stream.tell(Health{stream.now(), "thruster.2", state, 1, false, {}}); };
  expect_row(
      stream, Fault::kThrusterLost, 8, [&] { say(HealthState::kDegraded); }, [&] { say(HealthState::kOk); },
      {kCycle, Act::kSlow, kLimits.thruster_abort_s});
}

TEST(FaultsOfTheVehicle, HealthSilent) {
  SafetyStream stream;
  expect_row(
      stream, Fault::kHealthSilent, 20, [&] { stream.reports = false; }, [&] { stream.reports = true; },
      {kLimits.health_silent_s, Act::kSlow});
}

TEST(FaultsOfTheVehicle, LinkLost) {
  for (const LinkPolicy policy : {LinkPolicy::kContinue, LinkPolicy::kReturn, LinkPolicy::kSurface}) {
    SafetyConfig config;
    config.link_policy = policy;
    SafetyStream stream(test::hovering(), config);
    stream.beats = true;
    expect_row(
        stream, Fault::kLinkLost, 120, [&] { stream.beats = false; }, [&] { stream.beats = true; },
        {config.link_silent_s, Act::kNone, policy == LinkPolicy::kContinue ? -1 : config.link_abort_s});
    if (policy != LinkPolicy::kContinue) {
      EXPECT_EQ(stream.end(), policy == LinkPolicy::kReturn ? MissionEnd::kReturn : MissionEnd::kSurface);
    }
  }
}

TEST(FaultsOfTheVehicle, ClockJump) {
  for (const double by : {-100.0, -3.0, 3.0, 1e6}) {
    SafetyStream stream;
    stream.run_to(kBegin);
    stream.clock_off_s = by;
    stream.run_to(kBegin + 30);
    EXPECT_NEAR(stream.raised(Fault::kClockJump), kBegin, kCycle) << by;
    EXPECT_EQ(stream.acted(Act::kSlow), stream.raised(Fault::kClockJump));
    EXPECT_NEAR(stream.over(Fault::kClockJump), kBegin + kLimits.clear_after_s, 1.2) << "the new times are believed";
    EXPECT_EQ(stream.raised(Fault::kSonarSilent), -1);
    EXPECT_EQ(stream.raised(Fault::kNavigationSilent), -1);
    EXPECT_EQ(stream.raised(Fault::kNavigationJump), -1);
  }
}

// The logical clock itself: no watchdog takes the time that was jumped over for silence.
TEST(FaultsOfTheVehicle, AJumpOfTheLogicalClockTripsNoOtherWatchdog) {
  SafetyStream stream;
  stream.run_to(kBegin);
  Outbox out;
  stream.officer.tick(stream.now() + seconds(500), out);
  EXPECT_TRUE(stream.officer.raised(Fault::kClockJump));
  for (const FaultRow& row : fault_table()) {
    EXPECT_EQ(stream.officer.raised(row.fault), row.fault == Fault::kClockJump) << row.name;
  }
}

TEST(FaultsOfTheVehicle, DiskFull) {
  SafetyStream stream;
  const auto say = [&](HealthState state) { stream.tell(Health{stream.now(), "disk", state, 1, false, {}}); };
  expect_row(
      stream, Fault::kDiskFull, 10, [&] { say(HealthState::kLost); }, [&] { say(HealthState::kOk); },
      {kCycle, Act::kNone});
}

// ledger: S2-E10
TEST(SafetyOfficer, AVehicleThatCannotStopSurfaces) {
  SafetyStream stream(test::flying());
  stream.run_to(kBegin);
  stream.pings = false;
  stream.run_to(kBegin + 5);
  EXPECT_EQ(stream.acted(Act::kStop), -1);
  EXPECT_NEAR(stream.acted(Act::kSurface), kBegin + kLimits.sonar_silent_s, 0.2);
  EXPECT_EQ(stream.officer.action().setpoint.speed, 0.7);
}

// A stop must not hold a vehicle down that is on its way to the surface, nor is a fault over because the mission is.
TEST(SafetyOfficer, AStopLetsAVehicleSurface) {
  SafetyStream stream;
  stream.run_to(kBegin);
  stream.pings = false;
  stream.run_to(kBegin + 5);
  ASSERT_EQ(stream.officer.action().kind, Act::kStop);
  FollowOrder up;
  up.version = 2;
  up.surface = true;
  stream.tell(up);
  MissionReport aborted;
  aborted.phase = MissionPhase::kFinished;
  stream.tell(aborted);
  stream.run_to(kBegin + 20);
  EXPECT_EQ(stream.officer.action().kind, Act::kSurface);
  EXPECT_TRUE(stream.officer.raised(Fault::kSonarSilent));
}

TEST(SafetyOfficer, OfSeveralFaultsTheStrongestActionHoldsUntilItIsOver) {
  SafetyStream stream;
  stream.run_to(kBegin);
  stream.tell(Health{stream.now(), "thruster", HealthState::kLost, 1, false, {}});
  stream.run_to(kBegin + 2);
  EXPECT_EQ(stream.officer.action().kind, Act::kSlow);
  stream.pings = false;
  stream.run_to(kBegin + 5);
  EXPECT_EQ(stream.officer.action().kind, Act::kStop);
  EXPECT_EQ(stream.officer.action().fault, "sonar silent");
  stream.pings = true;
  stream.run_to(kBegin + 15);
  EXPECT_EQ(stream.officer.action().kind, Act::kSlow);
  EXPECT_EQ(stream.officer.action().fault, "thruster lost");
}

}  // namespace
}  // namespace isobath
