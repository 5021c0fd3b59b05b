#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/onboard/pose_buffer.hpp>
#include <numbers>
#include <tests/support/events.hpp>
#include <vector>

namespace isobath::pose_buffer_test {
namespace {

using test::fix_at;
Time at(double t) { return Time(seconds(t)); }

TEST(PoseBuffer, InterpolatesBetweenTheFixesAroundAPing) {
  PoseBuffer poses({});
  for (int i = 0; i <= 10; ++i) poses.add(fix_at(i, 2 * i, 10 * i));
  const auto pose = poses.at(at(4.25));
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation.x(), 8.5, 1e-12);
  EXPECT_NEAR(pose->rotation.heading().degrees(), 42.5, 1e-9);
}

TEST(PoseBuffer, CarriesOnWithTheLastVelocityForABoundedTime) {
  PoseBuffer poses({.max_extrapolation_s = 1});
  Navigation fix = fix_at(0, 0);
  fix.v_WB = Eigen::Vector3d(2, 0, 0);
  poses.add(fix);
  EXPECT_FALSE(poses.settled(at(0.5)));
  EXPECT_NEAR(poses.at(at(0.5))->translation.x(), 1, 1e-12);
  EXPECT_EQ(poses.at(at(1.5)).error(), PoseFault::kStale);
}

// On a circle at 30 degrees a second, with a fix each 0.1 s: a ping 0.08 s after the last one is placed at once, to a
// centimetre and a tenth of a degree.
TEST(PoseBuffer, PlacesAPingAtOnceWhereItsPoseIsKnownWellEnough) {
  constexpr double kSpeed = 1, kRate = std::numbers::pi / 6;
  const auto circling = [&](double t) {
    Navigation fix = fix_at(t, kSpeed / kRate * std::sin(kRate * t), 30 * t);
    fix.X_WB.translation.y() = kSpeed / kRate * (1 - std::cos(kRate * t));
    fix.v_WB = kSpeed * Eigen::Vector3d(std::cos(kRate * t), std::sin(kRate * t), 0);
    return fix;
  };
  PoseBuffer waits({.extrapolate_s = 0}), goes_on({.extrapolate_s = 0.15});
  EXPECT_FALSE(goes_on.settled(at(0)));
  goes_on.add(circling(0));
  EXPECT_FALSE(goes_on.settled(at(0.05))) << "the rate of turn is not known yet";
  for (double t = 0.1; t < 2.05; t += 0.1) waits.add(circling(t)), goes_on.add(circling(t));
  EXPECT_FALSE(waits.settled(at(2.08)));
  EXPECT_TRUE(goes_on.settled(at(2.08)));
  EXPECT_FALSE(goes_on.settled(at(2.2)));
  const Pose truth = circling(2.08).X_WB;
  EXPECT_NEAR((goes_on.at(at(2.08))->translation - truth.translation).norm(), 0, 0.01);
  EXPECT_NEAR(goes_on.at(at(2.08))->rotation.heading().degrees(), truth.rotation.heading().degrees(), 0.1);
  EXPECT_NEAR(waits.at(at(2.08))->rotation.heading().degrees(), 60, 0.1);
  EXPECT_NEAR(goes_on.at(at(2.9))->rotation.heading().degrees(), 60 + 30 * 0.15, 0.1) << "and turns no further";
}

TEST(PoseBuffer, NamesWhyThereIsNoPose) {
  PoseBuffer poses({.max_gap_s = 5});
  EXPECT_EQ(poses.at(at(0)).error(), PoseFault::kNoFixYet);
  poses.add(fix_at(10, 0));
  poses.add(fix_at(20, 0));
  EXPECT_EQ(poses.at(at(9)).error(), PoseFault::kBeforeFirst);
  EXPECT_EQ(poses.at(at(15)).error(), PoseFault::kGap);
  EXPECT_TRUE(poses.at(at(20)));
}

Navigation sailing(double t, double north, double east, bool with_velocity, double speed = 1.5) {
  Navigation fix = fix_at(t, north);
  fix.X_WB.translation.y() = east;
  if (with_velocity) fix.v_WB = Eigen::Vector3d(speed, 0, 0);
  return fix;
}

// ledger: S6-53
TEST(PoseBuffer, SaysByHowMuchThePositionJumpsAndBringsWhatWasBeforeInLine) {
  for (const bool with_velocity : {true, false}) {
    for (const double rate_hz : {10.0, 2.0, 1.0}) {
      PoseBuffer poses({.max_gap_s = 5});
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      int jumps = 0;
      for (int i = 0; i <= 40; ++i) {
        const double t = i / rate_hz, off = i < 20 ? 0 : -6.4;
        const Eigen::Vector3d jump = poses.add(sailing(t, 1.5 * t + 0.75 * off, off, with_velocity));
        jumps += jump.isZero(0) ? 0 : 1;
        sum += jump;
      }
      EXPECT_EQ(jumps, 1);
      EXPECT_LT((sum - Eigen::Vector3d(-4.8, -6.4, 0)).norm(), 0.05);
      const double before = 19.5 / rate_hz;  // half way to the jump
      EXPECT_LT((poses.at(at(before))->translation - Eigen::Vector3d(1.5 * before - 4.8, -6.4, 0)).norm(), 0.05);
    }
  }
}

// A log of a GPS without velocities, in which a boat that lies still has 4 m/s with the next fix.
TEST(PoseBuffer, SeesThatAJumpWhichGoesOnIsMotion) {
  PoseBuffer poses({});
  std::vector<int> jumps;
  for (int i = 0; i < 20; ++i) {
    const double north = i < 5 ? 0.01 * (i % 2) : 4.0 * (i - 4);
    if (!poses.add(fix_at(i, north)).isZero(0)) jumps.push_back(i);
  }
  EXPECT_EQ(jumps, std::vector<int>{5});
}

// A receiver that holds its position for seconds and then catches up, as some do; but not a vehicle that says that it
// stands.
TEST(PoseBuffer, TakesNoFrozenPositionForAMeasurement) {
  PoseBuffer poses({});
  for (int i = 0; i < 60; ++i) EXPECT_TRUE(poses.add(fix_at(i, 1.2 * (i - i % (3 + i / 20)))).isZero(0)) << i;
  PoseBuffer standing({});
  for (int i = 0; i < 60; ++i) {
    Navigation fix = fix_at(i, i < 40 ? 3 : 9);
    fix.v_WB = Eigen::Vector3d::Zero();
    EXPECT_EQ(standing.add(fix).isZero(0), i != 40) << i;
  }
}

TEST(PoseBuffer, TakesNoMotionForAJump) {
  const auto jumps = [](double rate_hz, bool with_velocity, auto place_at) {
    PoseBuffer poses({});
    int n = 0;
    for (int i = 0; i < 300; ++i) {
      const double t = i / rate_hz;
      Navigation fix = fix_at(t, 0);
      fix.X_WB.translation = place_at(t);
      if (with_velocity) fix.v_WB = (place_at(t + 1e-4) - place_at(t)) / 1e-4;
      n += poses.add(fix).isZero(0) ? 0 : 1;
    }
    return n;
  };
  Random random(4);
  for (const double rate_hz : {0.2, 1.0, 10.0, 100.0}) {
    for (const bool with_velocity : {true, false}) {
      // A boat of 6 m/s that circles at 10 degrees a second, a start at 1 m/s2, heave of 0.5 m in 6 s.
      EXPECT_EQ(jumps(rate_hz, with_velocity,
                      [](double t) {
                        const double a = 0.1745 * t;
                        return Eigen::Vector3d(34.4 * std::cos(a), 34.4 * std::sin(a), 0);
                      }),
                0)
          << rate_hz;
      EXPECT_EQ(jumps(rate_hz, with_velocity,
                      [](double t) {
                        return Eigen::Vector3d(t < 5 ? 0.5 * t * t : 12.5 + 5 * (t - 5), 0, 0.5 * std::sin(t * 1.05));
                      }),
                0)
          << rate_hz;
    }
  }
  EXPECT_EQ(jumps(1, false,
                  [&random](double t) {
                    const double north = t + 0.2 * random.normal();
                    return Eigen::Vector3d(north, 0.2 * random.normal(), 0);
                  }),
            0)
      << "fixes that scatter";
}

TEST(PoseBuffer, KeepsTheNewestThousandFixes) {
  PoseBuffer poses({});
  for (int i = 0; i < 5000; ++i) poses.add(fix_at(0.1 * i, i));
  EXPECT_NEAR(poses.at(at(450.05))->translation.x(), 4500.5, 1e-6);
  EXPECT_EQ(poses.at(at(1)).error(), PoseFault::kBeforeFirst);
}

}  // namespace
}  // namespace isobath::pose_buffer_test
