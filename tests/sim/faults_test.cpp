#include <bit>
#include <cmath>
#include <cstring>
#include <gmock/gmock.h>
#include <isobath/sim/faulty_channel.hpp>
#include <set>

namespace isobath {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Time at(double s) { return Time(seconds(s)); }

FaultConfig fault(const std::string& source, FaultKind kind, double amount = 0, double at_s = 10, double for_s = 10) {
  FaultConfig f;
  f.source = source;
  f.kind = kind;
  f.amount = amount;
  f.at_s = at_s;
  f.for_s = for_s;
  return f;
}

struct Arrival {
  double when;
  double made;
  double depth;
};

/// A gauge at 1 Hz that says 100 + t, for 30 s, seen at the far end of the channel.
std::vector<Arrival> arrivals(const FaultSchedule& schedule) {
  FaultyChannel<NavReading> channel(schedule, "depth");
  std::vector<Arrival> all;
  for (int t = 0; t < 30; ++t) {
    channel.push(at(t), {at(t), "depth", DepthReading{100.0 + t}});
    while (const auto r = channel.pop(at(t))) {
      all.push_back({static_cast<double>(t), to_seconds(r->time), std::get<DepthReading>(r->value).depth});
    }
  }
  return all;
}
std::vector<Arrival> arrivals(const FaultConfig& f) { return arrivals(FaultSchedule({f}, 1)); }

/// The fault holds for 10 <= t < 20 and nowhere else.
void expect_sound_outside(const std::vector<Arrival>& all) {
  int outside = 0;
  for (const Arrival& a : all) {
    if (a.when >= 10 && a.when < 20) continue;
    EXPECT_EQ(a.made, a.when);
    EXPECT_EQ(a.depth, 100 + a.when);
    ++outside;
  }
  EXPECT_EQ(outside, 20);
}

/// What arrives while the fault holds.
std::vector<Arrival> inside(const std::vector<Arrival>& all) {
  std::vector<Arrival> some;
  for (const Arrival& a : all) {
    if (a.when >= 10 && a.when < 20) some.push_back(a);
  }
  return some;
}

TEST(Faults, OffIsSilent) {
  const auto all = arrivals(fault("depth", FaultKind::kOff));
  expect_sound_outside(all);
  EXPECT_TRUE(inside(all).empty());
}

TEST(Faults, StuckRepeatsTheLastGoodValueUnderNewTimes) {
  const auto all = arrivals(fault("depth", FaultKind::kStuck));
  expect_sound_outside(all);
  ASSERT_EQ(inside(all).size(), 10u);
  for (const Arrival& a : inside(all)) {
    EXPECT_EQ(a.depth, 109);
    EXPECT_EQ(a.made, a.when);
  }
  const auto from_the_start = arrivals(fault("depth", FaultKind::kStuck, 0, 0, 10));
  EXPECT_EQ(from_the_start[9].depth, 100);
}

TEST(Faults, GarbageIsWildAndSometimesNoNumber) {
  FaultConfig f = fault("depth", FaultKind::kGarbage);
  expect_sound_outside(arrivals(f));
  f.at_s = 0;
  f.for_s = 0;
  std::set<double> values;
  int nan = 0;
  for (const Arrival& a : arrivals(f)) std::isfinite(a.depth) ? static_cast<void>(values.insert(a.depth)) : void(++nan);
  EXPECT_EQ(values.size() + static_cast<std::size_t>(nan), 30u);
  EXPECT_GT(nan, 0);
  EXPECT_LT(*values.begin(), -300);
  EXPECT_GT(*values.rbegin(), 300);
}

TEST(Faults, WrongScaleMultiplies) {
  const auto all = arrivals(fault("depth", FaultKind::kWrongScale, 1.5));
  expect_sound_outside(all);
  for (const Arrival& a : inside(all)) EXPECT_DOUBLE_EQ(a.depth, 1.5 * (100 + a.when));
}

TEST(Faults, SlowLetsOneAPeriodThrough) {
  FaultConfig f = fault("depth", FaultKind::kSlow);
  f.period_s = 3;
  const auto all = arrivals(f);
  expect_sound_outside(all);
  std::vector<double> when;
  for (const Arrival& a : inside(all)) when.push_back(a.when);
  EXPECT_THAT(when, ElementsAre(10, 13, 16, 19));
}

TEST(Faults, DelayedComesLateWithItsOwnTime) {
  int late = 0;
  for (const Arrival& a : arrivals(fault("depth", FaultKind::kDelayed, 2.5))) {
    const bool made_in_fault = a.made >= 10 && a.made < 20;
    EXPECT_EQ(a.when, made_in_fault ? a.made + 3 : a.made);  // the clock of this test ticks in seconds
    EXPECT_EQ(a.depth, 100 + a.made);
    late += made_in_fault;
  }
  EXPECT_EQ(late, 10);
}

TEST(Faults, IntermittentLosesItsShareAtRandomOrByPeriods) {
  FaultConfig f = fault("depth", FaultKind::kIntermittent, 0.5);
  expect_sound_outside(arrivals(f));
  f.period_s = 4;
  std::vector<double> when;
  for (const Arrival& a : inside(arrivals(f))) when.push_back(a.when);
  EXPECT_THAT(when, ElementsAre(12, 13, 16, 17));

  FaultSchedule schedule({fault("gps", FaultKind::kIntermittent, 0.3, 0, 0)}, 1);
  FaultyChannel<NavReading> channel(schedule, "gps");
  int through = 0;
  for (int i = 0; i < 5000; ++i) {
    channel.push(at(i), {at(i), "gps", GpsReading{}});
    through += channel.pop(at(i)).has_value();
  }
  EXPECT_NEAR(through / 5000.0, 0.7, 0.03);
}

TEST(Faults, DriftingGrowsFromItsBeginning) {
  const auto all = arrivals(fault("depth", FaultKind::kDrifting, -0.5));
  expect_sound_outside(all);
  for (const Arrival& a : inside(all)) EXPECT_DOUBLE_EQ(a.depth, 100 + a.when - 0.5 * (a.when - 10));
}

TEST(Faults, AJumpIsTheSameFromItsBeginning) {
  const auto all = arrivals(fault("depth", FaultKind::kJump, -7));
  expect_sound_outside(all);
  for (const Arrival& a : inside(all)) EXPECT_DOUBLE_EQ(a.depth, 100 + a.when - 7);
}

// What has no readings changes nothing by itself; whoever plays the part asks.
TEST(Faults, OfTheHostHoldAndAreAskedFor) {
  const FaultSchedule schedule({fault("agent.navigator", FaultKind::kOff), fault("agent.pilot", FaultKind::kStuck),
                                fault("link", FaultKind::kOff), fault("health", FaultKind::kOff),
                                fault("disk", FaultKind::kOff), fault("planner", FaultKind::kWrongScale, 0.01)},
                               1);
  for (const char* source : {"agent.navigator", "agent.pilot", "link", "health", "disk", "planner"}) {
    EXPECT_EQ(schedule.active(source, at(9)), nullptr) << source;
    EXPECT_NE(schedule.active(source, at(12)), nullptr) << source;
    EXPECT_EQ(schedule.active(source, at(20)), nullptr) << source;
  }
  EXPECT_EQ(schedule.active("agent.pilot", at(12))->kind, FaultKind::kStuck);
  EXPECT_EQ(schedule.active("planner", at(12))->amount, 0.01);
  EXPECT_EQ(schedule.active("agent.captain", at(12)), nullptr);
}

TEST(Faults, OfSeveralTheOrderOfTheListCounts) {
  const FaultConfig scale = fault("depth", FaultKind::kWrongScale, 2);
  const FaultConfig drift = fault("depth", FaultKind::kDrifting, 1);
  EXPECT_EQ(inside(arrivals(FaultSchedule({scale, drift}, 1)))[3].depth, 2 * 113 + 3);
  EXPECT_EQ(inside(arrivals(FaultSchedule({drift, scale}, 1)))[3].depth, 2 * (113 + 3));
}

TEST(Faults, BeginAtAnEventAndAfterIt) {
  FaultConfig f = fault("depth", FaultKind::kOff, 0, 0, 5);
  f.when = "obstacle_seen";
  f.after_s = 2;
  FaultSchedule schedule({f}, 1);
  EXPECT_EQ(schedule.active("depth", at(1000)), nullptr);
  schedule.raise("goal_reached", at(3));
  EXPECT_EQ(schedule.active("depth", at(6)), nullptr);
  schedule.raise("obstacle_seen", at(7));
  schedule.raise("obstacle_seen", at(10));
  EXPECT_EQ(schedule.active("depth", at(8.9)), nullptr);
  ASSERT_NE(schedule.active("depth", at(9)), nullptr);
  EXPECT_EQ(schedule.active("depth", at(9))->kind, FaultKind::kOff);
  EXPECT_EQ(schedule.active("sonar", at(9)), nullptr);
  EXPECT_NE(schedule.active("depth", at(13.9)), nullptr);
  EXPECT_EQ(schedule.active("depth", at(14)), nullptr);
}

TEST(Faults, TheClockOfAScheduleStartsWithTheRun) {
  const FaultSchedule schedule({fault("dvl", FaultKind::kOff)}, 1, at(1e9));
  EXPECT_EQ(schedule.active("dvl", at(1e9 + 9)), nullptr);
  EXPECT_NE(schedule.active("dvl", at(1e9 + 10)), nullptr);
}

// Readings of the other rooms: a range, a fix, a ping.

TEST(Faults, ARangeReadingIsHurtToo) {
  FaultSchedule schedule({fault("altimeter", FaultKind::kWrongScale, 2), fault("altimeter", FaultKind::kDrifting, 0.1)},
                         1);
  FaultyChannel<RangeReading> channel(schedule, "altimeter");
  RangeReading reading;
  reading.max_range_m = 50;
  reading.range_m = 10;
  channel.push(at(15), reading);
  EXPECT_DOUBLE_EQ(*channel.pop(at(15))->range_m, 20.5);
  reading.range_m.reset();
  channel.push(at(16), reading);
  EXPECT_FALSE(channel.pop(at(16))->range_m) << "no echo stays no echo";
}

TEST(Faults, AFixFreezes) {
  FaultSchedule schedule({fault("navigation", FaultKind::kStuck)}, 1);
  FaultyChannel<Navigation> channel(schedule, "navigation");
  Navigation fix;
  for (const double t : {9.0, 15.0, 20.0}) {
    fix.time = at(t);
    fix.X_WB.translation.x() = t;
    channel.push(at(t), fix);
    const auto seen = channel.pop(at(t));
    EXPECT_EQ(seen->time, at(t));
    EXPECT_EQ(seen->X_WB.translation.x(), t == 15 ? 9 : t);
  }
}

/// Four beams, -30 .. 30 degrees, of 5 bins; sample 10 beam + bin + base.
Ping ping_at(double t, SampleType type = SampleType::kU8, int base = 0) {
  static const auto fan = std::make_shared<const BeamFan>(
      BeamFan{{Angle::degrees(-30), Angle::degrees(-10), Angle::degrees(10), Angle::degrees(30)},
              {Angle::degrees(20), Angle::degrees(20), Angle::degrees(20), Angle::degrees(20)},
              Angle::degrees(20)});
  Ping ping;
  ping.time = at(t);
  ping.fan = fan;
  ping.window = {1, 0.5, 5};
  const std::ptrdiff_t width = type == SampleType::kU8 ? 1 : type == SampleType::kU16 ? 2 : 4;
  auto data = std::make_shared<std::vector<std::byte>>(static_cast<std::size_t>(20 * width));
  for (int i = 0; i < 20; ++i) {
    const int value = 10 * (i / 5) + i % 5 + base;
    std::byte* to = data->data() + i * width;
    if (type == SampleType::kU8) {
      *to = static_cast<std::byte>(value);
    } else if (type == SampleType::kU16) {
      const auto v = static_cast<std::uint16_t>(value);
      std::memcpy(to, &v, sizeof v);
    } else {
      const auto v = static_cast<float>(value);
      std::memcpy(to, &v, sizeof v);
    }
  }
  ping.intensity = {data->data(), type, 4, 5, 5 * width, width};
  ping.storage = data;
  return ping;
}

Ping through(const FaultConfig& f, Ping ping, double t = 15) {
  FaultSchedule schedule({f}, 1);
  FaultyChannel<Ping> channel(schedule, f.source);
  channel.push(at(t), std::move(ping));
  return *channel.pop(at(t));
}

TEST(Faults, APingWithoutFaultIsTheSamePing) {
  const Ping ping = ping_at(5);
  const Ping same = through(fault("sonar", FaultKind::kSaturated), ping, 5);
  EXPECT_EQ(same.intensity.data(), ping.intensity.data());
  EXPECT_EQ(same.storage, ping.storage);
  EXPECT_EQ(same.time, ping.time);
  EXPECT_EQ(same.window, ping.window);
}

TEST(Faults, APingIsHurtAndStaysValid) {
  for (const SampleType type : {SampleType::kU8, SampleType::kU16, SampleType::kF32}) {
    const Ping ping = ping_at(15, type);
    const Ping saturated = through(fault("sonar", FaultKind::kSaturated), ping);
    EXPECT_EQ(saturated.intensity(1, 2), 255);
    const Ping blind = through(fault("sonar", FaultKind::kBlindSide, -1), ping);
    EXPECT_EQ(blind.intensity(0, 2), 0);
    EXPECT_EQ(blind.intensity(1, 2), 0);
    EXPECT_EQ(blind.intensity(2, 2), 22);
    EXPECT_EQ(through(fault("sonar", FaultKind::kBlindSide, 1), ping).intensity(2, 2), 0);
    const Ping loud = through(fault("sonar", FaultKind::kWrongGain, 10), ping);
    EXPECT_EQ(loud.intensity(1, 2), 120);
    EXPECT_EQ(loud.intensity(3, 4), 255);
    const Ping stretched = through(fault("sonar", FaultKind::kWrongScale, 2), ping);
    EXPECT_EQ(stretched.window, (RangeWindow{2, 1, 5}));
    EXPECT_EQ(stretched.intensity(3, 4), 34);
    const Ping garbage = through(fault("sonar", FaultKind::kGarbage), ping);
    std::set<float> values;
    for (int k = 0; k < 20; ++k) values.insert(garbage.intensity(k / 5, k % 5));
    EXPECT_GT(values.size(), 15u);
    EXPECT_GT(*values.rbegin(), 150);
    for (const Ping& p : {saturated, blind, loud, stretched, garbage}) {
      EXPECT_EQ(check(p), PingFault::kNone);
      EXPECT_EQ(p.time, at(15));
      EXPECT_EQ(p.intensity.type(), type);
    }
    EXPECT_EQ(ping.intensity(1, 2), 12) << "the sonar's own buffer is left alone";
  }
}

TEST(Faults, AStuckSonarRepeatsTheSamplesOfTheLastGoodPing) {
  FaultSchedule schedule({fault("sonar", FaultKind::kStuck)}, 1);
  FaultyChannel<Ping> channel(schedule, "sonar");
  for (int t = 0; t < 25; ++t) {
    channel.push(at(t), ping_at(t, SampleType::kU8, 2 * t));
    const auto seen = channel.pop(at(t));
    EXPECT_EQ(seen->time, at(t));
    EXPECT_EQ(seen->intensity(1, 1), 11 + 2 * (t >= 10 && t < 20 ? 9 : t));
  }
}

TEST(Faults, TheSecondSonarIsAnother) {
  FaultSchedule schedule({fault("sonar.2", FaultKind::kOff)}, 1);
  FaultyChannel<Ping> first(schedule, "sonar"), second(schedule, "sonar.2");
  first.push(at(15), ping_at(15));
  second.push(at(15), ping_at(15));
  EXPECT_TRUE(first.pop(at(15)));
  EXPECT_FALSE(second.pop(at(15)));
}

TEST(Faults, TheVehicleLeaksLosesThrustAndTime) {
  const FaultSchedule schedule(
      {fault("vehicle", FaultKind::kLeak), fault("thruster.2", FaultKind::kThrusterLoss, 0.75),
       fault("thruster", FaultKind::kThrusterLoss, 0.5, 15, 0), fault("vehicle", FaultKind::kClockJump, -3.5)},
      1);
  const VehicleFaults before = schedule.vehicle_faults(at(9.9));
  EXPECT_FALSE(before.leak);
  EXPECT_THAT(before.thrust_share, testing::Each(1.0));
  EXPECT_EQ(before.clock_offset, Duration{});
  const VehicleFaults during = schedule.vehicle_faults(at(12));
  EXPECT_TRUE(during.leak);
  EXPECT_EQ(during.thrust_share[0], 1);
  EXPECT_EQ(during.thrust_share[1], 0.25);
  EXPECT_EQ(during.clock_offset, seconds(-3.5));
  EXPECT_EQ(schedule.vehicle_faults(at(16)).thrust_share[1], 0.125);
  const VehicleFaults after = schedule.vehicle_faults(at(20));
  EXPECT_FALSE(after.leak);
  EXPECT_EQ(after.clock_offset, Duration{});
  EXPECT_THAT(after.thrust_share, testing::Each(0.5));
}

TEST(Faults, TheBatteryDrainsEvenlyAndStaysDrained) {
  FaultConfig slow = fault("vehicle", FaultKind::kBattery, 0.4, 10, 0);
  slow.period_s = 100;
  const FaultSchedule schedule({slow, fault("vehicle", FaultKind::kBattery, 0.3, 200, 1)}, 1);
  const auto lost = [&](double t) { return schedule.vehicle_faults(at(t)).battery_lost; };
  EXPECT_EQ(lost(10), 0);
  EXPECT_DOUBLE_EQ(lost(60), 0.2);
  EXPECT_DOUBLE_EQ(lost(150), 0.4);
  EXPECT_DOUBLE_EQ(lost(200), 0.7);
  EXPECT_DOUBLE_EQ(lost(1000), 0.7);
}

TEST(Faults, SameSeedSameGarbage) {
  const auto values = [](std::uint64_t seed, std::vector<FaultConfig> faults) {
    FaultSchedule schedule(std::move(faults), seed);
    FaultyChannel<RangeReading> channel(schedule, "altimeter");
    std::vector<std::uint64_t> bits;
    RangeReading reading;
    reading.max_range_m = 50;
    for (int t = 10; t < 20; ++t) {
      channel.push(at(t), reading);
      bits.push_back(std::bit_cast<std::uint64_t>(*channel.pop(at(t))->range_m));
    }
    return bits;
  };
  const FaultConfig f = fault("altimeter", FaultKind::kGarbage);
  EXPECT_EQ(values(1, {f}), values(1, {f}));
  EXPECT_NE(values(1, {f}), values(2, {f}));
  EXPECT_EQ(values(1, {f}), values(1, {f, fault("dvl", FaultKind::kGarbage)}));
}

std::string problem_of(const std::string& text) {
  std::vector<FaultConfig> faults;
  Schema schema{{}, {section_list(faults)}};
  try {
    read_toml(text, "s.toml", schema);
    const FaultSchedule schedule(faults, 1);
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

TEST(Faults, AreReadFromFiles) {
  std::vector<FaultConfig> faults;
  Schema schema{{}, {section_list(faults)}};
  read_toml("[[fault]]\nsource = \"sonar\"\nkind = \"stuck\"\nat_s = 30\n[[fault]]\nkind = \"leak\"\nwhen = \"dive\"\n",
            "s.toml", schema);
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_EQ(faults[0].kind, FaultKind::kStuck);
  EXPECT_EQ(faults[0].at_s, 30);
  EXPECT_EQ(faults[1].when, "dive");
  EXPECT_EQ(faults[1].place.line, 5u);
}

TEST(Faults, WhatMakesNoSenseIsRefusedWithItsPlace) {
  EXPECT_EQ(problem_of("[[fault]]\nsource = \"sonar.2\"\nkind = \"off\"\n"), "none");
  const auto refused = [](const std::string& lines, const std::string& why) {
    const std::string problem = problem_of("\n[[fault]]\n" + lines + "\n");
    EXPECT_THAT(problem, HasSubstr("s.toml:2:")) << lines;
    EXPECT_THAT(problem, HasSubstr(why)) << lines;
  };
  refused("source = \"soner\"", "unknown source \"soner\"");
  refused("source = \"sonar.0\"", "unknown source");
  refused("source = \"dvl.2\"", "unknown source");
  refused("source = \"thruster.17\"\nkind = \"thruster_loss\"\namount = 1", "unknown source");
  refused("source = \"dvl\"\nkind = \"saturated\"", "dvl cannot have the fault saturated");
  refused("source = \"agent.\"", "unknown source");
  refused("source = \"link\"\nkind = \"stuck\"", "link cannot have the fault stuck");
  refused("source = \"link\"\nkind = \"intermittent\"\namount = 0.5\nperiod_s = 2", "intermittent has no period");
  refused("source = \"planner\"", "planner cannot have the fault off");
  refused("source = \"sonar\"\nkind = \"jump\"\namount = 1", "sonar cannot have the fault jump");
  refused("source = \"gps\"\nkind = \"jump\"", "not 0");
  refused("source = \"sonar\"\nkind = \"drifting\"\namount = 1", "sonar cannot have the fault drifting");
  refused("source = \"dvl\"\nkind = \"leak\"", "dvl cannot have the fault leak");
  refused("source = \"dvl\"\nkind = \"wrong_scale\"", "a factor");
  refused("source = \"dvl\"\nkind = \"wrong_scale\"\namount = 1", "a factor");
  refused("source = \"dvl\"\nkind = \"intermittent\"\namount = 1.5", "a share");
  refused("source = \"dvl\"\nkind = \"delayed\"\namount = -1", "seconds above 0");
  refused("source = \"dvl\"\nkind = \"off\"\namount = 2", "none with this kind");
  refused("source = \"sonar\"\nkind = \"blind_side\"\namount = 0.5", "-1 (port) or 1 (starboard)");
  refused("source = \"dvl\"\nkind = \"slow\"", "slow needs a period");
  refused("source = \"dvl\"\nkind = \"off\"\nwhen = \"dive\"\nat_s = 3", "an event and a time are both given");
  EXPECT_THAT(problem_of("[[fault]]\nkind = \"broken\""), HasSubstr("s.toml:2:8"));
}

}  // namespace
}  // namespace isobath
