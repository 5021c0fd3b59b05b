#include <algorithm>
#include <cmath>
#include <isobath/mission/agents/way_keeping.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Way = std::vector<Vector2d>;

// The parts of a path before and after `along`, which both hold that point; `leg` is the leg that was cut.
struct Cut {
  Way head;
  Way tail;
  int leg = 0;
};

Cut cut(std::span<const Vector2d> way, double along) {
  Cut result;
  double left = along;
  std::size_t i = 0;
  for (; i + 1 < way.size(); ++i) {
    const double leg = (way[i + 1] - way[i]).norm();
    result.head.push_back(way[i]);
    if (left <= leg) break;
    left -= leg;
  }
  result.leg = static_cast<int>(i);
  if (i + 1 >= way.size()) {
    result.head.push_back(way.back());
    return result;
  }
  const Vector2d leg = way[i + 1] - way[i];
  const double length = leg.norm();
  const Vector2d at = length > 0 ? Vector2d(way[i] + leg * (left / length)) : way[i];
  result.head.push_back(at);
  result.tail.push_back(at);
  result.tail.insert(result.tail.end(), way.begin() + static_cast<std::ptrdiff_t>(i) + 1, way.end());
  return result;
}

}  // namespace

Polygon to_local(const PlanFrame& frame, Polygon outline_W) {
  for (Vector2d& p : outline_W) p = frame.to_local(p);
  return outline_W;
}

double length_of(std::span<const Vector2d> way) {
  double length = 0;
  for (std::size_t i = 1; i < way.size(); ++i) length += (way[i] - way[i - 1]).norm();
  return length;
}

Vector2d point_at(std::span<const Vector2d> way, double along_m) { return cut(way, along_m).head.back(); }

std::optional<Conflict> conflict_ahead(const HazardMap& map, std::span<const Vector2d> way, double clearance_m) {
  if (way.empty()) return {};
  const double here = map.distance(way.front());
  if (here >= clearance_m || way.size() < 2 || here <= 0) return map.conflict(way, clearance_m);
  constexpr double kRounding = 0.05;  // m: a vehicle that drifts along a hazard does not count as nearer
  const Cut parts = cut(way, 2 * (clearance_m - here) + 1);
  if (auto conflict = map.conflict(parts.head, std::max(0.0, here - kRounding))) return conflict;
  if (parts.tail.size() < 2) return {};
  auto conflict = map.conflict(parts.tail, clearance_m);
  if (conflict) {
    conflict->leg += parts.leg;
    conflict->along_m += length_of(parts.head);
  }
  return conflict;
}

std::optional<Way> mended(const HazardMap& map, std::span<const Vector2d> way, double clearance_m) {
  constexpr int kRounds = 8;
  constexpr double kBeyond = 0.1;  // m, so that the next outline of the same obstacle finds it clear
  if (way.size() < 3) return {};
  Way result(way.begin(), way.end());
  for (int round = 0; round < kRounds; ++round) {
    const auto conflict = conflict_ahead(map, result, clearance_m);
    if (!conflict) return result;
    const Hazard& hazard = map.hazards()[conflict->hazard];
    bool moved = false;
    for (const int end : {conflict->leg, conflict->leg + 1}) {
      const auto corner = static_cast<std::size_t>(end);
      if (corner == 0 || corner + 1 >= result.size()) continue;
      const Vector2d away = result[corner] - nearest_point(hazard.outline, result[corner]);
      const double distance = away.norm();
      if (distance < 1e-6) continue;
      // Moving both ends by what the leg lacks moves the leg by it; a corner that alone is too near moves by its own
      // lack.
      const double lack = std::max(clearance_m - conflict->distance_m, clearance_m + hazard.margin_m - distance);
      result[corner] += away / distance * (lack + kBeyond);
      moved = true;
    }
    if (!moved) return {};
  }
  return {};
}

std::optional<Vector2d> nearest_place(const Vector2d& wanted, const Vector2d& from, double reach_m,
                                      const std::function<bool(const Vector2d&)>& clear) {
  constexpr double kStep = 0.5;
  if (clear(wanted)) return wanted;
  for (int ring = 1; ring * kStep <= reach_m; ++ring) {
    const double radius = ring * kStep;
    const int places = std::max(8, static_cast<int>(std::ceil(2 * std::numbers::pi * radius / kStep)));
    std::optional<Vector2d> best;
    for (int i = 0; i < places; ++i) {
      const double bearing = 2 * std::numbers::pi * i / places;
      const Vector2d p = wanted + radius * Vector2d(std::cos(bearing), std::sin(bearing));
      if (best && (p - from).norm() >= (*best - from).norm()) continue;
      if (clear(p)) best = p;
    }
    if (best) return best;
  }
  return {};
}

void trim_margins(std::vector<Hazard>& hazards, const Vector2d& vehicle, double room_m) {
  for (Hazard& h : hazards) {
    if (h.margin_m <= 0 || h.outline.empty()) continue;
    const double distance = (vehicle - nearest_point(h.outline, vehicle)).norm();
    if (distance - h.margin_m < room_m) h.margin_m = std::max(0.0, distance - room_m);
  }
}

}  // namespace isobath
