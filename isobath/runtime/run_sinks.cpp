#include <isobath/runtime/run_sinks.hpp>

namespace isobath {

RunSinks::RunSinks(const RunRequest& request, const std::optional<MissionSetup>& setup, RunFolder& folder,
                   RunInput& input)
    : voxels(request.configuration.voxels, request.out / "voxels.sqlite"),
      folder_(folder),
      reach_m_(request.configuration.mission.space_route.reach_m) {
  if (setup) mission.emplace(*setup, request.configuration, request.live_speed.has_value());
  if (!request.record.empty()) begin_recording(request, setup, input);
  if (request.watch && request.watch->display) shown = request.watch->display;
  if (RunFilm::wanted(request.configuration.report) && !request.live_speed) film.emplace(request.configuration.report);
  if (request.watch || recorder || film) display.emplace(*shown);
  if (mission && display) {
    mission->show_messages_to([this](const Envelope& envelope) {
      display->heard(envelope);
      if (recorder) recorder->heard(envelope);
    });
  }
  SimulatedSource* simulated = input.simulated();
  if (!simulated) return;
  if (!request.live_speed) judge.emplace(simulated->simulator());
  if (setup) track.emplace(simulated->simulator());
  simulated->tell_truth_to(this);
}

void RunSinks::begin_recording(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input) {
  recorder.emplace(request.record, request.configuration);
  if (SimulatedSource* simulated = input.simulated()) {
    recorder->describe(simulated->simulator(), scenario_text(request.input));
  } else {
    recorder->describe(input.report());
  }
  if (setup) recorder->describe(*setup);
}

void RunSinks::on_ping(const PosedPing& ping) {
  load.enter(Stage::kAgents);
  if (mission) mission->on_ping(ping);
  load.enter(Stage::kVoxels);
  voxels.take(ping);
  load.enter(Stage::kReport);
  folder_.on_ping(ping);
  if (judge) judge->on_ping(ping);
  if (recorder) recorder->on_ping(ping);
  if (display) display->on_ping(ping);
  if (mission) mission->resume();
}

void RunSinks::on_scan(const ScanResult& scan) {
  if (mission) {
    load.enter(Stage::kVoxels);
    const auto space = voxels.space_around(scan, reach_m_);
    load.enter(Stage::kAgents);
    if (space) mission->on_space(scan.detection.time, space);
    mission->on_scan(scan);
  }
  load.enter(Stage::kReport);
  folder_.on_scan(scan);
  if (judge) judge->on_scan(scan);
  if (recorder) recorder->on_scan(scan);
  if (display) display->on_scan(scan);
  if (mission) mission->resume();
}

void RunSinks::on_upright(const PosedPing& ping) {
  load.enter(Stage::kVoxels);
  voxels.take(ping);
  load.enter(Stage::kReport);
  if (recorder) recorder->on_upright(ping);
  if (display) display->on_upright(ping);
}

void RunSinks::on_soundings(const Swath& swath, const Pose& X_WB) {
  load.enter(Stage::kVoxels);
  voxels.take(swath, X_WB);
}

void RunSinks::on_jump(const Eigen::Vector3d& by_W) {
  voxels.move_along(by_W);
  folder_.on_jump(by_W);
  if (display) display->on_jump(by_W);
}

}  // namespace isobath
