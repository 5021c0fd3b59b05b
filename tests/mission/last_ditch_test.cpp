// The look ahead on raw echoes and ranges: stop while it can, else turn to the freer side, else surface.
#include <algorithm>
#include <gmock/gmock.h>
#include <isobath/mission/safety/near_echoes.hpp>
#include <isobath/mission/safety/sonar_health_sample.hpp>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <tests/mission/safety_stream.hpp>
#include <tests/planning/measured_water.hpp>

namespace isobath {
namespace {

using Act = SafetyActionKind;
using Eigen::Vector2d;
using test::SafetyStream;
using testing::HasSubstr;

constexpr double kNever = std::numeric_limits<double>::infinity();
const SafetyConfig kLimits;

/// Puts into each ping the echoes of points in W that the vehicle has in its fan and nearer than `range_m`, and not
/// nearer than `blanking_m`.
void show(SafetyStream& stream, std::vector<Vector2d> points, double range_m = 20, double blanking_m = 0.6) {
  stream.on_echoes = [&stream, points = std::move(points), range_m, blanking_m](SonarEchoes& heard) {
    const Eigen::Rotation2Dd R_LW(-stream.heading);
    heard.blanking_m = blanking_m;
    for (const Vector2d& p : points) {
      const Vector2d echo = R_LW * Vector2d(p - stream.place);
      if (echo.norm() < range_m && echo.norm() > blanking_m && echo.x() > 0) heard.echoes_L.push_back(echo);
    }
  };
}

/// What a fan of 130 degrees says that is silent up to `range_m`, but for its echoes.
void fall_silent(SonarEchoes& heard, double range_m = 30, Angle height = Angle::degrees(20)) {
  heard.fan = even_fan(131, Angle::degrees(130), Angle::degrees(1.5), height);
  for (const Angle azimuth : heard.fan->azimuth) {
    double silent = range_m;
    for (const Vector2d& p : heard.echoes_L) {
      if (std::abs(std::atan2(p.y(), p.x()) - azimuth.radians()) < 0.02) silent = std::min(silent, p.norm());
    }
    heard.silent_m.push_back(static_cast<float>(silent));
  }
}

double gap(const SafetyStream& stream, const std::vector<Vector2d>& points) {
  double least = kNever;
  for (const Vector2d& p : points) least = std::min(least, (p - stream.place).norm());
  return least - stream.parameters.hull_radius_m;
}

// The vehicle stops within the distance that was predicted, with the margin left, before an obstacle that no map has.
// ledger: S1-44 S2-28 S1-F10
TEST(LastDitch, StopsInTime) {
  for (const double ordered : {0.5, 1.0, 1.5, 2.0}) {
    SafetyStream stream;
    stream.speed = stream.speed_ordered = ordered;
    const std::vector<Vector2d> wall = {{60, -1}, {60, 0}, {60, 1}};
    show(stream, wall);
    stream.run_to(60 / ordered + 30);
    EXPECT_GE(stream.raised(Fault::kCollisionAhead), 0) << ordered;
    EXPECT_EQ(stream.raised(Fault::kCollisionUnavoidable), -1) << ordered;
    EXPECT_EQ(stream.speed, 0) << ordered;
    EXPECT_GE(gap(stream, wall), 0.9 * kLimits.collision_margin_m) << ordered;
    EXPECT_LE(gap(stream, wall), kLimits.collision_margin_m + 0.6 * ordered + 0.5)
        << ordered << ": not sooner than it must";
  }
}

// From the echo that confirms to the order to stop within one executor cycle.
// ledger: S2-28
TEST(LastDitch, ActsWithinOneCycleOfTheSecondEcho) {
  SafetyStream stream;
  stream.run_to(20);
  const Vector2d ahead = stream.place + Vector2d(3.5, 0);
  int told = 0;
  double second_s = -1;
  stream.on_echoes = [&](SonarEchoes& heard) {
    heard.echoes_L = {ahead - stream.place};
    if (++told == 2) second_s = stream.time_s();
  };
  stream.run_to(22);
  EXPECT_LE(stream.acted(Act::kStop) - second_s, 0.6);
  EXPECT_GE(stream.acted(Act::kStop), second_s) << "one echo is noise";
}

// An obstacle that was heard before it came into the blind zone is still there.
TEST(LastDitch, StopsBeforeWhatTheSonarHearsNoMore) {
  SafetyStream stream;
  const std::vector<Vector2d> pole = {{60, 0.2}};
  show(stream, pole, 20, 10.2);
  stream.run_to(70);
  EXPECT_EQ(stream.speed, 0) << "half a minute later, still";
  EXPECT_GT(gap(stream, pole), 0.8);
}

// A sonar that gives ranges alone.
// ledger: S1-44
TEST(LastDitch, StopsForShortRanges) {
  SafetyStream stream;
  stream.on_range = [&](RangeReading& reading) {
    reading.X_BS.rotation = Rotation();
    reading.range_m.reset();
    if (60 - stream.place.x() < 50) reading.range_m = 60 - stream.place.x();
  };
  stream.run_to(70);
  EXPECT_EQ(stream.speed, 0);
  EXPECT_GT(60 - stream.place.x() - stream.parameters.hull_radius_m, 0.5);
  EXPECT_EQ(stream.raised(Fault::kCollisionUnavoidable), -1);
}

// An echo on which two pings agree counts until ten pings in three seconds have looked at its place in vain. Hidden
// behind another echo, out of the sector or of the range, or where it may lie below the beams, it still counts.
// ledger: S1-44
TEST(NearEchoes, AreForgottenWhereTheSonarHearsThatTheyAreGone) {
  const auto lasts_s = [](const Vector2d& place, double silent_m, const std::vector<Vector2d>& others) {
    NearEchoes echoes;
    echoes.add(place, Pose(), 50, kLimits, 1.0);
    echoes.add(place, Pose(), 50, kLimits, 1.2);
    double t = 1.2;
    const auto stands = [&] {
      const auto all = echoes.confirmed(Pose(), 0.6, kLimits, t);
      return std::ranges::any_of(all, [&](const NearEcho& echo) { return (echo.place - place).norm() < 1e-9; });
    };
    while (t < 30 && stands()) {
      t += 0.2;
      SonarEchoes look;
      look.echoes_L = others;
      fall_silent(look, silent_m);
      echoes.add(look, 50, kLimits, t);
    }
    return t - 1.2;
  };
  EXPECT_NEAR(lasts_s({10, 1}, 30, {}), NearEchoes::kSilent_s, 0.21);
  EXPECT_NEAR(lasts_s({10, 1}, 30, {{5, -4}}), NearEchoes::kSilent_s, 0.21) << "the other one is elsewhere";
  EXPECT_GT(lasts_s({10, 1}, 30, {{5, 0.5}}), kLimits.memory_s - 0.5) << "hidden";
  EXPECT_GT(lasts_s({10, 1}, 30, {{10, 2}}), kLimits.memory_s - 0.5) << "it may be the same";
  EXPECT_GT(lasts_s({10, 1}, 11, {}), kLimits.memory_s - 0.5) << "at the end of the range";
  EXPECT_GT(lasts_s({-10, 1}, 30, {}), kLimits.memory_s - 0.5) << "astern";
  EXPECT_GT(lasts_s({4, 0}, 30, {}), kLimits.memory_s - 0.5) << "so near, it may lie below the beams";
}

// A fan of 20 degrees looks ahead at the depth of the vehicle up to 5 degrees of pitch.
TEST(NearEchoes, SilenceOfTiltedBeamsSaysNothing) {
  const auto fan = even_fan(3, Angle::degrees(30), Angle::degrees(10), Angle::degrees(20));
  const Ping ping = make_ping({}, fan, {0, 1, 64}, std::vector<std::uint8_t>(std::size_t{3} * 64));
  EchoDecisions decisions;
  decisions.reset(3, 64);
  const auto heard_at = [&](double pitch_deg) {
    const Pose X_WB{Rotation::from_heading_pitch_roll({}, Angle::degrees(pitch_deg), {}), {0, 0, 10}};
    return echoes_of(ping, decisions, X_WB, 6);
  };
  ASSERT_TRUE(heard_at(0));
  EXPECT_EQ(heard_at(0)->fan, fan);
  EXPECT_EQ(heard_at(0)->silent_m, std::vector<float>(3, 64.0F));
  EXPECT_EQ(heard_at(4)->fan, fan);
  EXPECT_EQ(heard_at(-6)->fan, nullptr);
}

// It stands where it stopped, turns to where it is ordered to go, and goes on once that way is free.
TEST(LastDitch, GoesOnWhenTheWayLiesFree) {
  SafetyStream stream;
  show(stream, {{40, 0}});
  stream.run_to(60);
  ASSERT_EQ(stream.speed, 0);
  ASSERT_EQ(stream.officer.action().kind, Act::kTurn) << "on the spot";
  EXPECT_EQ(stream.officer.action().setpoint.speed, 0);
  stream.on_echoes = {};  // it moved away
  stream.run_to(60 + kLimits.memory_s + kLimits.clear_after_s + 10);
  EXPECT_EQ(stream.officer.action().kind, Act::kNone);
  EXPECT_GT(stream.speed, 1);
}

// Sooner than an echo is forgotten, where the sonar looks on and hears nothing there.
TEST(LastDitch, GoesOnSoonerWhereTheSonarHearsThatTheWayIsFree) {
  const auto goes_on_after_s = [](bool hears) {
    SafetyStream stream;
    show(stream, {{40, 0}});
    stream.run_to(60);
    EXPECT_EQ(stream.speed, 0);
    stream.on_echoes = [hears](SonarEchoes& heard) {
      if (hears) fall_silent(heard, 30, Angle::degrees(80));  // it stands 2 m before the place
    };
    double t = 60;
    while (t < 100 && stream.officer.action().kind != Act::kNone) stream.run_to(t += 0.5);
    return t - 60;
  };
  EXPECT_LT(goes_on_after_s(true), NearEchoes::kSilent_s + kLimits.clear_after_s + 2);
  EXPECT_GT(goes_on_after_s(false), kLimits.memory_s);
}

// What appears nearer than it can stop is said to be unavoidable, and the vehicle turns to the side that is free.
TEST(LastDitch, TurnsToTheFreerSide) {
  for (const double side : {-1.0, 1.0}) {
    SafetyStream stream;
    stream.run_to(20);
    // 2.35 m before the bow, and a wall beside it.
    const Vector2d bow = stream.place + Vector2d(stream.parameters.hull_radius_m + 2.35, 0);
    std::vector<Vector2d> points = {bow};
    for (int i = -3; i < 6; ++i) points.emplace_back(bow.x() - 0.5 * i, side * 2.0);
    show(stream, points, 20, 0.1);
    stream.run_to(20.5);
    ASSERT_EQ(stream.officer.action().kind, Act::kTurn) << side;
    EXPECT_EQ(stream.officer.action().fault, "collision unavoidable");
    EXPECT_NEAR(stream.officer.action().setpoint.heading.degrees(), -90 * side, 20);
    EXPECT_LE(stream.officer.action().setpoint.speed, 1.5);
    EXPECT_THAT(stream.reason(Fault::kCollisionUnavoidable),
                HasSubstr(side > 0 ? "port is freer" : "starboard is freer"));
  }
}

TEST(LastDitch, SurfacesWhereNeitherSideIsFree) {
  SafetyStream stream;
  stream.run_to(20);
  const Vector2d bow = stream.place + Vector2d(stream.parameters.hull_radius_m + 1.5, 0);
  std::vector<Vector2d> points;
  for (int i = -8; i <= 8; ++i) points.emplace_back(bow.x(), 0.5 * i);
  show(stream, points, 20, 0.1);
  stream.run_to(20.5);
  EXPECT_EQ(stream.officer.action().kind, Act::kSurface);
  EXPECT_THAT(stream.reason(Fault::kCollisionUnavoidable), HasSubstr("neither side is free"));
}

// ledger: S2-E10
TEST(LastDitch, AVehicleThatCannotStopTurns) {
  SafetyStream stream(test::flying());
  show(stream, {{60, 0.3}});
  stream.run_to(45);
  EXPECT_EQ(stream.acted(Act::kStop), -1);
  EXPECT_GT(stream.acted(Act::kTurn), 0);
}

// A bay whose sides leave no room to turn, and whose far wall is nearer than `escape_s` of way: it turns while there is
// a way out, and surfaces where it is in already. ledger: S6-51 S2-E10
TEST(LastDitch, AVehicleThatCannotStopKeepsAWayOutOpen) {
  const auto bay = [](double entrance) {
    std::vector<Vector2d> points;
    for (double x = entrance; x < entrance + 15; x += 0.5) {
      points.emplace_back(x, -4);
      points.emplace_back(x, 4);
    }
    for (double y = -4; y < 4; y += 0.5) points.emplace_back(entrance + 15, y);
    for (double y = 4; y < 30; y += 0.5) {
      points.emplace_back(entrance, y);
      points.emplace_back(entrance, -y);
    }
    return points;
  };
  SafetyStream before(test::flying());
  const std::vector<Vector2d> ahead = bay(50);
  show(before, ahead, 40);
  double nearest = kNever;
  for (double s = 1; s < 60; ++s) {
    before.run_to(s);
    nearest = std::min(nearest, gap(before, ahead));
  }
  EXPECT_GT(before.acted(Act::kTurn), 0);
  EXPECT_LT(before.acted(Act::kTurn), 50 / 1.5) << "it is in the bay already";
  EXPECT_GT(nearest, 0.5 * kLimits.collision_margin_m);
  EXPECT_THAT(before.reason(Fault::kCollisionUnavoidable), HasSubstr("an escape is left"));

  SafetyStream inside(test::flying());
  inside.run_to(20);
  show(inside, bay(inside.place.x() - 5), 40);
  inside.run_to(25);
  EXPECT_EQ(inside.officer.action().kind, Act::kSurface);
  EXPECT_THAT(inside.reason(Fault::kCollisionUnavoidable), HasSubstr("none is left"));
}

// Ordered to go slowly, with a current from astern, it would be carried on during the turn.
TEST(LastDitch, AnEscapeIsSailedAtTheSpeedAtWhichTheVehicleTurnsFastest) {
  VehicleParameters vehicle = test::flying();
  vehicle.limits.turning_radius = 4.5;
  vehicle.limits.max_yaw_rate = Angle::degrees(15);
  SafetyStream stream(vehicle);
  stream.speed_ordered = 0.8;
  stream.current = {0.5, 0};
  std::vector<Vector2d> wall;
  for (double y = -15; y < 15; y += 0.5) wall.emplace_back(60, y);
  show(stream, wall, 40);
  double nearest = kNever, fastest = 0;
  for (double s = 1; s < 80; s += 0.5) {
    stream.run_to(s);
    nearest = std::min(nearest, gap(stream, wall));
    const SafetyAction& action = stream.officer.action();
    if (action.kind == Act::kTurn) fastest = std::max(fastest, action.setpoint.speed);
  }
  EXPECT_NEAR(fastest, 4.5 * Angle::degrees(15).radians(), 1e-9);
  EXPECT_GT(nearest, 0.5 * kLimits.collision_margin_m);
}

// Echoes beside the way, behind, and single false alarms stop nobody.
TEST(LastDitch, PassesWhatIsNotInTheWay) {
  SafetyStream stream;
  std::vector<Vector2d> banks;
  for (int i = 0; i < 100; ++i) {
    banks.emplace_back(2.0 * i, 2.5);
    banks.emplace_back(2.0 * i, -2.5);
  }
  show(stream, banks);
  stream.run_to(100);
  EXPECT_EQ(stream.count_reports(), 0u);
}

// A false alarm that stands out in one of a hundred pings, anywhere in the fan: once an hour is too often.
TEST(LastDitch, IsNotStoppedByNoise) {
  SafetyStream stream;
  std::mt19937 random(3);
  stream.on_echoes = [&](SonarEchoes& heard) {
    if (random() % 100 != 0) return;
    const double range = 1 + 49 * (static_cast<double>(random() % 10000) / 10000);
    const double bearing = (static_cast<double>(random() % 10000) / 10000 - 0.5) * 1.57;
    heard.echoes_L = {{range * std::cos(bearing), range * std::sin(bearing)}};
  };
  stream.run_to(650);
  EXPECT_EQ(stream.count_reports(), 0u);
}

// free_way against the plain walk of a disc in small steps.
TEST(FreeWay, IsWhatAWalkInSmallStepsFinds) {
  std::mt19937 random(1);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
  };
  int met = 0;
  for (int run = 0; run < 400; ++run) {
    const double curvature = run % 4 == 0 ? 0 : uniform(-0.4, 0.4);
    const double half = uniform(0.3, 1.5);
    const double x = uniform(0.5, 6), y = uniform(-4, 4);
    const std::vector<Vector2d> point = {{x, y}};
    const double reach = curvature == 0 ? 10 : std::min(10.0, 3.0 / std::abs(curvature));
    const double found = free_way(point, curvature, half, 0, reach);
    double walked = kNever;  // where the point is abeam of the middle, and within the half width
    double before = 1;
    for (double s = 0; s <= reach; s += 0.001) {
      const double turn = curvature * s;
      const Vector2d middle =
          curvature == 0 ? Vector2d(s, 0) : Vector2d(std::sin(turn) / curvature, (1 - std::cos(turn)) / curvature);
      const Vector2d off = point[0] - middle;
      const double along = off.x() * std::cos(turn) + off.y() * std::sin(turn);
      if (along <= 0 && before > 0 && off.norm() <= half) {
        walked = s;
        break;
      }
      before = along;
    }
    if (std::isfinite(walked)) ++met;
    if (std::isfinite(found) && std::isfinite(walked)) {
      EXPECT_NEAR(found, walked, 0.01) << run;
    } else if (std::abs(found - reach) > 0.01 && std::abs(walked - reach) > 0.01) {
      EXPECT_EQ(std::isfinite(found), std::isfinite(walked)) << run;
    }
  }
  EXPECT_GT(met, 50);
}

TEST(NearEchoes, TakesTwoPingsToConfirmOne) {
  NearEchoes echoes;
  const Vector2d at(8, 1);
  echoes.add(at, Pose{}, 30, kLimits, 1.0);
  echoes.add(at, Pose{}, 30, kLimits, 1.0);
  EXPECT_EQ(echoes.confirmed(Pose{}, 0, kLimits, 1.0).size(), 0u) << "the same ping";
  const Vector2d near(8.9, 1.4), far(14, 1);
  echoes.add(far, Pose{}, 30, kLimits, 1.1);
  EXPECT_EQ(echoes.confirmed(Pose{}, 0, kLimits, 1.1).size(), 0u);
  echoes.add(near, Pose{}, 30, kLimits, 1.2);
  EXPECT_GE(echoes.confirmed(Pose{}, 0, kLimits, 1.2).size(), 1u);
  EXPECT_EQ(echoes.confirmed(Pose{}, 0, kLimits, 1.2 + kLimits.memory_s + 0.1).size(), 0u);

  NearEchoes late;
  late.add(at, Pose{}, 30, kLimits, 1.0);
  late.add(at, Pose{}, 30, kLimits, 1.1 + kLimits.confirm_s);
  EXPECT_EQ(late.confirmed(Pose{}, 0, kLimits, 1.1 + kLimits.confirm_s).size(), 0u);
}

/// A head of one beam that sweeps 120 degrees in 44 steps, 28 times a second, to 20 m.
struct SweepingHead {
  static constexpr double kInterval_s = 0.035, kRange_m = 20;
  std::mt19937 random{11};
  std::shared_ptr<const BeamFan> fan = even_fan(1, Angle::degrees(2), Angle::degrees(2), Angle::degrees(25));
  int pings = 0;

  /// The next ping: a buoy ahead fills one beam, and a share of the pings has a false echo anywhere along the beam.
  SonarEchoes next(double false_share, std::optional<double> buoy_m) {
    const int step = pings % 86, beam = step < 44 ? step : 86 - step;
    ++pings;
    SonarEchoes ping;
    ping.fan = fan;
    ping.blanking_m = 0.75;
    ping.boresight_L = Angle::degrees(-58 + 2.7 * beam);
    double nearest = kRange_m;
    if (buoy_m && beam == 22) nearest = *buoy_m;
    if (std::bernoulli_distribution(false_share)(random))
      nearest = std::min(nearest, std::uniform_real_distribution(0.75, kRange_m)(random));
    ping.silent_m = {static_cast<float>(nearest)};
    if (nearest < kRange_m) ping.echoes_L = {nearest * Vector2d(cos(ping.boresight_L), sin(ping.boresight_L))};
    return ping;
  }
};

// A head that sweeps fast looks at the same water hundreds of times in confirm_s. Two false echoes in that time are no
// body; a buoy that one beam in 44 meets is one after a few sweeps.
// ledger: S1-44 S6-64
TEST(NearEchoes, NeedMoreOfThemWhereFalseOnesAreFrequent) {
  const auto count_of = [](double false_share) {
    SweepingHead head;
    NearEchoes echoes;
    std::set<std::pair<std::int64_t, std::int64_t>> confirmed;
    int heard = 0;
    for (double t = 0; t < 300; t += SweepingHead::kInterval_s) {
      const SonarEchoes ping = head.next(false_share, std::nullopt);
      heard += static_cast<int>(ping.echoes_L.size());
      echoes.add(ping, 25, kLimits, t);
      for (const NearEcho& echo : echoes.confirmed(Pose(), 0.75, kLimits, t)) confirmed.insert(echo.cell);
    }
    return static_cast<double>(confirmed.size()) / heard;
  };
  EXPECT_LT(count_of(0.02), 0.06);  // an event confirms two or three of them
  EXPECT_LT(count_of(0.1), 0.06);
  for (const double false_share : {0.0, 0.02, 0.1}) {
    SweepingHead head;
    NearEchoes echoes;
    double t = 0;
    for (; t < 60; t += SweepingHead::kInterval_s) echoes.add(head.next(false_share, std::nullopt), 25, kLimits, t);
    const auto sees_it = [&] {
      const auto all = echoes.confirmed(Pose(), 0.75, kLimits, t);
      return std::ranges::any_of(all, [](const NearEcho& echo) { return (echo.place - Vector2d(6, 0)).norm() < 1; });
    };
    while (t < 120 && !sees_it()) echoes.add(head.next(false_share, 6), 25, kLimits, t += SweepingHead::kInterval_s);
    EXPECT_LT(t - 60, false_share < 0.05 ? 6 : 15) << false_share;
  }
}

// Near the head all beams of a fan look at the same place: two false echoes there, a few pings apart, are no body. The
// silent pings before the first of them are tries, too.
// ledger: S1-44 S6-64
TEST(NearEchoes, PingsWithoutAnEchoBeforeTheFirstOneAreTries) {
  constexpr double kDensity = 1e-5, kRange_m = 40, kBlanking_m = 0.64, kInterval_s = 0.1, kNear_m = 3;
  constexpr int kBeams = 512;
  const auto fan = even_fan(kBeams, Angle::degrees(60), Angle::degrees(0.3), Angle::degrees(12));
  std::mt19937 random(5);
  std::poisson_distribution<int> false_echoes(kDensity * kBeams * (kRange_m - kBlanking_m));
  std::uniform_real_distribution range(kBlanking_m, kRange_m);
  std::uniform_int_distribution beam(0, kBeams - 1);
  NearEchoes echoes;
  std::set<std::pair<std::int64_t, std::int64_t>> confirmed;
  int heard = 0;
  for (double t = 0; t < 3000; t += kInterval_s) {
    SonarEchoes ping;
    ping.fan = fan;
    ping.blanking_m = kBlanking_m;
    ping.silent_m.assign(kBeams, static_cast<float>(kRange_m));
    for (int n = false_echoes(random); n > 0; --n) {
      const auto b = static_cast<std::size_t>(beam(random));
      const double r = range(random);
      ping.silent_m[b] = static_cast<float>(r);
      ping.echoes_L.emplace_back(r * cos(fan->azimuth[b]), r * sin(fan->azimuth[b]));
      heard += r < kNear_m;
    }
    echoes.add(ping, 25, kLimits, t);
    for (const NearEcho& echo : echoes.confirmed(Pose(), kBlanking_m, kLimits, t)) {
      if (echo.place.norm() < kNear_m) confirmed.insert(echo.cell);
    }
  }
  EXPECT_GT(heard, 200);
  EXPECT_LE(confirmed.size(), 2u) << "cells in fifty minutes";
}

TEST(NearEchoes, StandStillInTheWorldAndMoveWithItsCorrections) {
  NearEchoes echoes;
  const Vector2d at(8, 1);
  const Pose first;
  const Pose second{Rotation::from_heading(Angle::degrees(90)), {8, -5, 0}};
  echoes.add(at, first, 30, kLimits, 1.0);
  echoes.add(at, first, 30, kLimits, 1.1);
  const auto seen = echoes.confirmed(second, 0, kLimits, 1.2);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_NEAR((seen[0].place - Vector2d(6, 0)).norm(), 0, 1e-9);
  echoes.shift({2, 0});
  const auto moved = echoes.confirmed(second, 0, kLimits, 1.2);
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_NEAR((moved[0].place - Vector2d(6, -2)).norm(), 0, 1e-9);
}

/// A sweep of one square body about a place of W, which moves.
Sweep sweep_of(const SafetyStream& stream, const Vector2d& place_W, const Vector2d& velocity_W) {
  auto map = std::make_shared<Detection>();
  map->time = stream.now();
  map->X_WB = {Rotation::from_heading(Angle::radians(stream.heading)), {stream.place.x(), stream.place.y(), 0}};
  Obstacle o{};
  const Vector2d middle = Eigen::Rotation2Dd(-stream.heading) * Vector2d(place_W - stream.place);
  for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) o.outline.push_back(middle + Vector2d(x, y));
  o.motion = {.velocity_W = velocity_W, .track = 1};
  map->obstacles = {o};
  return {1, true, 0, map};
}

// A body crosses 6 m ahead from port to starboard, faster than the vehicle. By its echoes alone, which count for 15 s,
// it would leave a wall across the way; known to move, it has passed. ledger: S3-21 S2-28
TEST(LastDitch, ABodyThatMovesLeavesNoWallOfEchoes) {
  for (const bool tracked : {false, true}) {
    SafetyStream stream(test::flying());
    const Vector2d velocity(1.5, 2);
    const auto body = [&] { return Vector2d(12 + 1.5 * stream.time_s(), -20 + 2 * stream.time_s()); };
    stream.on_echoes = [&](SonarEchoes& heard) {
      const Vector2d echo = Eigen::Rotation2Dd(-stream.heading) * Vector2d(body() - stream.place);
      if (echo.x() > 0) heard.echoes_L.push_back(echo);
    };
    for (double s = 0.5; s <= 20; s += 0.5) {
      stream.run_to(s);
      if (tracked) stream.tell(sweep_of(stream, body(), velocity));
    }
    EXPECT_EQ(stream.raised(Fault::kCollisionUnavoidable) < 0, tracked);
  }
}

// Head on, it is met though it is far away now.
TEST(LastDitch, ABodyThatComesHeadOnIsEvadedInTime) {
  SafetyStream stream(test::flying());
  stream.run_to(1);
  const Vector2d start = stream.place + Vector2d(30, 0), velocity(-1.5, 0);
  const double from_s = stream.time_s();
  double least = kNever;
  for (double s = 1.5; s <= 20; s += 0.5) {
    stream.run_to(s);
    const Vector2d body = start + (stream.time_s() - from_s) * velocity;
    stream.tell(sweep_of(stream, body, velocity));
    least = std::min(least, (body - stream.place).norm());
  }
  EXPECT_GT(stream.acted(Act::kTurn), 0);
  EXPECT_GT(least, 1.4 + stream.parameters.hull_radius_m) << "past its corners";
}

// A berm that rises to a metre below the vehicle's margin: every ping hears it, and it is no obstacle.
// ledger: S5-35 S5-37
TEST(LastDitch, PassesOverWhatWasMeasuredToLieBelow) {
  for (const bool stops : {true, false}) {
    SafetyStream stream(stops ? test::hovering() : test::flying());
    const std::vector<Vector2d> berm = {{60, -3}, {60, -2}, {60, -1}, {60, 0}, {60, 1}, {60, 2}, {60, 3}};
    show(stream, berm, 20, 0.6);
    test::MeasuredWater water;
    water.clear({0, -8, 3}, {90, 8, 6.5});
    stream.tell(WorldSnapshot{.voxels = std::make_shared<const OccupancySnapshot>(water.grid())});
    stream.run_to(100);
    EXPECT_EQ(stream.raised(Fault::kCollisionAhead), -1) << stops;
    EXPECT_EQ(stream.raised(Fault::kCollisionUnavoidable), -1) << stops;
    EXPECT_GT(stream.place.x(), 80);
  }
  SafetyStream stream;
  show(stream, {{60, 0}}, 20, 0.6);
  test::MeasuredWater water;
  water.clear({0, -8, 3}, {90, 8, 5.5});
  stream.tell(WorldSnapshot{.voxels = std::make_shared<const OccupancySnapshot>(water.grid())});
  stream.run_to(100);
  EXPECT_GE(stream.raised(Fault::kCollisionAhead), 0) << "half a metre below it nothing was measured";
}

// A wall that only the map of voxels holds: no echo comes from it any more, and no planner has been asked.
// ledger: S5-37
TEST(LastDitch, AnOccupiedVoxelOnThePathStopsItWithoutThePlanner) {
  const auto ends_at_m = [](bool stops, double top_m) {
    SafetyStream stream(stops ? test::hovering() : test::flying());
    test::MeasuredWater water;
    water.occupy({60, -8, top_m}, {61, 8, top_m + 2});
    stream.run_to(20);
    stream.tell(WorldSnapshot{.voxels = std::make_shared<const OccupancySnapshot>(water.grid())});
    double farthest = 0;  // while it is before or in the wall, and not beside it
    for (double t = 20; t < 80; stream.run_to(t += 0.5)) {
      if (std::abs(stream.place.y()) < 8) farthest = std::max(farthest, stream.place.x());
    }
    return farthest + stream.parameters.hull_radius_m;
  };
  EXPECT_LT(ends_at_m(true, 4), 60);
  EXPECT_GT(ends_at_m(true, 4), 55);
  EXPECT_LT(ends_at_m(false, 4), 60) << "it turns away";
  EXPECT_GT(ends_at_m(true, 7), 65) << "it passes over it";
}

}  // namespace
}  // namespace isobath
