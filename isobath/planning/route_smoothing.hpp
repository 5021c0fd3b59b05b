// RouteSmoothing: turns a path over cells into few corners and straight legs, which keep the clearance and cost no more
// (ledger S6-52).
//
// Costs are those of the grid, with its preference for room (route_grid.hpp); legs are checked against the hazards
// themselves. Both ends stay. Cost: about 1 us per tried leg; some hundreds of legs for a path of 100 m.
#pragma once

#include <isobath/planning/route_grid.hpp>

namespace isobath {

/// Removes points where the straight leg past them keeps the clearance and costs no more.
void pull_straight(std::vector<Eigen::Vector2d>& way, const HazardMap& map, const RouteGrid& grid, double clearance_m);

/// Moves corners where that makes the path cheaper (by up to 2 cells at a time, down to a quarter), then pulls it
/// straight again: a path along the eight directions of cells is longer, and has less room, than it need be.
void settle_corners(std::vector<Eigen::Vector2d>& way, const HazardMap& map, const RouteGrid& grid, double clearance_m);

}  // namespace isobath
