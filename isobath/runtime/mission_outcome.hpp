// MissionOutcome: the outcome of a mission: for the report, for mission.json and decisions.json, and for the exit
// status of the program.
//
// decisions.json and the channel /decisions of a recorded log hold the same objects, and both are written here. A
// replay with the same decisions thus gives the same bytes. Positions are estimated positions in W, m; margins in m.
#pragma once

#include <isobath/mission/executor.hpp>
#include <isobath/mission/messages.hpp>
#include <isobath/runtime/ground_truth_trajectory.hpp>
#include <isobath/runtime/simulated_operator.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// Measured with a real clock, ms. No result depends on these times.
struct StageTime {
  std::uint64_t count = 0;
  double median_ms = 0, p99_ms = 0, worst_ms = 0;
};

struct MissionTimings {
  StageTime event_to_agents;   ///< until all agents have handled an event; live: until it is in their mailboxes
  StageTime ping_to_grid;      ///< until a ping is detected and mapped into the body grid
  StageTime detection;         ///< from the end of a sweep until its obstacles are found
  StageTime planning;          ///< the Navigator's turn on a scan of obstacles
  StageTime scan_to_decision;  ///< from the arrival of the event that ended a sweep until the Navigator has decided
  double agents_s = 0;         ///< processor time of the turns of all agents
};

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

/// The outline in W of a true body, or of one pylon of a row.
struct TrueBody {
  std::string name;
  Polygon outline;
};

struct MissionOutcome {
  MissionPlan plan;
  MissionReport report;
  std::vector<Decision> decisions;
  std::vector<BelievedPlace> believed;    ///< ten a second at most
  std::vector<SeenObstacle> seen;         ///< without those behind others
  std::optional<TrackTruth> truth;        ///< simulated runs only
  std::vector<TrueBody> bodies;           ///< at the end; simulated runs only
  std::uint64_t as_recorded = 0;          ///< replay: leading decisions that equal those of the recorded run
  std::optional<std::uint64_t> recorded;  ///< replay of a log with decisions: their number
  MissionTimings timings;
  ExecutorCounts executor;
  std::vector<OperatorAnswer> answers;  ///< what the operator of a simulated run received

  /// What went wrong, as one line: contact, a mission that did not end or was aborted, no point reached, decisions that
  /// differ from those recorded. Empty if all went well; a point that was dropped by the rules is not a failure.
  [[nodiscard]] std::string failure() const;
};

/// The estimated position at a time: the last one recorded by then.
std::optional<BelievedPlace> place_at(const MissionOutcome& outcome, Time time);

/// One decision as one line of JSON.
std::string decision_json(const Decision& decision);
/// The text of decisions.json.
std::string decisions_text(const std::vector<Decision>& decisions);
/// The outcome without its decisions. `with_timings`: with times of a real clock, which differ from run to run.
nlohmann::ordered_json mission_json(const MissionOutcome& outcome, bool with_timings);
/// The text of mission.json.
std::string mission_text(const MissionOutcome& outcome);

}  // namespace isobath
