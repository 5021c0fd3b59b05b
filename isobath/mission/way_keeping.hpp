// Keeping a way: whether what is left of it is still clear, and how little of it must change (Ganesan 2015, 5.2;
// ledger S6-47, S6-50, S6-54, S6-55, S6-65).
//
// A way is a polyline whose first point is the vehicle. All in one plan frame, m. Pure; cost is that of
// HazardMap::conflict and ::distance, no search.
#pragma once

#include <functional>
#include <isobath/planning/hazard_map.hpp>
#include <isobath/planning/plan_frame.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// An outline in W (north, east), in the plan frame.
Polygon to_local(const PlanFrame& frame, Polygon outline_W);

double length_of(std::span<const Eigen::Vector2d> way);
/// The place so far along the way; its end beyond that. The way is not empty.
Eigen::Vector2d point_at(std::span<const Eigen::Vector2d> way, double along_m);

/// Where the way comes nearer than the clearance to a hazard, seen by a vehicle that may be too near already: a current
/// or a late echo has put it there. It may leave: up to where it could be clear again, the way need only not lead
/// nearer than it stands. A vehicle inside a hazard is in conflict where it is.
std::optional<Conflict> conflict_ahead(const HazardMap& map, std::span<const Eigen::Vector2d> way, double clearance_m);

/// The same way with each corner (not its ends) that is too near to a hazard moved straight away from it, so far that
/// the way keeps the clearance: what a slightly larger outline asks for, and no change of sides. Empty where that does
/// not help.
std::optional<std::vector<Eigen::Vector2d>> mended(const HazardMap& map, std::span<const Eigen::Vector2d> way,
                                                   double clearance_m);

/// The place nearest to `wanted` within `reach_m` at which `clear` holds, looked for on rings 0.5 m apart; of two
/// equally near ones the one nearer to `from`. Empty where there is none.
std::optional<Eigen::Vector2d> nearest_place(const Eigen::Vector2d& wanted, const Eigen::Vector2d& from, double reach_m,
                                             const std::function<bool(const Eigen::Vector2d&)>& clear);

/// Hazards whose margin, but not whose outline, covers the vehicle: that it floats there shows that they do not reach
/// so far, and their margins are taken back to `room_m` from it.
void trim_margins(std::vector<Hazard>& hazards, const Eigen::Vector2d& vehicle, double room_m);

}  // namespace isobath
