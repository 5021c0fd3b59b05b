#include <algorithm>
#include <cmath>
#include <isobath/runtime/closed_loop.hpp>
#include <isobath/runtime/voxel_model.hpp>

namespace isobath {
namespace {

/// What the truth and the results of the pipeline go to: the track, the helm, and the judge if there is one.
class Watched : public SimulatedSource::TruthSink, public ResultSink {
 public:
  Watched(TrueTrack& track, Helm& helm, TruthJudge* judge, VoxelModel* voxels, double reach_m)
      : track_(track), helm_(helm), judge_(judge), voxels_(voxels), reach_m_(reach_m) {}
  void take(const EchoTruth& echoes) override {
    if (judge_) judge_->take(echoes);
  }
  void take(const TrueMotion& motion) override {
    track_.take(motion);
    if (judge_) judge_->take(motion);
  }
  void on_ping(const PosedPing& ping) override {
    helm_.on_ping(ping);
    if (voxels_) voxels_->take(ping);
    if (judge_) judge_->on_ping(ping);
  }
  void on_upright(const PosedPing& ping) override {
    if (voxels_) voxels_->take(ping);
  }
  void on_jump(const Eigen::Vector3d& by_W) override {
    if (voxels_) voxels_->move_along(by_W);
  }
  void on_scan(const ScanResult& scan) override {
    const auto space = voxels_ ? voxels_->space_around(scan, reach_m_) : nullptr;
    if (space) helm_.on_space(scan.detection.time, space);
    helm_.on_scan(scan);
    if (judge_) judge_->on_scan(scan);
  }

 private:
  TrueTrack& track_;
  Helm& helm_;
  TruthJudge* judge_;
  VoxelModel* voxels_;
  double reach_m_;
};

/// Only with a fan that stands upright is a map in three dimensions worth its time here.
bool tells_height(const Scene& scene) {
  return std::any_of(scene.sonars.begin(), scene.sonars.end(), [](const SonarConfig& sonar) {
    return sonar.on && sonar.kind == SonarKind::kFan && std::abs(sin(sonar.roll)) > std::sqrt(0.5);
  });
}

}  // namespace

LoopResult run_closed_loop(const Scenario& scenario, Helm& helm, const LoopRequest& request) {
  SimulatedSource source(scenario.scene, request.configuration.simulation, request.threads);
  source.add_operator(scenario.orders, scenario.mission);
  Simulator& simulator = source.simulator();
  TrueTrack truth(simulator);
  std::optional<TruthJudge> judge;
  if (request.judge && !request.live) judge.emplace(simulator);
  std::optional<VoxelModel> voxels;
  if (tells_height(simulator.scene())) voxels.emplace(request.configuration.voxels);
  Watched watched(truth, helm, judge ? &*judge : nullptr, voxels ? &*voxels : nullptr,
                  request.configuration.mission.space_route.reach_m);
  source.tell_truth_to(&watched);
  Pipeline pipeline(request.configuration, watched);
  std::optional<MappingThread> mapping;
  if (request.live) mapping.emplace([&pipeline](Event event, auto) { pipeline.take(std::move(event)); });
  double settled_s = 0;
  EndOfMission end;
  while (auto event = source.next()) {
    if (request.record) request.record(*event);
    helm.hear(*event);
    if (!mapping) {
      pipeline.take(std::move(*event));
    } else {
      mapping->take(std::move(*event));
      if (simulator.now_s() - settled_s >= to_seconds(kTick)) {
        settle(*mapping, helm);
        settled_s = simulator.now_s();
      }
    }
    simulator.command(helm.steer());
    source.answer(helm.to_operator());
    if (request.stop_at_contact && truth.truth().contact_s >= 0) break;
    if (request.stop_when_done && end.reached(helm.progress().phase, simulator.now_s())) break;
  }
  if (mapping) settle(*mapping, helm);
  return {truth.truth(),
          helm.decisions(),
          helm.progress(),
          pipeline.counts(),
          simulator.now_s(),
          judge ? judge->score() : TruthScore{},
          source.at_the_link() ? source.at_the_link()->answers() : std::vector<OperatorAnswer>{}};
}

void settle(MappingThread& mapping, Helm& helm) {
  mapping.settle();
  helm.settle();
}

bool EndOfMission::reached(MissionPhase phase, double now_s) {
  const bool over = phase == MissionPhase::kFinished || phase == MissionPhase::kAborted;
  if (!over) since_s_ = -1;
  if (over && since_s_ < 0) since_s_ = now_s;
  return over && now_s - since_s_ >= kWatchAfterEnd_s;
}

}  // namespace isobath
