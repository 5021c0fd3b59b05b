// Rotations and poses against written-out definitions: elementary matrices, Rodrigues' formula, small steps.
#include <cmath>
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/pose.hpp>
#include <rapidcheck/gtest.h>

namespace isobath {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d about(int axis, double angle) {
  Matrix3d m = Matrix3d::Identity();
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  m(i, i) = m(j, j) = std::cos(angle);
  m(i, j) = -std::sin(angle);
  m(j, i) = std::sin(angle);
  return m;
}

/// Rodrigues: I + sin|w| K + (1 - cos|w|) K^2, K the cross-product matrix of the axis.
Matrix3d rodrigues(const Vector3d& w) {
  const double angle = w.norm();
  const Vector3d a = w / angle;
  Matrix3d k;
  k << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return Matrix3d::Identity() + std::sin(angle) * k + (1 - std::cos(angle)) * k * k;
}

double distance(const Matrix3d& a, const Matrix3d& b) { return (a - b).cwiseAbs().maxCoeff(); }

struct Draw {
  Random random = Random(*rc::gen::arbitrary<std::uint64_t>());

  Vector3d direction() { return Vector3d(random.normal(), random.normal(), random.normal()).normalized(); }
  Vector3d point() { return direction() * std::pow(10, random.uniform(-3, 4)); }
  Rotation rotation() { return Rotation::exp(direction() * random.uniform(0, 3.14)); }
  Pose pose() { return {rotation(), point()}; }
};

RC_GTEST_PROP(RotationProperty, HeadingPitchRollAreTheElementaryTurnsInOrder, ()) {
  Draw draw;
  const double psi = draw.random.uniform(-3.1, 3.1), theta = draw.random.uniform(-1.5, 1.5),
               phi = draw.random.uniform(-3.1, 3.1);
  const Rotation r = Rotation::from_heading_pitch_roll(Angle::radians(psi), Angle::radians(theta), Angle::radians(phi));
  RC_ASSERT(distance(r.matrix(), about(2, psi) * about(1, theta) * about(0, phi)) < 1e-14);
  RC_ASSERT(std::abs(r.heading().radians() - psi) < 1e-12);
  RC_ASSERT(std::abs(r.pitch().radians() - theta) < 1e-12);
  RC_ASSERT(std::abs(r.roll().radians() - phi) < 1e-12);
}

RC_GTEST_PROP(RotationProperty, ExpIsRodriguesFormula, ()) {
  Draw draw;
  const Vector3d w = draw.direction() * std::pow(10, draw.random.uniform(-6, 1));
  RC_ASSERT(distance(Rotation::exp(w).matrix(), rodrigues(w)) < 1e-14 * (1 + w.norm()));
}

RC_GTEST_PROP(RotationProperty, LogIsTheShortestRotationVector, ()) {
  Draw draw;
  const Rotation r = draw.rotation();
  const Vector3d w = r.log();
  RC_ASSERT(w.norm() <= std::numbers::pi + 1e-15);
  RC_ASSERT(distance(Rotation::exp(w).matrix(), r.matrix()) < 1e-14);
  RC_ASSERT((r.inverse().log() + w).norm() < 1e-14);
}

RC_GTEST_PROP(RotationProperty, ARoundedMatrixGivesTheRotationThatWasMeant, ()) {
  Draw draw;
  const Rotation meant = draw.rotation();
  const Matrix3d rounded = (meant.matrix() * 1e4).array().round().matrix() / 1e4;  // a text file with four decimals
  RC_ASSERT(Rotation::valid(rounded));
  const Matrix3d m = Rotation::from_matrix(rounded).matrix();
  RC_ASSERT(distance(m, meant.matrix()) < 2e-4);
  RC_ASSERT(distance(m * m.transpose(), Matrix3d::Identity()) < 1e-14);
  RC_ASSERT(std::abs(m.determinant() - 1) < 1e-14);
}

TEST(Rotation, WhatIsNoRotationIsNotValid) {
  EXPECT_FALSE(Rotation::valid(Matrix3d::Zero()));
  EXPECT_FALSE(Rotation::valid(-Matrix3d::Identity())) << "a mirror";
  EXPECT_FALSE(Rotation::valid(1.01 * Matrix3d::Identity()));
  EXPECT_FALSE(Rotation::valid(Matrix3d::Constant(NAN)));
  EXPECT_TRUE(Rotation::valid(Matrix3d::Identity()));
}

TEST(Rotation, AnglesStayFiniteWhereTheNosePointsStraightUpOrDown) {
  for (const double pitch : {90.0, -90.0}) {
    const Rotation r = Rotation::from_heading_pitch_roll(Angle::degrees(30), Angle::degrees(pitch), Angle::degrees(10));
    EXPECT_NEAR(r.pitch().degrees(), pitch, 1e-5);
    EXPECT_TRUE(std::isfinite(r.heading().radians()) && std::isfinite(r.roll().radians()));
  }
}

RC_GTEST_PROP(PoseProperty, ChainsLikeMatricesOfFourByFour, ()) {
  Draw draw;
  const Pose X_WB = draw.pose(), X_BS = draw.pose();
  const auto homogeneous = [](const Pose& x) {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = x.rotation.matrix();
    m.topRightCorner<3, 1>() = x.translation;
    return m;
  };
  const double scale = 1 + X_WB.translation.norm() + X_BS.translation.norm();
  const Eigen::Matrix4d product = homogeneous(X_WB) * homogeneous(X_BS);
  RC_ASSERT((homogeneous(X_WB * X_BS) - product).cwiseAbs().maxCoeff() < 1e-14 * scale);
  RC_ASSERT((homogeneous(X_WB.inverse()) - homogeneous(X_WB).inverse()).cwiseAbs().maxCoeff() < 1e-13 * scale);
}

// Constant velocity, constant turn: two halves of the way are the whole, and the ends are the ends.
RC_GTEST_PROP(PoseProperty, InterpolationMovesEvenly, ()) {
  Draw draw;
  const Pose a = draw.pose(), b = draw.pose();
  const double share = draw.random.uniform();
  const auto near = [&](const Pose& x, const Pose& y) {
    return distance(x.rotation.matrix(), y.rotation.matrix()) < 1e-12 &&
           (x.translation - y.translation).norm() < 1e-12 * (1 + a.translation.norm() + b.translation.norm());
  };
  RC_ASSERT(near(interpolate(a, b, 0), a));
  RC_ASSERT(near(interpolate(a, b, 1), b));
  RC_ASSERT(near(interpolate(a, b, share), interpolate(b, a, 1 - share)));
  RC_ASSERT(near(interpolate(a, b, share / 2), interpolate(a, interpolate(a, b, share), 0.5)));
}

TEST(Pose, KnowsWhetherItIsFinite) {
  Pose x;
  EXPECT_TRUE(x.is_finite());
  x.translation.y() = NAN;
  EXPECT_FALSE(x.is_finite());
  x.translation.y() = INFINITY;
  EXPECT_FALSE(x.is_finite());
}

}  // namespace
}  // namespace isobath
