// The study of traffic.
#include <gtest/gtest.h>
#include <isobath/studies/traffic_gaps.hpp>
#include <isobath/studies/traffic_study.hpp>

namespace isobath::traffic_study {
namespace {

// The scenes are those of the stated figures: straight ahead, 42.8 % of 500 runs meet one of 20 discs of up to 1 m/s.
TEST(TrafficStudy, DrawsTheScenesOfTheBenchmark) {
  TrafficRequest request;
  request.discs = {20};
  request.max_speeds = {1};
  request.methods = {TrafficMethod::kStraight};
  const TrafficRow row = study_traffic(request).rows.at(0);
  EXPECT_NEAR(row.contacts / 500.0, 0.428, 0.005);
  EXPECT_EQ(row.arrived, 500);
  EXPECT_DOUBLE_EQ(row.time_median, 1);
  EXPECT_DOUBLE_EQ(row.deviation_median_m, 0);
}

// ledger: S3-01 S3-32 S3-D01
TEST(TrafficStudy, MeetsNothingAndIsTheSameOnAnyNumberOfThreads) {
  TrafficRequest request;
  request.discs = {50};
  request.max_speeds = {1.5};
  request.methods = {TrafficMethod::kPlanner};
  request.runs = 6;
  request.first_run = 20000;
  const TrafficRow one = study_traffic(request).rows.at(0);
  EXPECT_EQ(one.contacts, 0);
  EXPECT_GE(one.gap_least_m, request.planner.margin_m);
  EXPECT_LT(one.time_median, 1.05);
  request.threads = 3;
  const TrafficRow three = study_traffic(request).rows.at(0);
  EXPECT_EQ(one.time_p95, three.time_p95);
  EXPECT_EQ(one.gap_median_m, three.gap_median_m);
  EXPECT_EQ(one.water_median_m, three.water_median_m);
  EXPECT_EQ(one.deviation_median_m, three.deviation_median_m);
  EXPECT_EQ(one.gap_least_m, three.gap_least_m);
}

TEST(TrafficGaps, TheWidestWayPastOneDiscIsOnTheSideWithMoreWater) {
  const TrafficScene scene(TrafficScenery::kOpen, 3, 1, 0.5);
  const MovingBody& disc = scene.discs().front();
  const TrafficGaps gaps(scene);
  // To the points on the side of the field, which are 5 m apart.
  const double wider = 60 + std::abs(disc.p_W.y()) - disc.radius_m;
  EXPECT_NEAR(gaps.widest_m({0, 0}, TrafficScene::goal()), wider, 0.1);
}

/// After half a minute of motion the flips have kept the triangulation: a fresh one measures the same (S3-07).
TEST(TrafficGaps, FollowsTheDiscsAsAFreshTriangulationFindsThem) {
  TrafficScene scene(TrafficScenery::kOpen, 11, 60, 1.5);
  TrafficGaps kept(scene);
  for (int step = 0; step < 300; ++step) {
    scene.step();
    kept.follow(scene);
    if (step % 30 != 0) continue;
    EXPECT_NEAR(kept.widest_m({0, 0}, TrafficScene::goal()), TrafficGaps(scene).widest_m({0, 0}, TrafficScene::goal()),
                1e-6)
        << "step " << step;
  }
  EXPECT_GT(kept.flips(), 100);
}

}  // namespace
}  // namespace isobath::traffic_study
