// GroupRecord: what several simulated vehicles did together, and GroupScore: how well they searched their area (ledger
// S2-48, S2-50, S2-51).
//
// A place of the area counts as searched by a vehicle once its true track passes at most kReach lane breadths from it,
// on whatever errand it is. The shares are those of squares of a metre. Tracks are the true ones. Frame W, m, s.
#pragma once

#include <isobath/mission/messages/messages.hpp>
#include <isobath/mission/plan/mission_plan.hpp>
#include <isobath/scenario/ground_truth_trajectory.hpp>
#include <isobath/sim/acoustic_link.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct GroupVehicleRecord {
  std::string name;
  std::vector<TrueMotion> track;
  std::vector<Decision> decisions;
  MissionReport report;
  std::optional<double> lost_s;  ///< when it was lost, if the scene says so and it was still under way
  LinkCounts link;
};

struct GroupRecord {
  MissionPlan plan;
  std::vector<GroupVehicleRecord> vehicles;
  std::vector<TrueBody> bodies;                                         ///< that are no vehicles
  double duration_s = 0;                                                ///< until the last vehicle ended
  double least_separation_m = std::numeric_limits<double>::infinity();  ///< between the hulls of two vehicles
  double least_separation_s = 0;                                        ///< when
  double passage_shared_s = 0;  ///< how long two or more vehicles were within one passage of the mission

  /// Bits a second that a vehicle sent while it was under way.
  [[nodiscard]] double bit_rate(std::size_t vehicle) const;
  /// The lanes whose stations it visited.
  [[nodiscard]] std::size_t lanes(std::size_t vehicle) const;
};

inline constexpr double kReach = 0.55;

struct GroupScore {
  double searched = 0;                   ///< share of the area that some vehicle searched
  double overlap = 0;                    ///< share that two or more did
  std::vector<double> searched_by;       ///< share that each vehicle searched
  std::optional<double> all_searched_s;  ///< when the first vehicle knew the last lane to be done
  std::optional<double> reassigned_s;    ///< from the loss of a vehicle until another one shared the lanes anew
};
GroupScore score_of(const GroupRecord& record);

}  // namespace isobath
