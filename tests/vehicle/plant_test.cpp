// Autopilot, guidance and the two plants behind one interface.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/plant.hpp>
#include <tests/support/count_allocations.hpp>
#include <tests/vehicle/models.hpp>

namespace isobath::plant_test {
namespace {

constexpr double kDt = 0.1;
const WaterConditions kSea{1025, {0, 0, 0}};

struct Outcome {
  bool finished = false;
  std::size_t reached = 0;
  double seconds = 0;
  double worst_offset = 0;  ///< from the line, once the turn onto it is over
};

Outcome run(VehiclePlant& plant, const std::vector<Waypoint>& path, const GuidanceConfig& config,
            const WaterConditions& water = kSea, double limit = 600) {
  LineOfSight guidance(config, path);
  Outcome out;
  double settled = 0;
  std::size_t leg = 0;
  for (int i = 0; i * kDt < limit && !out.finished; ++i) {
    const Setpoint setpoint = guidance.step(plant.state(), kDt);
    settled = guidance.next() == leg ? settled + kDt : 0;
    leg = guidance.next();
    out.finished = guidance.finished();
    out.reached = guidance.reached();
    out.seconds = i * kDt;
    if (settled > 20 && !out.finished) out.worst_offset = std::max(out.worst_offset, std::abs(guidance.cross_track()));
    plant.step(setpoint, water, kDt);
  }
  return out;
}

const std::vector<Waypoint> kBox = {{60, 0, 8, 1.5}, {60, 60, 10, 1.5}, {0, 60, 12, 1.5}, {0, 0, 10, 1.5}};
const std::vector<Waypoint> kSmallBox = {{8, 0, 3, 0.5}, {8, 8, 4, 0.5}, {0, 8, 5, 0.5}, {0, 0, 3, 0.5}};

// ledger: S7-14
TEST(Plant, SameMissionSucceedsWithKinematicsAndDynamics) {
  const VehicleModel torpedo = test::remus(), box = test::rov();
  double seconds[2] = {};
  for (const PlantKind kind : {PlantKind::kKinematic, PlantKind::kDynamic}) {
    const auto vehicle = make_plant(torpedo, kind, test::at_speed(1.5, 8));
    const Outcome out = run(*vehicle, kBox, {});
    EXPECT_TRUE(out.finished);
    EXPECT_EQ(out.reached, 4u);
    EXPECT_LT(out.worst_offset, 1.0);
    EXPECT_NEAR(vehicle->state().X_WB.translation.z(), 10, 0.5);
    seconds[kind == PlantKind::kDynamic] = out.seconds;

    const auto rover = make_plant(box, kind, test::at_speed(0, 3));
    const Outcome small = run(*rover, kSmallBox, {2, 0.5, 0});
    EXPECT_EQ(small.reached, 4u);
    EXPECT_LT(small.worst_offset, 0.2);
  }
  EXPECT_NEAR(seconds[0], seconds[1], 0.1 * seconds[0]);
}

// ledger: S7-05 S7-14
TEST(Plant, ReachesWaypointsInACurrent) {
  DynamicVehicle vehicle(test::remus(), test::at_speed(1.5, 10));
  const WaterConditions water{1025, {0.0, 0.4, 0.0}};
  const std::vector<Waypoint> line = {{200, 0, 10, 1.5}};
  GuidanceConfig config;
  config.integral_gain = 0.5;
  const Outcome out = run(vehicle, line, config, water);
  EXPECT_EQ(out.reached, 1u);
  EXPECT_LT(std::abs(vehicle.state().X_WB.translation.y()), 1.0);  // the offset without integral would be above 2 m
}

// ledger: S7-05 S7-09
TEST(Plant, HoversInPlaceInACurrent) {
  DynamicVehicle vehicle(test::rov(), test::at_speed(0, 5));
  const Waypoint place{0, 0, 5, 0.5};
  const WaterConditions water{1028, {0.25, -0.15, 0.05}};
  StationKeeper keeper({}, parameters_of(test::rov()));
  double worst = 0;
  for (int i = 0; i < 1200; ++i) {
    if (i % 600 == 0) keeper.hold(place, Angle::degrees(i < 600 ? 0 : 90));  // turns on the spot half-way
    const VehicleState& s = vehicle.state();
    vehicle.step(keeper.step(s.X_WB, s.X_WB.rotation * s.v_B, kDt), water, kDt);
    if (i % 600 > 400) {
      worst = std::max(worst, (vehicle.state().X_WB.translation - Eigen::Vector3d(0, 0, 5)).norm());
    }
  }
  EXPECT_LT(worst, 0.2);
  EXPECT_NEAR(vehicle.state().X_WB.rotation.heading().degrees(), 90, 1);
}

// Without thrusters for pitch, at the speed at which Munk's moments would tip it over if nothing opposed them.
TEST(Plant, SixThrustersHoldDepthAndHeadingUnderWay) {
  for (const double speed : {0.4, 0.8, 1.0}) {
    DynamicVehicle vehicle(test::six_thrusters(), test::at_speed(speed, 5));
    const WaterConditions water{1025, {0.1, 0.2, 0}};
    double deepest = 0, steepest = 0, off = 0;
    for (int i = 0; i < 900; ++i) {
      const Angle heading = Angle::degrees(i < 450 ? 0 : 60);
      vehicle.step({heading, i < 100 ? 5.0 : 7.0, speed, 0}, water, kDt);
      const VehicleState& s = vehicle.state();
      steepest = std::max(steepest, std::abs(s.X_WB.rotation.pitch().degrees()));
      if (i % 450 < 300) continue;
      deepest = std::max(deepest, std::abs(s.X_WB.translation.z() - 7));
      off = std::max(off, std::abs((s.X_WB.rotation.heading() - heading).wrapped().degrees()));
    }
    EXPECT_LT(deepest, 0.1) << speed;
    EXPECT_LT(off, 1) << speed;
    EXPECT_LT(steepest, 15) << speed;
    EXPECT_NEAR(vehicle.state().v_B.x(), speed, 0.05);
  }
}

TEST(Plant, SixThrustersFollowWaypoints) {
  const auto rover = make_plant(test::six_thrusters(), PlantKind::kDynamic, test::at_speed(0, 3));
  const Outcome small = run(*rover, kSmallBox, {2, 0.5, 0});
  EXPECT_EQ(small.reached, 4u);
  EXPECT_LT(small.worst_offset, 0.2);
}

// ledger: S7-06
TEST(Plant, GoesOnWithALostThruster) {
  DynamicVehicle vehicle(test::rov(), test::at_speed(0, 5));
  vehicle.dynamics().set_effectiveness(0, 0);
  ActuatorVector works = ActuatorVector::Ones(8);
  works(0) = 0;
  vehicle.autopilot().set_known_effectiveness(works);
  for (int i = 0; i < 600; ++i) vehicle.step({Angle::degrees(-60), 7, 0.3, 0}, kSea, kDt);
  EXPECT_NEAR(vehicle.state().X_WB.rotation.heading().degrees(), -60, 1);
  EXPECT_NEAR(vehicle.state().X_WB.translation.z(), 7, 0.05);
  EXPECT_NEAR(vehicle.state().v_B.x(), 0.3, 0.03);
}

// A demand out of reach for a minute leaves nothing behind that must be unwound. ledger: S7-06
TEST(Autopilot, DoesNotWindUp) {
  VehicleModel model = test::rov();
  model.limits.max_speed = 5;
  DynamicVehicle vehicle(model, test::at_speed(0, 5));
  const Setpoint too_fast{Angle(), 5, 5, 0}, still{Angle(), 5, 0, 0};
  for (int i = 0; i < 600; ++i) vehicle.step(too_fast, kSea, kDt);
  EXPECT_LT(vehicle.autopilot().allocation().scale, 1);
  double back = 0;
  for (int i = 0; i < 100; ++i) {
    vehicle.step(still, kSea, kDt);
    back = std::min(back, vehicle.state().v_B.x());
  }
  EXPECT_NEAR(vehicle.state().v_B.x(), 0, 0.02);
  EXPECT_GT(back, -0.1);
}

TEST(Autopilot, TurnsTheShortWay) {
  VehicleState start = test::at_speed(0, 5);
  start.X_WB.rotation = Rotation::from_heading(Angle::degrees(170));
  DynamicVehicle vehicle(test::rov(), start);
  for (int i = 0; i < 300; ++i) {
    vehicle.step({Angle::degrees(-170), 5, 0, 0}, kSea, kDt);
    EXPECT_GT(std::abs(vehicle.state().X_WB.rotation.heading().degrees()), 165);
  }
  EXPECT_NEAR(vehicle.state().X_WB.rotation.heading().degrees(), -170, 0.5);
}

// ledger: S7-14
TEST(KinematicVehicle, TurnsOnAnArcOfItsTurningRadius) {
  const VehicleModel model = test::remus();
  KinematicVehicle vehicle(model, test::at_speed(1, 10));
  // Half a circle at 1 m/s, in steps that do not divide it.
  const double radius = model.limits.turning_radius;
  const double seconds = radius * std::numbers::pi;
  for (int i = 0; i < 40; ++i) vehicle.step({Angle::degrees(179.9), 10, 1, 0}, kSea, seconds / 40);
  EXPECT_NEAR(vehicle.state().X_WB.translation.y(), 2 * radius, 0.01);
  EXPECT_NEAR(vehicle.state().X_WB.translation.x(), 0, 0.03);
  EXPECT_NEAR(vehicle.state().X_WB.rotation.heading().degrees(), 179.9, 1e-9);
}

// ledger: S7-14
TEST(KinematicVehicle, KeepsItsLimits) {
  const VehicleModel model = test::remus();
  KinematicVehicle vehicle(model, test::at_speed(0, 10));
  Random random(6);
  Setpoint setpoint;
  VehicleState before = vehicle.state();
  for (int i = 0; i < 2000; ++i) {
    if (i % 50 == 0) {
      setpoint = {Angle::degrees(random.uniform(-180, 180)), random.uniform(-20, 120), random.uniform(0, 4), 0};
    }
    vehicle.step(setpoint, kSea, kDt);
    const VehicleState& s = vehicle.state();
    const Eigen::Vector3d moved = s.X_WB.translation - before.X_WB.translation;
    EXPECT_LE(moved.norm(), model.limits.max_speed * kDt * (1 + 1e-9));
    EXPECT_LE(std::abs(moved.z()), model.limits.max_climb_rate * kDt * (1 + 1e-9));
    EXPECT_LE(std::abs(s.v_B.x() - before.v_B.x()), model.limits.max_acceleration * kDt * (1 + 1e-9));
    const double turned = (s.X_WB.rotation.heading() - before.X_WB.rotation.heading()).wrapped().radians();
    EXPECT_LE(std::abs(turned), model.limits.max_yaw_rate.radians() * kDt * (1 + 1e-9));
    EXPECT_GE(s.X_WB.translation.z(), 0);
    EXPECT_LE(s.X_WB.translation.z(), model.limits.max_depth);
    before = s;
  }
}

TEST(LineOfSight, SteersForThePointAheadOnTheLine) {
  LineOfSight guidance({8, 3, 0}, {{0, 0, 5, 1}, {0, 100, 6, 2}});
  VehicleState state;  // at the first way-point, so that the line runs east from it
  Setpoint s = guidance.step(state, 0.1);
  EXPECT_EQ(guidance.reached(), 1u);
  EXPECT_NEAR(s.heading.degrees(), 90, 1e-9);
  EXPECT_EQ(s.depth, 6);
  EXPECT_EQ(s.speed, 2);
  state.X_WB.translation = {8, 40, 0};  // 8 m north of the line: to port
  s = guidance.step(state, 0.1);
  EXPECT_NEAR(guidance.cross_track(), -8, 1e-12);
  EXPECT_NEAR(s.heading.degrees(), 135, 1e-9);
}

TEST(LineOfSight, SaysWhenAWaypointIsReachedMissedAndAllIsDone) {
  LineOfSight guidance({8, 3, 0}, {{50, 0, 5, 1}, {100, 0, 5, 1}});
  VehicleState state;
  guidance.step(state, 0.1);
  state.X_WB.translation = {51, 10, 0};  // abeam, out of reach
  guidance.step(state, 0.1);
  EXPECT_EQ(guidance.missed(), 1u);
  EXPECT_EQ(guidance.next(), 1u);
  state.X_WB.translation = {98, 1, 0};
  const Setpoint end = guidance.step(state, 0.1);
  EXPECT_TRUE(guidance.finished());
  EXPECT_EQ(guidance.reached(), 1u);
  EXPECT_EQ(end.speed, 0);
  EXPECT_THROW(LineOfSight({}, {}), Error);
}

TEST(Plant, AllocatesNothing) {
  for (const PlantKind kind : {PlantKind::kKinematic, PlantKind::kDynamic}) {
    const auto vehicle = make_plant(test::rov(), kind, test::at_speed(0, 5));
    LineOfSight guidance({}, {{50, 0, 5, 1}, {100, 0, 5, 1}});
    const auto before = test::allocations();
    for (int i = 0; i < 10; ++i) vehicle->step(guidance.step(vehicle->state(), kDt), kSea, kDt);
    EXPECT_EQ(test::allocations(), before);
  }
}

}  // namespace
}  // namespace isobath::plant_test
