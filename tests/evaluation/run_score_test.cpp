#include <gtest/gtest.h>
#include <isobath/evaluation/run_score.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr const char* kScene = R"(
[scene]
title = "hand-made"
duration_s = 100
[vehicle]
start = [0, 0, 5]
speed = 2
[[cylinder]]
name = "pole"
centre = [50, 40, 5]
radius = 1
length = 4
[[cylinder]]
name = "wreck"
centre = [50, 0, 20]
radius = 1
length = 4
)";

/// A vehicle of half a metre: a quarter of the reference.
class Scored : public testing::Test {
 protected:
  Scored() {
    run_.scenario = parse_scenario(kScene, "hand-made.toml");
    MissionPlan& mission = run_.scenario.mission;
    mission.speed = 2;
    for (const Vector2d& p : {Vector2d(50, 0), Vector2d(100, 0)}) {
      mission.points.emplace_back();
      mission.points.back().north_east = p;
      mission.points.back().depth_m = 5;
      mission.points.back().name = "point " + std::to_string(mission.points.size());
    }
    suite_.about.goal_m = 6;
    suite_.about.near_body_m = 4;
    result_.report.phase = MissionPhase::kFinished;
  }

  /// Straight from corner to corner at 2 m/s, ten samples a second.
  void go(const std::vector<Vector2d>& corners) {
    result_.track.clear();
    double t = 0;
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const double length = (corners[i + 1] - corners[i]).norm();
      const int steps = static_cast<int>(std::lround(length / 0.2));
      for (int k = i == 0 ? 0 : 1; k <= steps; ++k, t += 0.1) {
        const Vector2d p = corners[i] + (corners[i + 1] - corners[i]) * (static_cast<double>(k) / steps);
        TrueMotion motion;
        motion.time = Time(seconds(t));
        motion.state.X_WB.translation = {p.x(), p.y(), 5};
        result_.track.push_back(motion);
      }
    }
    result_.duration_s = t;
  }

  [[nodiscard]] RunScore scored() const {
    return score(result_, run_.scenario.mission, RunTruth(suite_, run_), suite_.about);
  }

  Suite suite_;
  SuiteRun run_;
  LoopResult result_;
};

// ledger: S6-67
TEST_F(Scored, NearnessIsInProportionToTheHull) {
  go({{0, 0}, {100, 0}});
  const auto nearness = [&](double clearance) {
    result_.min_clearance_m = clearance;
    result_.nearest_body = "pole";
    const RunScore s = scored();
    return int{s.collision} + int{s.near_miss} + int{s.encounter};
  };
  EXPECT_EQ(nearness(0.249), 3);
  EXPECT_EQ(nearness(0.251), 2);
  EXPECT_EQ(nearness(1.249), 2);
  EXPECT_EQ(nearness(1.251), 1);
  EXPECT_EQ(nearness(3.749), 1);
  EXPECT_EQ(nearness(3.751), 0);
}

TEST_F(Scored, AContactIsACollisionWhateverTheClearance) {
  go({{0, 0}, {30, 0}});
  result_.contact_s = 12;
  result_.contact_with = "the bottom";
  result_.report.phase = MissionPhase::kAborted;
  result_.report.why = "it was too shallow";
  const RunScore s = scored();
  EXPECT_TRUE(s.collision);
  EXPECT_EQ(s.contact_with, "the bottom");
  EXPECT_FALSE(s.goal_reached);
  EXPECT_TRUE(s.refused.empty()) << "a refusal after a collision is none";
}

TEST_F(Scored, TheStraightWayIsOneTimesTheShortest) {
  go({{0, 0}, {100, 0}});
  const RunScore s = scored();
  EXPECT_TRUE(s.goal_reached);
  EXPECT_FALSE(s.encounter) << "nothing came near";
  EXPECT_NEAR(s.goal_s, 47, 0.11);  // 6 m before the point
  EXPECT_NEAR(s.path_m, 94, 0.3);
  EXPECT_NEAR(s.path_ratio, 1, 1e-9);
  EXPECT_NEAR(s.time_ratio, 1, 1e-9);
}

TEST_F(Scored, ADetourCountsByItsLength) {
  go({{0, 0}, {50, 0}, {50, 15}, {70, 0}, {100, 0}});  // 15 and 25 m for 20 m
  const RunScore s = scored();
  EXPECT_TRUE(s.goal_reached);
  EXPECT_NEAR(s.path_ratio, 1.2, 1e-3);
  EXPECT_NEAR(s.time_ratio, 1.2, 1e-2);
}

TEST_F(Scored, PointsAreReachedInOrderOrSaidToBeDropped) {
  go({{0, 0}, {0, 50}, {100, 50}, {100, 0}});  // past the first point
  EXPECT_FALSE(scored().goal_reached);
  result_.report.dropped = 1;
  result_.report.why = "an obstacle stands on point 1";
  const RunScore s = scored();
  EXPECT_TRUE(s.goal_reached);
  EXPECT_EQ(s.points_dropped, 1);
  EXPECT_LT(s.path_ratio, 0) << "the shortest way leads by all points";
  EXPECT_TRUE(s.refused.empty()) << "it came to the goal";
}

TEST_F(Scored, ShortOfTheGoalItIsRefusedOnlyWithAReason) {
  go({{0, 0}, {60, 0}});
  result_.report.phase = MissionPhase::kAborted;
  EXPECT_TRUE(scored().refused.empty());
  result_.report.why = "no way past pole";
  const RunScore s = scored();
  EXPECT_EQ(s.refused, "no way past pole");
  EXPECT_NEAR(s.goal_distance_m, 40, 1e-9);
  EXPECT_LT(s.path_ratio, 0);
  result_.report.phase = MissionPhase::kUnderWay;  // time was over
  EXPECT_TRUE(scored().refused.empty());
}

TEST_F(Scored, TheTruthHoldsWhatStandsAtTheVehiclesDepth) {
  const RunTruth truth(suite_, run_);
  ASSERT_EQ(truth.outlines().size(), 1u);  // the wreck lies deeper
  EXPECT_DOUBLE_EQ(truth.hull_length(), 0.5);
  EXPECT_DOUBLE_EQ(truth.way_m(), 100);
  run_.scenario.scene.bodies[1].shape = Cylinder{{50, 0, 5}, {0, 0, 1}, 1, 4};
  const RunTruth blocked(suite_, run_);
  EXPECT_EQ(blocked.way_m(), 0);
  EXPECT_NE(blocked.no_way().find("point 1"), std::string::npos) << blocked.no_way();
}

TEST_F(Scored, AReplanForAnObstacleFarFromEveryBodyWasForNothing) {
  go({{0, 0}, {100, 0}});
  const auto decide = [&](const char* agent, const char* what, const std::optional<Vector2d>& obstacle) {
    Decision& d = result_.decisions.emplace_back();
    d.agent = agent;
    d.what = what;
    d.obstacle = obstacle;
  };
  decide("navigator", "replan", Vector2d(50, 35.1));  // 3.9 m from the pole
  decide("navigator", "replan", Vector2d(50, 34.5));  // 4.5 m
  decide("navigator", "replan", std::nullopt);
  decide("navigator", "drop point", Vector2d(0, 0));
  const RunScore s = scored();
  EXPECT_EQ(s.replans, 3);
  EXPECT_EQ(s.false_replans, 1);
}

// What is known only after the last moment to turn away is known too late; of two openings the last counts.
// ledger: S5-45 S5-D09
TEST_F(Scored, AnOpeningIsKnownIfItIsBeforeTheLastMomentToTurnAway) {
  go({{0, 0}, {100, 0}});
  using Verdicts = std::vector<std::tuple<const char*, double, double>>;  // what, distance, share
  const auto judged = [&](const Verdicts& verdicts) {
    result_.decisions.clear();
    for (const auto& [what, distance_m, share] : verdicts) {
      Decision& d = result_.decisions.emplace_back();
      d.what = what;
      d.opening = OpeningSighting{distance_m, 22, 8, share};
    }
    const RunScore s = scored();
    return std::pair(s.opening_known_m, s.opening_share);
  };
  EXPECT_EQ(judged({}), std::pair(-1.0, -1.0));
  EXPECT_EQ(judged({{"opening", 45, 0.1}, {"helix", 40, 0.5}, {"opening known", 36, 0.9}}), std::pair(36.0, 0.9));
  EXPECT_EQ(judged({{"opening", 45, 0.1}, {"opening unknown", 17, 0.8}, {"opening known", 12, 0.9}}),
            std::pair(-1.0, 0.8));
  EXPECT_EQ(
      judged({{"opening", 28, 0.1}, {"opening unknown", 17, 0.2}, {"opening", 40, 0.1}, {"opening known", 30, 1}}),
      std::pair(30.0, 1.0));
  EXPECT_EQ(judged({{"opening", 45, 0.1}, {"opening known", 36, 0.9}, {"opening", 30, 0.1}}), std::pair(36.0, 0.9));
}

TEST_F(Scored, DelaysAreThoseOfTheBodiesThatWereFound) {
  go({{0, 0}, {100, 0}});
  result_.sight.bodies.resize(2);
  result_.sight.bodies[0].scans_found = 3;
  result_.sight.bodies[0].delay_pings = 4;
  result_.sight.bodies[0].first_range_m = 31;
  const RunScore s = scored();
  EXPECT_EQ(s.delay_pings, std::vector<double>{4});
  EXPECT_EQ(s.first_range_m, std::vector<double>{31});
  EXPECT_EQ(s.bodies_missed, 1);
}

}  // namespace
}  // namespace isobath
