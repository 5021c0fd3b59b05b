// run_group: a run of several vehicles in one water (vehicle_group.hpp), each with its own simulator, sonars,
// navigation errors, maps and agents. Each vehicle writes the files of a run into a folder of its name; beside them
// stand report.html, group.json and group.png. loop_group: the same without files, for evaluations.
#pragma once

#include <isobath/report/group_outcome.hpp>
#include <isobath/run/closed_loop.hpp>
#include <isobath/run/run_request.hpp>
#include <isobath/scenario/scenario.hpp>
#include <span>

namespace isobath {

/// The recording or the map of a vehicle, with its name after that of the group's: run-alpha.mcap for run.mcap.
std::filesystem::path file_of_vehicle(const std::filesystem::path& file, const std::string& vehicle);

/// Throws Error as run does, and for another mission. Live, each vehicle keeps to the clock by itself. `watches`: one
/// for each vehicle, or none, instead of that of the request.
GroupOutcome run_group(const RunRequest& request, const Scenario& scenario, std::span<const RunWatch> watches = {});

struct GroupLoop {
  GroupRecord record;
  std::vector<LoopResult> vehicles;
};
/// The agents of the mission steer each vehicle. `request`: without observers; a mission's end does not end the loop of
/// a vehicle.
GroupLoop loop_group(const Scenario& scenario, const LoopRequest& request);

}  // namespace isobath
