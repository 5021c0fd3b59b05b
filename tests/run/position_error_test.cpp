// A mission past a pole by a vehicle that is wrong about its position.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <isobath/run/closed_loop.hpp>
#include <isobath/scenario/scenario.hpp>
#include <tests/support/pole_scene.hpp>

namespace isobath {
namespace {

/// The mission point lies `error_m` further north, as the vehicle believes itself to do.
LoopResult past_the_pole(double error_m, double drift_m_s = 0) {
  std::string text = test::kPoleScene;
  text += fmt::format("[mission]\ntitle = \"Past a pole\"\nspeed = 1.5\n[[mission_point]]\nnorth = {}\ndepth_m = 10\n",
                      45 + error_m);
  const auto fault = [&](const char* kind, double amount) {
    text += fmt::format("[[fault]]\nsource = \"navigation\"\nkind = \"{}\"\namount = {}\n", kind, amount);
  };
  if (error_m != 0) fault("jump", error_m);
  if (drift_m_s != 0) fault("drifting", drift_m_s);
  return run_closed_loop(parse_scenario(text, "pole.toml"));
}

// By 100 m, and by 1 % of a way of 2,437 m before the run. With a drift of 1 % that goes on, the estimate of the way to
// the mission point is wrong by that much, and the distance from the pole by no more. ledger: S6-53
TEST(PositionError, LeavesTheTrackPastAPoleAsItIs) {
  const LoopResult right = past_the_pole(0), wrong = past_the_pole(100 + 0.01 * 2437);
  EXPECT_EQ(right.report.phase, MissionPhase::kFinished);
  EXPECT_GT(right.min_clearance_m, 1);
  ASSERT_FALSE(right.decisions.empty());
  ASSERT_EQ(wrong.track.size(), right.track.size());
  double aside = 0;
  for (std::size_t i = 0; i < right.track.size(); ++i) {
    const Eigen::Vector3d& p = right.track[i].state.X_WB.translation;
    ASSERT_LT((wrong.track[i].state.X_WB.translation - p).norm(), 1e-6) << i;
    aside = std::max(aside, std::abs(p.y()));
  }
  EXPECT_GT(aside, 1) << "the pole stands on the straight way";
  const LoopResult drifting = past_the_pole(100, 0.01 * 1.5);
  EXPECT_EQ(drifting.report.phase, MissionPhase::kFinished);
  EXPECT_NEAR(drifting.min_clearance_m, right.min_clearance_m, 0.01 * right.length_m);
}

}  // namespace
}  // namespace isobath
