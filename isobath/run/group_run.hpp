// run_group: a run of several vehicles in one water (vehicle_group.hpp), each with its own simulator, sonars,
// navigation errors, maps and agents. Each vehicle writes the files of a run into a folder of its name; beside them
// stand group.json and group.png. loop_group: the same without files, for evaluations.
#pragma once

#include <isobath/report/group_outcome.hpp>
#include <isobath/run/closed_loop.hpp>
#include <isobath/run/run_request.hpp>
#include <isobath/scenario/scenario.hpp>

namespace isobath {

/// Throws Error as run does, and for a live run, a page, a map or another mission. The recordings of the
/// vehicles have their names after that of the request: run-alpha.mcap for run.mcap
GroupOutcome run_group(const RunRequest& request, const Scenario& scenario);

struct GroupLoop {
  GroupRecord record;
  std::vector<LoopResult> vehicles;
};
/// The agents of the mission steer each vehicle. `request`: without observers; a mission's end does not end the loop of
/// a vehicle.
GroupLoop loop_group(const Scenario& scenario, const LoopRequest& request);

}  // namespace isobath
