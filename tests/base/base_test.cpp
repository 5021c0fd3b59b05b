#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/angle.hpp>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/base/time.hpp>

namespace isobath {
namespace {

TEST(Error, IsOneLineWithPlaceRangeAndAdvice) {
  const Error e("bad\nvalue", {"log.bin", 12, {}, {}, "angle"}, "0 .. 399", "check the head");
  EXPECT_STREQ(e.what(), "log.bin: byte 12: angle: bad value; allowed: 0 .. 399; check the head");
}

TEST(Angle, WrapsToHalfOpenTurn) {
  EXPECT_DOUBLE_EQ(Angle::degrees(180).wrapped().degrees(), 180);
  EXPECT_DOUBLE_EQ(Angle::degrees(-180).wrapped().degrees(), 180);
  EXPECT_DOUBLE_EQ(Angle::degrees(540).wrapped().degrees(), 180);
  EXPECT_NEAR(Angle::degrees(-90).wrapped_positive().degrees(), 270, 1e-12);
  EXPECT_LT(Angle::radians(-1e-20).wrapped_positive().degrees(), 360);
  EXPECT_DOUBLE_EQ(Angle::gradians(200).degrees(), 180);
}

TEST(Time, KeepsNanosecondsOfADate) {
  const Time t{seconds(1710345016.25)};
  EXPECT_EQ(to_text(t), "2024-03-13T15:50:16.250Z");
  EXPECT_EQ(seconds(-0.5).count(), -500'000'000);
  EXPECT_EQ(to_text(Time{seconds(12.3456)}), "12.346 s");
  EXPECT_FALSE(representable_seconds(NAN));
  EXPECT_FALSE(representable_seconds(1e300));
}

// The published first output of splitmix64 for seed 1234567, and the moments of the derived laws.
TEST(Random, MatchesThePublishedSequence) {
  Random r(1234567);
  EXPECT_EQ(r.bits(), 6457827717110365317u);
  EXPECT_EQ(r.bits(), 3203168211198807973u);
}

TEST(Random, NormalHasUnitMoments) {
  Random r(1);
  double sum = 0, squares = 0;
  constexpr int kCount = 200000;
  for (int i = 0; i < kCount; ++i) {
    const double x = r.normal();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / kCount, 0, 4 / std::sqrt(kCount));
  EXPECT_NEAR(squares / kCount, 1, 4 * std::sqrt(2.0 / kCount));
  for (int i = 0; i < 1000; ++i) EXPECT_LT(r.index(7), 7u);
}

}  // namespace
}  // namespace isobath
