// The results of a run of several vehicles, for the commands that run one.
#pragma once

#include <isobath/report/group_outcome.hpp>
#include <isobath/run/run_request.hpp>
#include <isobath/scenario/scenario.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace isobath::app {

/// The scene, if the input is one of several vehicles.
std::optional<Scenario> vehicle_group_of(const RunRequest& request);
nlohmann::ordered_json group_results_json(const RunRequest& request, const GroupOutcome& outcome);
void print_group_results(const RunRequest& request, const GroupOutcome& outcome);
/// Prints to standard error what went wrong. Returns the exit code.
int conclude_group(const GroupOutcome& outcome);

}  // namespace isobath::app
