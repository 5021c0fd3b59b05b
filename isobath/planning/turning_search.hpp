// TurningSearch: a path that a vehicle with a turning radius can follow, where the path of a point gives none
// (hybrid-state A*; Dolgov, Thrun, Montemerlo, Diebel 2010). Ledger S6-52.
//
// States are places with one of 16 headings, counted from the first. From each state the vehicle goes straight on, or
// turns on the circle of its radius by 22.5 degrees to either side; of the states in one cell with one heading the
// cheapest is kept. The bound is the cost to the goal over the cells, from a search from the goal that ignores turning.
// From every expanded state the search tries an arc and a straight leg to the goal. The first that is clear ends the
// search if its arc is no more than half a circle; otherwise the search goes on a little for a path without such an
// arc.
//
// An arc is two legs with a corner between, which rounded with the radius is the arc again: the result is a path of
// legs whose corners fit (turning.hpp). `clear` says whether a leg is allowed. An arc is allowed where both legs and
// the chord are, as no hazard that keeps off all three can be nearer to what lies between them.
//
// Not promised: the shortest path, or that a path is found where there is one; the resolution is that of headings and
// cells. Cost: about 10 us per state.
#pragma once

#include <functional>
#include <isobath/planning/route_grid.hpp>

namespace isobath {

struct TurningTask {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  std::optional<double> heading;  ///< from x towards y; empty: any of the 16
  Eigen::Vector2d goal = Eigen::Vector2d::Zero();
  double radius_m = 1;  ///< above 0
  int max_expanded = 2000;
};

/// Start, corners, goal; empty if no path was found. The goal must lie in the grid's window, or no path is found.
std::optional<std::vector<Eigen::Vector2d>> search_turning(
    const RouteGrid& grid, const TurningTask& task,
    const std::function<bool(const Eigen::Vector2d&, const Eigen::Vector2d&)>& clear);

}  // namespace isobath
