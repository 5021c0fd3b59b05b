#include <gtest/gtest.h>
#include <isobath/runtime/pose_buffer.hpp>
#include <tests/runtime/events.hpp>

namespace isobath {
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

TEST(PoseBuffer, NamesWhyThereIsNoPose) {
  PoseBuffer poses({.max_gap_s = 5});
  EXPECT_EQ(poses.at(at(0)).error(), PoseFault::kNoFixYet);
  poses.add(fix_at(10, 0));
  poses.add(fix_at(20, 0));
  EXPECT_EQ(poses.at(at(9)).error(), PoseFault::kBeforeFirst);
  EXPECT_EQ(poses.at(at(15)).error(), PoseFault::kGap);
  EXPECT_TRUE(poses.at(at(20)));
}

TEST(PoseBuffer, KeepsTheNewestThousandFixes) {
  PoseBuffer poses({});
  for (int i = 0; i < 5000; ++i) poses.add(fix_at(0.1 * i, i));
  EXPECT_NEAR(poses.at(at(450.05))->translation.x(), 4500.5, 1e-6);
  EXPECT_EQ(poses.at(at(1)).error(), PoseFault::kBeforeFirst);
}

}  // namespace
}  // namespace isobath
