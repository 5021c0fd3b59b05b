// The main job: an input in; map, obstacles, decisions, pictures and a report out, in one folder.
//
// The same input, configuration and seed give the same bytes in every file, on any number of threads, but for a live
// run. Measured times are therefore in the outcome (and on the terminal), and in the report only if they are asked for.
//
// Live: a mission in a scene with real threads, one for mapping and one for each agent, as on a vehicle: what it
// decides depends on who is faster, so what was seen is not held against what was there, and a recording of it is of
// what happened: run again, the crew hears the same and may decide otherwise.
#pragma once

#include <isobath/runtime/run_outcome.hpp>
#include <isobath/runtime/run_request.hpp>

namespace isobath {

/// Throws Error if the input cannot be opened, nothing in it can be used, or the folder cannot be written.
RunOutcome run(const RunRequest& request);

}  // namespace isobath
