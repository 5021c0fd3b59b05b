// Depth and altitude over bottoms whose shape is known, alone and with vehicles that follow.
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/vehicle/depth_keeper.hpp>
#include <isobath/vehicle/plant.hpp>
#include <limits>
#include <tests/support/count_allocations.hpp>
#include <tests/vehicle/models.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using Bottom = std::function<double(double)>;  ///< depth by north

constexpr double kDt = 0.1;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const Vector3d kSlow(1, 0, 0);

Time t(double s) { return Time(seconds(s)); }

Pose pose(double north, double depth, double heading_deg = 0) {
  return {Rotation::from_heading(Angle::degrees(heading_deg)), {north, 0, depth}};
}

/// An altimeter that looks straight down from B.
Pose down() { return {Rotation::from_heading_pitch_roll(Angle(), Angle::degrees(-90), Angle()), Vector3d::Zero()}; }

AltimeterReading reading(double time, std::optional<double> range, double max_range = 30) {
  return {t(time), range, max_range, Angle::degrees(10), down()};
}

/// Hears ten echoes of a bottom while the vehicle goes from north 0 to `north`; returns the time.
double approach(DepthKeeper& keeper, const Bottom& bottom, double north, double depth, double heading_deg = 0) {
  double now = 0;
  for (int i = 0; i <= 100; ++i, now += kDt) {
    const double x = north * i / 100;
    keeper.on_altimeter(reading(now, bottom(x) - depth), pose(x, depth, heading_deg));
  }
  return now;
}

/// A vehicle that is where it is told to be.
VehicleParameters prompt() {
  VehicleParameters parameters = parameters_of(test::rov());
  parameters.depth_lag_s = 0;
  return parameters;
}

TEST(DepthKeeper, GivesBackAWishedDepthWhereNoBottomWasEverHeard) {
  DepthKeeper keeper({}, parameters_of(test::rov()));
  EXPECT_EQ(keeper.step({12, {}}, pose(0, 3), kSlow, t(1)).depth, 12);
  EXPECT_EQ(keeper.step({1000, {}}, pose(0, 3), kSlow, t(2)).depth, 100);  // the vehicle's limit
  EXPECT_FALSE(keeper.bottom_depth());
  const DepthOrder lost = keeper.step({0, 5.0}, pose(0, 3), kSlow, t(3));
  EXPECT_TRUE(lost.lost);
  EXPECT_EQ(lost.depth, DepthKeeperConfig{}.safe_depth);
}

// Wild echoes, shallow and deep, one in five, with noise: the median of what is left stands.
TEST(DepthKeeper, KeepsAnAltitudeOverALevelBottomWithWildEchoes) {
  DepthKeeper keeper({}, prompt());
  Random random(4);
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pose X_WB = pose(0.1 * i, 10);
    double range = 12 + 0.05 * random.normal();
    if (i % 5 == 2) range = random.uniform(0, 30);
    keeper.on_altimeter(reading(kDt * i, range), X_WB);
    if (i > 100) worst = std::max(worst, std::abs(keeper.step({0, 4.0}, X_WB, kSlow, t(kDt * i)).depth - 18));
  }
  EXPECT_LT(worst, 0.3);
}

TEST(DepthKeeper, HoldsTheLeastAltitudeInBothModes) {
  DepthKeeperConfig config;
  config.min_altitude = 2;
  DepthKeeper keeper(config, prompt());
  const double now = approach(
      keeper, [](double) { return 20.0; }, 10, 15);
  const DepthOrder deep = keeper.step({25, {}}, pose(10, 15), kSlow, t(now));
  EXPECT_NEAR(deep.depth, 18, 1e-9);
  EXPECT_TRUE(deep.raised);
  EXPECT_NEAR(keeper.step({0, 0.5}, pose(10, 15), kSlow, t(now)).depth, 18, 1e-9);
  const DepthOrder high = keeper.step({10, {}}, pose(10, 15), kSlow, t(now));
  EXPECT_EQ(high.depth, 10);
  EXPECT_FALSE(high.raised);
  // Never above the surface, whatever the bottom asks for.
  DepthKeeper shallow(config, prompt());
  EXPECT_EQ(shallow
                .step({5, {}}, pose(10, 0.5), kSlow,
                      t(approach(
                          shallow, [](double) { return 1.5; }, 10, 0.5)))
                .depth,
            0);
}

// On a plane bottom the slope is exact, along the way that is taken now: back it is the other way, across it is none.
TEST(DepthKeeper, KnowsTheSlopeAlongItsWay) {
  const Bottom rising = [](double x) { return 30 - 0.1 * x; };
  DepthKeeper keeper({}, prompt());
  const double now = approach(keeper, rising, 20, 10);
  EXPECT_NEAR(keeper.step({5, {}}, pose(20, 10), {1, 0, 0}, t(now)).max_speed, 0.7 * 0.4 / 0.1, 1e-9);
  EXPECT_NEAR(keeper.slope(), -0.1, 1e-9);
  keeper.step({5, {}}, pose(20, 10, 180), {-1, 0, 0}, t(now));
  EXPECT_NEAR(keeper.slope(), 0.1, 1e-9);
  keeper.step({5, {}}, pose(20, 10, 90), {0, 1, 0}, t(now));
  EXPECT_NEAR(keeper.slope(), 0, 1e-9);
}

// deepest = bottom - least altitude, less what cannot be climbed until it is reached: 8 s at 1 m/s over a slope of one
// in two climbs 4 m, of which 0.7 x 0.4 x 8 = 2.24 m can be made good.
TEST(DepthKeeper, ClimbsInTimeForARisingBottom) {
  DepthKeeper keeper({}, prompt());
  const double now = approach(
      keeper, [](double x) { return 40 - 0.5 * x; }, 20, 10);
  EXPECT_NEAR(keeper.step({50, {}}, pose(20, 10), {1, 0, 0}, t(now)).depth, 30 - 1 - (4 - 2.24), 0.2);
}

struct Trip {
  double min_altitude = 1e9;
  double worst_error = 0;  ///< of the altitude, once settled
};

Trip follow(const VehicleModel& model, const Bottom& bottom, const DepthKeeperConfig& config, const DepthWish& wish,
            double speed, double start_depth, double seconds, bool looks_ahead = true) {
  DynamicVehicle vehicle(model, test::at_speed(speed, start_depth));
  VehicleParameters parameters = parameters_of(model);
  DepthKeeperConfig used = config;
  if (!looks_ahead) used.look_ahead = parameters.depth_lag_s = 0;
  DepthKeeper keeper(used, parameters);
  Random random(9);
  Trip trip;
  for (int i = 0; i * kDt < seconds; ++i) {
    const VehicleState& s = vehicle.state();
    const Vector3d p = s.X_WB.translation;
    const Vector3d axis = s.X_WB.rotation * Vector3d::UnitZ();
    double range = 0;  // along the beam to the bottom, by small steps
    while (p.z() + range * axis.z() < bottom(p.x() + range * axis.x())) range += 0.01;
    const std::optional<double> echo = range < 30 ? std::optional(range + 0.03 * random.normal()) : std::nullopt;
    keeper.on_altimeter(reading(kDt * i, echo), s.X_WB);
    const DepthOrder order = keeper.step(wish, s.X_WB, s.X_WB.rotation * s.v_B, t(kDt * i));
    vehicle.step({Angle(), order.depth, std::min(speed, std::max(order.max_speed, parameters_of(model).min_speed)), 0},
                 {1025, {0, 0, 0}}, kDt);
    const double altitude = bottom(p.x()) - p.z();
    trip.min_altitude = std::min(trip.min_altitude, altitude);
    if (i * kDt > 60 && wish.altitude_m)
      trip.worst_error = std::max(trip.worst_error, std::abs(altitude - *wish.altitude_m));
  }
  return trip;
}

// A bank of 8 m, one in five steep; the torpedo dives by pitch and comes long after its set-point. ledger: S6-37
TEST(DepthKeeper, CarriesVehiclesOverABank) {
  const Bottom bank = [](double x) { return 25 - std::clamp(0.2 * (x - 100), 0.0, 8.0); };
  DepthKeeperConfig config;
  config.min_altitude = 2;
  const Trip torpedo = follow(test::remus(), bank, config, {0, 5.0}, 1.5, 15, 200);
  EXPECT_GT(torpedo.min_altitude, 4);
  EXPECT_LT(torpedo.worst_error, 1.3);
  const Trip rover = follow(test::rov(), bank, config, {0, 4.0}, 0.8, 18, 300);
  EXPECT_GT(rover.min_altitude, 3.4);
  EXPECT_LT(rover.worst_error, 0.8);
  // By depth, with a wish that leads into the bank.
  const Trip ordered = follow(test::remus(), bank, config, {20, {}}, 1.5, 15, 200);
  EXPECT_GT(ordered.min_altitude, 1.9);
  // Without looking ahead it would come far below its least altitude.
  EXPECT_LT(follow(test::remus(), bank, config, {20, {}}, 1.5, 15, 200, false).min_altitude, 1.0);
}

TEST(DepthKeeper, BelievesALostBottomForAWhileThenGoesUp) {
  DepthKeeperConfig config;
  config.hold = 10;
  config.safe_depth = 3;
  DepthKeeper keeper(config, prompt());
  const double now = approach(
                         keeper, [](double) { return 20.0; }, 10, 15) -
                     kDt;
  EXPECT_NEAR(keeper.step({0, 4.0}, pose(11, 15), kSlow, t(now + 9.9)).depth, 16, 1e-9);
  const DepthOrder lost = keeper.step({0, 4.0}, pose(12, 15), kSlow, t(now + 10.1));
  EXPECT_TRUE(lost.lost);
  EXPECT_EQ(lost.depth, 3);
  // By depth: no deeper than was allowed when the bottom was last known ...
  EXPECT_NEAR(keeper.step({50, {}}, pose(12, 15), kSlow, t(now + 11)).depth, 19, 1e-9);
  EXPECT_EQ(keeper.step({5, {}}, pose(12, 15), kSlow, t(now + 11)).depth, 5);
  // ... until the altimeter says that there is nothing within its range of 30 m.
  keeper.on_altimeter(reading(now + 12, {}), pose(12, 15));
  EXPECT_NEAR(keeper.step({50, {}}, pose(12, 15), kSlow, t(now + 12)).depth, 15 + 30 - 1, 1e-9);
  // Back again after three echoes.
  for (int i = 0; i < 5; ++i) keeper.on_altimeter(reading(now + 13 + 0.1 * i, 6), pose(13, 15));
  EXPECT_FALSE(keeper.step({0, 4.0}, pose(13, 15), kSlow, t(now + 14)).lost);
}

// A narrow beam measures along itself, a wide one finds the nearest of a level bottom straight below.
TEST(DepthKeeper, AllowsForTheTiltOfTheBeam) {
  for (const double tilt_deg : {0.0, 10.0, 30.0}) {
    for (const bool wide : {false, true}) {
      DepthKeeper keeper({}, prompt());
      const double tilt = Angle::degrees(tilt_deg).radians();
      Pose X_WB = pose(0, 5);
      X_WB.rotation = Rotation::from_heading_pitch_roll(Angle(), Angle::degrees(tilt_deg), Angle());
      AltimeterReading r = reading(0, wide ? 10 : 10 / std::cos(tilt));
      r.width = Angle::degrees(wide ? 90 : 0);
      for (int i = 0; i < 5; ++i) EXPECT_TRUE(keeper.on_altimeter(r, X_WB));
      keeper.step({}, X_WB, Vector3d::Zero(), t(0));
      EXPECT_NEAR(keeper.bottom_depth().value(), 15, 1e-9) << tilt_deg << wide;
    }
  }
}

TEST(DepthKeeper, RefusesWhatIsNotFiniteAndLeavesOtherBeamsAlone) {
  DepthKeeper keeper({}, parameters_of(test::rov()));
  EXPECT_FALSE(keeper.on_altimeter(reading(0, kNaN), pose(0, 5)));
  EXPECT_FALSE(keeper.on_altimeter(reading(0, 5), pose(kNaN, 5)));
  EXPECT_FALSE(keeper.on_altimeter(reading(0, -1), pose(0, 5)));
  EXPECT_EQ(keeper.refused(), 3u);
  AltimeterReading ahead = reading(0, 5);
  ahead.X_BS = {};
  EXPECT_FALSE(keeper.on_altimeter(ahead, pose(0, 5)));
  EXPECT_EQ(keeper.refused(), 3u);
  EXPECT_EQ(keeper.step({7, {}}, pose(0, 5), {kNaN, 0, 0}, t(1)).depth, 7);
}

TEST(DepthKeeper, AllocatesNothing) {
  DepthKeeper keeper({}, parameters_of(test::rov()));
  const auto before = test::allocations();
  for (int i = 0; i < 50; ++i) {
    keeper.on_altimeter(reading(i, 10), pose(i, 5));
    keeper.step({0, 4.0}, pose(i, 5), kSlow, t(i));
  }
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace isobath
