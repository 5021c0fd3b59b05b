// Whatever is asked for, what comes out is allowed.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/vehicle/envelope.hpp>
#include <limits>
#include <tests/support/count_allocations.hpp>
#include <tests/vehicle/models.hpp>

namespace isobath {
namespace {

constexpr double kDt = 0.1;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const Pose kHere{Rotation::from_heading(Angle::degrees(30)), {5, 6, 7}};

EnvelopeLimits limits() {
  EnvelopeLimits l;
  l.min_depth = 1;
  l.max_depth = 40;
  l.min_altitude = 2;
  l.max_speed = 1.5;
  l.max_acceleration = 0.5;
  l.max_turn_rate = Angle::degrees(20);
  return l;
}

// ledger: S6-37
TEST(Envelope, LeavesWhatIsAllowedAsItIs) {
  Envelope envelope(limits());
  const Setpoint wanted{Angle::degrees(31), 12, 1.2, 0.1};
  for (int i = 0; i < 3; ++i) {
    const Setpoint out = envelope.limit(wanted, kHere, 30, kDt);
    EXPECT_EQ(out.heading, wanted.heading);
    EXPECT_EQ(out.depth, wanted.depth);
    EXPECT_EQ(out.speed, wanted.speed);
    EXPECT_EQ(out.sway_speed, wanted.sway_speed);
  }
  const EnvelopeCounts& n = envelope.counts();
  EXPECT_EQ(n.set_points, 3u);
  EXPECT_EQ(n.not_finite + n.depth + n.altitude + n.speed + n.acceleration + n.turn_rate, 0u);
}

// Random set-points with every kind of nonsense among them, for a vehicle that hovers and one that must keep going.
// ledger: S6-37
TEST(Envelope, LetsNothingOutThatIsNotAllowed) {
  for (const double min_speed : {0.0, 0.7}) {
    EnvelopeLimits l = limits();
    l.min_speed = min_speed;
    Envelope envelope(l);
    Random random(8);
    const auto any = [&random](double low, double high) {
      const double kind = random.uniform();
      const double value = random.uniform(low, high);
      return kind < 0.05 ? kNaN : kind < 0.1 ? kInfinity : kind < 0.15 ? -1e300 : value;
    };
    Setpoint before;
    for (int i = 0; i < 20000; ++i) {
      const Angle heading = Angle::radians(any(-10, 10));
      const double depth = any(-10, 60);
      const double speed = any(-3, 3);
      const double sway = any(-3, 3);
      const double bottom = any(0, 50);
      const Setpoint out = envelope.limit({heading, depth, speed, sway}, kHere, bottom, kDt);
      ASSERT_TRUE(std::isfinite(out.heading.radians()));
      EXPECT_LE(out.depth, 40);
      EXPECT_GE(out.depth, 0);
      if (std::isfinite(bottom)) {
        EXPECT_LE(out.depth, std::max(0.0, bottom - 2));
        EXPECT_GE(out.depth, std::min(1.0, std::max(0.0, bottom - 2)));
      }
      EXPECT_LE(std::hypot(out.speed, out.sway_speed), 1.5 + 1e-12);
      EXPECT_GE(out.speed, min_speed > 0 ? min_speed : -1.5);
      if (i > 0) {
        EXPECT_LE(abs((out.heading - before.heading).wrapped()).degrees(), 2 + 1e-9);
        EXPECT_LE(std::abs(out.speed) - std::abs(before.speed), 0.05 + 1e-12);
      }
      before = out;
    }
    EXPECT_EQ(envelope.counts().set_points, 20000u);
    EXPECT_GT(envelope.counts().not_finite, 3000u);
    EXPECT_GT(envelope.counts().turn_rate, 1000u);
  }
}

TEST(Envelope, HoldsWhereASetpointIsNotFinite) {
  Envelope envelope(limits());
  const Setpoint first = envelope.limit({Angle::radians(kNaN), 5, 1, 0}, kHere, {}, kDt);
  EXPECT_NEAR(first.heading.degrees(), 30, 1e-9);
  EXPECT_EQ(first.depth, 7);
  EXPECT_EQ(first.speed, 0);
  envelope.limit({Angle::degrees(31), 12, 0.04, 0.02}, kHere, {}, kDt);
  const Setpoint hold = envelope.limit({Angle(), 5, kNaN, 0.3}, {{}, {kNaN, 0, 0}}, {}, kDt);
  EXPECT_NEAR(hold.heading.degrees(), 31, 1e-9);
  EXPECT_EQ(hold.depth, 12);  // where it is is not known either
  EXPECT_EQ(hold.speed, 0);
  EXPECT_EQ(hold.sway_speed, 0);
  EXPECT_EQ(envelope.counts().not_finite, 2u);
}

// A stop is a stop; speeding up and turning take their time. ledger: S6-37
TEST(Envelope, StopsAtOnceAndSpeedsUpByTheLimit) {
  Envelope envelope(limits());
  envelope.limit({Angle::degrees(30), 5, 1.5, 0}, kHere, {}, kDt);
  EXPECT_EQ(envelope.limit({Angle::degrees(30), 5, 0, 0}, kHere, {}, kDt).speed, 0);
  EXPECT_EQ(envelope.counts().acceleration, 0u);
  double speed = 0;
  for (int i = 1; i <= 10; ++i) {
    speed = envelope.limit({Angle::degrees(30), 5, 1.5, 0}, kHere, {}, kDt).speed;
    EXPECT_NEAR(speed, 0.05 * i, 1e-12);
  }
  // From ahead to astern: to zero at once, on by the limit.
  EXPECT_NEAR(envelope.limit({Angle::degrees(30), 5, -1.5, 0}, kHere, {}, kDt).speed, -0.05, 1e-12);
  double heading = 30;
  for (int i = 1; i <= 5; ++i) {
    heading = envelope.limit({Angle::degrees(-100), 5, 0, 0}, kHere, {}, kDt).heading.degrees();
    EXPECT_NEAR(heading, 30 - 2 * i, 1e-9);
  }
}

TEST(Envelope, RefusesLimitsThatNothingCouldKeep) {
  const auto refused = [](auto change) {
    EnvelopeLimits l = limits();
    change(l);
    EXPECT_THROW(Envelope{l}, Error);
  };
  refused([](EnvelopeLimits& l) { l.max_depth = 0.5; });
  refused([](EnvelopeLimits& l) { l.min_speed = 2; });
  refused([](EnvelopeLimits& l) { l.min_altitude = kNaN; });
  refused([](EnvelopeLimits& l) { l.max_acceleration = 0; });
  refused([](EnvelopeLimits& l) { l.max_turn_rate = Angle(); });
  EXPECT_NO_THROW(Envelope(limits_of(sheet_of(test::remus()))));
  EXPECT_EQ(limits_of(sheet_of(test::remus())).min_speed, sheet_of(test::remus()).min_speed);
}

TEST(Envelope, AllocatesNothing) {
  Envelope envelope(limits());
  const auto before = test::allocations();
  for (int i = 0; i < 10; ++i) envelope.limit({Angle::degrees(40.0 * i), 5.0 * i, 1, 0}, kHere, 20, kDt);
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace isobath
