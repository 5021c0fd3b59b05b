#include <isobath/runtime/closed_loop.hpp>

namespace isobath {

LoopResult run_closed_loop(const Scenario& scenario, Helm& helm, const LoopRequest& request) {
  SimulatedSource source(scenario.scene, request.configuration.simulation, request.threads);
  Simulator& simulator = source.simulator();
  TrueTrack truth(simulator);
  source.tell_truth_to(&truth);
  Pipeline pipeline(request.configuration, helm);
  EndOfMission end;
  while (auto event = source.next()) {
    if (request.record) request.record(*event);
    helm.hear(*event);
    pipeline.take(std::move(*event));
    simulator.command(helm.steer());
    if (request.stop_when_done && end.reached(helm, simulator.now_s())) break;
  }
  return {truth.truth(), helm.decisions(), helm.progress(), pipeline.counts(), simulator.now_s()};
}

bool EndOfMission::reached(const Helm& helm, double now_s) {
  const MissionPhase phase = helm.progress().phase;
  const bool over = phase == MissionPhase::kFinished || phase == MissionPhase::kAborted;
  if (!over) since_s_ = -1;
  if (over && since_s_ < 0) since_s_ = now_s;
  return over && now_s - since_s_ >= kWatchAfterEnd_s;
}

}  // namespace isobath
