// Evaluation: a suite's runs under several helms, scored and summed up (ledger S6-67, S6-62).
//
// Runs go in parallel, each on one thread and apart from all others; every number depends on suite, configuration and
// seeds alone, not on threads nor on where an evaluation was interrupted. Each finished run is a line of runs.jsonl in
// the folder of results, with a fingerprint of all that it follows from; lines of the same fingerprint are not run
// again, others are dropped, and so is whatever is no whole line: the end of a file that was cut off.
//
// Shares stand with Wilson's interval of 95 %, differences of two shares with Newcombe's (1998, method 10), which takes
// the runs of both for independent: on the same runs it is wider than it must be.
#pragma once

#include <functional>
#include <isobath/runtime/run_score.hpp>
#include <isobath/runtime/suite.hpp>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace isobath {

/// A method under test: how its helm is made, and the configuration of the pipeline that it looks through.
struct Competitor {
  std::string name;
  Configuration configuration;
  std::function<std::unique_ptr<Helm>(const Scenario&, const VehicleSheet&, const Configuration&)> make;
};
/// Isobath's own command first, then the suite's baselines.
std::vector<Competitor> competitors_of(const Suite& suite, const Configuration& configuration);

struct Share {
  std::size_t count = 0, of = 0;
  double low = 0, high = 1;  ///< 95 %
  [[nodiscard]] double value() const { return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : 0; }
};
Share share(std::size_t count, std::size_t of);

struct ShareDifference {
  double value = 0, low = 0, high = 0;
};
ShareDifference difference(const Share& a, const Share& b);

/// Of a sorted or unsorted sample, linear between its values; p in [0, 1]. The sample is not empty.
double quantile(std::vector<double> sample, double p);

/// Of any number of values, 0 too.
struct Spread {
  std::size_t count = 0;
  double least = 0, low = 0, median = 0, high = 0, most = 0;  ///< 5, 50 and 95 %
};
Spread spread(const std::vector<double>& sample);

/// A row of the fault table over the runs that were to show it.
struct RowSummary {
  std::string name;
  Share shown;
  double latest_s = -1;               ///< FaultProof::after_s, at most; -1: not known
  std::vector<std::string> failures;  ///< "seed 7: not raised"
};

struct Summary {
  std::string name;                                                 ///< of the competitor, or of the variant
  Share collisions, near_misses, encounters, goals, refused, lost;  ///< lost: none of goal, refusal, collision
  Share safe_goals;                                                 ///< goals without a collision
  Spread path_ratio, time_ratio;                                    ///< of the runs that came to the goal
  Spread clearance_m, delay_pings, first_range_m;
  double false_obstacles = 0, near_false_obstacles = 0;  ///< a scan, over the scans of all runs
  int points_dropped = 0, bodies_missed = 0, replans = 0, false_replans = 0, safety_actions = 0;
  std::size_t no_way_there = 0;        ///< of the refused ones: the planner with full truth found none either
  std::map<std::string, int> reasons;  ///< of refusals; # for every number
  Share shown;                         ///< of the runs of faults, those that show their rows
  std::vector<RowSummary> rows;        ///< all of the fault table, in its order; empty without such runs
};
Summary summarise(const std::string& name, const std::vector<ScoredRun>& runs, std::size_t competitor);
/// The first competitor's, a variant each, in their order; variants without runs are left out.
std::vector<Summary> summarise_variants(const std::vector<SuiteVariant>& variants, const std::vector<ScoredRun>& runs);
/// The bars that it stays below, each as a sentence.
std::vector<std::string> broken_bars(const BarsConfig& bars, const Summary& summary);

inline constexpr std::size_t kWorstRuns = 3;  ///< that a report shows

struct EvaluationRequest {
  Suite suite;
  std::vector<Competitor> competitors;  ///< the first is the one whose bars count
  int runs = 0;                         ///< 0: the suite's
  int seed = -1;                        ///< -1: the suite's
  int threads = 1;
  std::filesystem::path out;
  std::string version;  ///< of the program: results of another one are not taken over
  std::function<void(int done, int all)> progress;
};

struct Evaluation {
  std::vector<ScoredRun> runs;
  std::vector<Summary> summaries;
  std::vector<Summary> variants;  ///< of the first competitor: a suite's variants in their order, those that were run
  std::vector<std::string> broken;
  int taken_over = 0;  ///< runs that were already there
  /// Of the runs that were done now, by their seeds: the first competitor's kWorstRuns worst, which the report shows.
  std::map<std::uint64_t, LoopResult> worst;
};

/// Throws Error: a folder that cannot be written, a scene that cannot begin.
Evaluation evaluate(const EvaluationRequest& request);

/// One run under one helm; for whoever wants to look at it.
LoopResult run_competitor(const Competitor& competitor, const SuiteRun& run, const VehicleSheet& vehicle);
/// From the worst, by the first competitor: contact, collision, a fault's row not shown, lost, refused, then the
/// longest way.
std::vector<std::size_t> worst_runs(const std::vector<ScoredRun>& runs, std::size_t most);

}  // namespace isobath
