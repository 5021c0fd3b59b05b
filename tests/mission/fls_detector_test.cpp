// The sonar detector under a script.
#include <gtest/gtest.h>
#include <isobath/mission/agents/fls_detector.hpp>
#include <isobath/planning/plan_frame.hpp>

#include "agent_script.hpp"

namespace isobath {
namespace {

using Eigen::Vector2d;

class FlsDetectorTest : public testing::Test {
 protected:
  FlsDetectorTest() : agent(FlsDetectorConfig{}, ObstacleMemoryConfig{}), script(agent) {}

  std::vector<Message> sweep(double s, const Pose& X_WL, const std::vector<Polygon>& outlines_L,
                             double existence = 0.95, bool doubtful = false) {
    auto map = std::make_shared<Detection>();
    map->time = at(s);
    map->X_WB = X_WL;
    map->cells.cell_m = 0.5;
    for (const Polygon& outline : outlines_L) {
      map->obstacles.push_back(obstacle(outline, existence));
      map->obstacles.back().possible_multiple = doubtful;
      map->obstacles.back().behind = doubtful;
      map->obstacles.back().motion = motion;
      map->obstacles.back().number = first_number + static_cast<int>(map->obstacles.size()) - 1;
    }
    return script.hear(Sweep{static_cast<int>(s), true, 0.1, map}, s);
  }
  static Pose pose(double north, double east, double heading_deg) {
    return {Rotation::from_heading(Angle::degrees(heading_deg)), {north, east, 2}};
  }
  void start(const std::vector<InjectedMap>& maps, double s) {
    MissionPlan plan;
    plan.injected = maps;
    MissionOrder order;
    order.plan = std::make_shared<const MissionPlan>(plan);
    script.hear(order, s);
  }

  FlsDetector agent;
  Script script;
  int first_number = 1;   ///< of the obstacles of a sweep
  ObstacleMotion motion;  ///< of the obstacles of a sweep
};

TEST_F(FlsDetectorTest, HazardsCarryTheNumberOfTheObstacleThatTheyAreAPieceOf) {
  first_number = 5;
  for (double s = 1; s <= 2; ++s) sweep(s, pose(0, 0, 0), {square(15, 3, 1), square(30, -8, 1)});
  const auto scans = only<ObstacleScan>(sweep(3, pose(0, 0, 0), {square(15, 3, 1)}));
  ASSERT_EQ(scans.size(), 1u);
  ASSERT_EQ(scans[0].hazards.size(), 2u);
  EXPECT_EQ(scans[0].hazards[0].kind, HazardKind::kSeen);
  EXPECT_EQ(scans[0].hazards[0].obstacle, 5);
  EXPECT_EQ(scans[0].hazards[1].kind, HazardKind::kRemembered);
  EXPECT_EQ(scans[0].hazards[1].obstacle, 6);
  ASSERT_EQ(scans[0].known->obstacles.size(), 2u);
  EXPECT_EQ(scans[0].known->obstacles[1].number, 6);
}

// ledger: S3-21
TEST_F(FlsDetectorTest, CountsAMovingBodyWithTheWaterThatItIsAboutToCrossAndRemembersItNowhere) {
  motion = {.velocity_W = {0, 1}, .track = 3};  // towards the east, which is ahead
  for (double s = 1; s <= 3; ++s) {
    const auto scans = only<ObstacleScan>(sweep(s, pose(0, 0, 90), {square(15, 3, 1)}, 0.99));
    ASSERT_EQ(scans.size(), 1u);
    ASSERT_EQ(scans[0].hazards.size(), 1u);
    const Polygon& outline = scans[0].hazards[0].outline;
    EXPECT_TRUE(contains(outline, Vector2d(15, 3)));
    EXPECT_TRUE(contains(outline, Vector2d(19.9, 3))) << "5 s ahead";
    EXPECT_FALSE(contains(outline, Vector2d(13, 3))) << "behind it the water is free";
    EXPECT_TRUE(scans[0].known->obstacles.empty());
  }
}

// A first estimate of a motion counts only where something is known to move: reverberation among still bodies has one,
// too. ledger: S3-21
TEST_F(FlsDetectorTest, AmongMovingBodiesCountsThoseThatMayMoveAsMoving) {
  for (const bool traffic : {false, true}) {
    auto map = std::make_shared<Detection>();
    map->time = at(1);
    map->X_WB = pose(0, 0, 0);
    map->cells.cell_m = 0.5;
    map->obstacles = {obstacle(square(15, 3, 1), 0.99), obstacle(square(30, 3, 1), 0.99)};
    map->obstacles[0].may_move = true;
    map->obstacles[0].motion.velocity_W = {0, 1};
    if (traffic) map->obstacles[1].motion = {.velocity_W = {0, 1}, .track = 3};
    const auto scans = only<ObstacleScan>(script.hear(Sweep{1, true, 0, map}, 1));
    ASSERT_EQ(scans.size(), 1u);
    ASSERT_EQ(scans[0].hazards.size(), 2u);
    EXPECT_EQ(scans[0].hazards[0].kind, traffic ? HazardKind::kMoving : HazardKind::kSeen);
    EXPECT_EQ(scans[0].hazards[0].outline, square(15, 3, 1)) << "where it is";
  }
}

// ledger: S6-38
TEST_F(FlsDetectorTest, SaysAtTheEndOfEachSweepWhatItHasSeen) {
  const auto scans = only<ObstacleScan>(sweep(1, pose(10, 20, 90), {square(15, 3, 1), square(30, -8, 2)}, 0.95, true));
  ASSERT_EQ(scans.size(), 1u);
  EXPECT_EQ(scans[0].number, 1);
  EXPECT_EQ(scans[0].time, at(1));
  ASSERT_EQ(scans[0].hazards.size(), 2u);
  EXPECT_EQ(scans[0].hazards[0].outline, square(15, 3, 1))
      << "in the vehicle's own frame, hidden ones and possible multiples too";
  EXPECT_EQ(scans[0].hazards[0].kind, HazardKind::kSeen);
  EXPECT_DOUBLE_EQ(scans[0].hazards[0].margin_m, 0.25);
  EXPECT_TRUE(only<ObstacleScan>(sweep(2, pose(10, 20, 90), {square(15, 3, 1)}, 0.4)).at(0).hazards.empty());
}

// ledger: S6-58
TEST_F(FlsDetectorTest, GivesAnInjectedMapAtExactlyItsTime) {
  script.hear(fix(0, 0, 0, 90), 0);
  InjectedMap map;
  map.at_s = 10;
  map.outlines = {square(0, 40, 3)};
  start({map}, 2.34);
  for (double s = 2.4; s < 12.35; s += 0.1) EXPECT_TRUE(script.tick(s).empty()) << s;
  const auto scans = only<ObstacleScan>(script.tick(12.4));
  ASSERT_EQ(scans.size(), 1u);
  EXPECT_EQ(scans[0].time, at(2.34) + seconds(10));
  ASSERT_EQ(scans[0].hazards.size(), 1u);
  EXPECT_EQ(scans[0].hazards[0].kind, HazardKind::kInjected);
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& p : scans[0].hazards[0].outline) middle += p / 4;
  EXPECT_LT((middle - Vector2d(40, 0)).norm(), 1e-9) << "ahead of a vehicle that heads east";
  EXPECT_TRUE(script.tick(12.5).empty());
  EXPECT_EQ(only<ObstacleScan>(sweep(13, pose(0, 5, 90), {})).at(0).hazards.size(), 1u) << "and from then on";
}

// ledger: S6-66
TEST_F(FlsDetectorTest, RecallsWhatSweepsHaveConfirmedWhenTheVehicleComesBack) {
  for (int i = 1; i <= 4; ++i) sweep(i, pose(0, 0, 0), {square(20, 0, 2)});
  const auto away = only<ObstacleScan>(sweep(10, pose(100, 50, 180), {}));
  ASSERT_EQ(away.at(0).hazards.size(), 1u);
  const Hazard rock = away[0].hazards[0];
  EXPECT_EQ(rock.kind, HazardKind::kRemembered);
  const PlanFrame frame = PlanFrame::of(away[0].X_WL);
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& p : rock.outline) middle += frame.to_world(p) / static_cast<double>(rock.outline.size());
  EXPECT_LT((middle - Vector2d(20, 0)).norm(), 0.5);
  EXPECT_GT(rock.margin_m, 0);
  EXPECT_TRUE(only<ObstacleScan>(sweep(11, pose(400, 50, 180), {})).at(0).hazards.empty()) << "out of reach";
}

// ledger: S6-66
TEST_F(FlsDetectorTest, TellsWhatItRemembersInViewOrNotAndWhatItTookTheSweepFor) {
  for (int i = 1; i <= 4; ++i) sweep(i, pose(0, 0, 0), {square(20, 0, 2)});
  const auto scan = only<ObstacleScan>(sweep(5, pose(0, 0, 0), {square(40, 9, 2), square(20, 0, 2)})).at(0);
  ASSERT_TRUE(scan.known);
  EXPECT_EQ(scan.known->sweep, 5);
  ASSERT_EQ(scan.known->obstacles.size(), 1u) << "the other was seen once";
  const RememberedObstacle& rock = scan.known->obstacles[0];
  EXPECT_EQ(rock.first_seen, at(1));
  EXPECT_EQ(rock.last_seen, at(5));
  EXPECT_TRUE(rock.whole);
  ASSERT_EQ(scan.known->seen_as.size(), 2u);
  EXPECT_NE(scan.known->seen_as[0], rock.id);
  EXPECT_EQ(scan.known->seen_as[1], rock.id);
  const auto away = only<ObstacleScan>(sweep(9, pose(0, 0, 180), {})).at(0);
  ASSERT_EQ(away.known->obstacles.size(), 1u);
  EXPECT_EQ(away.known->obstacles[0].last_seen, at(5));
  EXPECT_FALSE(away.known->obstacles[0].whole);
  EXPECT_TRUE(away.known->seen_as.empty());
}

TEST_F(FlsDetectorTest, RemembersNothingWithoutAPosition) {
  auto map = std::make_shared<Detection>();
  map->obstacles = {obstacle(square(20, 0, 2), 1)};
  for (int i = 1; i <= 4; ++i) {
    map->time = at(i);
    const auto scan = only<ObstacleScan>(script.hear(Sweep{i, false, 0, map}, i));
    EXPECT_FALSE(scan.at(0).posed);
    EXPECT_FALSE(scan.at(0).known);
    EXPECT_EQ(scan.at(0).hazards.size(), 1u);
  }
  EXPECT_TRUE(only<ObstacleScan>(sweep(6, pose(10, 0, 0), {})).at(0).hazards.empty());
}

// An obstacle that another vehicle tells of counts with the next sweep, with the errors of both positions, and is gone
// as soon as sweeps see nothing there. ledger: S2-50 S2-51
TEST_F(FlsDetectorTest, CountsWhatOtherVehiclesTellUntilItsOwnSonarKnowsBetter) {
  sweep(1, pose(0, 0, 0), {});
  const GroupObstacles told{{{1, 7, {60, 5}, 2, 1.5}}};
  const auto said = only<Decision>(script.hear(told, 1.5));
  ASSERT_EQ(said.size(), 1u);
  EXPECT_EQ(said[0].what, "obstacle told");
  EXPECT_TRUE(only<Decision>(script.hear(told, 1.6)).empty()) << "the same again is no news";
  const auto scan = only<ObstacleScan>(sweep(2, pose(0, 0, 0), {})).at(0);
  ASSERT_EQ(scan.hazards.size(), 1u);
  EXPECT_EQ(scan.hazards[0].kind, HazardKind::kRemembered);
  EXPECT_NEAR(signed_distance(scan.hazards[0].outline, {60, 5}), -2, 0.1);
  EXPECT_NEAR(scan.hazards[0].margin_m, 2 * std::sqrt(1.5 * 1.5 + 0.1 * 0.1 + 0.5 * 0.5), 1e-6);
  EXPECT_TRUE(scan.known->obstacles.at(0).told);
  const auto seen = only<ObstacleScan>(sweep(3, pose(0, 0, 0), {square(61, 6, 1.5)})).at(0);
  ASSERT_EQ(seen.known->obstacles.size(), 1u) << "it is the one that was told";
  EXPECT_FALSE(seen.known->obstacles[0].told);
  EXPECT_LT(seen.known->obstacles[0].margin_m, 1.5);
}

}  // namespace
}  // namespace isobath
