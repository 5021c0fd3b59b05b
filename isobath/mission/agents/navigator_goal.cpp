// Whether the Navigator can go to the mission point, and where near it if it cannot.
#include <algorithm>
#include <fmt/format.h>
#include <isobath/mission/agents/navigator.hpp>
#include <isobath/mission/agents/way_keeping.hpp>
#include <isobath/mission/messages/reason_text.hpp>

namespace isobath {

using Eigen::Vector2d;

namespace {

constexpr double kDropDistance_m = 10;
constexpr double kTraffic_s = 60;  // for which a body that moved counts
constexpr int kTrafficScans = 15;  // times `sure_scans`

double outline_distance(const Hazard& hazard, const Vector2d& p) {
  return (p - nearest_point(hazard.outline, p)).norm();
}

bool is_certain(HazardKind kind) { return kind == HazardKind::kCharted || kind == HazardKind::kInjected; }

}  // namespace

// S6-51. A vehicle that cannot stop needs room to turn round at the point; one that hovers needs its clearance.
double Navigator::drop_distance() const {
  if (request_->target.drop_distance_m > 0) return request_->target.drop_distance_m;
  if (config_.drop_distance_m > 0) return config_.drop_distance_m;
  return vehicle_.min_speed > 0 ? kDropDistance_m : clearance();
}

/// Whether a body moves, or did a short time ago.
bool Navigator::in_traffic() const { return traffic_ && to_seconds(now_ - *traffic_) < kTraffic_s; }

/// Scans with an obstacle at the mission point after which the point is given up. Among bodies that move, it may not be
/// known to move yet.
int Navigator::goal_scans() const { return config_.sure_scans * (in_traffic() ? kTrafficScans : 1); }

// S6-39, S6-51. Removes the obstacles at the point that are not believed yet.
std::optional<Navigator::Refusal> Navigator::judge_goal(const PlanFrame& frame, std::vector<Hazard>& hazards) {
  const Vector2d& goal_W = request_->target.north_east;
  if (!inside_fence(goal_W, 0)) return Refusal{RouteRefused::Reason::kOutsideFence, "the point is outside the fence"};
  const Vector2d goal = frame.to_local(goal_W);
  const Vector2d vehicle = frame.to_local(here_->X_WB.translation.head<2>());
  const auto blocks = [&](const Hazard& h) {
    return h.kind != HazardKind::kFence &&
           outline_distance(h, goal) < std::max(drop_distance(), clearance() + h.margin_m);
  };
  // A body that moves will have left the point; so may one, among bodies that move, that is out of view. One that is
  // near the vehicle is avoided.
  const bool traffic = in_traffic();
  const auto leaves = [&](const Hazard& h) {
    return h.kind == HazardKind::kMoving || (traffic && h.kind == HazardKind::kRemembered);
  };
  std::erase_if(hazards, [&](const Hazard& h) {
    return leaves(h) && blocks(h) && outline_distance(h, vehicle) > config_.sure_within_m;
  });
  const Hazard* nearest = nullptr;
  bool sure = false;
  for (const Hazard& h : hazards) {
    if (!blocks(h) || leaves(h)) continue;
    sure = sure || is_certain(h.kind);
    if (nearest == nullptr || outline_distance(h, goal) < outline_distance(*nearest, goal)) nearest = &h;
  }
  goal_blocked_ = nearest != nullptr ? goal_blocked_ + static_cast<int>(new_scan_) : 0;
  if (nearest == nullptr) return {};
  // From afar an obstacle is no reason to give up the point: the vehicle goes on and looks again.
  const bool far = (goal - vehicle).norm() > config_.decide_within_m;
  if (!sure && (far || goal_blocked_ < goal_scans())) {
    std::erase_if(hazards,
                  [&](const Hazard& h) { return blocks(h) && outline_distance(h, vehicle) > config_.sure_within_m; });
    return {};
  }
  const Vector2d place = frame.to_world(nearest_point(nearest->outline, goal));
  const double distance = outline_distance(*nearest, goal);
  const std::string where =
      distance > 0 ? fmt::format("{:.1f} m from it ({:.1f} m wanted)", distance, drop_distance()) : "on it";
  return Refusal{RouteRefused::Reason::kGoalBlocked,
                 fmt::format("{} is {}, at {}", text_of(*nearest), where, text_of(place)),
                 safe_near(goal, vehicle, frame, hazards), place, nearest->obstacle};
}

std::optional<Vector2d> Navigator::safe_near(const Vector2d& goal, const Vector2d& vehicle, const PlanFrame& frame,
                                             std::vector<Hazard> hazards) const {
  if (request_->target.move_m <= 0) return {};
  const HazardMap map(std::move(hazards));
  const auto clear = [&](const Vector2d& p) {
    const bool far = std::all_of(map.hazards().begin(), map.hazards().end(), [&](const Hazard& h) {
      return h.kind == HazardKind::kFence || outline_distance(h, p) >= drop_distance() + config_.slack_m;
    });
    return far && map.distance(p) >= clearance() && inside_fence(frame.to_world(p), config_.fence_clearance_m);
  };
  const auto place = nearest_place(goal, vehicle, request_->target.move_m, clear);
  return place ? std::optional(frame.to_world(*place)) : std::nullopt;
}

}  // namespace isobath
