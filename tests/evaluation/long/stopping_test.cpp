// A vehicle that has stopped stays clear of what stands beside it, though a current sets it there.
#include <gtest/gtest.h>
#include <isobath/evaluation/evaluation.hpp>
#include <isobath/run/closed_loop.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

// Without a path it stops 6 m before a dam, with a current of 0.18 m/s towards it; where it kept its heading it drifted
// to 0.2 m from the dam. ledger: S2-28 S6-67
TEST(Stopping, KeepsClearOfADamThatACurrentSetsTo) {
  const Suite suite = load_suite(test::source_folder() / "suites" / "faults.toml");
  const SuiteRun run = make_run(suite, load_scenes(suite), 43);
  ASSERT_EQ(run.scenario.scene.about.title, "No path");
  const LoopResult result = run_closed_loop(run.scenario);
  EXPECT_GT(result.min_clearance_m, 1);
}

}  // namespace
}  // namespace isobath
