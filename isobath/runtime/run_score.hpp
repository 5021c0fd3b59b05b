// RunScore: what one closed-loop run came to, held against the truth (ledger S6-67).
//
// Nearness, from the hull (TrueTrack) to the nearest body: a collision is a contact (with a body or the bottom) or less
// than 1 m, a near miss less than 5 m, an encounter less than 15 m, all for a hull of 2 m and in proportion for others:
// a REMUS 100 of 1.6 m collides below 0.8 m. Each holds the ones before it.
//
// The goal is reached where the vehicle truly comes within `goal_m` of the last mission point, after all others in
// their order but those that it dropped. A run is refused where the vehicle ended its mission short of the goal, safe,
// and said why. The way is compared with that of a planner that knows every outline at the vehicle's depth: it goes by
// the same route planner from point to point, with the same clearance; the rest from where the goal counts as reached
// to the goal itself is added to what was run. Where even that planner finds no way, or where the vehicle dropped a
// point, there is no comparison.
#pragma once

#include <isobath/planning/route_planner.hpp>
#include <isobath/runtime/closed_loop.hpp>
#include <isobath/runtime/fault_proof.hpp>
#include <isobath/runtime/suite.hpp>
#include <isobath/vehicle/vehicle_sheet.hpp>
#include <string>
#include <vector>

namespace isobath {

inline constexpr double kReferenceHull_m = 2;
inline constexpr double kCollision_m = 1, kNearMiss_m = 5, kEncounter_m = 15;  ///< of a hull of that length

struct RunScore {
  bool collision = false, near_miss = false, encounter = false;
  double contact_s = -1;
  std::string contact_with;
  double least_clearance_m = -1;  ///< below 0: nothing to come near to, or inside it
  std::string nearest_body;

  bool goal_reached = false;
  double goal_s = -1;
  double goal_distance_m = 0;  ///< least, to the last mission point
  std::string refused;         ///< why; empty: it was not
  int points_dropped = 0;

  double path_m = 0;  ///< to the goal, or all of it
  double duration_s = 0;
  double path_ratio = -1, time_ratio = -1;  ///< by the planner with full truth; -1: not comparable

  std::vector<double> delay_pings, first_range_m;  ///< of each body that was found
  int bodies_missed = 0;                           ///< heard, never found
  int replans = 0, false_replans = 0, safety_actions = 0;

  int scans = 0;
  int false_obstacles = 0, near_false_obstacles = 0;  ///< over all scans; near: within kNearObstacle_m (TruthJudge)

  FaultProof proof;  ///< of a run of a fault
};

/// The truth that all helms of one run are held against.
class RunTruth {
 public:
  RunTruth(const Suite& suite, const SuiteRun& run);

  [[nodiscard]] const VehicleSheet& vehicle() const { return vehicle_; }
  [[nodiscard]] double hull_length() const { return hull_length_; }
  [[nodiscard]] const std::vector<Hazard>& outlines() const { return outlines_; }
  /// Of the planner with full truth; empty where it finds none.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& way() const { return way_; }
  [[nodiscard]] double way_m() const { return way_m_; }
  [[nodiscard]] const std::string& no_way() const { return no_way_; }  ///< why there is none

 private:
  void plan(const Suite& suite, const SuiteRun& run);

  VehicleSheet vehicle_;
  double hull_length_ = 0;
  std::vector<Hazard> outlines_;
  std::vector<Eigen::Vector2d> way_;
  double way_m_ = 0;
  std::string no_way_;
};

RunScore score(const LoopResult& result, const MissionPlan& mission, const RunTruth& truth, const SuiteConfig& suite);

/// What became of one run of a suite under each of the competitors.
struct ScoredRun {
  std::uint64_t seed = 0;
  std::string variant;  ///< of the suite's variants; empty where it has none
  std::string conditions;
  double way_m = 0;              ///< of the planner with full truth
  std::string no_way;            ///< why it found none
  std::vector<RunScore> scores;  ///< in the order of the competitors
};

}  // namespace isobath
