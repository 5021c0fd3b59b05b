#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/planning/space_route.hpp>
#include <isobath/planning/turning.hpp>
#include <numbers>
#include <queue>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using SpaceWay = std::vector<Vector3d>;

constexpr double kFarthestGoal = 1e7;           // m
constexpr double kTurnOff = 0.05;               // m: no vehicle follows its path more accurately
constexpr double kArcSag = 0.1;                 // m
constexpr double kNearestGoal = 5;              // m: a partial path leads at least this far
constexpr std::array kAhead = {0.5, 1.0, 2.0};  // turning radii
constexpr int kDoubtAfter = 10000;  // cells expanded before the search checks whether the goal can be reached
constexpr int kWidestCell = 20;     // voxels
constexpr double kLittle = 0.1;     // m that a start that is hemmed in may lose between centres of voxels

class SpaceRouter {
 public:
  SpaceRouter(const ClearanceField& room, const SpaceRouteTask& task, const SpaceRouteConfig& config)
      : room_(room),
        task_(task),
        config_(config),
        band_(std::max(room.voxel_m(), config.wished_clearance_m - config.clearance_m)),
        need_(task.half_width_m + config.clearance_m),
        at_start_(room.distance(task.start)) {}

  Result<SpaceRoutePath, RouteRefusal> plan();

 private:
  struct Node {
    float cost = std::numeric_limits<float>::infinity();
    std::int16_t came_by = -1;
    bool closed = false;
  };
  bool aim();
  [[nodiscard]] std::size_t node_of(const VoxelIndex& cell) const;
  [[nodiscard]] bool is_open(const VoxelIndex& voxel) const;
  [[nodiscard]] bool can_be_reached(const VoxelIndex& last) const;
  Result<SpaceWay, RouteRefusal> search(const Vector3d& from);
  Result<SpaceWay, RouteRefusal> turnable();
  [[nodiscard]] VoxelIndex voxel_of(std::size_t node) const;
  [[nodiscard]] SpaceWay way_to(std::size_t node, const Vector3d& from) const;
  [[nodiscard]] double need_at(const Vector3d& p) const;
  [[nodiscard]] bool keeps(const Vector3d& a, const Vector3d& b) const;
  [[nodiscard]] double price(const Vector3d& p) const;
  [[nodiscard]] double leg_price(const Vector3d& a, const Vector3d& b) const;
  [[nodiscard]] bool is_allowed(const Vector3d& p) const;
  [[nodiscard]] bool can_climb(const Vector3d& a, const Vector3d& b) const;
  void pull_straight(SpaceWay& way) const;
  [[nodiscard]] std::optional<SpaceWay> turned(const SpaceWay& way) const;
  [[nodiscard]] bool can_be_turned(const SpaceWay& way) const;

  const ClearanceField& room_;
  const SpaceRouteTask& task_;
  const SpaceRouteConfig& config_;
  double band_, need_, at_start_;
  Vector3d target_ = Vector3d::Zero();
  int wide_ = 1;  ///< voxels per cell along north and east; one along depth
  VoxelIndex origin_ = VoxelIndex::Zero(), cells_ = VoxelIndex::Zero();
  std::vector<Node> nodes_;
  int expanded_ = 0;
};

/// Aims at the farthest place on the straight line to the goal that is within reach and clear.
bool SpaceRouter::aim() {
  const Vector3d leg = task_.goal - task_.start;
  const double all = leg.head<2>().norm();
  const double reach = std::min(all, config_.reach_m);
  for (double at = reach; at >= std::min(reach, kNearestGoal); at -= room_.voxel_m()) {
    target_ = all > 0 ? Vector3d(task_.start + at / all * leg) : task_.goal;
    target_.z() = task_.goal.z();
    if (room_.distance(target_) >= need_) return true;
    if (reach == all) return false;  // the goal itself
  }
  return false;
}

/// For a start that is hemmed in, the required distance grows by half a metre per metre travelled.
double SpaceRouter::need_at(const Vector3d& p) const {
  return at_start_ >= need_ ? need_ : std::min(need_, at_start_ + 0.5 * (p - task_.start).norm());
}

bool SpaceRouter::keeps(const Vector3d& a, const Vector3d& b) const {
  if (at_start_ >= need_) return room_.leg_distance(a, b) >= need_;
  const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / (0.5 * room_.voxel_m()))));
  for (int i = 0; i <= pieces; ++i) {
    const Vector3d p = a + (b - a) * i / pieces;
    if (room_.distance(p) < need_at(p) - kLittle) return false;
  }
  return true;
}

double SpaceRouter::price(const Vector3d& p) const {
  const double lack = std::max(0.0, 1 - (room_.distance(p) - need_) / band_);
  return 1 + config_.room_weight * lack + config_.depth_weight * std::abs(p.z() - task_.goal.z());
}

double SpaceRouter::leg_price(const Vector3d& a, const Vector3d& b) const {
  const double length = (b - a).norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / room_.voxel_m())));
  double sum = 0;
  for (int i = 0; i < pieces; ++i) sum += price(a + (b - a) * ((i + 0.5) / pieces));
  return sum * length / pieces;
}

/// Whether a place is within the depths of the mission, or on the way to them.
bool SpaceRouter::is_allowed(const Vector3d& p) const {
  const double shallow = std::min(task_.least_depth_m, task_.start.z()),
               deep = std::max(task_.most_depth_m, task_.start.z());
  return p.z() >= shallow - 0.5 * room_.voxel_m() && p.z() <= deep + 0.5 * room_.voxel_m();
}

bool SpaceRouter::can_climb(const Vector3d& a, const Vector3d& b) const {
  return std::abs(b.z() - a.z()) <= task_.steepest * (b - a).head<2>().norm() + 1e-9 ||
         std::abs(b.z() - a.z()) <= 0.5 * room_.voxel_m();
}

VoxelIndex SpaceRouter::voxel_of(std::size_t node) const {
  const auto z = static_cast<std::size_t>(cells_.z()), y = static_cast<std::size_t>(cells_.y());
  const VoxelIndex cell(static_cast<int>(node / (z * y)), static_cast<int>(node / z % y), static_cast<int>(node % z));
  return origin_ + cell.cwiseProduct(VoxelIndex(wide_, wide_, 1));
}

std::size_t SpaceRouter::node_of(const VoxelIndex& cell) const {
  return (static_cast<std::size_t>(cell.x()) * static_cast<std::size_t>(cells_.y()) +
          static_cast<std::size_t>(cell.y())) *
             static_cast<std::size_t>(cells_.z()) +
         static_cast<std::size_t>(cell.z());
}

bool SpaceRouter::is_open(const VoxelIndex& voxel) const {
  const Vector3d there = room_.centre_of(voxel);
  return room_.distance(voxel) >= need_at(there) && is_allowed(there);
}

/// Whether open cells connect the last cell with any that the search has reached, whatever lies between cells. If not,
/// there is no path; this check finds that out long before the search has tried all cells.
bool SpaceRouter::can_be_reached(const VoxelIndex& last) const {
  const VoxelIndex step(wide_, wide_, 1);
  if (!is_open(origin_ + last.cwiseProduct(step))) return false;
  std::vector<bool> met(nodes_.size(), false);
  std::vector<VoxelIndex> front = {last}, grown;
  met[node_of(last)] = true;
  while (!front.empty()) {
    grown.clear();
    for (const VoxelIndex& from : front) {
      for (int neighbour = 0; neighbour < 27; ++neighbour) {
        const VoxelIndex cell = from + VoxelIndex(neighbour / 9 - 1, neighbour / 3 % 3 - 1, neighbour % 3 - 1);
        if ((cell.array() < 0).any() || (cell.array() >= cells_.array()).any()) continue;
        const std::size_t node = node_of(cell);
        if (met[node]) continue;
        met[node] = true;
        if (nodes_[node].cost < std::numeric_limits<float>::infinity()) return true;
        if (is_open(origin_ + cell.cwiseProduct(step))) grown.push_back(cell);
      }
    }
    front.swap(grown);
  }
  return false;
}

Result<SpaceWay, RouteRefusal> SpaceRouter::search(const Vector3d& from) {
  // 1. cells about the start; a step along all axes is no steeper than the vehicle can climb
  wide_ = task_.steepest >= 1 ? 1 : std::clamp(static_cast<int>(std::ceil(1 / task_.steepest)), 1, kWidestCell);
  const VoxelIndex start = room_.voxel_at(from), goal = room_.voxel_at(target_), step(wide_, wide_, 1);
  origin_ = VoxelIndex(start.x() % wide_, start.y() % wide_, 0);
  cells_ = ((room_.size() - origin_).array() + step.array() - 1) / step.array();
  nodes_.assign(static_cast<std::size_t>(cells_.cast<double>().prod()), {});
  const VoxelIndex first = (start - origin_).cwiseQuotient(step);
  const VoxelIndex last = ((goal - origin_).array() + step.array() / 2) / step.array();
  if ((last.array() < 0).any() || (last.array() >= cells_.array()).any()) {
    return tl::unexpected(RouteRefusal::kGoalBlocked);
  }
  const Vector3d aim_at = room_.centre_of(origin_ + last.cwiseProduct(step));

  // 2. A*: smallest bound first, of equal ones the larger cost so far, then the smaller cell
  using Open = std::tuple<double, double, std::size_t>;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  const bool can_rise = task_.steepest >= 1;
  const int before = expanded_;
  nodes_[node_of(first)].cost = 0;
  open.emplace((aim_at - from).norm(), 0, node_of(first));
  while (!open.empty()) {
    const std::size_t at = std::get<2>(open.top());
    open.pop();
    if (nodes_[at].closed) continue;
    nodes_[at].closed = true;
    const VoxelIndex voxel = voxel_of(at);
    const Vector3d here = room_.centre_of(voxel);
    if (at == node_of(last)) return way_to(at, from);
    if (++expanded_ > config_.most_expanded) return tl::unexpected(RouteRefusal::kOutOfBudget);
    if (expanded_ - before == kDoubtAfter && !can_be_reached(last)) break;
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      const VoxelIndex by(neighbour / 9 - 1, neighbour / 3 % 3 - 1, neighbour % 3 - 1);
      if (by.isZero() || (by.x() == 0 && by.y() == 0 && !can_rise)) continue;
      const VoxelIndex cell = (voxel - origin_).cwiseQuotient(step) + by;
      if ((cell.array() < 0).any() || (cell.array() >= cells_.array()).any()) continue;
      Node& next = nodes_[node_of(cell)];
      if (next.closed) continue;
      const VoxelIndex to = origin_ + cell.cwiseProduct(step);
      if (!is_open(to)) continue;
      const Vector3d there = room_.centre_of(to);
      const double cost = nodes_[at].cost + (there - here).norm() * price(there);
      if (!(cost < next.cost) || !keeps(here, there)) continue;
      next.cost = static_cast<float>(cost);
      next.came_by = static_cast<std::int16_t>(neighbour);
      open.emplace(cost + (aim_at - there).norm(), -cost, node_of(cell));
    }
  }
  return tl::unexpected(RouteRefusal::kNoPath);
}

SpaceWay SpaceRouter::way_to(std::size_t node, const Vector3d& from) const {
  SpaceWay way = {target_};
  for (std::size_t at = node; nodes_[at].came_by >= 0;) {
    way.push_back(room_.centre_of(voxel_of(at)));
    const int neighbour = nodes_[at].came_by;
    const std::ptrdiff_t back =
        (static_cast<std::ptrdiff_t>(neighbour / 9 - 1) * cells_.y() + neighbour / 3 % 3 - 1) * cells_.z() +
        neighbour % 3 - 1;
    at = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) - back);
  }
  way.push_back(from);
  std::reverse(way.begin(), way.end());
  return way;
}

void SpaceRouter::pull_straight(SpaceWay& way) const {
  for (bool changed = true; changed;) {
    changed = false;
    SpaceWay pulled = {way.front()};
    for (std::size_t from = 0; from + 1 < way.size();) {
      double cost = 0;
      std::size_t to = from + 1, best = to;
      cost = leg_price(way[from], way[to]);
      for (++to; to < way.size(); ++to) {
        cost += leg_price(way[to - 1], way[to]);
        if (can_climb(way[from], way[to]) && leg_price(way[from], way[to]) <= cost * (1 + 1e-9) &&
            keeps(way[from], way[to])) {
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
    if (!keeps(way[i - 1], way[i])) return false;
    if (i + 1 == way.size() || task_.turning_radius_m == 0) continue;
    // the arc, at the corner's depth
    const auto arc = rounded_corner(plan[i - 1], plan[i], plan[i + 1], task_.turning_radius_m, kArcSag);
    for (const Vector2d& p : arc) {
      const Vector3d at(p.x(), p.y(), way[i].z());
      if (room_.distance(at) < need_at(at) - kLittle) return false;
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
      if (length >= least || !can_climb(candidate[last_turn], candidate[last_turn + 1])) continue;
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
  auto found = search(task_.start);
  if (!found) return tl::unexpected(found.error());
  pull_straight(*found);
  const double longest = way_length(*found) + std::numbers::pi * radius;
  auto way = turned(*found);
  if (way && way_length(*way) <= longest) return *std::move(way);
  if (!task_.heading) return tl::unexpected(RouteRefusal::kCannotTurn);
  for (const double ahead : kAhead) {
    const Vector3d on = ahead * radius * Vector3d(cos(*task_.heading), sin(*task_.heading), 0);
    const Vector3d from = task_.start + on;
    if (!keeps(task_.start, from)) break;
    auto later = search(from);
    if (!later) continue;
    pull_straight(*later);
    later->insert(later->begin(), task_.start);
    if (way_length(*later) <= longest && can_be_turned(*later)) return *std::move(later);
  }
  return tl::unexpected(RouteRefusal::kCannotTurn);
}

Result<SpaceRoutePath, RouteRefusal> SpaceRouter::plan() {
  if (at_start_ < task_.half_width_m) return tl::unexpected(RouteRefusal::kStartBlocked);
  if (!aim()) return tl::unexpected(RouteRefusal::kGoalBlocked);
  auto way = turnable();
  if (!way) return tl::unexpected(way.error());
  SpaceRoutePath path;
  path.clearance_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < way->size(); ++i) {
    path.clearance_m = std::min(path.clearance_m, room_.leg_distance((*way)[i - 1], (*way)[i]));
  }
  path.sure_m = sure_length(room_, *way);
  if ((target_ - task_.goal).norm() > 1e-9) way->push_back(task_.goal);
  path.length_m = way_length(*way);
  path.points = std::move(*way);
  path.expanded = expanded_;
  return path;
}

}  // namespace

std::vector<Field> fields(SpaceRouteConfig& c) {
  return {
      Field::real("clearance_m", &c.clearance_m, {0, 100}, "m",
                  "Clearance from the hull to water that is not known to be clear, all round."),
      Field::real("wished_clearance_m", &c.wished_clearance_m, {0, 100}, "m",
                  "Clearance that is kept where there is room."),
      Field::real("room_weight", &c.room_weight, {0, 100}, "1", "Detour per metre that the wished clearance is worth."),
      Field::real("depth_weight", &c.depth_weight, {0, 10}, "1/m",
                  "Detour per metre that a metre off the goal's depth is worth."),
      Field::real("decide_m", &c.decide_m, {0, 1000}, "m",
                  "Distance before unmeasured water at which the vehicle must have another path."),
      Field::real("reach_m", &c.reach_m, {10, 1000}, "m",
                  "To a goal farther than this only a partial path is planned."),
      Field::real("margin_m", &c.margin_m, {0, 1000}, "m", "Margin of the box around start and goal."),
      Field::integer("most_expanded", &c.most_expanded, {1, 100'000'000}, "1",
                     "Maximum number of cells that a search expands."),
  };
}

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
  box.most_m = std::max(need, wished) + 2 * grid.voxel_m();
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

bool is_finite(const SpaceRouteTask& task) {
  const auto far = [](const Vector3d& p) { return !p.allFinite() || p.cwiseAbs().maxCoeff() > kFarthestGoal; };
  return !far(task.start) && !far(task.goal);
}

}  // namespace isobath
