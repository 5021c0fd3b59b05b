// Ranges from one moving camera, against planes and spheres ray by ray.
#include <gtest/gtest.h>
#include <isobath/geometry/pose.hpp>
#include <isobath/stereo/motion_stereo.hpp>
#include <tests/stereo/ray_pictures.hpp>

namespace isobath {
namespace {

using Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;

struct Moved {
  int found = 0, near_focus = 0, near_focus_asked = 0;
  double worst = 0;  ///< relative error that nine tenths of the pixels off the focus stay below
  double median = 0;
  double within_sigma = 0;  ///< share within two standard deviations
};

Moved moved(const Vector3d& p_AB, const Matrix3d& R_AB) {
  CameraModel camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 300;
  camera.cx = 159.5;
  camera.cy = 119.5;
  const std::vector<test::Surface> scene = test::room().scene;
  const auto sight = [&](const Vector3d& from, const Matrix3d& R) {
    return [&camera, from, R](double column, double row) {
      const Vector2d n = camera.normalised({column, row});
      return std::pair(from, Vector3d(R * Vector3d(n.x(), n.y(), 1).normalized()));
    };
  };
  const CameraImage first =
      test::take_picture(scene, 320, 240, sight({0, 0, 0}, Matrix3d::Identity()), test::textured(), 0.5, 1);
  const CameraImage second = test::take_picture(scene, 320, 240, sight(p_AB, R_AB), test::textured(), 0.5, 2);
  MotionStereoConfig config;
  config.every = 3;
  const MotionDepth depth = motion_depth(first, second, camera, R_AB, p_AB, config);
  Moved out;
  std::vector<double> errors;
  int within = 0;
  for (int row = 0; row < depth.height; ++row) {
    for (int column = 0; column < depth.width; ++column) {
      const Vector2d n = camera.normalised({column * 3, row * 3});
      const Vector3d along = Vector3d(n.x(), n.y(), 1).normalized();
      const double off_deg = std::acos(std::min(1.0, std::abs(along.dot(p_AB.normalized())))) * 180 / 3.141592653589793;
      const bool near = off_deg < 1.5;  // hardly moves: at 2 m by 1.4 pixels for 0.3 m ahead
      const std::size_t i = static_cast<std::size_t>(row * depth.width + column);
      out.near_focus_asked += near;
      if (!std::isfinite(depth.depth_m[i])) continue;
      out.near_focus += near;
      if (off_deg < 10) continue;
      const double truth = test::nearest(scene, {0, 0, 0}, along)->p.z();
      errors.push_back(std::abs(depth.depth_m[i] / truth - 1));
      within += std::abs(depth.depth_m[i] - truth) < 2 * depth.sigma_m[i];
    }
  }
  std::ranges::sort(errors);
  out.found = static_cast<int>(errors.size());
  if (errors.empty()) return out;
  out.worst = errors[errors.size() * 9 / 10];
  out.median = errors[errors.size() / 2];
  out.within_sigma = within / static_cast<double>(errors.size());
  return out;
}

// ledger: S8-05 S8-D03
TEST(MotionStereo, RangesOfACameraThatMovesAsideAreWithinFivePerCent) {
  const Moved aside = moved({0.12, 0, 0}, Matrix3d::Identity());
  EXPECT_GT(aside.found, 3500);
  EXPECT_LT(aside.worst, 0.05);
  EXPECT_GT(aside.within_sigma, 0.8);
}

// ledger: S8-05 S8-D03
TEST(MotionStereo, ACameraThatMovesAheadAndTurnsKnowsLittleNearTheFocusOfExpansion) {
  const Moved ahead = moved({0.03, 0, 0.3}, Rotation::exp({0.02, 0.03, -0.02}).matrix());
  EXPECT_GT(ahead.found, 2000);
  EXPECT_LT(ahead.worst, 0.05) << "more than 10 degrees off it";
  ASSERT_GT(ahead.near_focus_asked, 15);
  EXPECT_LE(ahead.near_focus, ahead.near_focus_asked / 5) << "uncertain pixels have no depth";
}

TEST(MotionStereo, ACameraThatRestsGivesNoDepth) { EXPECT_EQ(moved({0, 0, 1e-9}, Matrix3d::Identity()).found, 0); }

}  // namespace
}  // namespace isobath
