#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/run/group_run.hpp>
#include <isobath/run/vehicle_group.hpp>
#include <isobath/run/vehicle_run.hpp>
#include <isobath/scenario/mission_chart.hpp>
#include <memory>

namespace isobath {
namespace {

void check_group(const RunRequest& request) {
  const auto refuse = [&request](const char* what) {
    throw Error(fmt::format("{} of a group of vehicles", what), {request.input.string(), {}, {}, {}, {}},
                "a run without it");
  };
  if (!request.mission.empty()) refuse("another mission");
}

/// The request of one vehicle of the group.
RunRequest request_of_vehicle(const RunRequest& request, const MissionPlan& plan, std::size_t vehicle) {
  RunRequest own = request;
  own.vehicle = vehicle;
  own.out = request.out / plan.group[vehicle].name;
  own.threads = 1;
  if (!request.record.empty()) own.record = file_of_vehicle(request.record, plan.group[vehicle].name);
  if (!request.map.empty()) own.map = file_of_vehicle(request.map, plan.group[vehicle].name);
  int& seed = own.configuration.simulation.seed;
  if (seed >= 0) seed = seed_of_vehicle(seed, vehicle);
  if (vehicle > 0) own.progress = {};
  return own;
}

std::uint64_t seed_of_link(const Configuration& configuration, const Scenario& scenario) {
  const int seed = configuration.simulation.seed;
  return static_cast<std::uint64_t>(seed >= 0 ? seed : scenario.scene.about.seed);
}

/// One vehicle of a group in a closed loop.
struct LoopedVehicle {
  LoopedVehicle(const Scenario& scenario, const LoopRequest& request)
      : helm(make_serial_helm(setup_of(scenario, request.configuration), request.configuration)),
        loop(scenario, *helm, request) {}

  std::unique_ptr<Helm> helm;
  ClosedLoop loop;
};

}  // namespace

std::filesystem::path file_of_vehicle(const std::filesystem::path& file, const std::string& vehicle) {
  std::filesystem::path own = file;
  return own.replace_filename(file.stem().string() + "-" + vehicle + file.extension().string());
}

GroupOutcome run_group(const RunRequest& request, const Scenario& scenario, std::span<const RunWatch> watches) {
  check_group(request);
  ISOBATH_ASSERT(watches.empty() || watches.size() == scenario.mission.group.size());
  std::vector<std::unique_ptr<VehicleRun>> runs;
  std::vector<SteppedRun*> stepped;
  for (std::size_t v = 0; v < scenario.mission.group.size(); ++v) {
    RunRequest own = request_of_vehicle(request, scenario.mission, v);
    if (!watches.empty()) own.watch = watches[v];
    runs.push_back(std::make_unique<VehicleRun>(own));
    stepped.push_back(runs.back().get());
  }
  GroupOutcome outcome;
  // A live vehicle waits for the clock in its own thread.
  const int threads = request.live_speed ? static_cast<int>(runs.size()) : request.threads;
  outcome.record = VehicleGroup(scenario, stepped, seed_of_link(request.configuration, scenario), threads).run();
  outcome.record.bodies = bodies_without_vehicles(*runs.front(), scenario.mission);
  for (std::size_t v = 0; v < runs.size(); ++v) {
    const RunOutcome& run = outcome.runs.emplace_back(runs[v]->outcome());
    if (!run.mission) continue;
    GroupVehicleRecord& vehicle = outcome.record.vehicles[v];
    vehicle.decisions = run.mission->decisions;
    vehicle.report = run.mission->report;
    if (run.mission->truth) vehicle.track = run.mission->truth->track;
  }
  outcome.score = score_of(outcome.record);
  write_whole_file(request.out / "group.json", group_text(outcome));
  const std::string picture = draw_group(outcome.record, "Tracks of the vehicles");
  write_whole_file(request.out / "group.png", picture);
  write_whole_file(request.out / "report.html", group_report(outcome, picture));
  return outcome;
}

GroupLoop loop_group(const Scenario& scenario, const LoopRequest& request) {
  ISOBATH_ASSERT(request.observers.empty());
  std::vector<std::unique_ptr<LoopedVehicle>> vehicles;
  std::vector<SteppedRun*> stepped;
  for (std::size_t v = 0; v < scenario.mission.group.size(); ++v) {
    LoopRequest own = request;
    own.stop_when_done = own.stop_at_contact = false;
    int& seed = own.configuration.simulation.seed;
    if (seed >= 0) seed = seed_of_vehicle(seed, v);
    vehicles.push_back(std::make_unique<LoopedVehicle>(scenario.of_vehicle(v), own));
    stepped.push_back(&vehicles.back()->loop);
  }
  GroupLoop group;
  group.record = VehicleGroup(scenario, stepped, seed_of_link(request.configuration, scenario), request.threads).run();
  group.record.bodies = bodies_without_vehicles(*stepped.front(), scenario.mission);
  for (std::size_t v = 0; v < vehicles.size(); ++v) {
    const LoopResult& result = group.vehicles.emplace_back(vehicles[v]->loop.result());
    GroupVehicleRecord& vehicle = group.record.vehicles[v];
    vehicle.decisions = result.decisions;
    vehicle.report = result.report;
    vehicle.track = result.track;
  }
  return group;
}

}  // namespace isobath
