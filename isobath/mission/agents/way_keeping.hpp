// Path keeping: whether the rest of a path is still clear, and how little of it must change (Ganesan 2015, 5.2; ledger
// S6-47, S6-50, S6-54, S6-55, S6-65).
//
// A path is a polyline whose first point is the vehicle. All in one plan frame, m. Pure functions; their cost is that
// of HazardMap::conflict and ::distance, without a search.
#pragma once

#include <functional>
#include <isobath/planning/hazard_map.hpp>
#include <isobath/planning/plan_frame.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// An outline in W (north, east), transformed into the plan frame.
Polygon to_local(const PlanFrame& frame, Polygon outline_W);

double length_of(std::span<const Eigen::Vector2d> way);
/// The point `along_m` along the path; its end beyond that. The path must not be empty.
Eigen::Vector2d point_at(std::span<const Eigen::Vector2d> way, double along_m);

/// Where the path comes nearer than the clearance to a hazard, for a vehicle that may already be too near because of a
/// current or a late echo. Such a vehicle may leave: up to where the path could be clear again, it need only not lead
/// nearer than the vehicle stands. A vehicle inside a hazard is in conflict where it is.
std::optional<Conflict> conflict_ahead(const HazardMap& map, std::span<const Eigen::Vector2d> way, double clearance_m);

/// The same path with each corner (not its ends) that is too near to a hazard moved straight away from it, so far that
/// the path keeps the clearance. This suffices where an outline has grown slightly; the path keeps its side of every
/// hazard. Empty where it does not help.
std::optional<std::vector<Eigen::Vector2d>> mended(const HazardMap& map, std::span<const Eigen::Vector2d> way,
                                                   double clearance_m);

/// The place nearest to `wanted` within `reach_m` at which `clear` holds, searched on rings 0.5 m apart; of two equally
/// near places the one nearer to `from`. Empty where there is none.
std::optional<Eigen::Vector2d> nearest_place(const Eigen::Vector2d& wanted, const Eigen::Vector2d& from, double reach_m,
                                             const std::function<bool(const Eigen::Vector2d&)>& clear);

/// Takes back the margins of hazards whose margin, but not whose outline, covers the vehicle. The vehicle floats there,
/// so that these hazards do not reach that far: their margins then end `room_m` from it.
void trim_margins(std::vector<Hazard>& hazards, const Eigen::Vector2d& vehicle, double room_m);

}  // namespace isobath
