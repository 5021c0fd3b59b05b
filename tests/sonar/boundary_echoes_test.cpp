#include <cmath>
#include <gtest/gtest.h>
#include <isobath/sonar/echo_detector.hpp>
#include <tests/support/echoes.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

constexpr int kBeams = 31, kBins = 200;
constexpr double kBin = 0.25, kAltitude = 5;
constexpr double kNoise = 8, kRing = 45;  // Rayleigh parameters, counts
const Angle kHeight = Angle::degrees(30);

/// Thresholds of open water, as a calibration in a lake gives them: the noise reaches them at the rate f.
EchoDetectorConfig open_water() {
  EchoDetectorConfig config;
  config.method = DetectionMethod::kGlobal;
  config.global_threshold = kNoise * std::sqrt(-2 * std::log(config.false_alarm)) / 255;
  config.boundary.max_level = 20;  // there are no walls in open water
  return config;
}

WaterColumn over_bottom(double altitude_m, double pitch_deg = 0) {
  return {Rotation::from_heading_pitch_roll({}, Angle::degrees(pitch_deg), {}), altitude_m, {}};
}

std::shared_ptr<const BeamFan> tall_fan(int beams = kBeams) {
  auto fan = std::make_shared<BeamFan>(*test::fan_of(beams, Angle::degrees(-45), Angle::degrees(3)));
  fan->height = kHeight;
  return fan;
}

/// Amplitude of the bottom in a bin: a Gaussian beam, -3 dB two-way at half its height, over ground whose echo falls
/// with range. Made from its own geometry: the point of the bottom at that range, seen from the beam's axis.
double bottom_level(const WaterColumn& water, Angle azimuth, double range) {
  const double h = *water.above_bottom_m;
  if (range <= h) return 0;
  const Eigen::Vector3d axis_W = water.R_WS * Eigen::Vector3d(cos(azimuth), sin(azimuth), 0);
  const Eigen::Vector3d towards =
      Eigen::Vector3d(axis_W.x(), axis_W.y(), 0).normalized() * std::sqrt(range * range - h * h) +
      Eigen::Vector3d(0, 0, h);
  const double off = std::acos(std::clamp(axis_W.dot(towards) / range, -1.0, 1.0));
  const double halves = off / (kHeight.radians() / 2);
  return kRing * std::pow(2.0, -halves * halves / 2) * 15 / range;
}

struct Pole {
  int beam = -1;
  double range = 0, amplitude = 0;
};

Ping ping_over(const WaterColumn& water, Random& random, const Pole& pole = {}, int beams = kBeams) {
  const auto fan = tall_fan(beams);
  return test::ping_of<std::uint8_t>(fan, {0, kBin, kBins}, [&](int beam, int bin) {
    const double range = (bin + 0.5) * kBin;
    const double sigma = std::hypot(kNoise, bottom_level(water, fan->azimuth[beam], range));
    const bool stands = beam == pole.beam && std::abs(range - pole.range) < kBin;
    return std::hypot(sigma * random.normal() + (stands ? pole.amplitude : 0), sigma * random.normal());
  });
}

/// Share of the bins from one range to another with an echo, of those that tell anything.
double echo_share(const EchoDecisions& decisions, double from, double to) {
  int told = 0, echoes = 0;
  for (int b = 0; b < decisions.beams(); ++b) {
    for (int k = static_cast<int>(from / kBin); k < static_cast<int>(to / kBin); ++k) {
      if (!decisions.tells(b, k)) continue;
      ++told;
      echoes += decisions.hit(b, k) ? 1 : 0;
    }
  }
  return told > 0 ? static_cast<double>(echoes) / told : 0;
}

// A level beam of 30 degrees, -3 dB edge: bottom from A / sin 15, surface from its depth / sin 15; tilted likewise.
// ledger: S6-69 S1-F09
TEST(BoundaryReach, FollowsFromDepthAltitudeAndAttitude) {
  WaterColumn water = over_bottom(5);
  water.below_surface_m = 2;
  const auto sine = [](double deg) { return std::sin(deg * std::numbers::pi / 180); };
  const BoundaryReach level = boundary_reach(water, {}, kHeight / 2);
  EXPECT_NEAR(level.bottom_m, 5 / sine(15), 1e-9);
  EXPECT_NEAR(level.surface_m, 2 / sine(15), 1e-9);
  EXPECT_EQ(level.label(7), BinLabel::kClear);
  EXPECT_EQ(level.label(10), BinLabel::kMayBeSurface);
  EXPECT_EQ(level.label(20), BinLabel::kMayBeEither);

  water.R_WS = Rotation::from_heading_pitch_roll(Angle::degrees(70), Angle::degrees(-10), {});  // nose down
  const BoundaryReach ahead = boundary_reach(water, {}, kHeight / 2);
  EXPECT_NEAR(ahead.bottom_m, 5 / sine(25), 1e-9);
  EXPECT_NEAR(ahead.surface_m, 2 / sine(5), 1e-9);
  const BoundaryReach abeam = boundary_reach(water, Angle::degrees(90), kHeight / 2);
  EXPECT_NEAR(abeam.bottom_m, 5 / sine(15), 1e-9) << "pitch does not move what looks abeam";
  const BoundaryReach astern = boundary_reach(water, Angle::degrees(180), kHeight / 2);
  EXPECT_NEAR(astern.bottom_m, 5 / sine(5), 1e-9);

  water.R_WS = Rotation::from_heading_pitch_roll({}, Angle::degrees(20), {});
  const BoundaryReach up = boundary_reach(water, {}, kHeight / 2);
  EXPECT_EQ(up.label(1e6), BinLabel::kMayBeSurface) << "it looks over the bottom";
  water.R_WS = Rotation::from_heading_pitch_roll({}, Angle::degrees(-80), {});
  EXPECT_EQ(boundary_reach(water, {}, kHeight / 2).bottom_m, 5) << "straight below is in the beam";
  EXPECT_EQ(boundary_reach({}, {}, kHeight / 2).label(1e6), BinLabel::kClear) << "nothing is known";
}

// The ring has no more echoes than open water has false ones, at rest and pitching.
// ledger: S6-69
TEST(BoundaryEchoes, TheRingIsNoTarget) {
  ISOBATH_NOT_SANITIZED();
  for (const double pitch : {0.0, 5.0}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      EchoDetector with(open_water()), without(open_water());
      EchoDecisions told, as_before;
      Random random(seed);
      double ring = 0, ring_before = 0;
      for (int i = 0; i < 120; ++i) {
        const WaterColumn water = over_bottom(kAltitude, pitch * std::sin(0.4 * i));
        const Ping ping = ping_over(water, random);
        with.detect(ping, told, water);
        without.detect(ping, as_before);
        if (i < 60) continue;
        ring += echo_share(told, 13, 22) / 60;
        ring_before += echo_share(as_before, 13, 22) / 60;
      }
      EXPECT_LT(ring, 2 * with.false_alarm()) << "pitch " << pitch << ", seed " << seed;
      EXPECT_GT(ring_before, 5 * with.false_alarm()) << "the ring that this is about";
    }
  }
}

// What is louder than the bottom is an echo in the ring; what is nearer than the ring is one as ever.
// ledger: S6-69
TEST(BoundaryEchoes, WhatStandsOutOfTheRingIsATarget) {
  ISOBATH_NOT_SANITIZED();
  EchoDetector detector(open_water());
  EchoDecisions told;
  Random random(7);
  const WaterColumn water = over_bottom(kAltitude);
  int in_ring = 0, before = 0, looks = 0;
  for (int i = 0; i < 120; ++i) {
    const bool near = i % 2 == 0;
    const Pole pole{15, near ? 6.1 : 18.1, near ? 60.0 : 220.0};
    detector.detect(ping_over(water, random, pole), told, water);
    if (i < 60) continue;
    ++looks;
    const int bin = static_cast<int>(pole.range / kBin);
    EXPECT_TRUE(told.tells(15, bin));
    (near ? before : in_ring) += told.hit(15, bin) ? 1 : 0;
    EXPECT_TRUE(!near || (told.dim(15)[bin / 64] >> (bin % 64) & 1) == 0) << "clear of the bottom";
  }
  EXPECT_GT(before, 0.4 * looks);
  EXPECT_GT(in_ring, 0.4 * looks);
}

// A bin of the ring without an echo says less of free water than one before it, and nothing before the ring is known.
// ledger: S6-69
TEST(BoundaryEchoes, SaysWhereItCannotTell) {
  EchoDetector detector(open_water());  // decides from the first ping on
  EchoDecisions told;
  Random random(7);
  const WaterColumn water = over_bottom(kAltitude);
  const int in_ring = static_cast<int>(18 / kBin), before = static_cast<int>(6 / kBin);
  const auto hear = [&] { detector.detect(ping_over(water, random, {}, 1), told, water); };
  hear();
  EXPECT_FALSE(told.tells(0, in_ring)) << "how loud the bottom is, is not known yet";
  EXPECT_TRUE(told.tells(0, before));
  for (int i = 0; i < 200; ++i) hear();
  ASSERT_NE(told.dim(0)[in_ring / 64] >> (in_ring % 64) & 1, 0u);
  EXPECT_LT(told.p_dim(0, in_ring), 0.6 * open_water().p_detect);
}

// In a basin the walls may stand at one distance on every bearing; they are louder than any bottom, and stay.
// ledger: S6-69
TEST(BoundaryEchoes, WallsAllRoundAreNoRing) {
  EchoDetectorConfig config = open_water();
  config.boundary.max_level = BoundaryConfig().max_level;
  EchoDetector detector(config);
  EchoDecisions told;
  Random random(5);
  const int wall = static_cast<int>(18 / kBin);
  int found = 0, looks = 0;
  for (int i = 0; i < 120; ++i) {
    const auto fan = tall_fan();
    const Ping ping = test::ping_of<std::uint8_t>(fan, {0, kBin, kBins}, [&](int, int bin) {
      const double x = kNoise * random.normal();
      return std::hypot(x + (bin == wall ? 150 : 0), kNoise * random.normal());
    });
    detector.detect(ping, told, over_bottom(kAltitude));
    if (i < 20) continue;
    for (int b = 0; b < kBeams; ++b, ++looks) found += told.hit(b, wall) && told.tells(b, wall);
  }
  EXPECT_EQ(found, looks);
}

// Without depth and altitude nothing changes.
// ledger: S6-69
TEST(BoundaryEchoes, UnknownWaterIsAsBefore) {
  EchoDetectorConfig on, off;
  on.method = off.method = DetectionMethod::kLearnt;
  off.boundary.tell_boundaries = false;
  EchoDetector with(on), without(off);
  EchoDecisions a, b;
  Random random(3);
  for (int i = 0; i < 30; ++i) {
    const Ping ping = ping_over(over_bottom(kAltitude), random);
    with.detect(ping, a, {});
    without.detect(ping, b, over_bottom(kAltitude));
    for (int beam = 0; beam < kBeams; ++beam) {
      ASSERT_EQ(a.dim(beam), nullptr);
      for (int k = 0; k < kBins; ++k) ASSERT_EQ(a.hit(beam, k), b.hit(beam, k));
    }
  }
}

}  // namespace
}  // namespace isobath
