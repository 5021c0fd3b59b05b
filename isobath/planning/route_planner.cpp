// In one file, of some 400 lines: search, windows and the fitting of turns share the types below.
#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/geometry/cone_integral.hpp>
#include <isobath/geometry/segment.hpp>
#include <isobath/planning/grid_search.hpp>
#include <isobath/planning/route_grid.hpp>
#include <isobath/planning/route_planner.hpp>
#include <isobath/planning/route_smoothing.hpp>
#include <isobath/planning/turning.hpp>
#include <isobath/planning/turning_search.hpp>
#include <numbers>
#include <utility>

namespace isobath {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Way = std::vector<Vector2d>;

constexpr double kKept = 1e-6;     // m more than asked: survives a change of frame and back
constexpr double kTouch = 1e-9;    // m
constexpr double kOff = 0.05;      // m: no vehicle follows its path more accurately
constexpr double kSag = 0.01;      // m, from arcs to the chords that replace them
constexpr double kFarthest = 1e7;  // m
constexpr double kGrowth = 3;      // factor on the margin, from one window to the next
/// Shares of the turning radius: how deep an arc cuts a corner of 60 degrees.
constexpr std::array<double, 2> kRounder = {0, 0.16};

double length_of(const Way& way) {
  double sum = 0;
  for (std::size_t i = 1; i < way.size(); ++i) sum += (way[i] - way[i - 1]).norm();
  return sum;
}

/// A path, and the number of its points from the start that leave the neighbourhood of a hazard.
struct Found {
  Way way;
  std::size_t escape = 0;
};

class Router {
 public:
  Router(const HazardMap& map, const RouteTask& task, const RouteConfig& config)
      : map_(map),
        task_(task),
        config_(config),
        need_(task.half_width_m + config.clearance_m + kKept),
        target_(task.goal),
        at_start_(map.distance(task.start)) {
    for (const CostlyArea& area : task.costly) {
      const Vector2d radius = Vector2d::Constant(area.radius_m);
      costly_.extend(AlignedBox2d(area.centre - radius, area.centre + radius));
      widest_ = std::max(widest_, area.radius_m);
    }
    if (task.corridor) {
      corridor_m_ = std::max(task.corridor->width_m, off_line(task.start) + config.cell_m) + kKept;
    }
  }

  Result<RoutePath, RouteRefusal> exact();
  Result<RoutePath, RouteRefusal> coarse();

 private:
  Result<Found, RouteRefusal> find(double need);
  Result<Found, RouteRefusal> search(RouteGrid& grid, double need);
  [[nodiscard]] std::optional<std::size_t> goal_cell(const RouteGrid& grid, double need) const;
  [[nodiscard]] RouteWindow window(double margin, double reach, bool& whole) const {
    return RouteWindow::around(task_.start, target_, map_, {config_.cell_m, margin, reach, costly_}, whole);
  }
  void add_wishes(RouteGrid& grid) const;
  [[nodiscard]] double cost_of(const Way& way) const;
  [[nodiscard]] bool is_costly(const Vector2d& a, const Vector2d& b) const;
  /// Distance from the line of the corridor.
  [[nodiscard]] double off_line(const Vector2d& p) const {
    return (nearest_on_segment(task_.corridor->from, task_.corridor->to, p) - p).norm();
  }
  [[nodiscard]] bool stays_in_corridor(const Way& way) const {
    return !task_.corridor ||
           std::ranges::all_of(way, [this](const Vector2d& p) { return off_line(p) <= corridor_m_; });
  }
  Result<std::vector<std::size_t>, RouteRefusal> cells(const RouteGrid& grid, std::size_t from, std::size_t to);
  [[nodiscard]] Vector2d near_target(double reach) const;
  [[nodiscard]] bool keeps(const Vector2d& a, const Vector2d& b, double more_m) const;
  [[nodiscard]] bool can_be_turned(const Way& way) const;
  [[nodiscard]] std::optional<Way> turned(const Way& way) const;
  [[nodiscard]] std::optional<Way> of_arcs() const;
  [[nodiscard]] RoutePath finished(Way way) const;
  [[nodiscard]] double band() const { return std::max(0.0, config_.wished_clearance_m - config_.clearance_m); }

  const HazardMap& map_;
  const RouteTask& task_;
  const RouteConfig& config_;
  double need_;      ///< of the vehicle's centre
  Vector2d target_;  ///< of the search: the goal, or a place on the way there beyond all hazards
  double at_start_;  ///< distance of the start to a hazard
  std::int64_t expanded_ = 0;
  AlignedBox2d costly_;  ///< all costly areas
  double widest_ = 0;    ///< radius of the largest of them
  double corridor_m_ = 0;
  bool shut_in_ = false;  ///< the last search could not leave its window
};

Result<RoutePath, RouteRefusal> Router::exact() {
  // 1. both ends
  if (map_.holding(task_.start)) return tl::unexpected(RouteRefusal::kStartBlocked);
  const double at_goal = map_.distance(task_.goal);
  if (at_goal < need_) return tl::unexpected(RouteRefusal::kGoalBlocked);
  // 2. a path; where it does not fit the turning radius, one that keeps farther off
  double tried = 0;
  std::optional<Way> circling;  // a path that begins with a circle
  for (const double share : kRounder) {
    const double need = std::min(need_ + share * task_.turning_radius_m, at_goal);
    if (need == tried) continue;
    tried = need;
    const auto found = find(need);
    if (!found) {
      if (share > 0) break;
      return tl::unexpected(found.error());
    }
    if (!stays_in_corridor(found->way)) return tl::unexpected(RouteRefusal::kNoPath);
    if (!config_.smooth) return finished(found->way);
    auto way = turned(found->way);
    if (!way) continue;
    const double half_a_circle = std::numbers::pi * task_.turning_radius_m;
    if (cost_of(*way) <= cost_of(found->way) + half_a_circle) return finished(std::move(*way));
    if (!circling || cost_of(*way) < cost_of(*circling)) circling = std::move(way);
  }
  // 3. a path made of arcs and straight legs
  auto way = of_arcs();
  if (circling && (!way || cost_of(*circling) < cost_of(*way))) way = std::move(circling);
  if (!way) return tl::unexpected(RouteRefusal::kCannotTurn);
  return finished(std::move(*way));
}

/// What the path is to prefer, and the corridor that it may not leave.
void Router::add_wishes(RouteGrid& grid) const {
  grid.prefer_room(band(), config_.room_weight);
  for (const CostlyArea& area : task_.costly) grid.add_cost(area.centre, area.radius_m, area.extra);
  if (task_.corridor) grid.close_beyond(task_.corridor->from, task_.corridor->to, corridor_m_);
}

/// Its length, and what the costly areas add.
double Router::cost_of(const Way& way) const {
  double cost = length_of(way);
  for (std::size_t i = 1; i < way.size(); ++i) {
    for (const CostlyArea& area : task_.costly) {
      cost += area.extra * cone_integral(way[i - 1], way[i], area.centre, area.radius_m);
    }
  }
  return cost;
}

bool Router::is_costly(const Vector2d& a, const Vector2d& b) const {
  return std::ranges::any_of(task_.costly, [&](const CostlyArea& area) {
    return area.extra > 0 && (nearest_on_segment(a, b, area.centre) - area.centre).norm() < area.radius_m;
  });
}

Result<Found, RouteRefusal> Router::find(double need) {
  if (!is_costly(task_.start, task_.goal) && at_start_ >= need &&
      map_.leg_distance(task_.start, task_.goal) >= need + band()) {
    return Found{{task_.start, task_.goal}, 0};
  }
  target_ = near_target(need + band());
  bool whole = false;
  RouteRefusal last = RouteRefusal::kNoPath;
  for (double margin = config_.margin_m + widest_; !whole; margin = kGrowth * margin + config_.cell_m) {
    RouteGrid grid = RouteGrid::exact(map_, window(margin, need + band(), whole), need);
    add_wishes(grid);
    auto found = search(grid, need);
    if (found) {
      if (config_.smooth) {
        const auto exit = found->way.begin() + static_cast<std::ptrdiff_t>(found->escape);
        Way leaving(found->way.begin(), exit + 1), rest(exit, found->way.end());
        pull_straight(leaving, map_, grid, at_start_ - kTouch);
        pull_straight(rest, map_, grid, need);
        settle_corners(rest, map_, grid, need);
        found->escape = leaving.size() - 1;
        leaving.insert(leaving.end(), rest.begin() + 1, rest.end());
        found->way = std::move(leaving);
      }
      return found;
    }
    last = found.error();
    if (last == RouteRefusal::kOutOfBudget || shut_in_) break;
  }
  return tl::unexpected(last);
}

Result<Found, RouteRefusal> Router::search(RouteGrid& grid, double need) {
  const auto from = grid.window().at(task_.start);
  ISOBATH_ASSERT(from.has_value());
  if (grid.blocked(*from)) grid.open_escape(map_, *from, 2 * need + 4 * grid.window().cell_m);
  const auto to = goal_cell(grid, need);
  if (!to) {
    if (!map_.leg_is_clear(task_.start, target_, need)) return tl::unexpected(RouteRefusal::kNoPath);
    Found found{{task_.start, target_}, 0};
    if (target_ != task_.goal) found.way.push_back(task_.goal);
    return found;
  }
  const auto path = cells(grid, *from, *to);
  if (!path) return tl::unexpected(path.error());
  Found found;
  for (const std::size_t cell : *path) {
    if (grid.blocked(cell)) ++found.escape;
    found.way.push_back(grid.window().centre(cell));
  }
  found.way.front() = task_.start;
  if (found.way.size() > 1 && (found.way.back() - target_).norm() < kTouch) found.way.pop_back();
  found.way.push_back(target_);
  if (target_ != task_.goal) found.way.push_back(task_.goal);
  found.escape = std::min(found.escape, found.way.size() - 1);
  return found;
}

/// The cell nearest to the goal, of those around it from which the goal can be reached.
std::optional<std::size_t> Router::goal_cell(const RouteGrid& grid, double need) const {
  std::optional<std::size_t> best;
  double least = INFINITY;
  for (const int dy : {0, -1, 1}) {
    for (const int dx : {0, -1, 1}) {
      const auto cell = grid.window().at(target_ + grid.window().cell_m * Vector2d(dx, dy));
      if (!cell || grid.blocked(*cell)) continue;
      const Vector2d centre = grid.window().centre(*cell);
      const double away = (centre - target_).norm();
      if (away >= least || !map_.leg_is_clear(centre, target_, need)) continue;
      least = away;
      best = cell;
    }
  }
  return best;
}

Result<std::vector<std::size_t>, RouteRefusal> Router::cells(const RouteGrid& grid, std::size_t from, std::size_t to) {
  const RouteWindow& w = grid.window();
  GridSearch<RouteGrid> search(grid, w.columns, w.rows, w.cell_m);
  const GridOutcome outcome = search.run(from, to, config_.max_expanded - expanded_);
  expanded_ += search.expanded();
  if (outcome == GridOutcome::kReached) return search.path_to(to);
  if (outcome == GridOutcome::kOutOfBudget) return tl::unexpected(RouteRefusal::kOutOfBudget);
  // All reachable cells were expanded: did the search get away from the hazard, and does it touch the window's edge?
  bool left = false;
  shut_in_ = true;
  for (std::int32_t row = 0, cell = 0; row < w.rows; ++row) {
    for (std::int32_t column = 0; column < w.columns; ++column, ++cell) {
      const auto i = static_cast<std::size_t>(cell);
      if (!std::isfinite(search.cost(i))) continue;
      left = left || !grid.blocked(i);
      const bool inside = row > 0 && row + 1 < w.rows && column > 0 && column + 1 < w.columns;
      shut_in_ = shut_in_ && inside;
    }
  }
  return tl::unexpected(left ? RouteRefusal::kNoPath : RouteRefusal::kStartBlocked);
}

/// For a goal far beyond all hazards: the place on the straight line to the start that lies as far beyond them as they
/// are wide, from which the rest of that line is free. This affects only the cost of paths on another side of all
/// hazards.
Vector2d Router::near_target(double reach) const {
  AlignedBox2d all = map_.bounds();
  if (!costly_.isEmpty()) all.extend(costly_);
  if (all.isEmpty()) return task_.goal;
  all.extend(task_.start);
  const Vector2d beyond = Vector2d::Constant(reach + all.diagonal().norm() + config_.margin_m);
  all = AlignedBox2d(all.min() - beyond, all.max() + beyond);
  const double goal_out = (task_.goal - all.center()).cwiseQuotient(all.sizes() / 2).cwiseAbs().maxCoeff();
  if (goal_out <= 1) return task_.goal;
  const Vector2d leg = task_.goal - task_.start;
  double share = 1;
  for (const Eigen::Index axis : {0, 1}) {
    const double border = leg[axis] > 0 ? all.max()[axis] : all.min()[axis];
    if (leg[axis] != 0) share = std::min(share, (border - task_.start[axis]) / leg[axis]);
  }
  return task_.start + share * leg;
}

/// Whether a piece keeps the clearance plus `more_m`; while the vehicle leaves a hazard, the distance that the start
/// had.
bool Router::keeps(const Vector2d& a, const Vector2d& b, double more_m) const {
  if (map_.leg_is_clear(a, b, need_ + more_m)) return true;
  return at_start_ < need_ && map_.distance(a) < need_ && map_.leg_distance(a, b) >= at_start_ + more_m - kTouch;
}

bool Router::can_be_turned(const Way& way) const {
  const double radius = task_.turning_radius_m;
  if (!corners_fit(way, radius) || !stays_in_corridor(way)) return false;
  for (std::size_t i = 1; i < way.size(); ++i) {
    if (!keeps(way[i - 1], way[i], 0)) return false;
  }
  for (std::size_t i = 1; i + 1 < way.size(); ++i) {
    const Way arc = rounded_corner(way[i - 1], way[i], way[i + 1], radius, kSag);
    for (std::size_t k = 1; k < arc.size(); ++k) {
      if (!keeps(arc[k - 1], arc[k], kSag - kOff)) return false;
    }
  }
  return true;
}

/// The path as the vehicle can follow it: unchanged, or with a turn at its start towards one of its points; the
/// cheapest.
std::optional<Way> Router::turned(const Way& way) const {
  const double radius = task_.turning_radius_m;
  if (radius == 0) return way;
  if (!task_.heading) return can_be_turned(way) ? std::optional(way) : std::nullopt;
  std::optional<Way> best;
  double least = INFINITY;
  for (std::size_t target = 1; target < way.size(); ++target) {
    for (const int side : {1, -1}) {
      const auto corners = turn_towards(task_.start, *task_.heading, radius, side, way[target], kOff);
      if (!corners) continue;
      Way candidate = {task_.start};
      candidate.insert(candidate.end(), corners->begin(), corners->end());
      candidate.insert(candidate.end(), way.begin() + static_cast<std::ptrdiff_t>(target), way.end());
      const double cost = cost_of(candidate);
      if (cost >= least || !can_be_turned(candidate)) continue;
      least = cost;
      best = std::move(candidate);
    }
  }
  return best;
}

std::optional<Way> Router::of_arcs() const {
  bool whole = false;
  const double radius = task_.turning_radius_m;
  RouteGrid grid = RouteGrid::exact(map_, window(std::max(config_.margin_m, 4 * radius), need_ + band(), whole), need_);
  add_wishes(grid);
  const TurningTask turning{task_.start, task_.heading, target_, radius};
  auto way = search_turning(grid, turning, [this](const Vector2d& a, const Vector2d& b) { return keeps(a, b, 0); });
  if (!way) return std::nullopt;
  if (target_ != task_.goal) way->push_back(task_.goal);
  if (!can_be_turned(*way)) return std::nullopt;
  // Remove corners that the path can do without.
  const auto starts_ahead = [&](const Vector2d& next) {
    if (!task_.heading) return true;
    const Vector2d ahead(std::cos(*task_.heading), std::sin(*task_.heading));
    const double share = (next - task_.start).normalized().dot(ahead);
    return share > 0 && radius * (1 - share) <= kOff;
  };
  for (bool fewer = true; fewer;) {
    fewer = false;
    for (std::size_t i = way->size() - 1; i-- > 1;) {
      Way without = *way;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
      if (!starts_ahead(without[1]) || !can_be_turned(without)) continue;
      if (cost_of(without) > cost_of(*way) + kTouch) continue;
      way = std::move(without);
      fewer = true;
    }
  }
  return way;
}

RoutePath Router::finished(Way way) const {
  RoutePath path;
  path.points = std::move(way);
  path.length_m = length_of(path.points);
  path.clearance_m = INFINITY;
  path.expanded = static_cast<int>(expanded_);
  const double asked = need_ - kKept;
  bool leaving = at_start_ < asked;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const Vector2d &a = path.points[i - 1], &b = path.points[i];
    path.clearance_m = std::min(path.clearance_m, map_.leg_distance(a, b));
    if (leaving) path.escape_m += (b - a).norm();
    leaving = leaving && map_.distance(b) < asked;
  }
  return path;
}

Result<RoutePath, RouteRefusal> Router::coarse() {
  if (map_.holding(task_.start)) return tl::unexpected(RouteRefusal::kStartBlocked);
  need_ = config_.clearance_m;
  bool whole = false;
  for (double margin = config_.margin_m; !whole; margin = kGrowth * margin + config_.cell_m) {
    const RouteWindow w = window(margin, need_ + config_.cell_m, whole);
    RouteGrid grid = RouteGrid::coarse(map_, w, need_, config_.cut_corners);
    const auto from = w.at(task_.start), to = w.at(task_.goal);
    ISOBATH_ASSERT(from.has_value() && to.has_value());
    if (grid.blocked(*to)) return tl::unexpected(RouteRefusal::kGoalBlocked);
    if (grid.blocked(*from)) grid.free_cell(*from);
    const auto path = cells(grid, *from, *to);
    if (!path && (path.error() == RouteRefusal::kOutOfBudget || shut_in_)) return tl::unexpected(path.error());
    if (!path) continue;
    Way way = {task_.start};
    for (std::size_t i = 1; i < path->size(); ++i) {
      const bool straight_on = i + 1 < path->size() && (*path)[i + 1] - (*path)[i] == (*path)[i] - (*path)[i - 1];
      if (!straight_on) way.push_back(w.centre((*path)[i]));
    }
    if ((way.back() - task_.goal).norm() > kTouch || way.size() == 1) way.push_back(task_.goal);
    return finished(std::move(way));
  }
  return tl::unexpected(RouteRefusal::kNoPath);
}

bool within_reach(const Vector2d& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() <= kFarthest; }

}  // namespace

RouteConfig RouteConfig::as_printed() {
  RouteConfig c;
  c.method = Method::kCoarse;
  c.cell_m = 5;
  c.clearance_m = 0;
  c.cut_corners = true;
  return c;
}

std::vector<Field> fields(RouteConfig& c) {
  using Method = RouteConfig::Method;
  return {
      Field::choice("method", &c.method, {{"exact", Method::kExact}, {"coarse", Method::kCoarse}},
                    "Exact steps and smooth paths, or the paper's coarse cells and paths through their centres."),
      Field::real("cell_m", &c.cell_m, {0.05, 100}, "m", "Edge of a cell of the search."),
      Field::real("clearance_m", &c.clearance_m, {0, 1000}, "m",
                  "Clearance from the hull to hazards; coarse cells: around cells."),
      Field::real("wished_clearance_m", &c.wished_clearance_m, {0, 1000}, "m",
                  "Clearance that is kept where there is room."),
      Field::real("room_weight", &c.room_weight, {0, 100}, "1", "Share of detour that the wished clearance is worth."),
      Field::real("margin_m", &c.margin_m, {0, 100000}, "m",
                  "Initial margin of the search around start and goal; it grows as needed."),
      Field::flag("smooth", &c.smooth, "Pull paths straight and respect the turning radius; not for coarse cells."),
      Field::flag("cut_corners", &c.cut_corners, "Coarse cells: allow diagonal steps past blocked cells, as printed."),
      Field::integer("max_expanded", &c.max_expanded, {1, 100'000'000}, "1",
                     "Maximum number of cells that a search expands.")
          .was("most_expanded"),
  };
}

const char* to_text(RouteRefusal refusal) {
  switch (refusal) {
    case RouteRefusal::kNotFinite: return "start or goal is not finite, or too far away";
    case RouteRefusal::kStartBlocked: return "the start is in a hazard, or cannot leave its neighbourhood";
    case RouteRefusal::kGoalBlocked: return "the goal is too near to a hazard";
    case RouteRefusal::kNoPath: return "no path keeps the clearance";
    case RouteRefusal::kOutOfBudget: return "no path was found within the budget";
    case RouteRefusal::kCannotTurn: return "no path was found for the turning radius";
  }
  return "";
}

Result<RoutePath, RouteRefusal> plan_route(const HazardMap& map, const RouteTask& request, const RouteConfig& config) {
  ISOBATH_ASSERT(config.cell_m > 0 && config.clearance_m >= 0);
  ISOBATH_ASSERT(request.half_width_m >= 0 && request.turning_radius_m >= 0);
  const bool heading_known = !request.heading || std::isfinite(*request.heading);
  if (!within_reach(request.start) || !within_reach(request.goal) || !heading_known) {
    return tl::unexpected(RouteRefusal::kNotFinite);
  }
  Router router(map, request, config);
  return config.method == RouteConfig::Method::kCoarse ? router.coarse() : router.exact();
}

}  // namespace isobath
