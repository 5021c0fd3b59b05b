// What an evaluation says: as a table, as JSON, and as a page with its worst runs drawn.
#pragma once

#include <isobath/runtime/evaluation.hpp>
#include <string>
#include <vector>

namespace isobath {

/// A line a value: what, then the value for every helm, in their order. The first line holds the names.
std::vector<std::vector<std::string>> evaluation_table(const Evaluation& evaluation);
/// A line a variant of the suite, by the first helm, under a line of headings; empty where the suite has none.
std::vector<std::vector<std::string>> variant_table(const Evaluation& evaluation);
/// How far the first helm is ahead of another: share of runs that came to the goal without a collision.
std::vector<std::string> comparison_lines(const Evaluation& evaluation);
std::string to_json(const EvaluationRequest& request, const Evaluation& evaluation);

/// One run from above: bodies, mission, the way of the planner with full truth, the vehicle's way, its replans.
std::string run_picture(const SuiteRun& run, const RunTruth& truth, const LoopResult& result, const std::string& title);

/// Writes results.json and report.html into the request's folder; the worst runs are run again to be drawn.
void write_evaluation(const EvaluationRequest& request, const Evaluation& evaluation);

}  // namespace isobath
