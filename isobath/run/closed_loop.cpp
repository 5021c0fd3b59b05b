#include <algorithm>
#include <cmath>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/onboard/onboard.hpp>
#include <isobath/run/closed_loop.hpp>
#include <isobath/run/run_pace.hpp>
#include <isobath/scenario/mission_chart.hpp>
#include <limits>
#include <memory>

namespace isobath {
namespace {

/// Whether the scene has a vertical fan: only then is the voxel map worth its time.
bool tells_height(const Scene& scene) {
  if (std::ranges::any_of(scene.cameras, &CameraPairConfig::on)) return true;
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
  ClosedLoop loop(scenario, helm, request);
  loop.advance(std::numeric_limits<double>::infinity());
  return loop.result();
}

ClosedLoop::ClosedLoop(const Scenario& scenario, Helm& helm, const LoopRequest& request)
    : scenario_(scenario),
      request_(request),
      configuration_(scenario.with_prior(request.configuration)),
      helm_(helm),
      source_(scenario.scene, configuration_.simulation, request.threads, configuration_.cameras),
      depths_(configuration_, {}),
      truth_(source_.simulator()) {
  source_.add_operator(scenario.orders, scenario.mission);
  depths_.locate(source_.report().origin);
  std::vector<std::string> priors;
  if (!configuration_.prior.file.empty()) priors.push_back(configuration_.prior.file);
  depths_.set_prior_files(priors);
  onboard_ = std::make_unique<Onboard>(
      configuration_, depths_,
      OnboardParts{.helm = &helm_,
                   .voxels = tells_height(source_.simulator().scene()),
                   .sphere = configuration_.mission.chart_room.sphere || configuration_.scan.on,
                   .corners = charted_corners({}, priors, configuration_, source_.report().origin),
                   .live = request.live});
  for (OnboardObserver* observer : request_.observers) onboard_->show_to(*observer);
  source_.tell_truth_to(truth_);
  if (request_.judge && !request_.live) {
    judge_.emplace(source_.simulator());
    eye_ = std::make_unique<HelmsEye>(helm_, *judge_);
    onboard_->show_to(*eye_);
    source_.tell_truth_to(*judge_);
  }
  if (request_.live) pace_ = std::make_unique<LivePace>(0, source_.simulator());
}

ClosedLoop::~ClosedLoop() = default;

bool ClosedLoop::advance(double until_s) {
  while (!over_ && source_.simulator().now_s() < until_s) {
    auto event = source_.next();
    over_ = !event;
    if (over_) break;
    onboard_->on_event(std::move(*event));
    if (pace_) pace_->keep(*onboard_);
    mission_over_ = !steer_simulated(*onboard_, helm_, source_, end_);
    for (FrameBytes& packet : helm_.to_group()) packets_.push_back(std::move(packet));
    if (request_.stop_at_contact && truth_.truth().contact_s >= 0) over_ = true;
    if (request_.stop_when_done && mission_over_) over_ = true;
  }
  return !over_;
}

LoopResult ClosedLoop::result() {
  onboard_->settle();
  return {truth_.truth(),
          helm_.decisions(),
          helm_.progress(),
          onboard_->pipeline().counts(),
          onboard_->corner_fixes().outcome(),
          onboard_->contacts().outcome(),
          source_.simulator().now_s(),
          judge_ ? judge_->score() : TruthScore{},
          source_.at_the_link() ? source_.at_the_link()->answers() : std::vector<OperatorAnswer>{}};
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
