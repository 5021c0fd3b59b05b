// The Safety Officer's collision check for a vehicle that cannot stop: it is safe while it has an escape manoeuvre
// (escape.hpp).
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
constexpr double kMinTurn = 0.01;      // rad/s
constexpr double kMinSpeed = 0.1;      // m/s
constexpr double kTurnsWithin = 0.25;  // of its radius: the distance in which a turn builds up
constexpr double kQuarter = std::numbers::pi / 2;
/// Shares of the margin: where no escape manoeuvre keeps all of it, one that keeps less is better than none.
constexpr std::array<double, 2> kNarrower = {0.5, 0.25};

}  // namespace

/// The known points around the vehicle, in its frame: raw echoes, and the outlines of obstacles, seen, remembered,
/// charted and mapped.
std::vector<Vector2d> SafetyOfficer::known_points(const Pose& X_WL, std::span<const Vector2d> echoes_L) const {
  std::vector<Vector2d> points(echoes_L.begin(), echoes_L.end());
  const Pose X_LW = X_WL.inverse();
  for (const std::vector<Vector2d>* some : {&mapped_W_, &charted_W_}) {
    for (const Vector2d& p : *some) {
      const Eigen::Vector3d p_W(p.x(), p.y(), X_WL.translation.z());
      if (!passes_by(p_W)) points.emplace_back((X_LW * p_W).head<2>());
    }
  }
  return points;
}

EscapeTask SafetyOfficer::escape_task() const {
  const Angle heading = fix_->navigation.X_WB.rotation.heading();
  const Vector2d ahead(cos(heading), sin(heading)), aside(-sin(heading), cos(heading));
  const Vector2d& drift_W = drift_.velocity_W();
  EscapeTask task;
  task.drift = {drift_W.dot(ahead), drift_W.dot(aside)};
  task.speed = std::max({fix_->v_W.dot(ahead) - task.drift.x(), vehicle_.min_speed, kMinSpeed});
  const double radius = std::max(vehicle_.limits.turning_radius, kMinRadius);
  // Fins turn the vehicle by the water that flows past them; a current from astern that was never crossed is unknown.
  const double flow = std::max({task.speed - config_.unknown_current, vehicle_.min_speed, kMinSpeed});
  task.turn_rate = std::min(std::max(vehicle_.limits.max_yaw_rate.radians(), kMinTurn), flow / radius);
  task.lag_s = kTurnsWithin * radius / flow;
  task.turn_now = fix_->yaw_rate;
  task.horizon_s = config_.escape_s;
  task.room_m = vehicle_.hull_radius_m + config_.collision_margin_m;
  return task;
}

/// Turn from the current heading to the one that is ordered, or that is held while surfacing, rad.
double SafetyOfficer::ordered_turn() const {
  const Angle heading = fix_->navigation.X_WB.rotation.heading();
  const bool surfacing = action_.kind == SafetyActionKind::kSurface;
  const Angle wanted = surfacing ? action_.setpoint.heading : order_ ? order_->heading : heading;
  return (wanted - heading).wrapped().radians();
}

void SafetyOfficer::check_escape(const Pose& X_WL, std::span<const Vector2d> echoes_L) {
  const std::vector<Vector2d> points = known_points(X_WL, echoes_L);
  EscapeTask task = escape_task();
  const EscapeSearch search(points, task);
  const Escape ordered = search.after(ordered_turn(), kLookAhead);
  const bool safe = search.free(ordered) && !imminent_.raised();
  const bool taking = raised(Fault::kCollisionUnavoidable) && turn_;
  if (safe && !taking) return;
  // 1. the escape manoeuvre: the current one as long as it is free
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
  Escape escape = way_out(search);
  for (const double share : kNarrower) {
    if (search.free(escape)) break;
    task.room_m = vehicle_.hull_radius_m + share * config_.collision_margin_m;
    escape = way_out(EscapeSearch(points, task));
  }
  bool free = search.free(escape);
  if (safe && !free) {  // going on as ordered is free
    escape = {0, ordered_turn(), ordered.free_s, ordered.room_m, {}};
    free = true;
  }
  // 2. steer it
  way_out_ = escape;
  const double now = escape.wait_s > 0 ? 0 : std::clamp(escape.turn, -kQuarter, kQuarter);
  turn_ = (heading + Angle::radians(now)).wrapped();
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
