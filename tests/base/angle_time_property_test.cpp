// Angles and times over their whole range, against their definitions.
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/angle.hpp>
#include <isobath/base/random.hpp>
#include <isobath/base/time.hpp>
#include <rapidcheck/gtest.h>

namespace isobath {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// A real in (low, high), all sizes alike likely.
rc::Gen<double> real(double low, double high) {
  return rc::gen::map(rc::gen::arbitrary<std::uint64_t>(), [=](std::uint64_t seed) {
    Random random(seed);
    const double magnitude = random.index(2) == 0 ? 1 : std::pow(10, -random.uniform(0, 12));
    return low + (high - low) * random.uniform() * magnitude;
  });
}

RC_GTEST_PROP(AngleProperty, WrappingKeepsTheDirectionAndTheHalfOpenTurn, ()) {
  const Angle a = Angle::radians(*real(-1e4, 1e4));
  const double wrapped = a.wrapped().radians();
  RC_ASSERT(wrapped > -std::numbers::pi);
  RC_ASSERT(wrapped <= std::numbers::pi);
  const double turns = (a.radians() - wrapped) / kTurn;
  RC_ASSERT(std::abs(turns - std::round(turns)) < 1e-11);
  RC_ASSERT(a.wrapped().wrapped() == a.wrapped());
}

RC_GTEST_PROP(AngleProperty, CompassBearingsAreTheSameDirectionFromZeroToAFullTurn, ()) {
  const Angle a = Angle::radians(*real(-1e4, 1e4));
  const double bearing = a.wrapped_positive().radians();
  RC_ASSERT(bearing >= 0);
  RC_ASSERT(bearing < kTurn);
  RC_ASSERT(std::abs((a.wrapped_positive() - a).wrapped().radians()) < 1e-11);
}

RC_GTEST_PROP(AngleProperty, UnitsAgree, ()) {
  const double x = *real(-1e6, 1e6);
  RC_ASSERT(std::abs(Angle::degrees(x).degrees() - x) <= 1e-15 * std::abs(x) * 2);
  RC_ASSERT(std::abs(Angle::gradians(x).degrees() - 0.9 * x) <= 1e-15 * std::abs(x) * 2);
}

TEST(Angle, KeepsItsEdges) {
  const double pi = std::numbers::pi;
  EXPECT_EQ(Angle::radians(pi).wrapped().radians(), pi);
  EXPECT_EQ(Angle::radians(-pi).wrapped().radians(), pi);
  EXPECT_EQ(Angle::radians(std::nextafter(-pi, 0)).wrapped().radians(), std::nextafter(-pi, 0));
  EXPECT_EQ(Angle::radians(std::nextafter(kTurn, 7)).wrapped_positive().radians(), std::nextafter(kTurn, 7) - kTurn);
  EXPECT_EQ(Angle::degrees(360).wrapped_positive(), Angle());
  EXPECT_LT(Angle::degrees(10), Angle::degrees(11));
  EXPECT_DOUBLE_EQ(Angle::degrees(90) / Angle::degrees(30), 3);
}

RC_GTEST_PROP(TimeProperty, SecondsAreRoundedToTheNearestNanosecond, ()) {
  const double value = *real(-9.1e9, 9.1e9);
  RC_ASSERT(representable_seconds(value));
  const Duration duration = seconds(value);
  const auto difference = static_cast<long double>(duration.count()) - static_cast<long double>(value) * 1e9L;
  RC_ASSERT(std::abs(difference) <= 0.5L + 1e-6L);
}

RC_GTEST_PROP(TimeProperty, ADatesNanosecondsSurviveToItsDoublesPrecision, ()) {
  const auto count = *rc::gen::inRange<std::int64_t>(0, 2'000'000'000'000'000'000);
  const double value = to_seconds(Duration(count));
  RC_ASSERT(std::abs(seconds(value).count() - count) <= 256);  // 2^-53 of 2e9 s is 222 ns
}

TEST(Time, RepresentsNothingBeyondItsRange) {
  EXPECT_TRUE(representable_seconds(9.19e9));
  EXPECT_TRUE(representable_seconds(-9.19e9));
  EXPECT_FALSE(representable_seconds(9.2e9));
  EXPECT_FALSE(representable_seconds(INFINITY));
  EXPECT_FALSE(representable_seconds(-INFINITY));
}

TEST(Time, TextOfDatesAndOfLogsWithoutOne) {
  EXPECT_EQ(to_text(Time{}), "0.000 s");
  EXPECT_EQ(to_text(Time{seconds(951827696)}), "2000-02-29T12:34:56.000Z");
  EXPECT_EQ(to_text(Time{seconds(4102444799.999)}), "2099-12-31T23:59:59.999Z");
  EXPECT_EQ(to_text(Time{seconds(-1.5)}), "-1.500 s");
}

TEST(Random, StreamsForkWithoutDisturbingTheirParent) {
  Random parent(9), twin(9);
  Random child = parent.fork();
  (void)twin.bits();
  for (int i = 0; i < 100; ++i) {
    EXPECT_NE(child.bits(), parent.bits());
    (void)twin.bits();
  }
  EXPECT_EQ(parent.bits(), twin.bits());
}

}  // namespace
}  // namespace isobath
