// run: the main job. Reads an input, and writes map, obstacles, decisions, pictures and a report into one folder.
//
// The same input, configuration and seed give the same bytes in every file, on any number of threads; live runs are the
// exception. Measured times are therefore in the outcome (and on the terminal), and in the report only on request.
//
// A live run is a mission in a scene with real threads, one for mapping and one for each agent, as on a vehicle. Live
// runs are not deterministic; their detections are not scored. A recording holds what happened: in a replay the agents
// receive the same events and may decide otherwise.
#pragma once

#include <isobath/report/run_outcome.hpp>
#include <isobath/run/run_request.hpp>

namespace isobath {

/// Throws Error if the input cannot be opened, nothing in it can be used, or the folder cannot be written.
RunOutcome run(const RunRequest& request);

}  // namespace isobath
