// share_lanes: divides lanes among the vehicles of a group, so that the last of them is done as early as possible
// (Herman 1988, 2, 3.1: the spatial decomposition of the group level; ledger S2-10, S2-50).
//
// Each vehicle gets a row of lanes that follow one another in the list, and sails them back and forth. All vehicles
// proceed to the same side, so that a vehicle comes to a lane beside another's row only when that one has gone on long
// ago. The time of a vehicle is the way to the nearer end of its first lane, the lanes, the steps from lane to lane,
// and `turn_s` a step. All divisions into rows are compared, by dynamic programming, and all orders of up to kOrdered
// vehicles along the area; of more vehicles only their order along the area and its reverse. Frame W, m, s. Pure.
#pragma once

#include <isobath/mission/plan/search_area.hpp>
#include <span>
#include <vector>

namespace isobath {

inline constexpr std::size_t kOrdered = 4;

/// A vehicle that can sail lanes.
struct LaneSailor {
  Eigen::Vector2d place_W = Eigen::Vector2d::Zero();
  double ready_s = 0;  ///< when it will be at that place
};

struct SailingRules {
  double speed = 1.5;  ///< m/s
  double turn_s = 10;  ///< for a turn into the next lane, beyond the way
};

struct LaneShares {
  std::vector<std::vector<std::size_t>> lanes;  ///< by vehicle, in the order in which it sails them
  bool ascending = true;                        ///< whether the vehicles proceed to higher lanes
  double last_s = 0;                            ///< when the last vehicle is done
};
/// `open`: the lanes to divide, ascending. Without vehicles the result has no lanes.
LaneShares share_lanes(std::span<const Lane> lanes, std::span<const std::size_t> open,
                       std::span<const LaneSailor> sailors, const SailingRules& rules);

/// How long a vehicle takes for these lanes in this order, s.
double sailing_s(std::span<const Lane> lanes, std::span<const std::size_t> order, const LaneSailor& sailor,
                 const SailingRules& rules);

/// A lane that is sailed.
struct LaneVisit {
  std::size_t lane = 0;
  bool backwards = false;  ///< from its last station to its first
  bool operator==(const LaneVisit&) const = default;
};
/// Back and forth over these lanes, from the nearer end of the first.
std::vector<LaneVisit> visits_of(std::span<const Lane> lanes, std::span<const std::size_t> order,
                                 const Eigen::Vector2d& place_W);
/// The points of the mission on these lanes (search_area.hpp). A vehicle comes to a lane at the side of the area, not
/// at the end of its run-out, which only the vehicle that leaves the lane needs.
std::vector<std::size_t> stations_of(std::span<const LaneVisit> visits, const SearchArea& area);

}  // namespace isobath
