// ARACATI 2017: detections of a real imaging sonar that moves through a marina, with satellite track and compass. The
// expected figures are those of a short script that shares no code with the program.
#include <gtest/gtest.h>
#include <isobath/run/run.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

RunOutcome run_of(const std::filesystem::path& input, LogTrack track = LogTrack::kGnss) {
  RunRequest request;
  request.input = input;
  request.out = test::scratch_folder() / "out";
  request.configuration.input.track = track;
  return run(request);
}

// ledger: S3-15
TEST(MovingFanRecording, TheBasinOfAracati2017) {
  ISOBATH_NEEDS_DATA(folder, "aracati2017-detections");
  const RunOutcome outcome = run_of(folder);
  EXPECT_EQ(outcome.problem, "");
  ASSERT_TRUE(outcome.sharpness);
  const Sharpness& sharpness = *outcome.sharpness;
  EXPECT_EQ(sharpness.detections, 42'055u);
  EXPECT_NEAR(double(sharpness.cells), 4053, 10);
  EXPECT_NEAR(sharpness.best.degrees(), 0, 1.01);
  const auto at = [&](int degrees) { return double(sharpness.curve[std::size_t(degrees + 30)].cells); };
  EXPECT_NEAR(at(-10), 6223, 15);
  EXPECT_NEAR(at(10), 5848, 15);
  EXPECT_NEAR(at(-20), 7967, 20);
  EXPECT_NEAR(double(sharpness.mirrored), 15'561, 40);
  const MovingBodies::Counts& bodies = outcome.counts.bodies;
  EXPECT_GT(bodies.confirmed, 200u);
  EXPECT_EQ(bodies.moving, 0u) << "boats at their moorings, and quays";
  EXPECT_GT(double(bodies.slow), 0.83 * double(bodies.confirmed));
}

// ledger: S6-66 S6-F04
TEST(MovingFanRecording, TheBasinOfAracati2017ByDeadReckoning) {
  ISOBATH_NEEDS_DATA(folder, "aracati2017-detections");
  const RunOutcome outcome = run_of(folder, LogTrack::kDeadReckoning);
  ASSERT_TRUE(outcome.drift);
  EXPECT_NEAR(outcome.drift->max_m, 27.7, 0.5);
  EXPECT_NEAR(outcome.drift->rms_m, 18.6, 0.5);
  EXPECT_NEAR(double(outcome.drift->cells), 9122, 200);
  EXPECT_NEAR(double(outcome.drift->reference_cells), 4053, 10);
}

}  // namespace
}  // namespace isobath
