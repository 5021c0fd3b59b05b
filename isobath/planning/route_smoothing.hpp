// RouteSmoothing: from a way over cells to few corners and straight legs, which keep the clearance and cost no more
// (ledger S6-52).
//
// Costs are those of the grid, room preferred (route_grid.hpp); legs are checked against the hazards themselves. Both
// ends stay. Cost: about 1 us a leg that is tried; some hundreds for a way of 100 m.
#pragma once

#include <isobath/planning/route_grid.hpp>

namespace isobath {

/// Leaves out points between which the straight leg keeps the clearance and costs no more.
void pull_straight(std::vector<Eigen::Vector2d>& way, const HazardMap& map, const RouteGrid& grid, double clearance_m);

/// Moves corners where that makes the way cheaper (by up to 2 cells at a time, down to a quarter), then pulls it
/// straight again: the eight directions of cells leave more length, and less room, than there need be.
void settle_corners(std::vector<Eigen::Vector2d>& way, const HazardMap& map, const RouteGrid& grid, double clearance_m);

}  // namespace isobath
