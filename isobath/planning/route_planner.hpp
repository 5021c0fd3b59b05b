// RoutePlanner: a way past what is in the way (Ganesan 2015, 5.2.2, algorithm 1; ledger S6-44 to S6-52).
//
// Default: A* (grid_search.hpp) over cells whose steps are decided exactly (route_grid.hpp), with half-width, clearance
// and margins; then the way is pulled straight as far as it keeps the clearance and costs no more; then its corners and
// its start are made ones that the vehicle can turn (turning.hpp), with more clearance where that is what it takes.
// What comes out was checked leg by leg: map.conflict(points, half_width + clearance) is empty, and stays so when the
// way is carried into another frame and back (1e-6 m more is kept than asked). Arcs at corners may come 0.05 m nearer
// than legs.
//
// Cost of a way: the integral of 1 + w max(0, 1 - d / band), d what it keeps beyond the clearance, band = wished -
// clearance: where there is room it stands off, at a detour of at most a share w. Every step costs its length or more,
// so that the heuristic stays consistent.
//
// A start nearer than the clearance may leave, by a way that comes nowhere nearer than it stands (S6-50); within an
// outline itself it is refused, kStartBlocked: map.distance(start) says how deep. The search window is the box of start
// and goal with a margin; it grows until there is a way or it holds all hazards. What no hazard covers is free, so that
// goals off any map are goals like others. Windows of more than a million cells take larger cells.
//
// kCoarse is the paper's method: cells of 5 m, blocked where a hazard touches, through their centres, no smoothing, no
// heed of turning; `RouteConfig::as_printed` has its corner cutting too. It keeps half a cell (2.5 m) from hazards and
// `clearance_m` more, from cell centre to cell centre, if no corners are cut (S6-49, S6-52, S6-E18); the half-width is
// not counted.
//
// Pure: a function of map, request and configuration; the budget counts expansions, so that the same request gives the
// same answer on any machine. Not promised: the very shortest way (a few per cent of cells' directions remain), and a
// way through gaps in which no cell centre lies.
#pragma once

#include <isobath/base/error.hpp>
#include <isobath/planning/hazard_map.hpp>

namespace isobath {

struct RouteConfig {
  enum class Method : std::uint8_t { kExact, kCoarse } method = Method::kExact;
  double cell_m = 1;
  double clearance_m = 3;         ///< from the vehicle's hull to a hazard; kCoarse: of cells to a hazard
  double wished_clearance_m = 6;  ///< kept where there is room
  double room_weight = 0.3;       ///< w: the detour a metre that the wish is worth
  double margin_m = 30;           ///< first searched around start and goal
  bool smooth = true;             ///< pull straight, and heed turning
  bool cut_corners = false;       ///< kCoarse only
  int most_expanded = 200'000;

  /// The paper's: kCoarse, 5 m, no clearance of its own, corners cut.
  static RouteConfig as_printed();
};
std::vector<Field> fields(RouteConfig& config);

enum class RouteRefusal : std::uint8_t {
  kNotFinite,     ///< or farther than 1e7 m from the origin
  kStartBlocked,  ///< on an outline, or no step away that is not nearer still
  kGoalBlocked,
  kNoPath,
  kOutOfBudget,
  kCannotTurn,  ///< there is a way, but none was found that the vehicle can turn
};
const char* to_text(RouteRefusal refusal);

struct RouteTask {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  std::optional<double> heading;  ///< at the start, from x towards y; empty: any
  Eigen::Vector2d goal = Eigen::Vector2d::Zero();
  double half_width_m = 0.5;
  double turning_radius_m = 0;
};

struct RoutePath {
  std::vector<Eigen::Vector2d> points;  ///< start, corners, goal
  double length_m = 0;
  double clearance_m = 0;  ///< least distance of the way to a hazard; infinite without
  double escape_m = 0;     ///< of the length, at its start, nearer to a hazard than asked; 0 where the start is clear
  int expanded = 0;
};

Result<RoutePath, RouteRefusal> plan_route(const HazardMap& map, const RouteTask& request, const RouteConfig& config);

}  // namespace isobath
