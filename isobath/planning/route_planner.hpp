// RoutePlanner: a path past hazards (Ganesan 2015, 5.2.2, algorithm 1; ledger S6-44 to S6-52).
//
// Default: A* (grid_search.hpp) over cells whose steps are decided exactly (route_grid.hpp), with half-width, clearance
// and margins. The path is then pulled straight as far as it keeps the clearance and costs no more. Then its corners
// and its start are fitted to the turning radius (turning.hpp), with more clearance where that is needed. The result is
// checked leg by leg: map.conflict(points, half_width + clearance) is empty, and stays so when the path is transformed
// into another frame and back (the planner keeps 1e-6 m more than asked). Arcs at corners may come 0.05 m nearer than
// legs.
//
// Cost of a path: the integral of 1 + w max(0, 1 - d / band), where d is the distance kept beyond the clearance, and
// band = wished - clearance. Where there is room the path keeps off, at a detour of at most a share w. Every step costs
// at least its length, so that the heuristic stays consistent.
//
// Costly areas add to the cost of a metre in them; a corridor bounds how far the path may lead from a straight line
// (S2-14, S2-15). kCoarse knows neither.
//
// A start nearer than the clearance may leave, by a path that comes nowhere nearer than the start is (S6-50). A start
// within an outline itself is refused, kStartBlocked: map.distance(start) says how deep it is. The search window is the
// box of start and goal with a margin; it grows until there is a path or it holds all hazards. Water that no hazard
// covers is free, so that goals off any map are goals like others. Windows of more than a million cells use larger
// cells.
//
// kCoarse is the paper's method: cells of 5 m, blocked where a hazard touches them, paths through their centres, no
// smoothing and no turning radius; `RouteConfig::as_printed` has the paper's corner cutting too. It keeps half a cell
// (2.5 m) from hazards and `clearance_m` more, from cell centre to cell centre, if no corners are cut (S6-49, S6-52,
// S6-E18); the half-width is not counted.
//
// Pure: a function of map, request and configuration. The budget counts expansions, so that the same request gives the
// same answer on any machine. Not promised: the very shortest path (a few per cent remain from the directions of
// cells), and a path through gaps in which no cell centre lies.
#pragma once

#include <isobath/base/error.hpp>
#include <isobath/planning/hazard_map.hpp>

namespace isobath {

struct RouteConfig {
  enum class Method : std::uint8_t { kExact, kCoarse } method = Method::kExact;
  double cell_m = 1;
  double clearance_m = 3;         ///< from the vehicle's hull to a hazard; kCoarse: of cells to a hazard
  double wished_clearance_m = 6;  ///< kept where there is room
  double room_weight = 0.3;       ///< w: the detour per metre that the wish is worth
  double margin_m = 30;           ///< first searched around start and goal
  bool smooth = true;             ///< pull straight, and respect the turning radius
  bool cut_corners = false;       ///< kCoarse only
  int max_expanded = 200'000;

  /// The paper's configuration: kCoarse, 5 m, no clearance of its own, corners cut.
  static RouteConfig as_printed();
};
std::vector<Field> fields(RouteConfig& config);

enum class RouteRefusal : std::uint8_t {
  kNotFinite,     ///< or farther than 1e7 m from the origin
  kStartBlocked,  ///< in an outline, or every step away leads nearer still
  kGoalBlocked,
  kNoPath,
  kOutOfBudget,
  kCannotTurn,  ///< there is a path, but none was found for the turning radius
};
const char* to_text(RouteRefusal refusal);

/// A circle in which a metre costs more, by this share at the centre, falling linearly to 0 at the radius.
struct CostlyArea {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius_m = 0;
  double extra = 0;
};

/// The path stays within this distance of a segment, or as near to it as its start is.
struct RouteCorridor {
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();
  double width_m = 0;  ///< to each side
};

struct RouteTask {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  std::optional<double> heading = {};  ///< at the start, from x towards y; empty: any
  Eigen::Vector2d goal = Eigen::Vector2d::Zero();
  double half_width_m = 0.5;
  double turning_radius_m = 0;
  std::vector<CostlyArea> costly = {};
  std::optional<RouteCorridor> corridor = {};
};

struct RoutePath {
  std::vector<Eigen::Vector2d> points;  ///< start, corners, goal
  double length_m = 0;
  double clearance_m = 0;  ///< minimum distance of the path to a hazard; infinite without hazards
  double escape_m = 0;     ///< length at the start that is nearer to a hazard than asked; 0 where the start is clear
  int expanded = 0;
};

Result<RoutePath, RouteRefusal> plan_route(const HazardMap& map, const RouteTask& request, const RouteConfig& config);

}  // namespace isobath
