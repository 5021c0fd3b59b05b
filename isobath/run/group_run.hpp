// run_group: several vehicles in one scene, each with its own simulator, sonars, navigation errors, maps and agents,
// joined by what is real between them: they see each other as bodies, and their modems share the water (ledger S2-50,
// S2-51).
//
// The vehicles run side by side in steps of kGroupStep_s. Within a step the others go on with the velocity that they
// had at its begin; packets that a vehicle sends within a step are sent at its end. The result is a function of the
// input, the configuration and the seed, on any number of threads. A vehicle that the scene loses neither moves nor
// speaks from then on. Each vehicle writes the files of a run into a folder of its name; beside them stand group.json
// and group.png.
#pragma once

#include <isobath/report/group_outcome.hpp>
#include <isobath/run/run_request.hpp>
#include <isobath/scenario/scenario.hpp>

namespace isobath {

inline constexpr double kGroupStep_s = 0.1;

/// Throws Error as run does, and for a live run, a page, a map or another mission. The recordings of the
/// vehicles have their names after that of the request: run-alpha.mcap for run.mcap
GroupOutcome run_group(const RunRequest& request, const Scenario& scenario);

}  // namespace isobath
