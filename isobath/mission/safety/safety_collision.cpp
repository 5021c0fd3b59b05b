// The Safety Officer's collision check, from raw echoes and ranges alone.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/safety/safety_officer.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kFreshFix = 3;     // s
constexpr double kDrifting = 0.05;  // m/s: below it, the direction of travel is noise
constexpr double kTurning = 0.2;    // m/s: below it, the current turn says nothing about the path
constexpr double kStanding = 0.1;   // m/s
constexpr Angle kTurned = Angle::degrees(15);
constexpr double kMinBraking = 0.001;  // m/s2

std::vector<Eigen::Vector2d> along(std::span<const ObstaclePoint> points, double drift) {
  std::vector<Eigen::Vector2d> turned;
  const double c = std::cos(drift), s = std::sin(drift);
  for (const auto& [p, velocity] : points) turned.emplace_back(c * p.x() + s * p.y(), c * p.y() - s * p.x());
  return turned;
}

}  // namespace

double SafetyOfficer::stop_way(double speed, double delay_s) const {
  const double v = std::max(0.0, speed);
  return v * delay_s + v * v / (2 * std::max(vehicle_.braking, kMinBraking));
}

SafetyOfficer::Travel SafetyOfficer::travel() const {
  Travel t;
  const double heading = fix_->navigation.X_WB.rotation.heading().radians();
  t.speed = fix_->v_W.norm();
  if (t.speed > kDrifting)
    t.drift = std::remainder(std::atan2(fix_->v_W.y(), fix_->v_W.x()) - heading, 2 * std::numbers::pi);
  if (t.speed > kTurning) {
    const double tightest = 1 / std::max(vehicle_.limits.turning_radius, kMinRadius);
    t.curvature = std::clamp(fix_->yaw_rate / t.speed, -tightest, tightest);
  }
  t.half_width_m = std::abs(std::cos(t.drift)) * vehicle_.half_width_m +
                   std::abs(std::sin(t.drift)) * vehicle_.hull_radius_m + config_.side_margin_m;
  return t;
}

/// Whether the water at this place and depth was measured to be clear: an echo there then comes from above or below.
bool SafetyOfficer::passes_by(const Eigen::Vector3d& p_W) const {
  return space_ && space_->is_measured(p_W, config_.height_margin_m);
}

/// The echo where it is now: it moves with the body in whose place it was when it came.
ObstaclePoint SafetyOfficer::where_now(const NearEcho& echo, const Pose& X_WL) const {
  const Eigen::Vector2d place_W = (X_WL * Eigen::Vector3d(echo.place.x(), echo.place.y(), 0)).head<2>();
  for (const Mover& mover : movers_) {
    const double before_s = clock_s_ - echo.age_s - mover.seen_s;  // the sweep
    const Eigen::Vector2d then_W = place_W - before_s * mover.velocity_W;
    if ((nearest_point(mover.outline_W, then_W) - then_W).norm() > config_.confirm_m) continue;
    const Eigen::Vector3d way_W(mover.velocity_W.x(), mover.velocity_W.y(), 0);
    const Eigen::Vector2d velocity = (X_WL.rotation.inverse() * way_W).head<2>();
    return {echo.place + echo.age_s * velocity, velocity};
  }
  return {echo.place};
}

/// All confirmed echoes at the vehicle's depth, in its frame. A moving body has left the place of its older echoes.
/// They do not come back when it stops or turns, and is no longer known to move.
std::vector<ObstaclePoint> SafetyOfficer::confirmed_echoes(const Pose& X_WL) {
  constexpr double kMoverLasts_s = 5, kMoverEchoes_s = 1;
  std::erase_if(movers_, [&](const Mover& mover) { return clock_s_ - mover.seen_s > kMoverLasts_s; });
  std::vector<ObstaclePoint> left;
  for (const NearEcho& echo : echoes_.confirmed(X_WL, blanking_m_, config_, clock_s_)) {
    if (passes_by(X_WL * Eigen::Vector3d(echo.place.x(), echo.place.y(), 0))) continue;
    const ObstaclePoint now = where_now(echo, X_WL);
    const bool moves = !now.velocity.isZero();
    if (moves && echo.age_s > kMoverEchoes_s) {
      echoes_.remove(echo);
    } else {
      left.push_back(now);
    }
  }
  return left;
}

/// The columns of voxels that are occupied at the vehicle's depth, in its frame.
std::vector<ObstaclePoint> SafetyOfficer::solid_points(const Pose& X_WL) const {
  std::vector<ObstaclePoint> points;
  const Pose X_LW = X_WL.inverse();
  for (const Eigen::Vector2d& p : solid_W_)
    points.push_back({(X_LW * Eigen::Vector3d(p.x(), p.y(), X_WL.translation.z())).head<2>()});
  return points;
}

void SafetyOfficer::check_collision() {
  const bool was = raised(Fault::kCollisionAhead) || raised(Fault::kCollisionUnavoidable);
  if (!was) stopped_ = false;
  const bool fresh = fix_ && clock_s_ - fix_->heard_s <= kFreshFix;
  if (!fresh) circle_ = 0;
  if (!watching() || !fresh) return;
  Pose X_WL = level(fix_->navigation.X_WB);
  X_WL.translation.head<2>() += fix_->v_W * (clock_s_ - fix_->heard_s);
  Travel t = travel();
  stopped_ = stopped_ || (raised(Fault::kCollisionAhead) && t.speed < kStanding);
  double speed = t.speed;
  if (stopped_) {  // is the path along its heading free?
    t.curvature = 0;
    t.drift = 0;
    speed = std::max(speed, order_ ? order_->speed : 0);
  }
  const std::vector<ObstaclePoint> echoes = confirmed_echoes(X_WL);
  if (vehicle_.min_speed > 0) {
    const std::vector<ObstaclePoint> known = known_points(X_WL, echoes), fence = fence_points(X_WL);
    std::vector<ObstaclePoint> all = fence;
    all.insert(all.end(), known.begin(), known.end());
    check_fence(X_WL, fence, all);
    choose_circle(X_WL, all);
    return check_escape(X_WL, known);
  }
  auto points = along(echoes, t.drift);
  const double reach = stop_way(speed, config_.reaction_s) + config_.collision_margin_m;
  const auto free = [&](std::span<const Eigen::Vector2d> of) {
    return free_way(of, t.curvature, t.half_width_m, vehicle_.hull_radius_m, reach);
  };
  const auto voxels = along(solid_points(X_WL), t.drift);
  const double by_echoes = free(points), way = std::min(by_echoes, free(voxels));
  if (!std::isfinite(way) && !imminent_.raised()) return;
  points.insert(points.end(), voxels.begin(), voxels.end());
  const double least = stop_way(t.speed, to_seconds(kTick));
  const std::string where = !std::isfinite(way) ? "short ranges ahead"
                            : way < by_echoes   ? fmt::format("an occupied voxel {:.1f} m ahead", way)
                                                : fmt::format("an echo {:.1f} m ahead", way);
  if (!stopped_ && way < least) {
    const Angle heading = fix_->navigation.X_WB.rotation.heading();
    const bool turned = turn_ && abs((*turn_ - heading).wrapped()) < kTurned;  // an obstacle stands there, too
    if (!raised(Fault::kCollisionUnavoidable) || turned) choose_turn(points, t);
    const char* side = hemmed_in_                                   ? "neither side is free"
                       : (*turn_ - heading).wrapped().radians() > 0 ? "starboard is freer"
                                                                    : "port is freer";
    find(Fault::kCollisionUnavoidable,
         fmt::format("{} at {:.1f} m/s, {:.1f} m needed to stop; {}", where, t.speed, least, side));
    row(Fault::kCollisionUnavoidable).margin_m = std::isfinite(way) ? std::optional(way - least) : std::nullopt;
    return;
  }
  find(Fault::kCollisionAhead, fmt::format("{} at {:.1f} m/s, {:.1f} m wanted to stop", where, t.speed, reach));
  Row& ahead = row(Fault::kCollisionAhead);
  ahead.margin_m = std::isfinite(way) ? std::optional(way - least) : std::nullopt;
  if (std::isfinite(way)) {
    const double bearing = t.drift;
    const double far = way + vehicle_.hull_radius_m;
    ahead.place = (X_WL * Eigen::Vector3d(far * std::cos(bearing), far * std::sin(bearing), 0)).head<2>();
  }
}

void SafetyOfficer::choose_turn(std::span<const Eigen::Vector2d> points, const Travel& t) {
  const double yaw_rate = std::max(vehicle_.limits.max_yaw_rate.radians(), 0.01);
  const double radius = std::max({vehicle_.limits.turning_radius, t.speed / yaw_rate, kMinRadius});
  const double reach = radius * std::numbers::pi / 2 + config_.collision_margin_m;
  const auto free = [&](double curvature) {
    return free_way(points, curvature, t.half_width_m, vehicle_.hull_radius_m, reach);
  };
  const double port = free(-1 / radius), starboard = free(1 / radius);
  hemmed_in_ = std::isfinite(port) && std::isfinite(starboard);  // then the side on which the hull gets farther
  double beside = 0;                                             // side of the path on which the nearest echo stands
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& p : points) {
    if (p.x() > 0 && p.norm() < nearest) {
      nearest = p.norm();
      beside = p.y();
    }
  }
  const bool to_starboard = port == starboard ? beside <= 0 : starboard > port;
  const Angle course = fix_->navigation.X_WB.rotation.heading() + Angle::radians(t.drift);
  turn_ = (course + Angle::degrees(to_starboard ? 90 : -90)).wrapped();
}

}  // namespace isobath
