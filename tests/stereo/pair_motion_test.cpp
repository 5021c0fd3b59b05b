// The motion between pairs of pictures, against the poses that they were taken from.
#include <Eigen/Cholesky>
#include <gtest/gtest.h>
#include <isobath/stereo/pair_motion.hpp>
#include <isobath/stereo/pair_ranger.hpp>
#include <tests/stereo/simulated_pairs.hpp>

namespace isobath::pair_motion_of_scenes {
namespace {

using Eigen::Vector3d;

/// forward, starboard, down from right, down, forward.
Pose forward_first(const Pose& X_KN) {
  const Eigen::Matrix3d A = (Eigen::Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished();
  return {Rotation::from_matrix(A * X_KN.rotation.matrix() * A.transpose()), A * X_KN.translation};
}

struct Found {
  std::optional<PairMotion> motion;
  Vector3d off;         ///< m
  Vector3d turned_off;  ///< rad
};

Found motion_between(const Pose& X_WA, const Pose& X_WB, bool in_water, const MotionGuess& guess = {}) {
  test::SimulatedPairs pairs(test::kWallAndBoulder, test::small_cameras(in_water));
  PairRanger ranger({}, pairs.cameras, {});
  EXPECT_EQ(ranger.update(pairs.at(X_WA)), PairFault::kNone);
  const MotionKey key(ranger.left(), ranger.map(), ranger.geometry(), {});
  EXPECT_EQ(ranger.update(pairs.at(X_WB)), PairFault::kNone);
  Found found;
  found.motion = pair_motion(key, ranger.left(), ranger.map(), ranger.geometry(), 0.25, guess, {});
  if (!found.motion) return found;
  const Pose was = X_WA.inverse() * X_WB, is = forward_first(found.motion->X_KN);
  found.off = is.translation - was.translation;
  found.turned_off = (was.rotation.inverse() * is.rotation).log();
  return found;
}

const Pose kHere{{}, {0, 0, 5}};

// ledger: S7-15 S8-05
TEST(PairMotion, IsThatOfTheCamerasToACentimetre) {
  const Pose there{Rotation::from_heading_pitch_roll(Angle::degrees(1.5), Angle::degrees(-1), Angle::degrees(0.7)),
                   {0.05, -0.06, 5.03}};
  for (const bool in_water : {false, true}) {
    const Found found = motion_between(kHere, there, in_water);
    ASSERT_TRUE(found.motion);
    EXPECT_GT(found.motion->inliers, 40);
    EXPECT_LT(found.off.norm(), 0.015) << "of 8 cm";
    EXPECT_LT(found.turned_off.norm(), 0.006) << "of 2 degrees";
    const Eigen::Matrix3d C = found.motion->covariance.topLeftCorner<3, 3>();
    EXPECT_LT(std::sqrt(C.trace()), 0.03);
    EXPECT_GT(std::sqrt(C.trace()), 0.0005) << "it is no exact measurement";
  }
}

TEST(PairMotion, OfAVehicleThatStandsStillIsNone) {
  const Found found = motion_between(kHere, kHere, false);
  ASSERT_TRUE(found.motion);
  EXPECT_LT(found.off.norm(), 0.004);
}

TEST(PairMotion, AGuessFindsPointsThatHaveMovedBeyondTheReach) {
  const Pose there{{}, {0, 0.3, 5}};
  EXPECT_FALSE(motion_between(kHere, there, false).motion && motion_between(kHere, there, false).off.norm() < 0.05);
  const Found found = motion_between(kHere, there, false, {{Rotation(), {0.27, 0, 0}}, 0.01});
  ASSERT_TRUE(found.motion);
  EXPECT_LT(found.off.norm(), 0.02) << "of 30 cm";
}

TEST(PairMotion, OfAnotherPlaceIsRefused) {
  EXPECT_FALSE(motion_between(kHere, {Rotation::from_heading(Angle::degrees(90)), {0, 1.5, 5}}, false).motion);
}

}  // namespace
}  // namespace isobath::pair_motion_of_scenes
