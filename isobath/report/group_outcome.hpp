// GroupOutcome: how several vehicles searched an area together: what each did, how much of the area was searched, how
// near they came to each other, and what went over the link (ledger S2-50, S2-51); and its files group.json, group.png.
//
// A place of the area counts as searched by a vehicle once its true track passes at most kReach lane breadths from it,
// on whatever errand it is. The shares are those of squares of a metre. Tracks are the true ones. Frame W, m, s.
#pragma once

#include <isobath/mission/plan/mission_plan.hpp>
#include <isobath/report/run_outcome.hpp>
#include <isobath/sim/acoustic_link.hpp>
#include <limits>
#include <string>
#include <vector>

namespace isobath {

struct GroupVehicleOutcome {
  std::string name;
  RunOutcome run;
  std::optional<double> lost_s;  ///< when it was lost, if the scene says so and it was still under way
  LinkCounts link;
  double searched = 0;    ///< share of the area
  std::size_t lanes = 0;  ///< as many as it visited stations of
};

struct GroupOutcome {
  MissionPlan plan;
  std::vector<GroupVehicleOutcome> vehicles;
  double duration_s = 0;                 ///< until the last vehicle ended
  double searched = 0;                   ///< share of the area that some vehicle searched
  double overlap = 0;                    ///< share that two or more did
  std::optional<double> all_searched_s;  ///< when the last lane was done
  double least_separation_m = std::numeric_limits<double>::infinity();  ///< between the hulls of two vehicles
  double least_separation_s = 0;                                        ///< when

  /// What went wrong, as one line; empty: nothing. A vehicle that the scene loses is no failure.
  [[nodiscard]] std::string failure() const;
  /// Bits a second that a vehicle sent.
  [[nodiscard]] double bit_rate(std::size_t vehicle) const;
};

inline constexpr double kReach = 0.55;

/// Fills the shares of the area from the true tracks of the runs.
void add_searched(GroupOutcome& outcome);
/// The text of group.json.
std::string group_text(const GroupOutcome& outcome);
/// PNG: the lanes and the true tracks.
std::string draw_group(const GroupOutcome& outcome);
/// Lines for a terminal.
std::vector<std::string> group_summary(const GroupOutcome& outcome);

}  // namespace isobath
