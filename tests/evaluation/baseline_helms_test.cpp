#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/evaluation/baseline_helms.hpp>
#include <isobath/evaluation/run_score.hpp>
#include <tests/support/pole_scene.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

class PoleOnTheWay : public testing::Test {
 protected:
  PoleOnTheWay() {
    const Scenario scenario = parse_scenario(test::kPoleScene, "pole.toml");
    run_ = make_run({}, {&scenario, 1}, 3);
    run_.scenario.scene.about.duration_s = 60;
    vehicle_ = RunTruth({}, run_).vehicle();
  }

  LoopResult steered_by(Helm& helm) {
    LoopRequest request;
    request.stop_at_contact = true;
    return run_closed_loop(run_.scenario, helm, request);
  }

  SuiteRun run_;
  VehicleParameters vehicle_;
};

// ledger: S6-62
TEST_F(PoleOnTheWay, IsHitByWhoAvoidsNothing) {
  LineOfSightHelm helm(run_.scenario.mission, vehicle_);
  const LoopResult result = steered_by(helm);
  EXPECT_EQ(result.contact_with, "pole");
  EXPECT_NEAR(result.contact_s, (26 - 0.5 - 0.35) / 1.5, 0.3);
  EXPECT_EQ(helm.progress().phase, MissionPhase::kUnderWay);
}

TEST_F(PoleOnTheWay, IsGoneRoundByAPotentialField) {
  PotentialFieldHelm helm(run_.scenario.mission, vehicle_, {});
  const LoopResult result = steered_by(helm);
  EXPECT_LT(result.contact_s, 0) << result.contact_with;
  EXPECT_GT(result.min_clearance_m, 0.25);
  EXPECT_EQ(result.report.phase, MissionPhase::kFinished);
  EXPECT_EQ(result.report.reached, 1u);
}

TEST_F(PoleOnTheWay, IsGoneRoundByImageThresholds) {
  ImageThresholdHelm helm(run_.scenario.mission, vehicle_, {});
  const LoopResult result = steered_by(helm);
  EXPECT_LT(result.contact_s, 0) << result.contact_with;
  EXPECT_GT(result.min_clearance_m, 1);
  EXPECT_EQ(result.report.phase, MissionPhase::kFinished);
  ASSERT_FALSE(result.decisions.empty());
  EXPECT_EQ(result.decisions.front().what, "replan");
  ASSERT_TRUE(result.decisions.front().obstacle);
  EXPECT_LT((*result.decisions.front().obstacle - Vector2d(26, 0.3)).norm(), 2.5);
}

TEST_F(PoleOnTheWay, IsNoObstacleBesideTheWay) {
  run_.scenario.scene.bodies[0].shape = Cylinder{{26, 18, 10}, {0, 0, 1}, 0.5, 20};
  PotentialFieldHelm field(run_.scenario.mission, vehicle_, {});
  for (const TrueMotion& m : steered_by(field).track) EXPECT_NEAR(m.state.X_WB.translation.y(), 0, 0.5);
}

/// One scan of a single beam that looks ahead, with these samples in bins of 1 m.
class OneBeam {
 public:
  OneBeam() { fan_ = std::make_shared<BeamFan>(BeamFan{{Angle()}, {Angle::degrees(3)}, Angle::degrees(20)}); }
  void scan(ImageThresholdHelm& helm, std::vector<std::uint8_t> samples) {
    Ping ping;
    ping.fan = fan_;
    ping.window = {0, 1, static_cast<int>(samples.size())};
    ping.intensity = {samples.data(), SampleType::kU8, 1, ping.window.bins, ping.window.bins, 1};
    ping.blanking_m = 1;
    const EchoDecisions decisions;
    helm.on_ping({ping, Pose{}, decisions});
    const Detection detection;
    const BodyGrid grid{BodyGridConfig{}};
    helm.on_scan({1, true, detection, grid});
  }

 private:
  std::shared_ptr<const BeamFan> fan_;
};

// Ganesan 2015, 2.1: three quarters of the maximum, believed when three scans agree. ledger: S6-62
TEST_F(PoleOnTheWay, ImageThresholdsBelieveWhatThreeScansShow) {
  ImageThresholdHelm helm(run_.scenario.mission, vehicle_, {});
  OneBeam sonar;
  const std::vector<std::uint8_t> scan{255, 10, 10, 10, 200, 10, 150, 149, 10};  // the first bin is blind
  sonar.scan(helm, scan);
  EXPECT_TRUE(helm.believed().empty());
  sonar.scan(helm, scan);
  EXPECT_TRUE(helm.believed().empty());
  sonar.scan(helm, scan);
  ASSERT_EQ(helm.believed().size(), 2u);
  EXPECT_DOUBLE_EQ(helm.believed()[0].x(), 4.5);
  EXPECT_DOUBLE_EQ(helm.believed()[1].x(), 6.5);  // 150 of 200; 149 is below
  sonar.scan(helm, {0, 10, 10, 10, 10, 10, 10, 10, 200});
  EXPECT_TRUE(helm.believed().empty());
}

// The other method of the same section: between the two highest modes of the histogram, and two scans agree. Without
// two modes there is no threshold. ledger: S6-62
TEST(HistogramThreshold, LiesBetweenTheTwoHighestModes) {
  Random random(9);
  std::vector<float> samples;
  const auto add = [&](int count, double middle) {
    for (int i = 0; i < count; ++i) samples.push_back(static_cast<float>(middle + 6 * random.normal()));
  };
  add(20000, 60);
  add(3000, 180);
  add(200, 120);  // lower than both
  const float between = threshold_between_modes(samples);
  EXPECT_GT(between, 80);
  EXPECT_LT(between, 160);
  EXPECT_TRUE(std::isinf(threshold_between_modes({})));
  EXPECT_TRUE(std::isinf(threshold_between_modes(std::vector<float>(50, 0.0F))));
  EXPECT_TRUE(std::isinf(threshold_between_modes(std::vector<float>(50, 7.0F))));
}

// What it goes by is what is scored: one obstacle for the echoes of one body, in the frame of the scan.
TEST_F(PoleOnTheWay, HistogramThresholdsBelieveWhatTwoScansShow) {
  ImageThresholdConfig config;
  config.threshold = ImageThreshold::kBetweenModes;
  config.scans = 2;
  config.same_m = 2.5;
  ImageThresholdHelm helm(run_.scenario.mission, vehicle_, config);
  OneBeam sonar;
  const std::vector<std::uint8_t> scan{255, 10, 10, 10, 200, 10, 200, 10, 10, 10, 10, 10, 200};
  sonar.scan(helm, scan);
  EXPECT_TRUE(helm.believed().empty());
  EXPECT_TRUE(helm.own_obstacles()->empty());
  sonar.scan(helm, scan);
  EXPECT_EQ(helm.believed().size(), 3u);
  ASSERT_EQ(helm.own_obstacles()->size(), 2u);
  std::vector<double> ranges;
  for (const Obstacle& one : *helm.own_obstacles()) ranges.push_back(one.range_m);
  std::ranges::sort(ranges);
  EXPECT_DOUBLE_EQ(ranges[0], 4.5);
  EXPECT_DOUBLE_EQ(ranges[1], 12.5);
}

}  // namespace
}  // namespace isobath
