// Paths in space: arc length, and frames against finite differences.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/geometry/space_path.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Radius R, advance a, in axes with z down; turns to starboard going down.
CurveJet circular(double t) {
  constexpr double R = 4, a = 2;
  const double c = std::cos(t), s = std::sin(t);
  return {{R * c, R * s, a * t}, {-R * s, R * c, a}, {-R * c, -R * s, 0}, {R * s, -R * c, 0}};
}

/// Straight in x up to 0, then bends to port and back, and up and back.
CurveJet straight_then_swinging(double x) {
  if (x <= 0) return {{x, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  const double k = 1e-4, l = 2e-5;
  return {{x, k * std::pow(x, 4) * (x - 10), l * std::pow(x, 4) * (x - 14)},
          {1, k * (5 * std::pow(x, 4) - 40 * std::pow(x, 3)), l * (5 * std::pow(x, 4) - 56 * std::pow(x, 3))},
          {0, k * (20 * std::pow(x, 3) - 120 * x * x), l * (20 * std::pow(x, 3) - 168 * x * x)},
          {0, k * (60 * x * x - 240 * x), l * (60 * x * x - 336 * x)}};
}

// ledger: S5-E15
TEST(SpacePath, IsAskedByItsArcLength) {
  const SpacePath path(circular, 0, 10);
  EXPECT_NEAR(path.length(), 10 * std::sqrt(20.0), 1e-9);
  for (const double s : {0.0, 0.3, 7.7, 20.0, path.length()}) {
    EXPECT_NEAR(path.parameter_at(s), s / std::sqrt(20.0), 1e-10);
  }
  // Where the parameter runs unevenly: chords of equal arc are equal, to the second order of the bend.
  const SpacePath uneven(
      [](double u) {
        return CurveJet{{u * u * u + u, 0, 0}, {3 * u * u + 1, 0, 0}, {6 * u, 0, 0}, {6, 0, 0}};
      },
      -1, 2);
  EXPECT_NEAR(uneven.length(), 12, 1e-9);
  for (double s = 0; s <= 12; s += 0.37) EXPECT_NEAR(uneven.frame_at(s).p_W.x(), s - 2, 1e-9);
}

TEST(SpacePath, GoesOnStraightBeyondItsEnds) {
  const SpacePath path(circular, 0, 3);
  const PathFrame end = path.frame_at(path.length()), beyond = path.frame_at(path.length() + 5);
  EXPECT_NEAR((beyond.p_W - end.p_W - 5 * end.tangent()).norm(), 0, 1e-12);
  EXPECT_EQ(beyond.k1, 0);
  const PathFrame before = path.frame_at(-2);
  EXPECT_NEAR((path.frame_at(0).p_W - before.p_W - 2 * before.tangent()).norm(), 0, 1e-12);
}

// ledger: S5-49
TEST(SpacePath, FrenetFrameOfACircularHelixIsTheTextbooks) {
  for (const double t : {-2.0, 0.0, 0.4, 3.0}) {
    const auto frame = frenet_frame(circular(t));
    ASSERT_TRUE(frame.has_value());
    EXPECT_NEAR(frame->k1, 4 / 20.0, 1e-14);
    EXPECT_NEAR(frame->torsion, 2 / 20.0, 1e-14);
    EXPECT_NEAR(frame->R_WF.determinant(), 1, 1e-14);
    EXPECT_NEAR((frame->R_WF.col(1) - Vector3d(-std::cos(t), -std::sin(t), 0)).norm(), 0, 1e-14);  // to the axis
  }
  EXPECT_FALSE(frenet_frame({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}}).has_value());
}

void expect_no_twist(const SpacePath& path) {
  constexpr double h = 1e-3;
  for (double s = 0.1; s < path.length() - 0.1; s += 0.217) {
    const PathFrame at = path.frame_at(s);
    const Matrix3d slope = (path.frame_at(s + h).R_WF - path.frame_at(s - h).R_WF) / (2 * h);
    // R^T R' is skew and holds the turn a metre: 0 about T, k1 towards N, k2 towards B.
    const Matrix3d turn = at.R_WF.transpose() * slope;
    EXPECT_NEAR(turn(1, 0), at.k1, 1e-6) << s;
    EXPECT_NEAR(turn(2, 0), at.k2, 1e-6) << s;
    EXPECT_NEAR(turn(2, 1), 0, 1e-6) << s;
    EXPECT_NEAR((at.R_WF.transpose() * at.R_WF - Matrix3d::Identity()).norm(), 0, 1e-12);
    EXPECT_NEAR(at.R_WF.determinant(), 1, 1e-12);
  }
}

// ledger: S5-55
TEST(SpacePath, RotationMinimisingFrameDoesNotTwist) {
  expect_no_twist(SpacePath(circular, 0, 6));
  expect_no_twist(SpacePath(straight_then_swinging, -5, 14));
}

// Against the known angle: in a circular helix the frame turns back against N and B by the torsion. ledger: S5-55
TEST(SpacePath, RotationMinimisingFrameFallsBehindFrenetsByTheTorsion) {
  const SpacePath path(circular, 0, 6);
  const auto angle = [&](double s) {
    const PathFrame frame = path.frame_at(s);
    return std::atan2(frame.k2, frame.k1);  // of N, in the frame
  };
  for (const double s : {1.0, 5.0, 11.0, 25.0}) {
    EXPECT_NEAR(std::remainder(angle(s) - angle(0) - 0.1 * s, 2 * std::numbers::pi), 0, 1e-6);
    EXPECT_NEAR(std::hypot(path.frame_at(s).k1, path.frame_at(s).k2), 0.2, 1e-12);
  }
}

// Frenet's normal turns over at an inflection; the frame does not. ledger: S5-55
TEST(SpacePath, FrameDoesNotJumpWhereTheCurveDoes) {
  const SpacePath path(
      [](double x) {
        const double s = std::sin(x / 3), c = std::cos(x / 3);
        return CurveJet{{x, 2 * s, 0}, {1, 2 * c / 3, 0}, {0, -2 * s / 9, 0}, {0, -2 * c / 27, 0}};
      },
      0, 30);
  double frenet_jump = 0, jump = 0;
  Vector3d last_normal = Vector3d::Zero(), last_frenet = Vector3d::Zero();
  for (double s = 0.05; s < path.length(); s += 0.02) {
    const Vector3d normal = path.frame_at(s).R_WF.col(1);
    const auto frenet = frenet_frame(path.jet_at(s));
    ASSERT_TRUE(frenet.has_value());
    if (s > 0.06) {
      jump = std::max(jump, (normal - last_normal).norm());
      frenet_jump = std::max(frenet_jump, (frenet->R_WF.col(1) - last_frenet).norm());
    }
    last_normal = normal;
    last_frenet = frenet->R_WF.col(1);
  }
  EXPECT_LT(jump, 0.02);
  EXPECT_GT(frenet_jump, 1.9);  // it turns right over
}

TEST(SpacePath, RefusesWhatIsNoPath) {
  EXPECT_THROW(SpacePath(circular, 1, 1), Error);
  EXPECT_THROW(SpacePath([](double) { return CurveJet{}; }, 0, 1), Error);
  EXPECT_THROW(SpacePath([](double u) { return CurveJet{{u, 0, 0}, {NAN, 0, 0}, {0, 0, 0}, {0, 0, 0}}; }, 0, 1), Error);
}

}  // namespace
}  // namespace isobath
