// Way-points and places on the vehicle's own estimate, in a current, with each kind of vehicle.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/plant.hpp>
#include <limits>
#include <numbers>
#include <tests/support/count_allocations.hpp>
#include <tests/support/sanitized.hpp>
#include <tests/vehicle/models.hpp>

namespace isobath::guidance_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDt = 0.1;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Pose pose(double north, double east, double heading_deg = 0, double depth = 5) {
  return {Rotation::from_heading(Angle::degrees(heading_deg)), {north, east, depth}};
}

Vector3d velocity_W(const VehicleState& s) { return s.X_WB.rotation * s.v_B; }

WaterConditions flowing(double north, double east) { return {1025, {north, east, 0}}; }

/// A box-shaped vehicle that hovers but makes no sway: two thrusters ahead.
VehicleModel twin_screw() {
  VehicleModel model = test::rov();
  model.thruster_axes(1) = 0;
  return model;
}

// ledger: S6-37
TEST(Waypoints, AreReachedWithinTheRadiusAndNotBeyond) {
  for (const double bearing : {0.0, 37.0, 90.0, 180.0, -120.0}) {
    for (const double off : {-80.0, 0.0, 45.0}) {
      const auto reached_from = [&](double distance) {
        const Angle leg = Angle::degrees(bearing), side = Angle::degrees(bearing + 180 + off);
        LineOfSight guidance({8, 5}, {{100 * cos(leg), 100 * sin(leg), 5, 1}, {500, 500, 5, 1}});
        guidance.step(pose(0, 0), {}, kDt);
        guidance.step(pose(100 * cos(leg) + distance * cos(side), 100 * sin(leg) + distance * sin(side)), {}, kDt);
        EXPECT_EQ(guidance.missed(), 0u);
        return guidance.reached() == 1;
      };
      EXPECT_TRUE(reached_from(4.99)) << bearing << ' ' << off;
      EXPECT_FALSE(reached_from(5.01)) << bearing << ' ' << off;
    }
  }
}

// Way-points closer together than the vehicle can turn: whatever it cannot reach it passes, and it comes to the end in
// the time that the way takes, with a detour of a turn a way-point. ledger: S6-37
TEST(Waypoints, AreNeverCircledForEver) {
  const VehicleModel model = test::remus();
  std::size_t missed = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(seed);
    std::vector<Waypoint> path;
    double length = 0;
    Vector2d before = Vector2d::Zero();
    for (int i = 0; i < 8; ++i) {
      const double north = random.uniform(-15, 15);
      const double east = random.uniform(-15, 15);
      path.push_back({north, east, 10, 1.5});
      length += (Vector2d(north, east) - before).norm();
      before = {north, east};
    }
    KinematicVehicle vehicle(model, test::at_speed(1.5));
    LineOfSight guidance({8, 1.5}, path, parameters_of(model));
    double seconds = 0;
    const WaterConditions water = flowing(0.3, -0.2);
    for (; !guidance.finished() && seconds < 1000; seconds += kDt) {
      vehicle.step(guidance.step(vehicle.state(), kDt), water, kDt);
    }
    EXPECT_TRUE(guidance.finished()) << seed;
    EXPECT_LT(seconds, (length + 8 * 4 * std::numbers::pi * 6) / 0.7) << seed;
    missed += guidance.missed();
  }
  EXPECT_GT(missed, 0u);
}

struct Crossing {
  const char* name;
  VehicleModel model;
  PlantKind kind;
  double speed;
};

std::vector<Crossing> crossings() {
  return {{"torpedo, dynamic", test::remus(), PlantKind::kDynamic, 1.5},
          {"torpedo, kinematic", test::remus(), PlantKind::kKinematic, 1.5},
          {"hovering, dynamic", test::rov(), PlantKind::kDynamic, 0.8},
          {"hovering, kinematic", test::rov(), PlantKind::kKinematic, 0.8},
          {"without sway, kinematic", twin_screw(), PlantKind::kKinematic, 0.8}};
}

// The greatest distance from a line of 300 m on its last third, by truth.
double offset(const Crossing& c, const GuidanceConfig& config, bool knows_velocity, const WaterConditions& water) {
  const auto vehicle = make_plant(c.model, c.kind, test::at_speed(c.speed));
  LineOfSight guidance(config, {{300, 0, 10, c.speed}}, parameters_of(c.model));
  double worst = 0;
  for (int i = 0; i < 8000 && !guidance.finished(); ++i) {
    const VehicleState& s = vehicle->state();
    const std::optional<Vector3d> v_W = knows_velocity ? std::optional(velocity_W(s)) : std::nullopt;
    vehicle->step(guidance.step(s.X_WB, v_W, kDt), water, kDt);
    if (s.X_WB.translation.x() > 200) worst = std::max(worst, std::abs(s.X_WB.translation.y()));
  }
  EXPECT_EQ(guidance.reached(), 1u) << c.name;
  return worst;
}

// Half a metre a second across, or from abaft or ahead of the beam; with a velocity log and without one.
// ledger: S6-37 S7-05 S7-09
TEST(Waypoints, AreFollowedOnTheLineInACurrent) {
  ISOBATH_NOT_SANITIZED();
  for (const Crossing& c : crossings()) {
    for (const WaterConditions& water : {flowing(0, 0.5), flowing(0.3, -0.4), flowing(-0.2, 0.45)}) {
      EXPECT_LT(offset(c, {}, true, water), 0.2) << c.name << water.current_W.transpose();
      EXPECT_LT(offset(c, {}, false, water), 0.2) << c.name << water.current_W.transpose();
    }
  }
  // Without either it would run beside the line: by lookahead tan(crab).
  GuidanceConfig neither;
  neither.integral_gain = neither.drift_time = 0;
  EXPECT_NEAR(offset(crossings()[1], neither, true, flowing(0, 0.5)), 8 * std::tan(std::asin(0.5 / 1.58)), 0.2);
}

// What is known of the current on one leg serves the next, also the other way round. ledger: S6-37
TEST(Waypoints, KeepWhatWasLearntOfTheCurrentRoundACorner) {
  for (const bool knows_velocity : {false, true}) {
    KinematicVehicle vehicle(test::remus(), test::at_speed(1.5));
    LineOfSight guidance({}, {{300, 0, 10, 1.5}, {300, 20, 10, 1.5}, {0, 20, 10, 1.5}});
    double settled = 0, worst = 0;
    for (int i = 0; i < 8000 && !guidance.finished(); ++i) {
      const VehicleState& s = vehicle.state();
      const std::optional<Vector3d> v_W = knows_velocity ? std::optional(velocity_W(s)) : std::nullopt;
      vehicle.step(guidance.step(s.X_WB, v_W, kDt), flowing(0, 0.5), kDt);
      settled = guidance.next() == 2 ? settled + kDt : 0;
      if (settled > 30) worst = std::max(worst, std::abs(s.X_WB.translation.y() - 20));
    }
    EXPECT_LT(worst, 0.4) << knows_velocity;
  }
}

// A new way in mid-course: the same line gives the same answer, as if nothing had happened. ledger: S6-37
TEST(Waypoints, CanBeReplacedUnderWay) {
  KinematicVehicle vehicle(test::remus(), test::at_speed(1.5));
  LineOfSight kept({}, {{200, 0, 10, 1.5}, {300, 100, 10, 1.5}});
  const WaterConditions water = flowing(0, 0.5);
  for (int i = 0; i < 600; ++i) vehicle.step(kept.step(vehicle.state(), kDt), water, kDt);
  LineOfSight replaced = kept;
  replaced.follow({{250, 0, 10, 1.5}, {300, 100, 12, 1.0}}, kept.leg_start());
  const Setpoint a = kept.step(vehicle.state(), kDt), b = replaced.step(vehicle.state(), kDt);
  EXPECT_EQ(a.heading, b.heading);
  EXPECT_EQ(replaced.next(), 0u);
  EXPECT_EQ(replaced.waypoints().size(), 2u);

  LineOfSight aside = kept;  // from where it is, to starboard: the integral serves the new line
  aside.follow({{vehicle.state().X_WB.translation.x(), 100, 10, 1.5}});
  aside.step(vehicle.state(), kDt);
  EXPECT_NEAR(aside.cross_track(), 0, 1e-9);
  EXPECT_THROW(aside.follow({}), Error);
}

// A vehicle that cannot get back to its line, or is far off it, keeps a sensible heading, and is not the worse for it.
// ledger: S6-37
TEST(Waypoints, DoNotWindUp) {
  GuidanceConfig config;
  config.drift_time = 0;
  LineOfSight stuck(config, {{1000, 0, 5, 1}}), fresh(config, {{1000, 0, 5, 1}});
  stuck.step(pose(0, 0), {}, kDt);
  fresh.step(pose(0, 0), {}, kDt);
  for (int i = 0; i < 10000; ++i) stuck.step(pose(10, 20, -60), {}, kDt);  // far off the line: nothing to learn there
  EXPECT_EQ(stuck.step(pose(10, 5, -30), {}, kDt).heading, fresh.step(pose(10, 5, -30), {}, kDt).heading);
  double least = 0;
  for (int i = 0; i < 20000; ++i) {
    const Angle heading = stuck.step(pose(10, 5, -40), {}, kDt).heading;
    least = std::min(least, heading.degrees());
  }
  EXPECT_GE(least, -std::atan((5.0 + 8) / 8) * 180 / std::numbers::pi - 1e-6);
  EXPECT_LT(least, -40);
}

// ledger: S6-37
TEST(Waypoints, StandWhereTheEstimateIsNotFinite) {
  LineOfSight guidance({}, {{100, 0, 5, 1}});
  const Setpoint before = guidance.step(pose(0, 1), {}, kDt);
  for (const Setpoint& s :
       {guidance.step(pose(kNaN, 0), {}, kDt), guidance.step(pose(0, 1), {}, kNaN), guidance.step(pose(0, 1), {}, 0)}) {
    EXPECT_EQ(s.heading, before.heading);
    EXPECT_EQ(s.speed, before.speed);
  }
  const Setpoint after = guidance.step(pose(0, 1), Vector3d(kNaN, 0, 0), kDt);
  EXPECT_TRUE(std::isfinite(after.heading.radians()));
}

// How far beyond the second leg a vehicle runs after a corner.
double overrun(double turn_deg, bool plans, const VehicleModel& model, double speed) {
  const Angle turn = Angle::degrees(turn_deg);
  const Vector2d along(cos(turn), sin(turn)), beyond(sin(turn), -cos(turn));
  const Vector2d corner(100, 0), end = corner + 150 * along;
  GuidanceConfig config;
  config.corner_tolerance = 1.5;
  const auto parameters = plans ? std::optional(parameters_of(model)) : std::nullopt;
  LineOfSight guidance(config, {{corner.x(), corner.y(), 10, speed}, {end.x(), end.y(), 10, speed}}, parameters);
  KinematicVehicle vehicle(model, test::at_speed(speed));
  double worst = 0;
  for (int i = 0; i < 5000 && !guidance.finished(); ++i) {
    const Setpoint s = guidance.step(vehicle.state(), kDt);
    if (guidance.next() == 1) {
      worst = std::max(worst, beyond.dot(vehicle.state().X_WB.translation.head<2>() - corner));
    }
    if (!guidance.finished()) {
      EXPECT_GE(s.speed, plans ? parameters_of(model).min_speed : speed);
    }
    vehicle.step(s, flowing(0, 0), kDt);
  }
  EXPECT_TRUE(guidance.finished());
  return worst;
}

// A quick vehicle that turns slowly slows before corners that it would overrun; where it cannot turn more tightly by
// being slow, it goes on. ledger: S6-37 S7-14
TEST(SpeedPlan, TakesCornersWithinTheTolerance) {
  VehicleModel quick = test::remus();
  quick.limits.max_speed = 3;
  quick.limits.turning_radius = 0;
  quick.limits.max_yaw_rate = Angle::degrees(12);
  quick.limits.max_acceleration = 0.4;
  quick.autopilot.min_flow = 0.1;
  double unplanned = 0;
  for (const double turn : {20.0, 45.0, 90.0, 120.0, 150.0}) {
    EXPECT_LT(overrun(turn, true, quick, 3), 1.5 + 0.75) << turn;
    unplanned = std::max(unplanned, overrun(turn, false, quick, 3));
  }
  EXPECT_GT(unplanned, 5);

  VehicleModel torpedo = test::remus();
  torpedo.limits.turning_radius = 6;  // at any speed: its greatest yaw rate would allow less
  LineOfSight guidance({}, {{30, 0, 10, 1.5}, {0, 1, 10, 1.5}}, parameters_of(torpedo));
  for (double north = 0; north < 26; north += 0.5) {
    EXPECT_NEAR(guidance.step(pose(north, 0), {}, kDt).speed, 1.5, 1e-9);
  }
}

// ledger: S6-37
TEST(SpeedPlan, StopsAVehicleThatHoversAtItsLastWaypointAndKeepsTheOtherMoving) {
  const VehicleModel rov = test::rov();
  DynamicVehicle hovering(rov, test::at_speed(0.8));
  LineOfSight there({8, 0.6}, {{30, 0, 10, 0.8}}, parameters_of(rov));
  double furthest = 0;
  for (int i = 0; i < 1500; ++i) {
    hovering.step(there.step(hovering.state(), kDt), flowing(0, 0), kDt);
    furthest = std::max(furthest, hovering.state().X_WB.translation.x());
  }
  EXPECT_TRUE(there.finished());
  EXPECT_LT(furthest, 30.6);
  EXPECT_GT(furthest, 29.4);

  const VehicleParameters torpedo = parameters_of(test::remus());
  LineOfSight past({}, {{30, 0, 10, 1.5}}, torpedo);
  EXPECT_EQ(past.step(pose(26, 0), {}, kDt).speed, 1.5);
  EXPECT_EQ(past.step(pose(29, 0), {}, kDt).speed, torpedo.min_speed);
}

// The last way-point as a corner: a vehicle that goes on from there neither stops nor overruns it.
// ledger: S2-41 S2-46
TEST(SpeedPlan, TakesTheLastWaypointAsACornerWhereItGoesOn) {
  const VehicleModel model = test::rov();
  const VehicleParameters parameters = parameters_of(model);
  const auto slowest_before = [&](const std::optional<Vector2d>& then) {
    LineOfSight guidance({8, 0.2}, {{60, 0, 5, 0.8}}, parameters);
    guidance.go_on_to(then);
    double slowest = 0.8;
    for (double x = 0; x < 59.7; x += 0.1) slowest = std::min(slowest, guidance.step(pose(x, 0), {}, kDt).speed);
    return slowest;
  };
  EXPECT_LT(slowest_before({}), 0.55) << "it brakes for the end";
  EXPECT_EQ(slowest_before(Vector2d(120, 0)), 0.8) << "straight on";
  const double corner = slowest_before(Vector2d(60, 60));
  EXPECT_GT(corner, slowest_before({}));
}

// ledger: S2-46
TEST(SpeedPlan, GoesAtFullSpeedIntoCornersWhereItIsSwitchedOff) {
  GuidanceConfig config{8, 1};
  config.slow_at_corners = false;
  LineOfSight guidance(config, {{60, 0, 5, 0.8}, {60, 60, 5, 0.8}}, parameters_of(test::rov()));
  for (double x = 0; x < 58.9; x += 0.1) EXPECT_EQ(guidance.step(pose(x, 0), {}, kDt).speed, 0.8);
}

// ledger: S7-15
TEST(StationKeeper, HoldsAPlaceInACurrent) {
  for (const bool sway : {true, false}) {
    for (const PlantKind kind : {PlantKind::kDynamic, PlantKind::kKinematic}) {
      if (!sway && kind == PlantKind::kDynamic) continue;
      const VehicleModel model = sway ? test::rov() : twin_screw();
      const auto vehicle = make_plant(model, kind, test::at_speed(0, 5));
      StationKeeper keeper({}, parameters_of(model));
      EXPECT_EQ(keeper.radius(keeper.place().speed), 0);
      keeper.hold({6, -4, 5, 0.6});
      double worst = 0;
      for (int i = 0; i < 3000; ++i) {
        const VehicleState& s = vehicle->state();
        vehicle->step(keeper.step(s.X_WB, velocity_W(s), kDt), flowing(0.1, 0.4), kDt);
        if (i > 2000) worst = std::max(worst, (s.X_WB.translation - Vector3d(6, -4, 5)).norm());
      }
      EXPECT_LT(worst, sway ? 0.15 : 2.5);
    }
  }
}

// A velocity estimate that is wrong by a decimetre a second must not cost a place: that is what the integral is for.
// ledger: S7-15
TEST(StationKeeper, LeavesNoOffsetByABiasOfTheSpeeds) {
  for (const double gain : {0.0, 0.02}) {
    StationConfig config;
    config.integral_gain = gain;
    StationKeeper keeper(config, parameters_of(test::rov()));
    keeper.hold({0, 0, 5, 0.6}, Angle());
    Vector2d p(3, -2);
    for (int i = 0; i < 3000; ++i) {
      const Setpoint s = keeper.step(pose(p.x(), p.y()), {}, kDt);
      p += kDt * (Vector2d(s.speed, s.sway_speed) + Vector2d(0.1, 0));
    }
    EXPECT_NEAR(p.norm(), gain > 0 ? 0 : 0.1 / config.gain, 0.01);
  }
}

// ledger: S7-15
TEST(StationKeeper, CirclesWhereTheVehicleCannotHover) {
  const VehicleModel model = test::remus();
  for (const PlantKind kind : {PlantKind::kDynamic, PlantKind::kKinematic}) {
    const auto vehicle = make_plant(model, kind, test::at_speed(1.5, 5));
    StationKeeper keeper({}, parameters_of(model));
    keeper.hold({40, 25, 5, 1.2});
    double nearest = 1e9, furthest = 0, turned = 0;
    Angle before;
    for (int i = 0; i < 4000; ++i) {
      const VehicleState& s = vehicle->state();
      const Setpoint wanted = keeper.step(s.X_WB, velocity_W(s), kDt);
      EXPECT_GE(wanted.speed, parameters_of(model).min_speed);
      vehicle->step(wanted, flowing(0.2, -0.2), kDt);
      const double distance = (s.X_WB.translation.head<2>() - Vector2d(40, 25)).norm();
      if (i > 1500) {
        nearest = std::min(nearest, distance);
        furthest = std::max(furthest, distance);
        turned += (s.X_WB.rotation.heading() - before).wrapped().degrees();
      }
      before = s.X_WB.rotation.heading();
    }
    EXPECT_GT(nearest, 0.7 * keeper.radius(keeper.place().speed));
    EXPECT_LT(furthest, 1.6 * keeper.radius(keeper.place().speed));
    EXPECT_GT(turned, 3 * 360);  // to starboard
  }
}

// On a leg that rises the set-point is the depth of where the vehicle will be when it has come after it.
// ledger: S5-53 S5-54
TEST(Waypoints, RiseAlongALegThatSaysWhereItBegins) {
  VehicleParameters parameters;
  parameters.depth_lag_s = 4;
  parameters.limits.max_speed = 2;
  const std::vector<Waypoint> way = {{0.5, 0, 8, 1}, {40, 0, 4, 1, 8.0}, {80, 0, 2, 1}};
  for (const bool known : {false, true}) {
    LineOfSight line({.acceptance_radius = 1}, way, known ? std::optional(parameters) : std::nullopt);
    const auto depth_at = [&](double north) {
      return line.step({Rotation(), {north, 0, 6}}, Vector3d(1, 0, 0), kDt).depth;
    };
    EXPECT_EQ(depth_at(-40), 8.0);
    depth_at(0);
    const double lead = known ? 4 : 0;
    for (double north = 2; north < 39; north += 4) {
      const double share = std::min(1.0, (north - 0.5 + lead) / 39.5);
      EXPECT_NEAR(depth_at(north), 8 - 4 * share, 0.01) << north;
    }
    EXPECT_EQ(depth_at(45), 2) << "at once";
  }
}

TEST(Waypoints, AllocateNothing) {
  LineOfSight guidance({}, {{50, 0, 5, 1}, {100, 0, 5, 1}}, parameters_of(test::remus()));
  StationKeeper keeper({}, parameters_of(test::rov()));
  const auto before = test::allocations();
  for (int i = 0; i < 10; ++i) {
    guidance.step(pose(i, 0), Vector3d(1, 0, 0), kDt);
    keeper.step(pose(i, 0), Vector3d(1, 0, 0), kDt);
  }
  EXPECT_EQ(test::allocations(), before);
}

// The water carries what the vehicle cannot hold: closed forms. ledger: S7-05 S7-14
TEST(KinematicVehicle, IsCarriedByTheCurrent) {
  const auto run = [](KinematicVehicle& vehicle, const Setpoint& s, const WaterConditions& water, double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / kDt)); ++i) {
      const Vector3d p = vehicle.state().X_WB.translation;
      vehicle.step(s, water, kDt);
      if (s.heading == Angle()) {  // the velocity that it states is the one that it makes
        EXPECT_LT(((vehicle.state().X_WB.translation - p) / kDt - velocity_W(vehicle.state())).norm(), 1e-9);
      }
    }
    return Vector3d(vehicle.state().X_WB.translation);
  };
  VehicleState start = test::at_speed(1);
  KinematicVehicle torpedo(test::remus(), start);  // ahead over ground as told, aside with the water
  EXPECT_LT((run(torpedo, {Angle(), 10, 1, 0}, flowing(0.3, 0.5), 60) - Vector3d(60, 30, 10)).norm(), 1e-6);

  start.v_B.setZero();
  KinematicVehicle rover(test::rov(), start);  // holds against it by sway
  EXPECT_LT((run(rover, {Angle(), 10, 0, 0}, flowing(0.3, 0.5), 60) - Vector3d(0, 0, 10)).norm(), 1e-6);
  // 1.2 m/s against a greatest speed of 0.9: it loses ground, 0.3 m/s after the first step.
  KinematicVehicle swept(test::rov(), start);
  EXPECT_NEAR(run(swept, {Angle(), 10, 0.9, 0}, flowing(-1.2, 0), 60).x(), -0.3 * 60, 0.05);

  // A turn in moving water is the turn in still water, carried along, where the speed through the water is the same.
  KinematicVehicle still(test::remus(), test::at_speed(1)), carried(test::remus(), test::at_speed(1));
  const Setpoint about{Angle::degrees(179), 10, 1, 0};
  const Vector3d a = run(still, about, flowing(0, 0), 10);
  const Vector3d b = run(carried, about, flowing(0, 0.001), 10);
  EXPECT_LT((b - a - Vector3d(0, 0.01, 0)).norm(), 0.01);
}

}  // namespace
}  // namespace isobath::guidance_test
