// ClosedLoop: a scene, a mission and a helm: the vehicle sees, decides and turns, on the simulator's clock (Ganesan
// 2015, 6.1; ledger S6-57). What is returned is truth, for whoever judges the run.
//
// What sees and decides is Onboard, as in `isobath run`. A function of scenario, configuration and helm: the same
// events and set-points on any number of threads. But for a live one: there all threads are waited for ten times a
// second of the simulator's clock; what is decided depends on who is faster.
#pragma once

#include <isobath/mission/mission_plan.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/helm.hpp>
#include <isobath/runtime/onboard_observer.hpp>
#include <isobath/runtime/scenario.hpp>
#include <isobath/runtime/true_track.hpp>
#include <isobath/runtime/truth_judge.hpp>

namespace isobath {

/// How long the vehicle is watched after its mission has ended.
constexpr double kWatchAfterEnd_s = 5;

struct LoopRequest {
  Configuration configuration;
  int threads = 1;
  bool stop_at_contact = false;             ///< what a vehicle does after a collision says nothing
  bool judge = false;                       ///< whether to hold what was seen against what was there; not of a live one
  bool live = false;                        ///< for a LiveHelm, which bears that another thread maps
  bool stop_when_done = true;               ///< end some seconds after the mission has finished or was aborted
  std::vector<OnboardObserver*> observers;  ///< look on; must outlive the run
};

struct LoopResult : TrackTruth {
  std::vector<Decision> decisions;
  MissionReport report;
  PipelineCounts counts;
  double duration_s = 0;                ///< simulated
  TruthScore sight;                     ///< how well the bodies were seen; where it was asked for
  std::vector<OperatorAnswer> answers;  ///< what the operator heard, where there was one
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
