#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/planning/space_route.hpp>
#include <isobath/planning/space_search.hpp>
#include <isobath/planning/turning.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTurnOff = 0.05;               // m: no vehicle follows its path more accurately
constexpr double kArcSag = 0.1;                 // m
constexpr std::array kAhead = {0.5, 1.0, 2.0};  // turning radii

class SpaceRouter {
 public:
  SpaceRouter(const ClearanceField& room, const SpaceRouteTask& task, const SpaceRouteConfig& config)
      : room_(room), task_(task), search_(room, task, config) {}

  Result<SpaceRoutePath, RouteRefusal> plan();

 private:
  Result<SpaceWay, RouteRefusal> turnable();
  void pull_straight(SpaceWay& way) const;
  [[nodiscard]] std::optional<SpaceWay> turned(const SpaceWay& way) const;
  [[nodiscard]] bool can_be_turned(const SpaceWay& way) const;

  const ClearanceField& room_;
  const SpaceRouteTask& task_;
  SpaceSearch search_;
};

void SpaceRouter::pull_straight(SpaceWay& way) const {
  for (bool changed = true; changed;) {
    changed = false;
    SpaceWay pulled = {way.front()};
    for (std::size_t from = 0; from + 1 < way.size();) {
      double cost = 0;
      std::size_t to = from + 1, best = to;
      cost = search_.leg_price(way[from], way[to]);
      for (++to; to < way.size(); ++to) {
        cost += search_.leg_price(way[to - 1], way[to]);
        if (search_.can_climb(way[from], way[to]) && search_.leg_price(way[from], way[to]) <= cost * (1 + 1e-9) &&
            search_.keeps(way[from], way[to])) {
          best = to;
        }
      }
      changed = changed || best > from + 1;
      pulled.push_back(way[best]);
      from = best;
    }
    way = std::move(pulled);
  }
}

bool SpaceRouter::can_be_turned(const SpaceWay& way) const {
  std::vector<Vector2d> plan;
  for (const Vector3d& p : way) plan.emplace_back(p.head<2>());
  if (!corners_fit(plan, task_.turning_radius_m)) return false;
  for (std::size_t i = 1; i < way.size(); ++i) {
    if (!search_.keeps(way[i - 1], way[i])) return false;
    if (i + 1 == way.size() || task_.turning_radius_m == 0) continue;
    // the arc, at the corner's depth
    const auto arc = rounded_corner(plan[i - 1], plan[i], plan[i + 1], task_.turning_radius_m, kArcSag);
    for (const Vector2d& p : arc) {
      const Vector3d at(p.x(), p.y(), way[i].z());
      if (room_.distance(at) < search_.need_at(at) - SpaceSearch::kLittle) return false;
    }
  }
  return true;
}

/// The path unchanged, or with a turn at its start towards one of its points: the shortest that the vehicle can follow.
std::optional<SpaceWay> SpaceRouter::turned(const SpaceWay& way) const {
  if (task_.turning_radius_m == 0) return way;
  if (!task_.heading) return can_be_turned(way) ? std::optional(way) : std::nullopt;
  std::optional<SpaceWay> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t target = 1; target < way.size(); ++target) {
    for (const int side : {-1, 1}) {
      const auto corners = turn_towards(task_.start.head<2>(), task_.heading->radians(), task_.turning_radius_m, side,
                                        way[target].head<2>(), kTurnOff);
      if (!corners) continue;
      SpaceWay candidate = {task_.start};
      for (const Vector2d& corner : *corners) candidate.emplace_back(corner.x(), corner.y(), task_.start.z());
      candidate.insert(candidate.end(), way.begin() + static_cast<std::ptrdiff_t>(target), way.end());
      const double length = way_length(candidate);
      const std::size_t last_turn = corners->size();
      if (length >= least || !search_.can_climb(candidate[last_turn], candidate[last_turn + 1])) continue;
      if (!can_be_turned(candidate)) continue;
      least = length;
      best = std::move(candidate);
    }
  }
  return best;
}

/// A path that fits the turning radius without a circle. Where the shortest path gives none, the vehicle first goes
/// straight ahead for a while.
Result<SpaceWay, RouteRefusal> SpaceRouter::turnable() {
  const double radius = task_.turning_radius_m;
  auto found = search_.search(task_.start);
  if (!found) return tl::unexpected(found.error());
  pull_straight(*found);
  const double longest = way_length(*found) + std::numbers::pi * radius;
  auto way = turned(*found);
  if (way && way_length(*way) <= longest) return *std::move(way);
  if (!task_.heading) return tl::unexpected(RouteRefusal::kCannotTurn);
  for (const double ahead : kAhead) {
    const Vector3d on = ahead * radius * Vector3d(cos(*task_.heading), sin(*task_.heading), 0);
    const Vector3d from = task_.start + on;
    if (!search_.keeps(task_.start, from)) break;
    auto later = search_.search(from);
    if (!later) continue;
    pull_straight(*later);
    later->insert(later->begin(), task_.start);
    if (way_length(*later) <= longest && can_be_turned(*later)) return *std::move(later);
  }
  return tl::unexpected(RouteRefusal::kCannotTurn);
}

Result<SpaceRoutePath, RouteRefusal> SpaceRouter::plan() {
  if (search_.room_at_start() < task_.half_width_m) return tl::unexpected(RouteRefusal::kStartBlocked);
  if (!search_.aim()) return tl::unexpected(RouteRefusal::kGoalBlocked);
  auto way = turnable();
  if (!way) return tl::unexpected(way.error());
  SpaceRoutePath path;
  path.clearance_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < way->size(); ++i) {
    path.clearance_m = std::min(path.clearance_m, room_.leg_distance((*way)[i - 1], (*way)[i]));
  }
  path.sure_m = sure_length(room_, *way);
  if ((search_.target() - task_.goal).norm() > 1e-9) way->push_back(task_.goal);
  path.length_m = way_length(*way);
  path.points = std::move(*way);
  path.expanded = search_.expanded();
  return path;
}

}  // namespace

double way_length(std::span<const Vector3d> way) {
  double sum = 0;
  for (std::size_t i = 1; i < way.size(); ++i) sum += (way[i] - way[i - 1]).norm();
  return sum;
}

ClearanceField room_for(const OccupancySnapshot& grid, const SpaceRouteTask& task, const SpaceRouteConfig& config,
                        bool look_on) {
  const double need = task.half_width_m + config.clearance_m, wished = task.half_width_m + config.wished_clearance_m;
  const Vector3d leg = task.goal - task.start;
  const double all = leg.head<2>().norm();
  const Vector3d end = all > config.reach_m ? Vector3d(task.start + config.reach_m / all * leg) : task.goal;
  const Vector3d margin(config.margin_m, config.margin_m, 0);
  ClearanceTask box;
  box.least = task.start.cwiseMin(end) - margin;
  box.most = task.start.cwiseMax(end) + margin;
  box.hazards = task.hazards;
  // the band that the mission goes through anyway, with the clearance that it needs there
  const double more = need + grid.voxel_m();
  box.shallow_m = std::min(task.start.z(), task.goal.z()) - more;
  box.deep_m = std::max(task.start.z(), task.goal.z()) + more;
  const double shallowest = grid.least().z() * grid.voxel_m(),
               deepest = (grid.least().z() + grid.size().z()) * grid.voxel_m();
  box.least.z() = grid.size().isZero() ? box.shallow_m : std::min(box.shallow_m, shallowest);
  box.most.z() = grid.size().isZero() ? box.deep_m : std::max(box.deep_m, deepest);
  box.max_m = std::max(need, wished) + 2 * grid.voxel_m();
  box.vehicle_W = task.start;
  box.apart_m = 2 * need;
  box.look_on_m = look_on ? std::max(config.decide_m, grid.voxel_m()) : 0;
  return ClearanceField(grid, box);
}

bool is_clear(const ClearanceField& room, std::span<const Vector3d> way, double clearance_m) {
  for (std::size_t i = 1; i < way.size(); ++i) {
    const int pieces = std::max(1, static_cast<int>(std::ceil((way[i] - way[i - 1]).norm() / (0.5 * room.voxel_m()))));
    for (int k = 0; k <= pieces; ++k) {
      const Vector3d p = way[i - 1] + (way[i] - way[i - 1]) * k / pieces;
      if (room.holds(p) && room.distance(p) < clearance_m) return false;
    }
  }
  return true;
}

double sure_length(const ClearanceField& room, std::span<const Vector3d> way) {
  double gone = 0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const double leg = (way[i] - way[i - 1]).norm();
    const int pieces = std::max(1, static_cast<int>(std::ceil(leg / (0.5 * room.voxel_m()))));
    for (int k = 0; k <= pieces; ++k) {
      if (room.is_unsure(way[i - 1] + (way[i] - way[i - 1]) * k / pieces)) return gone + leg * k / pieces;
    }
    gone += leg;
  }
  return gone;
}

Result<SpaceRoutePath, RouteRefusal> plan_space_route(const ClearanceField& room, const SpaceRouteTask& task,
                                                      const SpaceRouteConfig& config) {
  if (!room.has_unsure()) return SpaceRouter(room, task, config).plan();
  const ClearanceField known = room.of_what_is_known();
  auto path = SpaceRouter(known, task, config).plan();
  if (path) return path;
  auto tried = SpaceRouter(room, task, config).plan();
  return tried ? std::move(tried) : std::move(path);
}

Result<SpaceRoutePath, RouteRefusal> plan_space_route(const OccupancySnapshot& grid, const SpaceRouteTask& task,
                                                      const SpaceRouteConfig& config) {
  if (!is_finite(task)) return tl::unexpected(RouteRefusal::kNotFinite);
  return plan_space_route(room_for(grid, task, config, true), task, config);
}

}  // namespace isobath
