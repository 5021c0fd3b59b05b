// What a pair of cameras makes of fixes that are not sure.
#include <gtest/gtest.h>
#include <isobath/cameras/camera_rig.hpp>
#include <tests/stereo/simulated_pairs.hpp>

namespace isobath::camera_navigation {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

Navigation fix_of(double t, const Pose& X_WB, double sigma_m) {
  Navigation fix{Time(seconds(t)), X_WB, Vector3d(0, 0, 0), Eigen::Matrix<double, 6, 6>::Zero().eval()};
  fix.covariance->diagonal().head<2>().setConstant(sigma_m * sigma_m);
  fix.v_sigma = 0.3;
  return fix;
}

/// A vehicle that is carried off by a current, 4 cm a second to starboard and 2 cm ahead; its own dead reckoning holds
/// it for still, and says how little it knows.
struct Drifting {
  test::SimulatedPairs pairs;
  CameraRig rig;
  double worst_m = 0, worst_ratio = 0;
  Navigation last{};

  explicit Drifting(const CamerasConfig& config = {}) : rig(config, pairs.cameras, {}) {}
  static Pose truth(double t) { return {{}, {0.02 * t, 0.04 * t, 5}}; }
  void run(double from_s, double to_s, double sigma_per_s) {
    for (int step = static_cast<int>(from_s * 10); step <= static_cast<int>(to_s * 10); ++step) {
      const double t = 0.1 * step;
      last = fix_of(t, {{}, {0, 0, 5}}, sigma_per_s * t);
      rig.on_fix(last);
      if (t > 1) {
        const double off = (last.X_WB.translation - truth(t).translation).head<2>().norm();
        worst_m = std::max(worst_m, off);
        worst_ratio = std::max(worst_ratio, off / std::sqrt(last.covariance->topLeftCorner<2, 2>().trace()));
      }
      if (step % 5 == 0) (void)rig.on_pair(pairs.at(truth(t), t));
    }
  }
};

// ledger: S7-15
TEST(CameraNavigation, CarriesAPositionThatDeadReckoningLoses) {
  Drifting vehicle;
  vehicle.run(0, 10, 0.1);
  EXPECT_LT(vehicle.worst_m, 0.06) << "of 45 cm";
  EXPECT_LT(vehicle.worst_ratio, 3.5) << "and says how sure it is";
  EXPECT_NEAR((*vehicle.last.v_WB)[0], 0.02, 0.02);
  EXPECT_NEAR((*vehicle.last.v_WB)[1], 0.04, 0.02);
}

TEST(CameraNavigation, ASurerFixPassesAndPicturesGoOnFromThere) {
  Drifting vehicle;
  vehicle.run(0, 5, 0.1);
  Navigation sure = fix_of(5.05, {{}, {7, -3, 5}}, 0.001);
  vehicle.rig.on_fix(sure);
  EXPECT_EQ(sure.X_WB.translation, Vector3d(7, -3, 5));
  Navigation unsure = fix_of(5.1, {{}, {20, 20, 5}}, 5);
  vehicle.rig.on_fix(unsure);
  EXPECT_LT((unsure.X_WB.translation - Vector3d(7, -3, 5)).norm(), 0.05);
}

TEST(CameraNavigation, LeavesFixesThatStateNoCovarianceAndAllFixesIfItIsOff) {
  Drifting vehicle;
  vehicle.run(0, 2, 0.1);
  Navigation exact = fix_of(2.1, {{}, {1, 2, 5}}, 0);
  exact.covariance.reset();
  vehicle.rig.on_fix(exact);
  EXPECT_EQ(exact.X_WB.translation, Vector3d(1, 2, 5));
  CamerasConfig off;
  off.navigation.on = false;
  Drifting other(off);
  other.run(0, 3, 0.1);
  EXPECT_GT(other.worst_m, 0.1);
}

}  // namespace
}  // namespace isobath::camera_navigation
