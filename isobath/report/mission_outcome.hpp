// MissionOutcome: the outcome of a mission: for the report, for mission.json and decisions.json, and for the exit
// status of the program.
//
// Positions are estimated positions in W, m; margins in m.
#pragma once

#include <isobath/mission/command/executor.hpp>
#include <isobath/mission/messages/messages.hpp>
#include <isobath/mission/plan/timing_table.hpp>
#include <isobath/onboard/stage_times.hpp>
#include <isobath/scenario/ground_truth_trajectory.hpp>
#include <isobath/scenario/simulated_operator.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// An estimated position of the vehicle.
struct BelievedPlace {
  Time time;
  Eigen::Vector2d north_east = Eigen::Vector2d::Zero();
  double depth_m = 0;
};

/// An obstacle of one scan, at its estimated position.
struct SeenObstacle {
  Time time;
  Polygon outline;
  double existence = 0;
};

/// What a level of command did (mission/command/command_chain.hpp). Intervals are those between its commands.
struct LevelOutcome {
  CommandLevel level = CommandLevel::kMission;
  std::uint64_t commands = 0;
  double mean_interval_s = 0, least_interval_s = 0, longest_interval_s = 0;
  std::uint64_t without_parent = 0;  ///< commands that serve no command of the level above
  double longest_stale_s = 0;        ///< for which its commands served one that a level above had superseded
  LevelTiming timing;                ///< what the timing table wants
  std::uint64_t plans = 0, changed_plans = 0;
  double longest_replan_s = 0;  ///< between two plans
  double mean_horizon_s = 0;    ///< of plans that had something to plan

  /// Whether it planned as often as the timing table wants; the servo level, which plans nothing, whether it gave its
  /// commands as often.
  [[nodiscard]] bool in_time() const;
};

struct MissionOutcome {
  MissionPlan plan;
  MissionReport report;
  std::vector<Decision> decisions;
  std::vector<BelievedPlace> believed;    ///< ten a second at most
  std::vector<SeenObstacle> seen;         ///< without those behind others
  std::vector<Hazard> charted;            ///< hazards of the chart around the vehicle, as the mission began
  std::vector<Hazard> mapped;             ///< hazards around the vehicle that sonar had measured at the end
  std::optional<TrackTruth> truth;        ///< simulated runs only
  std::vector<TrueBody> bodies;           ///< at the end; simulated runs only
  std::uint64_t as_recorded = 0;          ///< replay: leading decisions that equal those of the recorded run
  std::optional<std::uint64_t> recorded;  ///< replay of a log with decisions: their number
  MissionTimings timings;
  ExecutorCounts executor;
  std::vector<AgentReport> crew;
  std::vector<LevelOutcome> levels;     ///< from the mission down; live: without the servo level
  std::vector<OperatorAnswer> answers;  ///< what the operator of a simulated run received

  /// What went wrong, as one line: contact, a mission that did not end or was aborted, no point reached, decisions that
  /// differ from those recorded. Empty if all went well; a point that was dropped by the rules is not a failure.
  [[nodiscard]] std::string failure() const;
};

/// The estimated position at a time: the last one recorded by then.
std::optional<BelievedPlace> place_at(const MissionOutcome& outcome, Time time);

/// Distance of the estimated from the true position.
struct NavigationError {
  double last_m = 0, largest_m = 0;
};
/// Empty if the true track is unknown.
std::optional<NavigationError> navigation_error(const MissionOutcome& outcome);

/// How far the vehicle ran beyond a corner of its mission (Herman 1988, 6; ledger S2-46, S2-D02).
struct CornerOverrun {
  std::size_t point = 0;         ///< index in the plan, of a point at which the mission turns by 30 degrees or more
  double overrun_m = 0;          ///< largest distance from the leg that leaves it, on the outer side, as estimated
  std::optional<double> true_m;  ///< the same of the true track
};
/// One for each such corner that was reached, in order; empty for missions that are not sailed in the order of the
/// file.
std::vector<CornerOverrun> corner_overruns(const MissionOutcome& outcome);

/// The outcome without its decisions. `with_timings`: with times of a real clock, which differ from run to run.
nlohmann::ordered_json mission_json(const MissionOutcome& outcome, bool with_timings);
/// The text of mission.json.
std::string mission_text(const MissionOutcome& outcome);

}  // namespace isobath
