// What stands in a spherical grid as hazards of the plan view, for planners (Auran, Silven 1995, 2 and 5; ledger
// S4-51): fine near the vehicle and coarse far off, as the grid is.
//
// Each occupied cell whose content lies within `half_height_m` of the vehicle's level, and half a cell more, is one
// hazard: the sector between its radii and sides, level. Frame P: x along y' of the grid and y along x', so (north,
// east) of the vehicle in a grid that is north-up, (ahead, starboard) in one that is course-up. What nobody has looked
// at is no hazard; way_ahead (spherical_passage.hpp) tells it from free water. Pure.
#pragma once

#include <isobath/map/spherical_grid.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <vector>

namespace isobath {

std::vector<Hazard> hazards_of(const SphericalGrid& grid, double half_height_m);

}  // namespace isobath
