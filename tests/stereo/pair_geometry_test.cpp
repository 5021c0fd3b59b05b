// Cameras, ports and rectification against closed forms and ray by ray.
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <isobath/stereo/dense_matcher.hpp>
#include <isobath/stereo/stereo_ranges.hpp>
#include <isobath/stereo/vertical_residual.hpp>
#include <numbers>
#include <tests/stereo/ray_pictures.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;
using testing::HasSubstr;

// ledger: S8-09
TEST(CameraModel, NormalisedCoordinatesAreTheInverseOfPixels) {
  CameraModel camera;
  camera.k1 = -0.27;
  camera.k2 = 0.09;
  camera.p1 = 0.001;
  camera.p2 = -0.0007;
  camera.k3 = -0.01;
  for (const double x : {-0.6, -0.1, 0.0, 0.4}) {
    for (const double y : {-0.45, 0.0, 0.3}) {
      const Vector2d back = camera.normalised(camera.pixel({x, y}));
      EXPECT_NEAR(back.x(), x, 1e-7);
      EXPECT_NEAR(back.y(), y, 1e-7);
    }
  }
}

// ledger: S8-10
TEST(FlatPort, RaysObeySnellsLawAtBothFaces) {
  const FlatPort port;
  const Vector2d seen(0.5, -0.3);
  const FlatPort::Ray ray = port.ray(seen);
  const double air = std::atan(seen.norm()), water = std::acos(ray.direction.z());
  EXPECT_NEAR(std::sin(air), port.water_index * std::sin(water), 1e-12);
  const double glass = std::asin(std::sin(air) / port.glass_index);
  EXPECT_NEAR(ray.origin.head<2>().norm(), port.distance_m * std::tan(air) + port.thickness_m * std::tan(glass), 1e-12);
  EXPECT_NEAR(ray.direction.x() / ray.direction.y(), seen.x() / seen.y(), 1e-12) << "it stays in its plane";
}

// ledger: S8-10
TEST(FlatPort, APointIsSeenWhereItsRayComesFromAndNearTheAxisTheFocalLengthIsTimesTheIndex) {
  const FlatPort port;
  for (const double t : {0.001, 0.2, 0.7, 1.5}) {
    const Vector2d seen(0.8 * t, -0.6 * t);
    const FlatPort::Ray ray = port.ray(seen);
    const Vector2d again = port.project(ray.origin + 3.7 * ray.direction);
    EXPECT_NEAR((again - seen).norm(), 0, 1e-10);
  }
  FlatPort thin;
  thin.distance_m = thin.thickness_m = 0;
  const Vector3d p(0.01, 0, 2);
  EXPECT_NEAR(thin.project(p).x(), 1.34 * 0.01 / 2, 1e-7);
}

/// Two cameras that stand askew, with lenses that distort.
StereoCalibration askew() {
  StereoCalibration c;
  c.left.width = c.right.width = 320;
  c.left.height = c.right.height = 240;
  c.left.fx = c.left.fy = 290;
  c.right.fx = c.right.fy = 297;
  c.left.cx = 157;
  c.left.cy = 122;
  c.right.cx = 163;
  c.right.cy = 116;
  c.left.k1 = -0.2;
  c.right.k1 = -0.17;
  c.right.k2 = 0.03;
  c.R_RL = Rotation::exp({0.02, -0.03, 0.025}).matrix();
  c.p_RL = {-0.15, 0.006, 0.004};
  return c;
}

/// What a camera of the calibration sees.
CameraImage seen_by(const StereoCalibration& c, Eye eye, const std::vector<test::Surface>& scene) {
  const CameraModel& model = eye == Eye::kLeft ? c.left : c.right;
  const Matrix3d R_LC = eye == Eye::kLeft ? Matrix3d(Matrix3d::Identity()) : Matrix3d(c.R_RL.transpose());
  const Vector3d p_LC = eye == Eye::kLeft ? Vector3d(0, 0, 0) : Vector3d(-c.R_RL.transpose() * c.p_RL);
  const auto sight = [&](double column, double row) {
    const Vector2d n = model.normalised({column, row});
    FlatPort::Ray ray{{0, 0, 0}, Vector3d(n.x(), n.y(), 1).normalized()};
    if (c.in_water) ray = c.port.ray(n);
    return std::pair(Vector3d(p_LC + R_LC * ray.origin), Vector3d(R_LC * ray.direction));
  };
  return test::take_picture(scene, model.width, model.height, sight, test::textured(), 0.5, eye == Eye::kLeft ? 1 : 2);
}

struct Ranged {
  double bias_on_axis = 0, worst_share = 0, vertical = 0, valid = 0;
};

/// Rectifies, matches and ranges a plane in front of the cameras, n.p = distance.
Ranged ranged(const StereoCalibration& truth, const StereoCalibration& used, const Vector3d& normal, double distance) {
  const std::vector<test::Surface> scene = {test::plane(normal, distance)};
  const PairGeometry geometry(used);
  const CameraImage left = geometry.rectify(Eye::kLeft, seen_by(truth, Eye::kLeft, scene));
  const CameraImage right = geometry.rectify(Eye::kRight, seen_by(truth, Eye::kRight, scene));
  DenseMatcher matcher({});
  const DisparityMap map = matcher.match(left, right);
  Ranged out;
  out.valid = map.share_of(PixelState::kValid);
  const auto vertical = vertical_residual(left, right, map);
  out.vertical = vertical ? vertical->median_absolute_px : 99;
  std::vector<double> on_axis, all;
  for (const StereoPoint& point : stereo_points(map, geometry, 0.25)) {
    const Vector3d p_L = geometry.R_VL().transpose() * point.p_V;
    // along the line from the camera to the point the plane is at this share of it
    const double share = p_L.dot(normal) / distance - 1;
    all.push_back(std::abs(share));
    if (std::abs(point.column - 160) < 30 && std::abs(point.row - 120) < 30) on_axis.push_back(share);
  }
  std::ranges::sort(on_axis);
  std::ranges::sort(all);
  if (!on_axis.empty()) out.bias_on_axis = on_axis[on_axis.size() / 2];
  if (!all.empty()) out.worst_share = all[all.size() * 9 / 10];
  return out;
}

// ledger: S8-09
TEST(PairGeometry, RectifiedRowsOfSkewedCamerasMeetWithinThreeTenthsOfAPixel) {
  const Ranged good = ranged(askew(), askew(), Vector3d(0.2, 0.1, 1).normalized(), 1.6);
  EXPECT_GT(good.valid, 0.55);
  EXPECT_LT(good.vertical, 0.3);
  EXPECT_LT(std::abs(good.bias_on_axis), 0.01);
  EXPECT_LT(good.worst_share, 0.03) << "nine tenths of all points";
  StereoCalibration other = askew();
  other.R_RL = Rotation::exp({0.03, -0.03, 0.025}).matrix();  // the right camera has nodded by 0.6 degrees
  EXPECT_GT(ranged(askew(), other, Vector3d(0.2, 0.1, 1).normalized(), 1.6).vertical, 1.5);
}

// ledger: S8-10
TEST(PairGeometry, WithoutThePortRangesAreAQuarterShortWithItWithinTwoPerCent) {
  StereoCalibration c = askew();
  c.in_water = true;
  StereoCalibration parallel = c, in_air;
  parallel.R_RL = Matrix3d::Identity();
  parallel.p_RL = {-0.15, 0, 0};
  in_air = parallel;
  in_air.in_water = false;
  for (const double distance : {1.2, 2.0, 3.0}) {
    const Ranged with = ranged(c, c, Vector3d(0.1, 0, 1).normalized(), distance);
    EXPECT_LT(std::abs(with.bias_on_axis), 0.02) << distance;
    EXPECT_LT(with.worst_share, 0.03) << distance << ": nine tenths of all points";
    EXPECT_LT(with.vertical, 0.3) << distance;
    const Ranged without = ranged(parallel, in_air, Vector3d(0.1, 0, 1).normalized(), distance);
    EXPECT_NEAR(without.bias_on_axis, 1 / 1.34 - 1, 0.03) << distance;
  }
}

// ledger: S8-07
TEST(PairGeometry, TheDeviationOfARangeGrowsWithItsSquare) {
  const PairGeometry geometry(RectifiedPair{500, 320, 240, 0.1, 0});
  EXPECT_DOUBLE_EQ(geometry.sigma_z(2, 0.25), 4 * 0.25 / 50);
  // and it is what a change of the disparity does
  const double d = 25, step = 1e-4;
  const double slope = (geometry.point(300, 200, d)->z() - geometry.point(300, 200, d + step)->z()) / step;
  EXPECT_NEAR(slope * 0.25, geometry.sigma_z(2, 0.25), 1e-5);
  EXPECT_FALSE(geometry.point(300, 200, 0));
  const Vector3d p = *geometry.point(420, 140, 25);
  EXPECT_NEAR((p - Vector3d(0.4, -0.4, 2)).norm(), 0, 1e-12);
}

// A wall 2 m ahead of a vehicle that heads east becomes readings, which a map takes as it takes those of sonars.
// ledger: S8-07
TEST(StereoReadings, UpdateTheSphericalGridWhereTheWallIs) {
  test::RayPair pair;
  pair.scene = {test::plane({0, 0, 1}, 2)};
  DenseMatcher matcher({});
  const DisparityMap map = matcher.match(pair.left(test::textured()), pair.right(test::textured()));
  const PairGeometry geometry(RectifiedPair{pair.focal, 159.5, 119.5, pair.baseline, 0});
  const auto readings = stereo_readings(map, geometry, 0.25, {}, {});
  ASSERT_GT(readings.size(), 100u);
  for (const StereoReading& one : readings) {
    const Vector3d p_B = one.reading.X_BS * Vector3d(*one.reading.range_m, 0, 0);
    EXPECT_NEAR(p_B.x(), 2, 0.06);
    const double sine = 2 / *one.reading.range_m;
    EXPECT_NEAR(one.sigma_m, 4 * 0.25 / (300 * 0.15) / sine, 0.01);
  }
  SphericalGridConfig config;
  SphericalGrid grid(config);
  SphericalMapper mapper({}, grid);
  const Pose X_WB{Rotation::from_heading(Angle::degrees(90)), {0, 0, 0}};
  mapper.move_to(X_WB, {});
  mapper.begin_scan();
  for (const StereoReading& one : readings) mapper.update(one.reading, X_WB);
  EXPECT_GT(grid.cells().size(), 20u);
}

StereoCalibration read(const std::string& text, const std::string& name = "rig.toml") {
  const std::filesystem::path file = test::scratch_folder() / name;
  std::ofstream(file) << text;
  return read_stereo_calibration(std::vector{file});
}

std::string problem_of(const std::string& text) {
  try {
    read(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// ledger: S8-09
TEST(StereoCalibration, ReadsTomlAndTheYamlOfOpenCv) {
  const StereoCalibration toml =
      read("[left]\nfx = 700\n[pair]\ntranslation_m = [-0.2, 0, 0]\n[port]\nin_water = true\n");
  EXPECT_EQ(toml.left.fx, 700);
  EXPECT_EQ(toml.p_RL.x(), -0.2);
  EXPECT_TRUE(toml.in_water);
  const std::string yaml =
      "%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 5.3e+02, 0., 3.3e+02, 0.,\n"
      "       5.4e+02, 2.4e+02, 0., 0., 1. ]\nD1: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
      "   data: [ -2.5e-01, 1., 0., 0., 0. ]\nM2: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [ 531., 0., 331., 0., 541., 241., 0., 0., 1. ]\nD2: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
      "   data: [ 0., 0., 0., 0., 0. ]\n";
  EXPECT_THAT(problem_of(yaml), HasSubstr("does not say how the right camera stands (R and T)"));
  const StereoCalibration c =
      read(yaml +
           "R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]\n"
           "T: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ -3.3, 0.1, 0. ]\n");
  EXPECT_EQ(c.left.fx, 530);
  EXPECT_EQ(c.left.cy, 240);
  EXPECT_EQ(c.left.k1, -0.25);
  EXPECT_EQ(c.left.k2, 1);
  EXPECT_EQ(c.right.fy, 541);
  EXPECT_EQ(c.p_RL.x(), -3.3);
  EXPECT_EQ(c.left.width, 0) << "not stated";
}

TEST(StereoCalibration, WrongInputIsRefusedInOneSentence) {
  EXPECT_THAT(problem_of("[left]\nfx = -3\n"), HasSubstr("rig.toml:2:"));
  EXPECT_THAT(problem_of("[pair]\nrotation = [1, 0, 0, 0, 1, 0, 0, 0.5, 1]\n"), HasSubstr("is not a rotation"));
  EXPECT_THAT(problem_of("%YAML:1.0\n"), HasSubstr("M1: has no camera matrix of nine numbers"));
  EXPECT_THAT(problem_of("%YAML:1.0\nM1: !!opencv-matrix\n   data: [ 1, x, 3 ]\n"), HasSubstr("cannot be read"));
  EXPECT_THAT(problem_of("%YAML:1.0\nM1: !!opencv-matrix\n"), HasSubstr("a matrix without data"));
  StereoCalibration exchanged;
  exchanged.p_RL = {0.12, 0, 0};
  EXPECT_THROW(PairGeometry{exchanged}, Error);
}

}  // namespace
}  // namespace isobath
