// TurningSearch: a way that a vehicle with a turning radius can follow, where a way for a point has none (hybrid-state
// A*; Dolgov, Thrun, Montemerlo, Diebel 2010). Ledger S6-52.
//
// States are places with one of 16 headings, counted from the first. From each the vehicle goes straight on, or on the
// circle of its radius by 22.5 degrees to either side; of states in one cell with one heading the cheapest is kept. The
// bound is the cost to the goal over the cells, by a search from the goal without heed of turning. From every state
// that is looked at an arc and a straight leg to the goal are tried; with the first that is clear the search ends, if
// the arc is no more than half a circle: else a little more is looked at for a way without one.
//
// An arc is two legs with a corner between, which rounded with the radius is the arc again: what comes out is a way of
// legs whose corners fit (turning.hpp). `clear` says whether a leg may be gone; an arc may be where both legs and the
// chord may, as no hazard that keeps off all three can be nearer to what lies between them.
//
// Not promised: the shortest way, nor one where there is one; resolution is that of headings and cells. Cost: about
// 10 us a state.
#pragma once

#include <functional>
#include <isobath/planning/route_grid.hpp>

namespace isobath {

struct TurningTask {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  std::optional<double> heading;  ///< from x towards y; empty: any of the 16
  Eigen::Vector2d goal = Eigen::Vector2d::Zero();
  double radius_m = 1;  ///< above 0
  int most_expanded = 2000;
};

/// Start, corners, goal; empty if none was found. The goal lies in the grid's window, or nothing is found.
std::optional<std::vector<Eigen::Vector2d>> search_turning(
    const RouteGrid& grid, const TurningTask& task,
    const std::function<bool(const Eigen::Vector2d&, const Eigen::Vector2d&)>& clear);

}  // namespace isobath
