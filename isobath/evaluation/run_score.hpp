// RunScore: the score of one closed-loop run against ground truth (ledger S6-67).
//
// The clearance is the distance from the hull (GroundTruthTrajectory) to the nearest body. A collision is a contact
// (with a body or the bottom) or a clearance below 1 m, a near miss one below 5 m, an encounter one below 15 m. These
// limits are for a hull of 2 m, and scale with its length: a REMUS 100 of 1.6 m collides below 0.8 m. Every collision
// is also a near miss, and every near miss an encounter.
//
// The goal is reached if the true position comes within `goal_m` of the last mission point, after all other points in
// their order, except those that the vehicle dropped. A run is refused if the vehicle ended its mission short of the
// goal, without a collision, and gave a reason. The path is compared with the route of a planner that knows every
// outline at the vehicle's depth: the same route planner, from point to point, with the clearance of the suite. The
// rest from the place where the goal counts as reached to the goal itself is added to the path. There is no comparison
// if that planner finds no route, or if the vehicle dropped a point.
#pragma once

#include <isobath/evaluation/evaluation_suite.hpp>
#include <isobath/evaluation/fault_injection_check.hpp>
#include <isobath/evaluation/group_score.hpp>
#include <isobath/evaluation/rules_score.hpp>
#include <isobath/planning/route_planner.hpp>
#include <isobath/run/closed_loop.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <string>
#include <vector>

namespace isobath {

inline constexpr double kReferenceHull_m = 2;
inline constexpr double kCollision_m = 1, kNearMiss_m = 5, kEncounter_m = 15;  ///< for a hull of that length

struct RunScore {
  bool collision = false, near_miss = false, encounter = false;
  double contact_s = -1;
  std::string contact_with;
  double min_clearance_m = -1;  ///< below 0: there were no bodies, or the hull was inside one
  std::string nearest_body;

  bool goal_reached = false;
  double goal_s = -1;
  double goal_distance_m = 0;  ///< minimum distance to the last mission point
  std::string refused;         ///< the reason; empty: not refused
  int points_dropped = 0;

  double path_m = 0;  ///< length to the goal, or of the whole path
  double duration_s = 0;
  double path_ratio = -1, time_ratio = -1;  ///< relative to the planner with full truth; -1: not comparable

  std::vector<double> delay_pings, first_range_m;  ///< of each detected body
  std::vector<double> range_error_m;               ///< root mean square, of each of them that is compact
  int bodies_missed = 0;                           ///< bodies with echoes that were never detected
  int replans = 0, false_replans = 0, safety_actions = 0;
  /// Distance before the last opening on the route from which on it is known to be free; -1: it is not where the
  /// vehicle can turn away for the last time.
  double opening_known_m = -1;
  double opening_share = -1;  ///< how much of it is known then, or there; -1: there was none

  int scans = 0;
  int false_obstacles = 0, near_false_obstacles = 0;  ///< in view, over all scans; near: within kNearObstacle_m
  int unseen_false_obstacles = 0;                     ///< the same out of view (DetectionScorer)

  int moving_bodies = 0, moving_known = 0;  ///< bodies that moved and were heard, and those known to move (MotionScore)
  double moving_known_s = -1;               ///< from the first echo until they were, median; -1: none
  double ospa_m = -1, velocity_rms = -1;    ///< of tracks and moving bodies; -1: none

  FaultInjectionCheck proof;  ///< for runs of a fault suite
  StoryCheck story;           ///< for runs of a suite with a story
  RulesScore rules;           ///< for runs of a suite of encounters
  GroupRunScore group;        ///< for runs of a group of vehicles
};

/// The ground truth for all helms of one run.
class RunTruth {
 public:
  RunTruth(const Suite& suite, const SuiteRun& run);

  [[nodiscard]] const VehicleParameters& vehicle() const { return vehicle_; }
  [[nodiscard]] double hull_length() const { return hull_length_; }
  /// Outlines of the bodies that lie still.
  [[nodiscard]] const std::vector<Hazard>& outlines() const { return outlines_; }
  /// Whether a body, at this time of the run, lies within a distance of a place, m in W.
  [[nodiscard]] bool is_near_body(const Eigen::Vector2d& p_W, double time_s, double within_m) const;
  /// The route of the planner with full truth; empty if it finds none.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& way() const { return way_; }
  [[nodiscard]] double way_m() const { return way_m_; }
  [[nodiscard]] const std::string& no_way() const { return no_way_; }  ///< why there is none

 private:
  void plan(const Suite& suite, const SuiteRun& run);

  VehicleParameters vehicle_;
  double hull_length_ = 0;
  std::vector<Hazard> outlines_;
  struct Moving {
    Body body;
    std::vector<Polygon> plan;  ///< at the first position
  };
  std::vector<Moving> moving_;
  std::vector<Eigen::Vector2d> way_;
  double way_m_ = 0;
  std::string no_way_;
};

/// Adds the clearance of a vehicle to a score: of several vehicles the nearest to a body counts. `scale`: the length of
/// the hull over kReferenceHull_m.
void add_clearance(const TrackTruth& truth, double scale, RunScore& score);
/// Whether a decision is an action of the Safety Officer, and not the end of one or a report.
bool is_safety_action(const Decision& decision);

RunScore score(const LoopResult& result, const MissionPlan& mission, const RunTruth& truth, const SuiteConfig& suite);

/// One run of a suite with its scores, one for each method.
struct ScoredRun {
  std::uint64_t seed = 0;
  std::string variant;  ///< name of the variant; empty if the suite has none
  std::string conditions;
  double way_m = 0;              ///< length of the route of the planner with full truth
  std::string no_way;            ///< why it found no route
  std::vector<RunScore> scores;  ///< in the order of the methods
};

}  // namespace isobath
