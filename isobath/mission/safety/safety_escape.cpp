// The Safety Officer's checks of collisions and of the fence for a vehicle that cannot stop: it is safe while it has an
// escape manoeuvre (escape.hpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/messages/reason_text.hpp>
#include <isobath/mission/safety/safety_officer.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kLookAhead = 2;       // s: after this time under an order there must be an escape manoeuvre
constexpr double kFenceLookAhead = 1;  // s: the same on a route before the fence
constexpr double kMinTurn = 0.01;      // rad/s
constexpr double kMinSpeed = 0.1;      // m/s
constexpr double kTurnsWithin = 0.25;  // of its radius: the distance in which a turn builds up
constexpr double kFenceNear = 40;      // m: farther parts of the fence do not matter to a turn
constexpr double kFenceApart = 1;      // m, between the points that stand for it
constexpr double kMovers = 10;         // s: for which an escape leads past bodies that move, where there is such a one
constexpr double kOnTheFence = 0.1;    // m: nearer to it, the direction to it is noise
constexpr double kQuarter = std::numbers::pi / 2;
/// Shares of the margin: where no escape manoeuvre keeps all of it, one that keeps less is better than none.
constexpr std::array<double, 2> kNarrower = {0.5, 0.25};

Vector2d nearest_on(const Polygon& border, const Vector2d& p) {
  Vector2d nearest = border.front();
  for (std::size_t i = 0; i < border.size(); ++i) {
    const Vector2d q = nearest_point({border[i], border[(i + 1) % border.size()]}, p);
    if ((q - p).squaredNorm() < (nearest - p).squaredNorm()) nearest = q;
  }
  return nearest;
}

/// The heading to steer now for an escape.
Angle steered(const Escape& escape, Angle heading) {
  const double now = escape.wait_s > 0 ? 0 : std::clamp(escape.turn, -kQuarter, kQuarter);
  return (heading + Angle::radians(now)).wrapped();
}

}  // namespace

/// The known points around the vehicle, in its frame: raw echoes, and the outlines of obstacles, moving, seen,
/// remembered, charted and mapped.
std::vector<ObstaclePoint> SafetyOfficer::known_points(const Pose& X_WL,
                                                       std::span<const ObstaclePoint> echoes_L) const {
  std::vector<ObstaclePoint> points(echoes_L.begin(), echoes_L.end());
  const Pose X_LW = X_WL.inverse();
  for (const std::vector<Vector2d>* some : {&mapped_W_, &charted_W_, &solid_W_}) {
    for (const Vector2d& p : *some) {
      const Eigen::Vector3d p_W(p.x(), p.y(), X_WL.translation.z());
      if (!passes_by(p_W)) points.push_back({(X_LW * p_W).head<2>()});
    }
  }
  for (const Mover& mover : movers_) {
    const Eigen::Vector3d v_W(mover.velocity_W.x(), mover.velocity_W.y(), 0);
    const Vector2d velocity = (X_LW.rotation * v_W).head<2>(), moved = (clock_s_ - mover.seen_s) * velocity;
    for (const Vector2d& p : mover.outline_W) {
      points.push_back({(X_LW * Eigen::Vector3d(p.x(), p.y(), X_WL.translation.z())).head<2>() + moved, velocity});
    }
  }
  return points;
}

/// Points of the fence around the vehicle, in its frame.
std::vector<ObstaclePoint> SafetyOfficer::fence_points(const Pose& X_WL) const {
  std::vector<ObstaclePoint> points;
  if (!fenced()) return points;
  const Polygon& fence = plan_->fence;
  const Vector2d here = X_WL.translation.head<2>();
  const Pose X_LW = X_WL.inverse();
  for (std::size_t i = 0; i < fence.size(); ++i) {
    const Vector2d side = fence[(i + 1) % fence.size()] - fence[i];
    const double length = side.norm();
    if (!(length > 0)) continue;
    const double abeam = side.dot(here - fence[i]) / length;  // m along the side
    const double begin = std::max(0.0, abeam - kFenceNear), end = std::min(length, abeam + kFenceNear);
    if (!(end >= begin)) continue;  // too far to be near, or too long to be counted
    const int pieces = static_cast<int>(std::min(std::ceil((end - begin) / kFenceApart), 2 * kFenceNear / kFenceApart));
    for (int k = 0; k <= pieces; ++k) {
      const Vector2d p = fence[i] + std::min(begin + k * kFenceApart, end) / length * side;
      if (!((p - here).norm() < kFenceNear)) continue;
      points.push_back({(X_LW * Eigen::Vector3d(p.x(), p.y(), X_WL.translation.z())).head<2>()});
    }
  }
  return points;
}

EscapeTask SafetyOfficer::escape_task(bool wary) const {
  const Angle heading = fix_->navigation.X_WB.rotation.heading();
  const Vector2d ahead(cos(heading), sin(heading)), aside(-sin(heading), cos(heading));
  const Vector2d& drift_W = current_.velocity_W();
  EscapeTask task;
  task.drift = {drift_W.dot(ahead), drift_W.dot(aside)};
  task.speed = std::max({fix_->v_W.dot(ahead) - task.drift.x(), vehicle_.min_speed, kMinSpeed});
  const double radius = std::max(vehicle_.limits.turning_radius, kMinRadius);
  // Fins turn the vehicle by the water that flows past them; a current from astern that was never crossed is unknown.
  const double most = std::clamp(task.speed - std::max(vehicle_.min_speed, kMinSpeed), 0.0, config_.unknown_current);
  if (wary) task.astern = std::min(most, current_.sigma_along(heading));
  const double flow = task.speed - task.astern;
  task.turn_rate = std::min(std::max(vehicle_.limits.max_yaw_rate.radians(), kMinTurn), flow / radius);
  task.lag_s = kTurnsWithin * radius / flow;
  task.turn_now = fix_->yaw_rate;
  task.horizon_s = config_.escape_s;
  task.moving_s = config_.escape_moving_s;
  task.room_m = vehicle_.hull_radius_m + config_.collision_margin_m;
  if (way_ && way_->points.size() > 1 && action_.kind != SafetyActionKind::kSurface) {
    const Vector2d way = way_->points.back() - fix_->navigation.X_WB.translation.head<2>();
    task.towards = std::atan2(way.dot(aside), way.dot(ahead));
  }
  return task;
}

/// Turn from the current heading to the one that is ordered, or that is held while surfacing, rad.
double SafetyOfficer::ordered_turn() const {
  const Angle heading = fix_->navigation.X_WB.rotation.heading();
  const bool surfacing = action_.kind == SafetyActionKind::kSurface;
  const Angle wanted = surfacing ? action_.setpoint.heading : order_ ? order_->heading : heading;
  return (wanted - heading).wrapped().radians();
}

// A vehicle that cannot stop turns away from the fence, also while it surfaces: on a held heading it would leave. Its
// turn keeps clear of all points where it can, those of the fence and the known ones.
void SafetyOfficer::check_fence(const Pose& X_WL, std::span<const ObstaclePoint> fence_L,
                                std::span<const ObstaclePoint> all_L) {
  if (!fenced()) return;
  const Vector2d here = X_WL.translation.head<2>();
  if (!encloses(plan_->fence, here)) {  // it is told as a breach: back over the nearest point
    const Vector2d back = nearest_on(plan_->fence, here) - here;
    if (back.norm() > kOnTheFence) inward_ = Angle::radians(std::atan2(back.y(), back.x()));
    return;
  }
  // The route of a vehicle that has one was planned within the fence; one that has none turns in good time.
  const bool on_route = action_.kind != SafetyActionKind::kSurface;
  const EscapeTask task = escape_task(!on_route);
  const EscapeSearch within(fence_L, task);
  if (within.free(within.after(ordered_turn(), on_route ? kFenceLookAhead : kLookAhead))) return;
  const EscapeSearch among(all_L, task);
  const Angle heading = fix_->navigation.X_WB.rotation.heading();
  const bool turning = raised(Fault::kFenceAhead) && inward_;
  Escape escape = turning ? among.try_turn((*inward_ - heading).wrapped().radians()) : Escape{};
  if (!among.free(escape)) escape = among.best();
  if (!among.free(escape)) escape = within.best();
  inward_ = steered(escape, heading);
  find(Fault::kFenceAhead, fmt::format("the order leaves no turn before the fence, {:.1f} m away, at {:.1f} m/s",
                                       inner_distance(plan_->fence, here), task.speed));
}

// A vehicle that surfaces circles where there is room: on a held heading it would go on into what it has not seen.
void SafetyOfficer::choose_circle(const Pose& X_WL, std::span<const ObstaclePoint> all_L) {
  const auto is_outside = [&] { return fenced() && !encloses(plan_->fence, X_WL.translation.head<2>()); };
  if (action_.kind != SafetyActionKind::kSurface || is_outside()) {
    circle_ = 0;
    return;
  }
  constexpr double kWhole = 2 * std::numbers::pi;
  EscapeTask task = escape_task(true);
  task.horizon_s = std::max(task.horizon_s, kWhole / task.turn_rate);
  const EscapeSearch search(all_L, task);
  if (circle_ != 0 && search.free(search.try_turn(circle_ * kWhole))) return;
  const Escape port = search.try_turn(-kWhole), starboard = search.try_turn(kWhole);
  const bool to_port = search.free(port) && !(search.free(starboard) && starboard.room_m >= port.room_m);
  circle_ = to_port ? -1 : search.free(starboard) ? 1 : 0;
}

void SafetyOfficer::check_escape(const Pose& X_WL, std::span<const ObstaclePoint> known_L) {
  const EscapeTask task = escape_task(true);
  const EscapeSearch search(known_L, task);
  const Escape ordered = search.after(ordered_turn(), kLookAhead);
  const bool safe = search.free(ordered) && !imminent_.raised();
  const bool taking = raised(Fault::kCollisionUnavoidable) && turn_;
  if (safe && !taking) return;
  // 1. the escape manoeuvre: the current one as long as it is free. An order counts as safe although a body may meet
  // its escape later than in the next seconds; the escape that is steered should not.
  const Angle heading = fix_->navigation.X_WB.rotation.heading();
  if (taking) {
    way_out_.turn -= (heading - way_out_from_).wrapped().radians();
    way_out_.wait_s = std::max(0.0, way_out_.wait_s - to_seconds(kTick));
  }
  way_out_from_ = heading;
  const auto way_out = [&](const EscapeSearch& among) {
    const Escape under_way = taking ? among.try_turn(way_out_.turn, way_out_.wait_s) : Escape{};
    return among.free(under_way) ? under_way : among.best();
  };
  const auto way_past = [&](double moving_s) {
    EscapeTask past = task;
    past.moving_s = moving_s;
    Escape found = way_out(EscapeSearch(known_L, past));
    for (const double share : kNarrower) {
      if (search.free(found)) break;
      past.room_m = vehicle_.hull_radius_m + share * config_.collision_margin_m;
      found = way_out(EscapeSearch(known_L, past));
    }
    return found;
  };
  Escape escape = way_past(movers_.empty() ? task.moving_s : std::max(task.moving_s, kMovers));
  if (!search.free(escape) && !movers_.empty()) escape = way_past(task.moving_s);
  bool free = search.free(escape);
  if (safe && !free) {  // going on as ordered is free
    escape = {0, ordered_turn(), ordered.free_s, ordered.room_m, {}};
    free = true;
  }
  // 2. steer it
  way_out_ = escape;
  turn_ = steered(escape, heading);
  hemmed_in_ = !free;
  if (safe) return;
  std::optional<Vector2d> place;
  if (ordered.meets) place = (X_WL * Eigen::Vector3d(ordered.meets->x(), ordered.meets->y(), 0)).head<2>();
  const std::string why = place ? fmt::format("the order leaves no escape past an obstacle at {}", text_of(*place))
                                : std::string("short ranges ahead");
  const double turn_deg = std::min(std::abs(escape.turn) * 180 / std::numbers::pi, 360.0);
  find(Fault::kCollisionUnavoidable,
       fmt::format("{}, at {:.1f} m/s, and the vehicle cannot stop; {}: {:.0f} degrees to {}", why, task.speed,
                   free ? "an escape is left" : fmt::format("none is left that is free for {:.0f} s", task.horizon_s),
                   turn_deg, escape.turn < 0 ? "port" : "starboard"));
  row(Fault::kCollisionUnavoidable).place = place;
  row(Fault::kCollisionUnavoidable).margin_m =
      std::isfinite(escape.room_m) ? std::optional(escape.room_m - vehicle_.hull_radius_m) : std::nullopt;
}

}  // namespace isobath
