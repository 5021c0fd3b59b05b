// The backup that acts on raw ranges: no map anywhere in this file.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/imminent_collision.hpp>
#include <tests/support/count_allocations.hpp>

namespace isobath {
namespace {

using Vector3 = Eigen::Vector3d;

RangeReading ahead(std::optional<double> range, Angle bearing = {}) {
  RangeReading r;
  r.range_m = range;
  r.max_range_m = 50;
  r.width = Angle::degrees(20);
  r.X_BS.rotation = Rotation::from_heading(bearing);
  return r;
}

// By hand: 3 + 1.5 * 1.2 + 1.5^2 / (2 * 0.25) = 9.3 m. ledger: S1-44
TEST(ImminentCollision, DangerRangeIsMarginReactionAndBraking) {
  const ImminentCollision bit({}, 1);
  EXPECT_NEAR(bit.danger_range(1.5), 9.3, 1e-12);
  EXPECT_NEAR(bit.danger_range(0), 3, 1e-12);
  EXPECT_NEAR(bit.danger_range(-2), 3, 1e-12);
}

// ledger: S1-44
TEST(ImminentCollision, OneSpuriousReadingRaisesNothingTwoInThreeDo) {
  ImminentCollision bit({}, 1);
  const Vector3 v(1.5, 0, 0);
  for (const std::optional<double> far : {std::optional(9.4), std::optional<double>()}) {
    EXPECT_FALSE(bit.update(0, ahead(9.2), v));
    EXPECT_FALSE(bit.update(0, ahead(far), v));
    EXPECT_FALSE(bit.update(0, ahead(far), v));
  }
  EXPECT_FALSE(bit.update(0, ahead(9.2), v));
  EXPECT_FALSE(bit.update(0, ahead(20), v));
  EXPECT_TRUE(bit.update(0, ahead(9.2), v));  // two in three
  EXPECT_TRUE(bit.update(0, ahead(9.2), v));
  EXPECT_TRUE(bit.update(0, ahead(20), v));  // one missed echo is no all-clear
  EXPECT_FALSE(bit.update(0, ahead(20), v));
}

// ledger: S1-44
TEST(ImminentCollision, EachSensorHasItsOwnWitness) {
  ImminentCollision bit({}, 3);
  const Vector3 v(1.5, 0, 0);
  for (int i = 0; i < 6; ++i) {  // a pole that one of three sensors sees
    bit.update(0, ahead(40), v);
    bit.update(1, ahead(5), v);
    bit.update(2, ahead({}), v);
    EXPECT_EQ(bit.raised(), i > 0);
  }
}

// ledger: S1-44
TEST(ImminentCollision, OnlyWhatLiesInTheDirectionOfTravelCounts) {
  const auto raised = [](Angle bearing, const std::optional<Vector3>& v) {
    ImminentCollision bit({}, 1);
    for (int i = 0; i < 3; ++i) bit.update(0, ahead(2, bearing), v);
    return bit.raised();
  };
  EXPECT_TRUE(raised(Angle::degrees(14), Vector3(1, 0, 0)));  // half the width and the slack: 15 degrees
  EXPECT_FALSE(raised(Angle::degrees(16), Vector3(1, 0, 0)));
  EXPECT_TRUE(raised(Angle::degrees(90), Vector3(0, 1, 0)));        // sideways to starboard
  EXPECT_FALSE(raised(Angle::degrees(0), Vector3(-1, 0, 0)));       // backing off is always allowed
  EXPECT_TRUE(raised(Angle::degrees(0), Vector3(0.01, -0.02, 0)));  // standing: ahead
  EXPECT_TRUE(raised(Angle::degrees(0), std::nullopt));
  EXPECT_TRUE(raised(Angle::degrees(0), Vector3(NAN, 0, 0)));
}

// ledger: S1-44
TEST(ImminentCollision, AnUnknownVelocityIsNotZero) {
  ImminentCollision bit({}, 1);
  const double at_two_metres_a_second = 3 + 2 * 1.2 + 4 / 0.5;
  for (int i = 0; i < 3; ++i) bit.update(0, ahead(at_two_metres_a_second - 0.1), std::nullopt);
  EXPECT_TRUE(bit.raised());
}

// ledger: S1-44
TEST(ImminentCollision, GarbledReadingsAreNoLook) {
  ImminentCollisionConfig config;
  config.min_confidence = 0.5;
  ImminentCollision bit(config, 1);
  const Vector3 v(1.5, 0, 0);
  bit.update(0, ahead(5), v);
  bit.update(0, ahead(NAN), v);
  bit.update(0, ahead(-1), v);
  RangeReading faint = ahead(40);
  faint.confidence = 0.1F;
  bit.update(0, faint, v);
  EXPECT_TRUE(bit.update(0, ahead(5), v));
  EXPECT_EQ(bit.unusable(), 3u);
}

/// Water left by a vehicle that does nothing but brake once the bit is up; its sonar looks every 0.6 s, up to 50 m.
double gap_left(double speed, double missed, double spurious, std::uint64_t seed) {
  const ImminentCollisionConfig config;
  ImminentCollision bit(config, 1);
  Random random(seed);
  double gap = 60 + random.uniform(), v = speed, since = 0;
  bool braking = false;
  constexpr double kDt = 0.02;
  for (int i = 0; i < 20000 && v > 0; ++i) {
    since += kDt;
    if (since >= 0.6 - 1e-9) {
      since = 0;
      std::optional<double> range = gap + 0.05 * random.normal();
      if (random.uniform() < missed || gap > 50) range.reset();
      if (random.uniform() < spurious) range = random.uniform(0, 50);
      braking = bit.update(0, ahead(range), Vector3(v, 0, 0)) || braking;
    }
    if (braking) v = std::max(0.0, v - config.braking * kDt);
    gap -= v * kDt;
  }
  EXPECT_EQ(v, 0) << "never braked";
  return gap;
}

// ledger: S1-44 S1-F10
TEST(ImminentCollision, TheVehicleStopsBeforeAWallWithoutAMap) {
  for (const double speed : {0.5, 1.0, 1.5, 2.0, 3.0}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      EXPECT_GT(gap_left(speed, 0, 0, seed), 3 - 0.3) << speed << " m/s, seed " << seed;  // the margin
      // Each look that is lost while it counts costs a period of travel: one here, and seldom two.
      EXPECT_GT(gap_left(speed, 0.05, 0.02, seed), 3 - 2 * 0.6 * speed - 0.3) << seed;
    }
  }
}

TEST(ImminentCollision, AllocatesNothingAndChecksItsConfiguration) {
  ImminentCollision bit({}, 4);
  const RangeReading reading = ahead(5);
  const std::uint64_t before = test::allocations();
  for (int i = 0; i < 10; ++i) bit.update(2, reading, Vector3(1, 0, 0));
  EXPECT_EQ(test::allocations(), before);
  ImminentCollisionConfig config;
  config.hits = 4;
  EXPECT_THROW(ImminentCollision(config, 1), Error);
}

}  // namespace
}  // namespace isobath
