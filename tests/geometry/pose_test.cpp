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

}  // namespace
}  // namespace isobath
