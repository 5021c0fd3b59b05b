#include <algorithm>
#include <cmath>
#include <functional>
#include <isobath/planning/space_search.hpp>
#include <queue>
#include <tuple>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr double kNearestGoal = 5;  // m: a partial path leads at least this far
constexpr int kDoubtAfter = 10000;  // cells expanded before the search checks whether the goal can be reached
constexpr int kWidestCell = 20;     // voxels

}  // namespace

SpaceSearch::SpaceSearch(const ClearanceField& room, const SpaceRouteTask& task, const SpaceRouteConfig& config)
    : room_(room),
      task_(task),
      config_(config),
      band_(std::max(room.voxel_m(), config.wished_clearance_m - config.clearance_m)),
      need_(task.half_width_m + config.clearance_m),
      at_start_(room.distance(task.start)) {}

bool SpaceSearch::aim() {
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

double SpaceSearch::need_at(const Vector3d& p) const {
  return at_start_ >= need_ ? need_ : std::min(need_, at_start_ + 0.5 * (p - task_.start).norm());
}

bool SpaceSearch::keeps(const Vector3d& a, const Vector3d& b) const {
  if (at_start_ >= need_) return room_.leg_distance(a, b) >= need_;
  const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / (0.5 * room_.voxel_m()))));
  for (int i = 0; i <= pieces; ++i) {
    const Vector3d p = a + (b - a) * i / pieces;
    if (room_.distance(p) < need_at(p) - kLittle) return false;
  }
  return true;
}

double SpaceSearch::price(const Vector3d& p) const {
  const double lack = std::max(0.0, 1 - (room_.distance(p) - need_) / band_);
  return 1 + config_.room_weight * lack + config_.depth_weight * std::abs(p.z() - task_.goal.z());
}

double SpaceSearch::leg_price(const Vector3d& a, const Vector3d& b) const {
  const double length = (b - a).norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(length / room_.voxel_m())));
  double sum = 0;
  for (int i = 0; i < pieces; ++i) sum += price(a + (b - a) * ((i + 0.5) / pieces));
  return sum * length / pieces;
}

/// Whether a place is within the depths of the mission, or on the way to them.
bool SpaceSearch::is_allowed(const Vector3d& p) const {
  const double shallow = std::min(task_.min_depth_m, task_.start.z()),
               deep = std::max(task_.max_depth_m, task_.start.z());
  return p.z() >= shallow - 0.5 * room_.voxel_m() && p.z() <= deep + 0.5 * room_.voxel_m();
}

bool SpaceSearch::can_climb(const Vector3d& a, const Vector3d& b) const {
  return std::abs(b.z() - a.z()) <= task_.steepest * (b - a).head<2>().norm() + 1e-9 ||
         std::abs(b.z() - a.z()) <= 0.5 * room_.voxel_m();
}

VoxelIndex SpaceSearch::voxel_of(std::size_t node) const {
  const auto z = static_cast<std::size_t>(cells_.z()), y = static_cast<std::size_t>(cells_.y());
  const VoxelIndex cell(static_cast<int>(node / (z * y)), static_cast<int>(node / z % y), static_cast<int>(node % z));
  return origin_ + cell.cwiseProduct(VoxelIndex(wide_, wide_, 1));
}

std::size_t SpaceSearch::node_of(const VoxelIndex& cell) const {
  return (static_cast<std::size_t>(cell.x()) * static_cast<std::size_t>(cells_.y()) +
          static_cast<std::size_t>(cell.y())) *
             static_cast<std::size_t>(cells_.z()) +
         static_cast<std::size_t>(cell.z());
}

bool SpaceSearch::is_open(const VoxelIndex& voxel) const {
  const Vector3d there = room_.centre_of(voxel);
  return room_.distance(voxel) >= need_at(there) && is_allowed(there);
}

/// Whether open cells connect the last cell with any that the search has reached, whatever lies between cells. If not,
/// there is no path; this check finds that out long before the search has tried all cells.
bool SpaceSearch::can_be_reached(const VoxelIndex& last) const {
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

Result<SpaceWay, RouteRefusal> SpaceSearch::search(const Vector3d& from) {
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
    if (++expanded_ > config_.max_expanded) return tl::unexpected(RouteRefusal::kOutOfBudget);
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

SpaceWay SpaceSearch::way_to(std::size_t node, const Vector3d& from) const {
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

}  // namespace isobath
