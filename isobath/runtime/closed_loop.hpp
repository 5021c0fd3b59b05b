// ClosedLoop: a scene, a mission and a helm: the vehicle sees, decides and turns, on the simulator's clock (Ganesan
// 2015, 6.1; ledger S6-57). What is returned is truth, for whoever judges the run.
#pragma once

#include <functional>
#include <isobath/mission/mission_plan.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/helm.hpp>
#include <isobath/sim/simulator.hpp>

namespace isobath {

/// A scene with the mission that stands in the same file; without one, the mission has no points.
struct Scenario {
  Scene scene;
  MissionPlan mission;
};
/// Throws Error with line and column.
Scenario load_scenario(const std::string& file);
Scenario parse_scenario(std::string_view text, const std::string& file);

struct LoopRequest {
  Configuration configuration;
  int threads = 1;
  bool stop_when_done = true;                ///< end some seconds after the mission has finished or was aborted
  std::function<void(const Event&)> record;  ///< sees every event that the vehicle gave, in order
};

struct LoopResult {
  std::vector<TrueMotion> track;  ///< ten a second
  double contact_s = -1;          ///< when the hull first touched a body or the bottom; -1: never
  double least_clearance_m = 0;   ///< from the hull to the nearest body, all along
  std::string nearest_body;
  std::vector<Decision> decisions;
  MissionReport report;
  PipelineCounts counts;
  double duration_s = 0;
};

LoopResult run_closed_loop(const Scenario& scenario, Helm& helm, const LoopRequest& request);

}  // namespace isobath
