// Evaluation: the runs of a suite under several helms, scored and summarised (ledger S6-67, S6-62).
//
// Runs are executed in parallel. Each run uses one thread and is independent of the others. Every number depends on
// suite, configuration and seeds alone, not on the number of threads nor on where an evaluation was interrupted. Each
// finished run is a line of runs.jsonl in the folder of results, with a fingerprint of everything that determines it.
// Runs with the same fingerprint are not repeated. Lines with another fingerprint are dropped, and so are incomplete
// lines: an interrupted evaluation may leave one at the end.
//
// A share has Wilson's 95 % interval, a difference of two shares Newcombe's (1998, method 10). Newcombe's method
// assumes independent runs: where both helms have the same runs, the interval is wider than necessary.
#pragma once

#include <functional>
#include <isobath/evaluation/evaluation_suite.hpp>
#include <isobath/evaluation/run_score.hpp>
#include <isobath/scenario/group_record.hpp>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace isobath {

/// A method under test: how its helm is made, and the configuration of its pipeline.
struct ComparedMethod {
  std::string name;
  Configuration configuration;
  std::function<std::unique_ptr<Helm>(const Scenario&, const VehicleParameters&, const Configuration&)> make;
};
/// Isobath's own agents first, then the suite's baselines.
std::vector<ComparedMethod> methods_of(const Suite& suite, const Configuration& configuration);

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

/// Quantile p in [0, 1] of a sample in any order, linear between its values. The sample is not empty.
double quantile(std::vector<double> sample, double p);

/// The distribution of any number of values, also of none.
struct Spread {
  std::size_t count = 0;
  double least = 0, low = 0, median = 0, high = 0, most = 0;  ///< 5, 50 and 95 %
};
Spread spread(const std::vector<double>& sample);

/// A row of the fault table over the runs that test it.
struct RowSummary {
  std::string name;
  Share shown;
  double latest_s = -1;               ///< largest FaultInjectionCheck::after_s; -1: unknown
  std::vector<std::string> failures;  ///< "seed 7: not raised"
};

/// A stage of the story over all runs.
struct StageSummary {
  std::string name;
  Share shown;            ///< runs that come to this stage within its limits
  Spread after_s, scans;  ///< of these: since the stage before
};

/// Runs of groups; without runs: there was none.
struct GroupSummary {
  std::size_t runs = 0;
  Spread searched, overlap, all_searched_s, separation_m, reassigned_s, bit_rate;
  Spread passage_shared_s;  ///< of the runs with a passage
  Spread overlap_unlost;    ///< of the runs that lost no vehicle
  Share reassigned;         ///< of the runs that lost a vehicle; the lost one may have had nothing left to do
};

struct Summary {
  std::string name;                                                 ///< of the method, or of the variant
  Share collisions, near_misses, encounters, goals, refused, lost;  ///< lost: none of goal, refusal, collision
  Share safe_goals;                                                 ///< goals without a collision
  Spread path_ratio, time_ratio;                                    ///< of the runs that reached the goal
  Spread clearance_m, delay_pings, first_range_m, range_error_m;
  Share openings_known;                   ///< of the runs that came to an opening
  Spread opening_known_m, opening_share;  ///< as in RunScore
  Share moving_known;                     ///< of the moving bodies that were heard in all runs
  Spread moving_known_s, ospa_m, velocity_rms;
  double false_obstacles = 0, near_false_obstacles = 0,
         unseen_false_obstacles = 0;                   ///< per scan, over the scans of all runs
  Share passed_astern, passed_port_to_port, stood_on;  ///< of the encounters in all runs (RulesScore)
  int points_dropped = 0, bodies_missed = 0, replans = 0, false_replans = 0, safety_actions = 0;
  std::size_t no_way_there = 0;               ///< refused runs where the planner with full truth found no route either
  std::map<std::string, int> reasons;         ///< of refusals, with # for every number
  Share shown;                                ///< fault runs that pass
  std::vector<RowSummary> rows;               ///< the fault table in its order; empty without fault runs
  Share story;                                ///< runs that show the whole story; of 0 without a story
  std::vector<StageSummary> stages;           ///< of the story in their order
  Spread injected_m;                          ///< least distance of the hull's centre from an injected outline
  std::map<std::string, int> story_failures;  ///< with # for every number
  GroupSummary group;
};
Summary summarise(const std::string& name, const std::vector<ScoredRun>& runs, std::size_t method,
                  const std::vector<StoryStage>& stages = {});
GroupSummary summarise_groups(const std::vector<ScoredRun>& runs, std::size_t method);
/// Adds the bars that the groups miss.
void add_broken_bars(const BarsConfig& bars, const GroupSummary& groups, std::vector<std::string>& broken);
/// Of the first method, one per variant in their order; variants without runs are left out.
std::vector<Summary> summarise_variants(const std::vector<SuiteVariant>& variants, const std::vector<ScoredRun>& runs);
/// The bars that the summary misses, each as a sentence.
std::vector<std::string> broken_bars(const BarsConfig& bars, const Summary& summary);

inline constexpr std::size_t kWorstRuns = 3;  ///< shown in a report

struct EvaluationRequest {
  Suite suite;
  std::vector<ComparedMethod> methods;  ///< the bars apply to the first
  int runs = 0;                         ///< 0: the suite's
  int seed = -1;                        ///< -1: the suite's
  int threads = 1;
  std::filesystem::path out;
  std::string version;  ///< of the program: results of another version are not reused
  std::function<void(int done, int all)> progress;
};

/// A run as a report shows it.
struct ShownRun {
  LoopResult result;
  std::optional<GroupRecord> group;  ///< if it had several vehicles
};

struct Evaluation {
  std::vector<ScoredRun> runs;
  std::vector<Summary> summaries;
  std::vector<Summary> variants;  ///< of the first method: the suite's variants that were run, in their order
  std::vector<std::string> broken;
  int taken_over = 0;  ///< runs reused from before
  /// By seed, of the new runs only: the first method's kWorstRuns worst, which the report shows.
  std::map<std::uint64_t, ShownRun> worst;
};

/// Throws Error if the folder cannot be written or a scene cannot start.
Evaluation evaluate(const EvaluationRequest& request);

/// One run under one helm. `observer` may be null.
LoopResult run_method(const ComparedMethod& method, const SuiteRun& run, const VehicleParameters& vehicle,
                      OnboardObserver* observer = nullptr);
/// A run of a group, with the score that RunScore gives to each run: the nearest of all vehicles to a body counts, and
/// the goal is reached when the area was searched whole and the mission of each vehicle that was not lost has ended.
/// The decisions of the result are those of all vehicles by time, each agent with the name of its vehicle.
ShownRun run_group_method(const ComparedMethod& method, const SuiteRun& run, RunScore& score);

/// The worst runs of the first method, worst first: contact, collision, failed fault check, lost, refused, then by
/// path ratio.
std::vector<std::size_t> worst_runs(const std::vector<ScoredRun>& runs, std::size_t most);

}  // namespace isobath
