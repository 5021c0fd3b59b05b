#include <isobath/runtime/run_sinks.hpp>

namespace isobath {

RunSinks::RunSinks(const RunRequest& request, const std::optional<MissionSetup>& setup, RunFolder& folder,
                   RunInput& input)
    : voxels(request.configuration.voxels, request.out / "voxels.sqlite"),
      display(request, setup, input),
      folder_(folder),
      reach_m_(request.configuration.mission.space_route.reach_m) {
  if (setup) mission.emplace(*setup, request.configuration, request.live_speed.has_value());
  if (mission && display.on()) mission->show_messages_to([this](const Envelope& envelope) { display.heard(envelope); });
  SimulatedSource* simulated = input.simulated();
  if (!simulated) return;
  if (!request.live_speed) judge.emplace(simulated->simulator());
  if (setup) track.emplace(simulated->simulator());
  simulated->tell_truth_to(this);
}

void RunSinks::on_ping(const PosedPing& ping) {
  load.enter(Stage::kAgents);
  if (mission) mission->on_ping(ping);
  load.enter(Stage::kVoxels);
  voxels.take(ping);
  load.enter(Stage::kReport);
  folder_.on_ping(ping);
  if (judge) judge->on_ping(ping);
  if (display.on()) display.on_ping(ping);
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
  if (display.on()) display.on_scan(scan);
  if (mission) mission->resume();
}

void RunSinks::on_upright(const PosedPing& ping) {
  load.enter(Stage::kVoxels);
  voxels.take(ping);
  load.enter(Stage::kReport);
  if (display.on()) display.on_upright(ping);
}

void RunSinks::on_soundings(const Swath& swath, const Pose& X_WB) {
  load.enter(Stage::kVoxels);
  voxels.take(swath, X_WB);
}

void RunSinks::on_jump(const Eigen::Vector3d& by_W) {
  voxels.move_along(by_W);
  folder_.on_jump(by_W);
  if (display.on()) display.on_jump(by_W);
}

}  // namespace isobath
