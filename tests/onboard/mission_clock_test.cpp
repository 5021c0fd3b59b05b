// One clock for the agents, whatever the clocks of the sensors do.
#include <gtest/gtest.h>
#include <isobath/onboard/mission_clock.hpp>

namespace isobath {
namespace {

Time at(double s) { return Time(seconds(s)); }

TEST(MissionClock, IsTheNewestTimeOfAnyEvent) {
  MissionClock clock;
  EXPECT_EQ(clock.update(at(5)), at(5));
  EXPECT_EQ(clock.update(at(4.9)), at(5)) << "a late event";
  EXPECT_EQ(clock.update(at(6)), at(6));
  EXPECT_EQ(clock.offset(), Duration{});
}

TEST(MissionClock, LateEventsBetweenTimelyOnesChangeNothing) {
  MissionClock clock;
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(clock.update(at(10 + 0.1 * i)), at(10 + 0.1 * i));
    EXPECT_EQ(clock.update(at(7 + 0.1 * i)), at(10 + 0.1 * i)) << "a sensor that is three seconds late";
  }
  EXPECT_EQ(clock.offset(), Duration{});
}

TEST(MissionClock, CountsOnWhereTheClockOfTheVehicleWasSetBack) {
  MissionClock clock;
  clock.update(at(100));
  for (int i = 0; i < MissionClock::kSetBackAfter - 1; ++i) EXPECT_EQ(clock.update(at(40 + 0.1 * i)), at(100));
  const double last = 40 + 0.1 * (MissionClock::kSetBackAfter - 1);
  EXPECT_EQ(clock.update(at(last)), at(100));
  EXPECT_EQ(clock.update(at(last + 0.1)), at(100) + seconds(last + 0.1) - seconds(last)) << "it goes on";
  EXPECT_EQ(clock.offset(), seconds(100) - seconds(last));
}

TEST(MissionClock, GoesForwardWithAClockThatWasSetForward) {
  MissionClock clock;
  clock.update(at(1));
  EXPECT_EQ(clock.update(at(61)), at(61));
  // And back again: it does not wait a minute.
  for (int i = 0; i < MissionClock::kSetBackAfter; ++i) clock.update(at(1.1 + 0.1 * i));
  EXPECT_GT(clock.update(at(1.1 + 0.1 * MissionClock::kSetBackAfter)), at(61));
}

}  // namespace
}  // namespace isobath
