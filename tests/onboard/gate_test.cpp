#include <gtest/gtest.h>
#include <isobath/onboard/event_gate.hpp>
#include <limits>
#include <tests/support/events.hpp>

namespace isobath {
namespace {

using test::fix_at;
using test::ping_at;
using Verdict = EventGate::Verdict;

TEST(EventGate, RejectsWhatRunsBackwardsAndCountsIt) {
  EventGate gate({});
  EXPECT_EQ(gate.judge(ping_at(1)), Verdict::kAdmitted);
  EXPECT_EQ(gate.judge(ping_at(1)), Verdict::kAdmitted) << "equal stamps are in order";
  EXPECT_EQ(gate.judge(ping_at(0.5)), Verdict::kRejected);
  EXPECT_EQ(gate.judge(ping_at(1.5)), Verdict::kAdmitted);
  EXPECT_EQ(gate.rejected().at(EventGate::kBackwards), 1u);
}

TEST(EventGate, OrdersEachStreamOnItsOwn) {
  EventGate gate({});
  EXPECT_EQ(gate.judge(ping_at(2)), Verdict::kAdmitted);
  EXPECT_EQ(gate.judge(fix_at(1, 0)), Verdict::kAdmitted) << "fixes may come later than the pings that they belong to";
  EXPECT_EQ(gate.judge(fix_at(-1, 0)), Verdict::kRejected);
}

TEST(EventGate, RejectsWhatIsOlderThanTheLimit) {
  EventGate gate({.max_age_s = 2});
  EXPECT_EQ(gate.judge(ping_at(10)), Verdict::kAdmitted);
  EXPECT_EQ(gate.judge(fix_at(7.9, 0)), Verdict::kRejected);
  EXPECT_EQ(gate.rejected().at(EventGate::kTooOld), 1u);
}

TEST(EventGate, RejectsWhatIsNotFinite) {
  EventGate gate({});
  Navigation bad = fix_at(1, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(gate.judge(bad), Verdict::kRejected);
  bad = fix_at(1, 1e12);
  EXPECT_EQ(gate.judge(bad), Verdict::kRejected) << "a position beyond any sea";
  Ping ping = ping_at(1);
  ping.window.bin_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(gate.judge(ping), Verdict::kRejected);
  EXPECT_EQ(gate.rejected().at(EventGate::kBadNavigation), 2u);
}

// ledger: S4-54
TEST(EventGate, RefusesPassiveBearingsThatCannotBe) {
  const auto heard = [](double t) {
    PassiveBearing b;
    b.time = Time(seconds(t));
    b.sigma = Angle::degrees(3);
    b.frequency_hz = 120;
    return b;
  };
  EventGate gate({});
  EXPECT_EQ(gate.judge(heard(1)), Verdict::kAdmitted);
  const auto with = [&](auto change) {
    PassiveBearing bad = heard(2);
    change(bad);
    return gate.judge(bad);
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::uint64_t bad = 0;
  for (const double v : {kNaN, kInfinity, -1.0, 0.0}) {
    EXPECT_EQ(with([v](PassiveBearing& b) { b.sigma = Angle::radians(v); }), Verdict::kRejected) << v;
    EXPECT_EQ(with([v](PassiveBearing& b) { b.frequency_hz = v; }), Verdict::kRejected) << v;
    EXPECT_EQ(with([v](PassiveBearing& b) { b.resolution_hz = v; }), Verdict::kRejected) << v;
    bad += 3;
  }
  for (const double v : {kNaN, kInfinity}) {
    EXPECT_EQ(with([v](PassiveBearing& b) { b.bearing = Angle::radians(v); }), Verdict::kRejected);
    EXPECT_EQ(with([v](PassiveBearing& b) { b.elevation = Angle::radians(v); }), Verdict::kRejected);
    EXPECT_EQ(with([v](PassiveBearing& b) { b.snr_db = v; }), Verdict::kRejected);
    EXPECT_EQ(with([v](PassiveBearing& b) { b.X_BS.translation.x() = v; }), Verdict::kRejected);
    bad += 4;
  }
  EXPECT_EQ(with([](PassiveBearing& b) { b.elevation = Angle::degrees(91); }), Verdict::kRejected);
  EXPECT_EQ(gate.rejected().at(EventGate::kBadBearing), bad + 1);
  EXPECT_EQ(gate.judge(heard(0.5)), Verdict::kRejected);
  EXPECT_EQ(gate.rejected().at(EventGate::kBackwards), 1U);
  EXPECT_EQ(gate.judge(heard(3)), Verdict::kAdmitted) << "bad ones do not stop good ones";
}

TEST(EventGate, StartsAnewWhenTheClockWasSetBack) {
  EventGate gate({.max_age_s = 2, .restart_after = 5});
  EXPECT_EQ(gate.judge(ping_at(1000)), Verdict::kAdmitted);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(gate.judge(ping_at(10 + i)), Verdict::kRejected);
  EXPECT_EQ(gate.judge(ping_at(14)), Verdict::kRestarted);
  EXPECT_EQ(gate.judge(ping_at(15)), Verdict::kAdmitted);
}

TEST(EventGate, OneStampFarAheadDoesNotDeafenForEver) {
  EventGate gate({.max_age_s = 2, .restart_after = 5});
  EXPECT_EQ(gate.judge(ping_at(1)), Verdict::kAdmitted);
  EXPECT_EQ(gate.judge(ping_at(1e6)), Verdict::kAdmitted);
  int lost = 0;
  for (int i = 2; i < 20; ++i) lost += gate.judge(ping_at(i)) == Verdict::kRejected;
  EXPECT_EQ(lost, 4);
}

TEST(EventGate, ALeapOfFiveKilometresIsRefusedAndCounted) {
  EventGate gate({});
  EXPECT_EQ(gate.judge(fix_at(1, 0)), Verdict::kAdmitted);
  EXPECT_EQ(gate.judge(fix_at(2, 5000)), Verdict::kRejected);
  EXPECT_EQ(gate.judge(fix_at(3, 2)), Verdict::kAdmitted);
  EXPECT_EQ(gate.rejected().at(EventGate::kLeap), 1u);
}

TEST(EventGate, ALeapIsBelievedWhenFixesInARowAgreeOnIt) {
  EventGate gate({.accept_jump_after = 3});
  EXPECT_EQ(gate.judge(fix_at(1, 0)), Verdict::kAdmitted);
  EXPECT_EQ(gate.judge(fix_at(2, 5000)), Verdict::kRejected);
  EXPECT_EQ(gate.judge(fix_at(3, -7000)), Verdict::kRejected) << "agrees with nothing";
  EXPECT_EQ(gate.judge(fix_at(4, -7001)), Verdict::kRejected);
  EXPECT_EQ(gate.judge(fix_at(5, -7002)), Verdict::kAdmitted);
  EXPECT_EQ(gate.judge(fix_at(6, -7003)), Verdict::kAdmitted);
}

TEST(EventGate, ALongPauseMayLeadFar) {
  EventGate gate({});
  EXPECT_EQ(gate.judge(fix_at(1, 0)), Verdict::kAdmitted);
  EXPECT_EQ(gate.judge(fix_at(3601, 5000)), Verdict::kAdmitted);
}

}  // namespace
}  // namespace isobath
