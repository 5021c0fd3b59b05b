// The results of an evaluation as a table, as JSON, and as a page with pictures of its worst runs.
#pragma once

#include <isobath/evaluation/evaluation.hpp>
#include <string>
#include <vector>

namespace isobath {

/// One line per quantity: its name, then its value for every helm, in their order. The first line holds their names.
std::vector<std::vector<std::string>> evaluation_table(const Evaluation& evaluation);
/// One line per variant of the suite, for the first helm, under a line of headings; empty if there are no variants.
std::vector<std::vector<std::string>> variant_table(const Evaluation& evaluation);
/// How far the first helm is ahead of each other one, in goals without a collision and in collisions avoided.
std::vector<std::string> comparison_lines(const Evaluation& evaluation);
std::string to_json(const EvaluationRequest& request, const Evaluation& evaluation);

/// Plan view of a run: bodies, mission, path of the planner with full truth, track, obstacles of its decisions.
std::string run_picture(const SuiteRun& run, const RunTruth& truth, const LoopResult& result, const std::string& title);

/// Writes results.json and report.html into the request's folder; repeats worst runs whose results are not at hand.
void write_evaluation(const EvaluationRequest& request, const Evaluation& evaluation);

}  // namespace isobath
