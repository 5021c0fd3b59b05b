// run_json: the results of a run as --json of run and serve prints them.
#pragma once

#include <isobath/run/run.hpp>
#include <nlohmann/json_fwd.hpp>

namespace isobath::app {

nlohmann::ordered_json run_json(const RunRequest& request, const RunOutcome& outcome);

}  // namespace isobath::app
