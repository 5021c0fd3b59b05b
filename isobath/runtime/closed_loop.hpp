// ClosedLoop: a scene, a mission and a helm: the vehicle sees, decides and turns, on the simulator's clock (Ganesan
// 2015, 6.1; ledger S6-57). What is returned is truth, for whoever judges the run.
//
//   simulator -> record -> helm.hear -> pipeline.take (results to the helm) -> helm.steer -> simulator.command
//
// A function of scenario, configuration and helm: the same events and set-points on any number of threads.
#pragma once

#include <functional>
#include <isobath/mission/mission_plan.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/helm.hpp>
#include <isobath/runtime/scenario.hpp>
#include <isobath/runtime/true_track.hpp>
#include <isobath/runtime/truth_judge.hpp>

namespace isobath {

/// How long the vehicle is watched after its mission has ended.
constexpr double kWatchAfterEnd_s = 5;

struct LoopRequest {
  Configuration configuration;
  int threads = 1;
  bool stop_at_contact = false;              ///< what a vehicle does after a collision says nothing
  bool judge = false;                        ///< whether to hold what was seen against what was there
  bool stop_when_done = true;                ///< end some seconds after the mission has finished or was aborted
  std::function<void(const Event&)> record;  ///< sees every event that the vehicle gave, in order
};

struct LoopResult : TrackTruth {
  std::vector<Decision> decisions;
  MissionReport report;
  PipelineCounts counts;
  double duration_s = 0;  ///< simulated
  TruthScore sight;       ///< how well the bodies were seen; where it was asked for
};

LoopResult run_closed_loop(const Scenario& scenario, Helm& helm, const LoopRequest& request);

/// Says when a helm has been watched long enough: kWatchAfterEnd_s after its mission was finished or aborted.
class EndOfMission {
 public:
  [[nodiscard]] bool reached(MissionPhase phase, double now_s);

 private:
  double since_s_ = -1;
};

}  // namespace isobath
