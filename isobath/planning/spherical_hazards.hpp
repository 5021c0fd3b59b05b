// Spherical hazards: the occupied cells of a spherical grid as hazards of the plan view, for planners (Auran, Silven
// 1995, 2 and 5; ledger S4-51): fine near the vehicle and coarse far off, like the grid.
//
// Each occupied cell with an echo (SphericalCell::holds_echo) whose content lies within `half_height_m` of the
// vehicle's level, plus half a cell, is one hazard: the level sector between its radii and sides. Frame P: x along y'
// of the grid and y along x', so (north, east) of the vehicle in a north-up grid, (ahead, starboard) in a course-up
// one. Water that was not observed is no hazard; way_ahead (spherical_passage.hpp) tells it from free water. Pure
// function.
#pragma once

#include <isobath/map/spherical/spherical_grid.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <vector>

namespace isobath {

std::vector<Hazard> hazards_of(const SphericalGrid& grid, double half_height_m);

}  // namespace isobath
