#include <algorithm>
#include <cmath>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/onboard/onboard.hpp>
#include <isobath/run/closed_loop.hpp>
#include <isobath/run/run_pace.hpp>
#include <isobath/scenario/mission_chart.hpp>
#include <memory>

namespace isobath {
namespace {

/// Whether the scene has a vertical fan: only then is the voxel map worth its time.
bool tells_height(const Scene& scene) {
  return std::any_of(scene.sonars.begin(), scene.sonars.end(), [](const SonarConfig& sonar) {
    return sonar.on && sonar.kind == SonarKind::kFan && std::abs(sin(sonar.roll)) > std::sqrt(0.5);
  });
}

/// Lets the judge see the obstacles that the helm goes by.
class HelmsEye : public OnboardObserver {
 public:
  HelmsEye(const Helm& helm, DetectionScorer& judge) : helm_(helm), judge_(judge) {}
  void on_ping(const PosedPing& ping) override { judge_.on_ping(ping); }
  void on_scan(const ScanResult& scan) override {
    const std::vector<Obstacle>* own = helm_.own_obstacles();
    if (!own) return judge_.on_scan(scan);
    Detection found = scan.detection;
    found.obstacles = *own;
    judge_.on_scan({scan.number, scan.posed, found, scan.grid});
  }

 private:
  const Helm& helm_;
  DetectionScorer& judge_;
};

}  // namespace

LoopResult run_closed_loop(const Scenario& scenario, const LoopRequest& request) {
  const MissionSetup setup = setup_of(scenario, request.configuration);
  std::unique_ptr<Helm> helm;
  if (request.live) {
    helm = make_threaded_helm(setup, request.configuration);
  } else {
    helm = make_serial_helm(setup, request.configuration);
  }
  return run_closed_loop(scenario, *helm, request);
}

LoopResult run_closed_loop(const Scenario& scenario, Helm& helm, const LoopRequest& request) {
  const Configuration configuration = scenario.with_prior(request.configuration);
  SimulatedSource source(scenario.scene, configuration.simulation, request.threads);
  source.add_operator(scenario.orders, scenario.mission);
  Simulator& simulator = source.simulator();
  DepthModel depths(configuration, {});
  depths.locate(source.report().origin);
  std::vector<std::string> priors;
  if (!configuration.prior.file.empty()) priors.push_back(configuration.prior.file);
  depths.set_prior_files(priors);
  Onboard onboard(configuration, depths,
                  {.helm = &helm,
                   .voxels = tells_height(simulator.scene()),
                   .sphere = configuration.mission.chart_room.sphere || configuration.scan.on,
                   .corners = charted_corners({}, priors, configuration, source.report().origin),
                   .live = request.live});
  for (OnboardObserver* observer : request.observers) onboard.show_to(*observer);
  GroundTruthTrajectory truth(simulator);
  source.tell_truth_to(truth);
  std::optional<DetectionScorer> judge;
  std::optional<HelmsEye> eye;
  if (request.judge && !request.live) {
    onboard.show_to(eye.emplace(helm, judge.emplace(simulator)));
    source.tell_truth_to(*judge);
  }
  std::optional<LivePace> pace;
  if (request.live) pace.emplace(0, simulator);
  EndOfMission end;
  while (auto event = source.next()) {
    onboard.on_event(std::move(*event));
    if (pace) pace->keep(onboard);
    const bool goes_on = steer_simulated(onboard, helm, source, end);
    if (request.stop_at_contact && truth.truth().contact_s >= 0) break;
    if (request.stop_when_done && !goes_on) break;
  }
  onboard.settle();
  return {truth.truth(),
          helm.decisions(),
          helm.progress(),
          onboard.pipeline().counts(),
          onboard.corner_fixes().outcome(),
          onboard.contacts().outcome(),
          simulator.now_s(),
          judge ? judge->score() : TruthScore{},
          source.at_the_link() ? source.at_the_link()->answers() : std::vector<OperatorAnswer>{}};
}

bool steer_simulated(Onboard& onboard, Helm& helm, SimulatedSource& source, EndOfMission& end) {
  Simulator& simulator = source.simulator();
  simulator.command(onboard.steer());
  if (const auto command = onboard.take_scan_command()) simulator.command_scanning(*command);
  source.answer(helm.to_operator());
  return !end.reached(helm.progress().phase, source.simulator().now_s());
}

bool EndOfMission::reached(MissionPhase phase, double now_s) {
  const bool over = phase == MissionPhase::kFinished || phase == MissionPhase::kAborted;
  if (!over) since_s_ = -1;
  if (over && since_s_ < 0) since_s_ = now_s;
  return over && now_s - since_s_ >= kWatchAfterEnd_s;
}

}  // namespace isobath
