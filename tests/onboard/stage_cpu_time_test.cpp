// StageCpuTime: the processor time of a thread goes to the stage that is under way, all of it once.
#include <chrono>
#include <gmock/gmock.h>
#include <isobath/onboard/stage_cpu_time.hpp>
#include <thread>

namespace isobath {
namespace {

/// Works for at least so long, by the processor's own clock.
double work(double seconds) {
  const std::int64_t begun = thread_nanoseconds();
  while (1e-9 * static_cast<double>(thread_nanoseconds() - begun) < seconds) {
  }
  return 1e-9 * static_cast<double>(thread_nanoseconds() - begun);
}

TEST(StageCpuTime, GivesEachStageWhatWasDoneInIt) {
  StageCpuTime load;
  const std::int64_t begun = thread_nanoseconds();
  load.enter(Stage::kEchoes);
  double echoes = work(0.003);
  load.enter(Stage::kVoxels);
  const double voxels = work(0.005);
  load.enter(Stage::kEchoes);
  echoes += work(0.002);
  load.leave();
  work(0.004);  // for nobody
  load.leave();
  const double all = 1e-9 * static_cast<double>(thread_nanoseconds() - begun);
  EXPECT_GE(load.seconds(Stage::kEchoes), echoes);
  EXPECT_GE(load.seconds(Stage::kVoxels), voxels);
  EXPECT_LE(load.seconds(Stage::kEchoes) + load.seconds(Stage::kVoxels), all - 0.004);
  EXPECT_EQ(load.seconds(Stage::kAgents), 0);
}

TEST(StageCpuTime, CountsNoSleep) {
  StageCpuTime load;
  load.enter(Stage::kAgents);
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  load.leave();
  EXPECT_LT(load.seconds(Stage::kAgents), 0.03);
}

// The simulator and the report are no part of what a vehicle would have to do.
TEST(StageCpuTime, SaysInOneLineWhatAPingCosts) {
  RunLoad load;
  load.add(Stage::kEchoes, 1.0);
  load.add(Stage::kVoxels, 2.0);
  load.add(Stage::kVoxels, 0.5);
  load.add(Stage::kAgents, 0.5);
  load.add(Stage::kSource, 7.0);
  load.add(Stage::kReport, 3.0);
  EXPECT_DOUBLE_EQ(load.sum_s(), 4.0);
  EXPECT_EQ(load_text(load, 100, 10),
            "load of one core: 40.0 ms per ping, 40 % of real time: echoes 10.0, plan view 0.0, voxels 25.0, "
            "spherical grid 0.0, depth map 0.0, obstacles 0.0, planning and agents 5.0; in addition, input 70.0 and "
            "report 30.0");
  EXPECT_EQ(load_text(load, 0, 10), "");
  EXPECT_EQ(load_text(load, 100, 0), "");
}

}  // namespace
}  // namespace isobath
