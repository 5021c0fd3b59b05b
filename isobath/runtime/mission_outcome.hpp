// MissionOutcome: what became of a mission: for the report, for mission.json and decisions.json, and for whoever asks
// whether it went well.
//
// decisions.json and the /decisions of a recorded log hold the same objects, written here and nowhere else: a replay
// that decides as the run did gives the same bytes. Positions in W as the vehicle believes to be in it, m; margins m.
#pragma once

#include <isobath/mission/crew.hpp>
#include <isobath/mission/messages.hpp>
#include <isobath/runtime/simulated_operator.hpp>
#include <isobath/runtime/true_track.hpp>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// Measured with a real clock, ms: no result depends on it.
struct StageTime {
  std::uint64_t count = 0;
  double median_ms = 0, p99_ms = 0, worst_ms = 0;
};

struct MissionTimings {
  StageTime event_to_crew;     ///< an event: heard by all agents; with real threads: in their mailboxes
  StageTime ping_to_grid;      ///< mapping: a ping, decided, in the body grid
  StageTime detection;         ///< the end of a sweep: obstacles found
  StageTime planning;          ///< the Navigator's turn that a scan of obstacles gets
  StageTime scan_to_decision;  ///< from when the event came that ended a sweep until the Navigator has decided
  double agents_s = 0;         ///< processor time of all agents' turns
};

/// Where the vehicle believed to be.
struct BelievedPlace {
  Time time;
  Eigen::Vector2d north_east = Eigen::Vector2d::Zero();
  double depth_m = 0;
};

/// An obstacle of one scan, where the vehicle believed it to stand.
struct SeenObstacle {
  Time time;
  Polygon outline;
  double existence = 0;
};

/// What really stands somewhere, or one pylon of a row: an outline of it in W.
struct TrueBody {
  std::string name;
  Polygon outline;
};

struct MissionOutcome {
  MissionPlan plan;
  MissionReport report;
  std::vector<Decision> decisions;
  std::vector<BelievedPlace> believed;    ///< ten a second at most
  std::vector<SeenObstacle> seen;         ///< those in front of others
  std::optional<TrackTruth> truth;        ///< of a simulated run
  std::vector<TrueBody> bodies;           ///< at the end; of a simulated run
  std::uint64_t as_recorded = 0;          ///< of a log: decisions that are those of the recorded run, from the first on
  std::optional<std::uint64_t> recorded;  ///< of a log that holds decisions: how many
  MissionTimings timings;
  CrewCounts crew;
  std::vector<OperatorAnswer> answers;  ///< what the operator of a simulated run heard

  /// What went wrong, as one line: contact, a mission that did not end or was aborted, no point reached, decisions that
  /// differ from those recorded. Empty where all is well; a point that was dropped by the rules is no failure.
  [[nodiscard]] std::string failure() const;
};

/// Where the vehicle believed to be at a time: the last place known by then.
std::optional<BelievedPlace> place_at(const MissionOutcome& outcome, Time time);

/// One decision as one line of JSON.
std::string decision_json(const Decision& decision);
/// decisions.json.
std::string decisions_text(const std::vector<Decision>& decisions);
/// The outcome without its decisions, and, where a clock may be seen, with the timings.
nlohmann::ordered_json mission_json(const MissionOutcome& outcome, bool with_timings);
/// mission.json.
std::string mission_text(const MissionOutcome& outcome);

}  // namespace isobath
