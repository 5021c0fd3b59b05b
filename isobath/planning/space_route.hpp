// SpaceRoute: a way in three dimensions, over, under or between what closes the plan view (Horner et al. c. 2009, 4, 5;
// ledger S5-33, S5-35 to S5-37, S5-39, S5-45).
//
// A* over the room that a box of water leaves (space_room.hpp): 26 neighbours, cells as wide as the vehicle's steepest
// climb asks for, every step and every leg with half-width and clearance all round; then pulled straight, and made one
// that the vehicle can turn. Cost: length times 1 + w max(0, 1 - d / band) as in the plane, d what it keeps beyond the
// clearance, and times 1 + `depth_weight` a metre off the goal's depth.
//
// Where there is no way through what is known, but one through hazards that are `decide_m` off and more and that nobody
// has measured yet, that one is given: to look on; `sure_m` says how far it is known to be clear. Nearer than that the
// vehicle must know: a REMUS takes 9 m to turn away at 1.2 m/s, 2 s of reaction and its clearance counted (S5-45).
//
// A goal farther off than `reach_m` is gone for in part: the way leads past what is near, the last leg straight to the
// goal, and is planned again on the way. A start nearer than the clearance takes what room there is, down to the hull.
//
// Frame W, (north, east, depth). Pure, and the same on every machine: the budget counts cells. Not promised: the very
// shortest way. Cost: 150 ms through
// 100 x 100 x 20 m in voxels of 0.5 m (bench/space_bench.cpp).
#pragma once

#include <isobath/planning/route_planner.hpp>
#include <isobath/planning/space_room.hpp>
#include <limits>

namespace isobath {

struct SpaceRouteConfig {
  double clearance_m = 1.2;         ///< from the hull, all round
  double wished_clearance_m = 2.5;  ///< kept where there is room
  double room_weight = 1;
  double depth_weight = 0.05;  ///< 1/m
  double decide_m = 14;
  double reach_m = 80;
  double margin_m = 20;  ///< of the box, around start and goal
  int most_expanded = 200'000;
};
std::vector<Field> fields(SpaceRouteConfig& config);

struct SpaceRouteTask {
  Eigen::Vector3d start = Eigen::Vector3d::Zero(), goal = Eigen::Vector3d::Zero();
  std::optional<Angle> heading;  ///< at the start; empty: any
  double half_width_m = 0.25;
  double turning_radius_m = 0;
  double steepest = 0.3;  ///< m of depth a metre of way; infinite: it can rise on the spot
  double least_depth_m = 0, most_depth_m = std::numeric_limits<double>::infinity();  ///< of the way
  std::span<const Hazard> hazards;
};

struct SpaceRoutePath {
  std::vector<Eigen::Vector3d> points;  ///< start, corners, goal
  double length_m = 0;
  double clearance_m = 0;  ///< least room about the hull's middle; what is `wished` and more counts as that
  double sure_m = 0;       ///< from the start, to where nobody has measured; the whole length where all is
  int expanded = 0;
};

double way_length(std::span<const Eigen::Vector3d> way);

/// Between these two; `look_on`: what may be looked on from there is unsure, else closed.
SpaceRoom room_for(const SpaceGrid& grid, const SpaceRouteTask& task, const SpaceRouteConfig& config, bool look_on);

/// Whether a way keeps `clearance_m` (hull not counted) as far as a room knows; what lies beyond its box is not asked.
bool is_clear(const SpaceRoom& room, std::span<const Eigen::Vector3d> way, double clearance_m);

/// From the start of a way to the first place that nobody has measured, m; its length where there is none.
double sure_length(const SpaceRoom& room, std::span<const Eigen::Vector3d> way);

/// In the room of this very task, of which the first looks on.
Result<SpaceRoutePath, RouteRefusal> plan_space_route(const SpaceRoom& room, const SpaceRouteTask& task,
                                                      const SpaceRouteConfig& config);
Result<SpaceRoutePath, RouteRefusal> plan_space_route(const SpaceGrid& grid, const SpaceRouteTask& task,
                                                      const SpaceRouteConfig& config);
/// Whether a way between these two can be asked for at all.
bool is_finite(const SpaceRouteTask& task);

}  // namespace isobath
