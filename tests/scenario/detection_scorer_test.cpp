#include <gtest/gtest.h>
#include <isobath/scenario/detection_scorer.hpp>

namespace isobath::detection_scorer_test {
namespace {

using Eigen::Vector2d;

/// A post 20 m behind and a pole 30 m ahead of a vehicle of 0.3 m height at 4 m, over a bottom that rises to the north:
/// 6 m deep at the origin, 2 m at 40 m.
constexpr const char* kScene = R"(
[scene]
title = "hand-made"
[bottom]
kind = "terrain"
depth = 6
relief_m = 0
slope = [-0.1, 0]
extent_m = 60
[vehicle]
start = [0, 0, 4]
[[cylinder]]
name = "pole"
centre = [30, 0, 4]
radius = 1
length = 4
[[cylinder]]
name = "post"
centre = [-20, 0, 4]
radius = 1
length = 4
)";

class Judged : public testing::Test {
 protected:
  Judged() : simulator_(parse_scene(kScene, "hand-made.toml"), {}), judge_(simulator_) {}

  /// A square of 2 m with its middle there.
  static Obstacle square(const Vector2d& at, double existence, int number) {
    Obstacle o;
    o.outline = {at + Vector2d(-1, -1), at + Vector2d(1, -1), at + Vector2d(1, 1), at + Vector2d(-1, 1)};
    o.nearest = nearest_point(o.outline, Vector2d::Zero());
    o.range_m = o.nearest.norm();
    o.existence = existence;
    o.number = number;
    return o;
  }

  /// A scan with one obstacle.
  const TruthScore& scan(const Vector2d& at, double existence) { return scan({square(at, existence, 0)}); }

  const TruthScore& scan(const std::vector<Obstacle>& obstacles) {
    TrueMotion motion;
    motion.state.X_WB.translation = {0, 0, 4};
    judge_.on_truth(motion);
    ping(motion.state.X_WB);
    const BodyGrid grid{BodyGridConfig{}};
    Detection found;
    found.cells = grid.cells();
    found.X_WB = motion.state.X_WB;
    found.obstacles = obstacles;
    judge_.on_scan({1, true, found, grid});
    return judge_.score();
  }

  /// A fan of one beam over this sector, to this range; at the start it hears everything.
  void ping(const Pose& X_WB) {
    Ping ping;
    ping.window = {0, 1, static_cast<int>(reach_m_)};
    auto fan = std::make_shared<BeamFan>();
    fan->azimuth = {middle_};
    fan->width = {sector_};
    ping.fan = std::move(fan);
    const EchoDecisions decisions;
    judge_.on_ping({ping, X_WB, decisions});
  }

  Angle middle_, sector_ = Angle::degrees(360);
  double reach_m_ = 100;
  Simulator simulator_;
  DetectionScorer judge_;
};

TEST_F(Judged, AnObstacleWhereABodyStandsIsNoneOfNothing) {
  const TruthScore& score = scan({30, 1.5}, 0.99);
  EXPECT_EQ(score.of_bodies, 1);
  EXPECT_EQ(score.false_obstacles, 0);
}

TEST_F(Judged, ASureObstacleWhereNothingStandsIsFalse) {
  scan({-10, 8}, kSureObstacle);
  scan({-10, -30}, 1);
  const TruthScore& score = scan({-10, 8}, kSureObstacle - 0.01);
  EXPECT_EQ(score.scans, 3);
  EXPECT_EQ(score.false_alarms, 3);
  EXPECT_EQ(score.false_obstacles, 2) << "the map was not sure of the third";
  EXPECT_EQ(score.near_false_obstacles, 1) << "one was further than 20 m away";
}

TEST_F(Judged, AFalseObstacleOutOfViewIsCountedApart) {
  sector_ = Angle::degrees(60);
  middle_ = Angle::degrees(90);
  reach_m_ = 12;
  EXPECT_EQ(scan({-2, 10}, 1).near_false_obstacles, 1) << "abeam";
  EXPECT_EQ(scan({-10, 4}, 1).unseen_false_obstacles, 1) << "on the quarter";
  const TruthScore& score = scan({0, 15}, 1);
  EXPECT_EQ(score.unseen_false_obstacles, 2) << "beyond the range";
  EXPECT_EQ(score.false_obstacles, 1);
}

TEST_F(Judged, AnObstacleAcrossTheWholeSectorIsInView) {
  sector_ = Angle::degrees(90);
  Obstacle wall = square({5, 0}, 1, 0);
  wall.outline = {{5, -8}, {6, -8}, {6, 8}, {5, 8}};
  EXPECT_EQ(scan({wall}).near_false_obstacles, 1) << "no corner of it is in the sector";
}

TEST_F(Judged, APieceBesideABodyIsOfTheBodyIfItIsOfTheSameObstacle) {
  const Obstacle of_post = square({-19, 0}, 1, 0), beside = square({-20, 3.5}, 1, 0), away = square({-20, 6}, 1, 0);
  EXPECT_EQ(scan({of_post, beside}).false_obstacles, 0) << "1.5 m beside the post";
  EXPECT_EQ(scan({of_post, away}).false_obstacles, 1) << "4 m beside it";
  EXPECT_EQ(scan({of_post, square({-20, 3.5}, 1, 1)}).false_obstacles, 2) << "another obstacle";
}

TEST_F(Judged, ABottomInTheWayIsAnObstacle) {
  // The vehicle needs 4 + 0.15 + 1 m: from 8.5 m north on the bottom is less deep.
  EXPECT_EQ(scan({10, 20}, 1).false_obstacles, 0);
  EXPECT_EQ(scan({5, 10}, 1).false_obstacles, 1);
}

}  // namespace
}  // namespace isobath::detection_scorer_test
