// A moving fan's detections, from the folder to the results of a run.
#include <gmock/gmock.h>
#include <isobath/run/run.hpp>
#include <tests/support/data.hpp>
#include <tests/support/fan_folder.hpp>

namespace isobath {
namespace {

using test::FanRecording;

RunOutcome run_of(const std::filesystem::path& input, const std::filesystem::path& out,
                  LogTrack track = LogTrack::kGnss, double mount_deg = 0) {
  RunRequest request;
  request.input = input;
  request.out = out;
  request.configuration.input.track = track;
  request.configuration.input.mount_heading = Angle::degrees(mount_deg);
  return run(request);
}

TEST(MovingFan, WallsBecomeObstaclesAndThePosesAreSharp) {
  const auto scratch = test::scratch_folder(), folder = scratch / "basin";
  FanRecording().write(folder);
  const RunOutcome outcome = run_of(folder, scratch / "out");
  EXPECT_EQ(outcome.problem, "");
  EXPECT_EQ(outcome.counts.swaths, 69u);
  EXPECT_EQ(outcome.counts.scans, 69u);
  EXPECT_FALSE(outcome.depth) << "detections of a fan have no depth";
  EXPECT_FALSE(outcome.voxels) << "nor a height";
  ASSERT_TRUE(outcome.sharpness);
  EXPECT_NEAR(outcome.sharpness->best.degrees(), 0, 1.01);
  EXPECT_EQ(outcome.sharpness->detections, 69u * 121u);
  EXPECT_FALSE(outcome.drift) << "there is nothing to compare with";
  const FanRecording::Place last = FanRecording::track().back();
  ASSERT_FALSE(outcome.obstacles.empty());
  for (const Obstacle& o : outcome.obstacles) {
    const Eigen::Vector2d p = Eigen::Rotation2Dd(last.heading) * o.nearest;
    EXPECT_LT(FanRecording::off_wall(last.north + p.x(), last.east + p.y()), 0.6) << "obstacle " << o.number;
  }
  EXPECT_THAT(outcome.files,
              testing::IsSupersetOf({std::filesystem::path("placed.png"), std::filesystem::path("sharpness.png")}));
}

TEST(MovingFan, AWrongCompassShowsAndTheMountCorrectsIt) {
  const auto scratch = test::scratch_folder(), folder = scratch / "basin";
  FanRecording{.compass_error_deg = 8}.write(folder);
  const RunOutcome wrong = run_of(folder, scratch / "wrong"),
                   right = run_of(folder, scratch / "right", LogTrack::kGnss, -8);
  ASSERT_TRUE(wrong.sharpness && right.sharpness);
  EXPECT_NEAR(wrong.sharpness->best.degrees(), -8, 1.01);
  EXPECT_NEAR(right.sharpness->best.degrees(), 0, 1.01);
  EXPECT_GT(10 * wrong.sharpness->cells, 12 * right.sharpness->cells);
}

// ledger: S6-66 S6-F04
TEST(MovingFan, DeadReckoningIsComparedWithTheSatelliteTrack) {
  const auto scratch = test::scratch_folder(), folder = scratch / "basin";
  FanRecording{.reckoned_share = 1.1}.write(folder);
  const RunOutcome outcome = run_of(folder, scratch / "reckoned", LogTrack::kDeadReckoning);
  EXPECT_EQ(outcome.problem, "");
  ASSERT_TRUE(outcome.drift && outcome.sharpness);
  EXPECT_NEAR(outcome.drift->max_m, 0.1 * std::hypot(10, 24), 0.1) << "a tenth of the way from the start";
  EXPECT_NEAR(outcome.drift->last_m, 0, 0.05) << "it comes back to the start";
  EXPECT_NEAR(outcome.drift->travelled_m, 68, 0.5);
  EXPECT_GT(outcome.drift->cells, outcome.drift->reference_cells);
  EXPECT_GT(outcome.drift->remembered, 0u);
  EXPECT_GT(outcome.drift->sightings, 0u);
  EXPECT_LE(outcome.drift->placed_max_m, outcome.drift->max_m + 0.1);
}

}  // namespace
}  // namespace isobath
