// manifest_json: what a run read, under which program, and what it wrote: manifest.json of the folder of a run.
#pragma once

#include <isobath/report/run_outcome.hpp>
#include <isobath/run/run_request.hpp>
#include <string>

namespace isobath {

/// What was run: input, version, counts, rejections, files. Holds no time of day, and no path but those of the request.
std::string manifest_json(const RunRequest& request, const RunOutcome& outcome);

}  // namespace isobath
