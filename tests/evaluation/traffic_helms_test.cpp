// The baselines for suites in which bodies move.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/evaluation/evaluation.hpp>
#include <isobath/evaluation/traffic_helms.hpp>
#include <string>
#include <tests/support/pole_scene.hpp>

namespace isobath::traffic_helms {
namespace {

using Eigen::Vector2d;

/// The pole crosses the way from port at 1 m/s, and is in front of a vehicle that goes straight after 17 s.
class BodyThatCrosses : public testing::Test {
 protected:
  BodyThatCrosses() {
    const Scenario scenario = parse_scenario(test::kPoleScene, "pole.toml");
    run_ = make_run({}, {&scenario, 1}, 3);
    Scene& scene = run_.scenario.scene;
    scene.about.duration_s = 90;
    scene.bodies[0].shape = Cylinder{.centre = {26, -17, 10}, .radius = 0.5, .length = 20};
    scene.bodies[0].path = {0, 26, -17, 10, 60, 26, 43, 10};
  }
  [[nodiscard]] LoopResult steered_by(Helm& helm) const {
    LoopRequest request;
    request.stop_at_contact = true;
    return run_closed_loop(run_.scenario, helm, request);
  }
  [[nodiscard]] VehicleParameters vehicle() const { return RunTruth({}, run_).vehicle(); }
  void let_it_lie_still() {
    run_.scenario.scene.bodies[0].shape = Cylinder{.centre = {26, 0.3, 10}, .radius = 0.5, .length = 20};
    run_.scenario.scene.bodies[0].path.clear();
  }

  SuiteRun run_;
};

TEST_F(BodyThatCrosses, IsHitByAVehicleThatGoesStraight) {
  LineOfSightHelm helm(run_.scenario.mission, vehicle());
  EXPECT_EQ(steered_by(helm).contact_with, "pole");
}

TEST_F(BodyThatCrosses, HasItsTruePlaceAndVelocity) {
  const std::vector<SceneDisc> discs = discs_of(run_.scenario.scene);
  ASSERT_EQ(discs.size(), 1u);
  const AvoidedDisc disc = discs[0].at(20);
  EXPECT_LT((disc.p - Vector2d(26, 3)).norm(), 1e-9);
  EXPECT_LT((disc.velocity - Vector2d(0, 1)).norm(), 1e-9);
  EXPECT_NEAR(disc.radius_m, 0.5, 1e-9);
  EXPECT_EQ(discs[0].top_m, 0);
  EXPECT_EQ(discs[0].bottom_m, 20);
  EXPECT_LT(discs[0].at(70).velocity.norm(), 1e-9) << "it rests at the end of its path";
}

TEST_F(BodyThatCrosses, IsADiscAroundItsOutlineWhereItIsABox) {
  run_.scenario.scene.bodies[0].shape = Box{.centre = {26, -17, 10}, .size = {6, 8, 4}};
  const std::vector<SceneDisc> discs = discs_of(run_.scenario.scene);
  ASSERT_EQ(discs.size(), 1u);
  EXPECT_LT((discs[0].p_W - Vector2d(26, -17)).norm(), 1e-4);
  EXPECT_NEAR(discs[0].radius_m, 5, 1e-4);
}

TEST_F(BodyThatCrosses, IsPassedByVelocityObstacles) {
  VelocityObstacleHelm helm(run_.scenario.mission, vehicle(), discs_of(run_.scenario.scene), {});
  const LoopResult result = steered_by(helm);
  EXPECT_LT(result.contact_s, 0) << result.contact_with;
  EXPECT_GT(result.min_clearance_m, vehicle().hull_radius_m) << "beyond the distance of a collision";
  EXPECT_EQ(result.report.phase, MissionPhase::kFinished);
}

TEST_F(BodyThatCrosses, IsPassedByVelocityObstaclesWhereItLiesStill) {
  let_it_lie_still();
  VelocityObstacleHelm helm(run_.scenario.mission, vehicle(), discs_of(run_.scenario.scene), {});
  const LoopResult result = steered_by(helm);
  EXPECT_LT(result.contact_s, 0) << result.contact_with;
  EXPECT_EQ(result.report.phase, MissionPhase::kFinished);
}

TEST_F(BodyThatCrosses, IsNoObstacleAtAnotherDepth) {
  run_.scenario.scene.bodies[0].shape = Cylinder{.centre = {26, -17, 30}, .radius = 0.5, .length = 20};
  run_.scenario.scene.bodies[0].path = {0, 26, -17, 30, 60, 26, 43, 30};
  VelocityObstacleHelm helm(run_.scenario.mission, vehicle(), discs_of(run_.scenario.scene), {});
  for (const TrueMotion& m : steered_by(helm).track) EXPECT_NEAR(m.state.X_WB.translation.y(), 0, 0.1);
}

// In a ring of bodies that leaves no way out.
TEST_F(BodyThatCrosses, NeverStopsAVehicleThatCannotStop) {
  VehicleParameters fast = vehicle();
  fast.min_speed = 0.7;
  std::vector<SceneDisc> crowd;
  for (int i = 0; i < 12; ++i) {
    const Angle a = Angle::degrees(30 * i);
    SceneDisc& disc = crowd.emplace_back();
    disc.p_W = 4 * Vector2d(cos(a), sin(a));
    disc.radius_m = 1;
    disc.bottom_m = 20;
  }
  VelocityObstacleHelm helm(run_.scenario.mission, fast, crowd, {});
  Navigation fix;
  fix.X_WB.translation = {0, 0, 10};
  fix.v_WB = Eigen::Vector3d(0.7, 0, 0);
  helm.on_event(fix);
  fix.time = Time{seconds(0.1)};
  helm.on_event(fix);
  EXPECT_DOUBLE_EQ(helm.steer().speed, 0.7);
}

TEST_F(BodyThatCrosses, IsWaitedForByAHelmThatStops) {
  StopAndWaitHelm helm(run_.scenario.mission, vehicle(), {});
  const LoopResult result = steered_by(helm);
  EXPECT_LT(result.contact_s, 0) << result.contact_with;
  EXPECT_EQ(result.report.phase, MissionPhase::kFinished);
  ASSERT_GE(result.decisions.size(), 2u);
  EXPECT_EQ(result.decisions[0].what, "stop");
  ASSERT_TRUE(result.decisions[0].obstacle);
  EXPECT_EQ(result.decisions[1].what, "resume");
}

TEST_F(BodyThatCrosses, EndsTheMissionOfAHelmThatStopsWhereItLiesStill) {
  let_it_lie_still();
  run_.scenario.scene.about.duration_s = 120;
  StopAndWaitHelm helm(run_.scenario.mission, vehicle(), {});
  const LoopResult result = steered_by(helm);
  EXPECT_LT(result.contact_s, 0) << result.contact_with;
  EXPECT_GT(result.min_clearance_m, 3);
  EXPECT_EQ(result.report.phase, MissionPhase::kAborted);
  ASSERT_FALSE(result.decisions.empty());
  const double stopped_s = to_seconds(result.decisions.front().time);
  EXPECT_NEAR(to_seconds(result.decisions.back().time) - stopped_s, 60, 3);
}

// The suites of traffic compare with both.
TEST(TrafficBaselines, AreMadeByName) {
  Suite suite;
  suite.baselines = {Baseline::kVelocityObstacles, Baseline::kStopAndWait};
  const std::vector<ComparedMethod> methods = methods_of(suite, {});
  ASSERT_EQ(methods.size(), 3u);
  EXPECT_EQ(methods[1].name, "velocity obstacles");
  EXPECT_EQ(methods[2].name, "stop and wait");
  const Scenario scenario = parse_scenario(test::kPoleScene, "pole.toml");
  SuiteRun run = make_run({}, {&scenario, 1}, 3);
  const auto velocity = methods[1].make(run.scenario, RunTruth({}, run).vehicle(), {});
  const auto waiting = methods[2].make(run.scenario, RunTruth({}, run).vehicle(), {});
  EXPECT_NE(dynamic_cast<VelocityObstacleHelm*>(velocity.get()), nullptr);
  EXPECT_NE(dynamic_cast<StopAndWaitHelm*>(waiting.get()), nullptr);
}

}  // namespace
}  // namespace isobath::traffic_helms
