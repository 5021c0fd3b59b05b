// From pairs of pictures to swaths, against the scene that they are of.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/stereo/pair_ranger.hpp>
#include <tests/stereo/simulated_pairs.hpp>

namespace isobath::pair_ranger {
namespace {

const Pose kFront{{}, {0, 0, 5}};

/// Distance of a sounding from the nearest true surface along its ray, in its own standard deviations.
std::vector<double> normalised_errors(const Swath& swath, const Pose& X_WB, const Pose& X_BL, const World& world) {
  std::vector<double> errors;
  const Eigen::Vector3d from = (X_WB * X_BL).translation;
  for (const Sounding& s : swath.soundings) {
    const Eigen::Vector3d to = X_WB * s.point.cast<double>();
    const auto hit = world.cast(from, (to - from).normalized(), 60);
    if (hit) errors.push_back((static_cast<double>(s.range_m) - hit->range) / static_cast<double>(s.sigma_range_m));
  }
  return errors;
}

// ledger: S8-07 S1-79
TEST(PairRanger, RangesAreThoseOfTheSceneWithinTheirStandardDeviations) {
  test::SimulatedPairs pairs;
  // The left camera stands ahead of the body's middle, to port, and looks 10 degrees to starboard.
  const Pose X_BL{Rotation::from_heading(Angle::degrees(10)), {0.2, -0.06, 0.05}};
  PairRanger ranger({}, pairs.cameras, X_BL);
  ASSERT_EQ(ranger.update(pairs.at(kFront * X_BL, 3)), PairFault::kNone);
  const Swath& swath = ranger.swath();
  EXPECT_EQ(swath.time, Time(seconds(3)));
  EXPECT_GT(swath.soundings.size(), 120u) << "of 20 x 15 blocks";
  std::vector<double> errors = normalised_errors(swath, kFront, X_BL, pairs.world());
  std::size_t within = 0;
  for (const double e : errors) within += std::abs(e) < 2 ? 1 : 0;
  EXPECT_GT(static_cast<double>(within), 0.9 * static_cast<double>(errors.size()));
  for (const Sounding& s : swath.soundings) {
    EXPECT_EQ(s.kind, Sounding::Kind::kWater);
    EXPECT_NEAR(static_cast<double>(s.range_m), (s.point.cast<double>() - X_BL.translation).norm(), 1e-5);
    const double z = (X_BL.inverse() * s.point.cast<double>()).x();
    EXPECT_NEAR(static_cast<double>(s.sigma_range_m), static_cast<double>(s.range_m) / z * z * z * 0.25 / (140 * 0.12),
                1e-5)
        << "sigma_R = R / Z x Z^2 sigma_d / (f B)";
  }
}

// ledger: S8-07 S8-10
TEST(PairRanger, BehindPortsInWaterRangesAreRightToo) {
  test::SimulatedPairs pairs(test::kWallAndBoulder, test::small_cameras(true));
  PairRanger ranger({}, pairs.cameras, {});
  ASSERT_EQ(ranger.update(pairs.at(kFront)), PairFault::kNone);
  std::vector<double> errors = normalised_errors(ranger.swath(), kFront, {}, pairs.world());
  double sum = 0;
  for (const double e : errors) sum += e;
  EXPECT_LT(std::abs(sum / static_cast<double>(errors.size())), 0.3) << "no bias";
}

// ledger: S8-11
TEST(PairRanger, TurbidWaterGivesNoReadings) {
  test::SimulatedPairs pairs;
  PairRangerConfig config;
  config.matching.min_contrast = 0.8;  // of noise of one grey level
  PairRanger ranger(config, pairs.cameras, {});
  ASSERT_EQ(ranger.update(pairs.at(kFront)), PairFault::kNone);
  const std::size_t clear = ranger.swath().soundings.size();
  pairs.cameras.light.attenuation_per_m = pairs.cameras.light.backscatter_per_m = {2.5, 2.5, 2.5};
  pairs.cameras.light.veil = {90, 90, 90};
  EXPECT_NE(ranger.update(pairs.at(kFront)), PairFault::kNone);
  EXPECT_EQ(ranger.swath().soundings.size(), 0u);
  EXPECT_GT(clear, 100u);
}

// ledger: S8-09
TEST(PairRanger, SaysWhatIsWrongWithAPair) {
  test::SimulatedPairs pairs;
  const CameraPair good = pairs.at(kFront);
  const auto fault_of = [&](const CameraPair& pair, const StereoCalibration& cameras) {
    return PairRanger({}, cameras, {}).update(pair);
  };
  EXPECT_EQ(fault_of({good.time, good.right, good.left}, pairs.cameras), PairFault::kExchanged);
  CameraPair other = good;
  other.right = halved(other.right);
  EXPECT_EQ(fault_of(other, pairs.cameras), PairFault::kSizesDiffer);
  other.left = halved(other.left);
  EXPECT_EQ(fault_of(other, pairs.cameras), PairFault::kOtherSize);
  other = good;
  std::fill(other.right.samples.begin(), other.right.samples.end(), std::uint8_t{3});
  EXPECT_EQ(fault_of(other, pairs.cameras), PairFault::kBlank);
  StereoCalibration nodded = pairs.cameras;
  nodded.R_RL = Rotation::exp({0.03, 0, 0}).matrix();  // the calibration of cameras that stand otherwise
  EXPECT_EQ(fault_of(good, nodded), PairFault::kRowsMiss);
  CameraImage tiny(40, 20, 1);
  StereoCalibration rectified;
  rectified.rectified = {100, 20, 10, 0.1, 0};
  EXPECT_EQ(fault_of({good.time, tiny, tiny}, rectified), PairFault::kTooSmall);
}

TEST(PairRanger, RefusesWhatCannotWork) {
  StereoCalibration moving = test::small_cameras();
  moving.moves = true;
  EXPECT_THROW(PairRanger({}, moving, {}), Error);
  PairRangerConfig config;
  config.matching.disparities = 70;
  EXPECT_THROW(PairRanger(config, test::small_cameras(), {}), Error);
}

}  // namespace
}  // namespace isobath::pair_ranger
