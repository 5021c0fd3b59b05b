// SpaceRoute: a path in three dimensions, over, under or between hazards that close the plan view (Horner et al. c.
// 2009, 4, 5; ledger S5-33, S5-35 to S5-37, S5-39, S5-45).
//
// A* in the clearance field of a box of water (clearance_field.hpp): 26 neighbours, cells as wide as the vehicle's
// steepest climb requires; every step and every leg keeps half-width and clearance all round. The path is then pulled
// straight, and fitted to the turning radius. Cost: length times 1 + w max(0, 1 - d / band) + `depth_weight` h, where d
// is the distance kept beyond the clearance, as in the plane, and h the distance off the goal's depth, m.
//
// Where no path leads through known water, but one leads through hazards that are `decide_m` or more away and not yet
// measured, that path is returned: the sonar will look there on the way. `sure_m` says how far the path is known to be
// clear. Nearer than `decide_m` the water must be known: a REMUS takes 9 m to turn away at 1.2 m/s, including 2 s of
// reaction and its clearance (S5-45).
//
// A goal farther than `reach_m` gets a partial path: it leads past what is near, and its last leg straight to the goal
// is planned again on the way. A start nearer than the clearance uses the room that there is, down to the hull.
//
// Frame W, (north, east, depth). Pure, and the same on every machine: the budget counts cells. Not promised: the very
// shortest path. Cost: 150 ms through 100 x 100 x 20 m in voxels of 0.5 m (bench/space_bench.cpp).
#pragma once

#include <isobath/planning/clearance_field.hpp>
#include <isobath/planning/route_planner.hpp>
#include <isobath/planning/space_route_task.hpp>

namespace isobath {

struct SpaceRoutePath {
  std::vector<Eigen::Vector3d> points;  ///< start, corners, goal
  double length_m = 0;
  double clearance_m = 0;  ///< minimum distance from the hull's middle; the wished one and more count the same
  double sure_m = 0;       ///< from the start to unmeasured water; the whole length where all is measured
  int expanded = 0;
};

double way_length(std::span<const Eigen::Vector3d> way);

/// The field between start and goal. `look_on`: hazards that can be looked at on the way are unsure, else closed.
ClearanceField room_for(const OccupancySnapshot& grid, const SpaceRouteTask& task, const SpaceRouteConfig& config,
                        bool look_on);

/// Whether a path keeps `clearance_m` (hull not counted) as far as a field knows; places outside its box are not
/// checked.
bool is_clear(const ClearanceField& room, std::span<const Eigen::Vector3d> way, double clearance_m);

/// Length from the start of a path to the first unmeasured place, m; its whole length where there is none.
double sure_length(const ClearanceField& room, std::span<const Eigen::Vector3d> way);

/// Plans in the given field, which room_for has made for the same task with `look_on`; the second makes that field.
Result<SpaceRoutePath, RouteRefusal> plan_space_route(const ClearanceField& room, const SpaceRouteTask& task,
                                                      const SpaceRouteConfig& config);
Result<SpaceRoutePath, RouteRefusal> plan_space_route(const OccupancySnapshot& grid, const SpaceRouteTask& task,
                                                      const SpaceRouteConfig& config);
}  // namespace isobath
