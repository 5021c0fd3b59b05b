#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/pose.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

Vector3d random_vector(Random& r, double scale) {
  return {r.uniform(-scale, scale), r.uniform(-scale, scale), r.uniform(-scale, scale)};
}

TEST(Rotation, HeadingTurnsForwardToEast) {
  const Rotation R_WB = Rotation::from_heading(Angle::degrees(90));
  EXPECT_TRUE((R_WB * Vector3d::UnitX()).isApprox(Vector3d::UnitY(), 1e-15));
  const Rotation nose_up = Rotation::from_heading_pitch_roll({}, Angle::degrees(30), {});
  EXPECT_LT((nose_up * Vector3d::UnitX()).z(), 0) << "z is down";
}

TEST(Rotation, AnglesRoundTrip) {
  const Rotation r = Rotation::from_heading_pitch_roll(Angle::degrees(-170), Angle::degrees(40), Angle::degrees(25));
  EXPECT_NEAR(r.heading().degrees(), -170, 1e-12);
  EXPECT_NEAR(r.pitch().degrees(), 40, 1e-12);
  EXPECT_NEAR(r.roll().degrees(), 25, 1e-12);
}

TEST(Rotation, ExpAndLogAreInverse) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    Vector3d w = random_vector(random, 1.8);
    if (i % 10 == 0) w *= 1e-10;
    EXPECT_NEAR((Rotation::exp(w).log() - w).norm(), 0, 1e-13);
  }
  EXPECT_NEAR(Rotation::exp(Vector3d(M_PI, 0, 0)).log().norm(), M_PI, 1e-12);
}

TEST(Pose, ChainsAndInverts) {
  Random random(4);
  const Pose a{Rotation::exp(random_vector(random, 1)), random_vector(random, 10)};
  const Pose b{Rotation::exp(random_vector(random, 1)), random_vector(random, 10)};
  const Vector3d p = random_vector(random, 5);
  EXPECT_NEAR(((a * b) * p - a * (b * p)).norm(), 0, 1e-13);
  EXPECT_NEAR((a.inverse() * (a * p) - p).norm(), 0, 1e-13);
}

TEST(Pose, InterpolatesOnTheShortestArc) {
  const Pose a{Rotation::from_heading(Angle::degrees(170)), Vector3d(0, 0, 0)};
  const Pose b{Rotation::from_heading(Angle::degrees(-170)), Vector3d(2, 0, 4)};
  const Pose half = interpolate(a, b, 0.5);
  EXPECT_NEAR(std::abs(half.rotation.heading().degrees()), 180, 1e-9);
  EXPECT_TRUE(half.translation.isApprox(Vector3d(1, 0, 2)));
}

/// A pixel of an image plane in the world: range, azimuth to the right, elevation up, without mounting.
Vector3d located(double range, Angle azimuth, Angle elevation, const Pose& X_WB) {
  return X_WB * Vector3d(range * cos(elevation) * cos(azimuth), range * cos(elevation) * sin(azimuth),
                         -range * sin(elevation));
}

/// The simple form: heading and azimuth are added, and pitch and elevation; depth with a minus (printed with a plus).
Vector3d by_added_angles(double range, Angle azimuth, Angle elevation, const Pose& X_WB) {
  const Angle turn = X_WB.rotation.heading() + azimuth, rise = X_WB.rotation.pitch() + elevation;
  return X_WB.translation + range * Vector3d(cos(turn) * cos(rise), sin(turn) * cos(rise), -sin(rise));
}

// ledger: S5-10 S5-11 S5-E02 S5-E03
TEST(Pose, AddingAnglesLocatesAPixelWhereNothingRollsAndOnlyOneAngleIsTurned) {
  Random random(8);
  for (int i = 0; i < 500; ++i) {
    const auto angle = [&](double max_deg) { return Angle::degrees(random.uniform(-max_deg, max_deg)); };
    const Angle heading = angle(180), elevation = angle(30), other = angle(30);
    const bool pitches = i % 2 == 0;
    const Pose X_WB{Rotation::from_heading_pitch_roll(heading, pitches ? other : Angle{}, {}),
                    random_vector(random, 20)};
    const Angle azimuth = pitches ? Angle{} : other;
    const double range = random.uniform(1, 90);
    const Vector3d full = located(range, azimuth, elevation, X_WB);
    EXPECT_NEAR((full - by_added_angles(range, azimuth, elevation, X_WB)).norm(), 0, 1e-12 * range);
  }
}

// The ledger's figures, for a pixel 50 m off and 45 degrees to the right.
// ledger: S5-10 S5-11
TEST(Pose, AddingAnglesMissesByMetresWhereTheVehiclePitchesOrRolls) {
  const auto missed = [](double pitch_deg, double roll_deg) {
    const Pose X_WB{Rotation::from_heading_pitch_roll({}, Angle::degrees(pitch_deg), Angle::degrees(roll_deg)),
                    Vector3d::Zero()};
    const Angle azimuth = Angle::degrees(45);
    return (located(50, azimuth, {}, X_WB) - by_added_angles(50, azimuth, {}, X_WB)).norm();
  };
  EXPECT_NEAR(missed(10, 0), 2.6, 0.05);
  EXPECT_NEAR(missed(0, 5), 3.1, 0.05);
  EXPECT_NEAR(missed(10, 5), 5.6, 0.05);
}

}  // namespace
}  // namespace isobath
