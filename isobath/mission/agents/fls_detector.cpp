#include <algorithm>
#include <fmt/format.h>
#include <isobath/mission/agents/fls_detector.hpp>
#include <isobath/mission/agents/way_keeping.hpp>
#include <isobath/mission/messages/reason_text.hpp>

namespace isobath {

namespace {

constexpr double kMovingExistence = 0.3;

/// The outline in L with what the obstacle crosses from now on.
Polygon outline_ahead(const Obstacle& obstacle, const Pose& X_WL, double ahead_s) {
  if (!obstacle.moves()) return obstacle.outline;
  const Eigen::Vector3d way_W(obstacle.motion.velocity_W.x(), obstacle.motion.velocity_W.y(), 0);
  const Eigen::Vector2d way = ahead_s * (X_WL.rotation.inverse() * way_W).head<2>();
  Polygon corners = obstacle.outline;
  for (const Eigen::Vector2d& p : obstacle.outline) corners.push_back(p + way);
  return convex_hull(std::move(corners));
}

}  // namespace

std::vector<Field> fields(FlsDetectorConfig& c) {
  return {
      Field::real("min_existence", &c.min_existence, {0, 1}, "1", "Obstacles less probable than this are left out.")
          .was("least_existence"),
      Field::real("margin_cells", &c.margin_cells, {0, 10}, "cells",
                  "How far an obstacle may reach beyond its outline, in cells of the grid."),
      Field::real("memory_radius_m", &c.memory_radius_m, {0, 1e5}, "m",
                  "How far from the vehicle obstacles of earlier sweeps are recalled."),
      Field::real("moving_ahead_s", &c.moving_ahead_s, {0, 60}, "s",
                  "A moving obstacle counts with the water that it crosses in this time."),
  };
}

void FlsDetector::on_message(const Message& message, Time now, Outbox& out) {
  if (const auto* fix = std::get_if<Navigation>(&message)) {
    if (fix->X_WB.is_finite()) here_ = *fix;
  }
  if (const auto* sweep = std::get_if<Sweep>(&message)) on(*sweep, out);
  if (const auto* told = std::get_if<GroupObstacles>(&message)) on(*told, now, out);
  if (const auto* order = std::get_if<MissionOrder>(&message)) {
    if (order->kind == MissionOrder::Kind::kStart && order->plan) start(*order->plan, now);
  }
}

void FlsDetector::tick(Time now, Outbox& out) {
  while (!due_.empty() && due_.front().at <= now && here_) {
    const Due map = std::move(due_.front());
    due_.erase(due_.begin());
    injected_.insert(injected_.end(), map.outlines.begin(), map.outlines.end());
    say_scan(map.at, level(here_->X_WB), true, out);
  }
}

void FlsDetector::on(const Sweep& sweep, Outbox& out) {
  const Detection& map = *sweep.map;
  X_WL_seen_ = level(map.X_WB);
  seen_.clear();
  const bool traffic = std::ranges::any_of(map.obstacles, &Obstacle::moves);
  for (const Obstacle& o : map.obstacles) {
    // The echoes of a moving obstacle reach no map: it counts until its track is improbable.
    if (o.existence < (o.moves() ? kMovingExistence : config_.min_existence) || o.outline.empty()) continue;
    seen_.push_back({outline_ahead(o, X_WL_seen_, config_.moving_ahead_s), config_.margin_cells * map.cells.cell_m,
                     o.moves() || (traffic && o.may_move) ? HazardKind::kMoving : HazardKind::kSeen,
                     static_cast<std::uint32_t>(seen_.size()), o.number});
  }
  if (sweep.posed) remember(sweep);
  say_scan(map.time, X_WL_seen_, sweep.posed, out);
}

void FlsDetector::on(const GroupObstacles& told, Time now, Outbox& out) {
  for (const ToldObstacle& o : told.obstacles) {
    if (!memory_.tell(o, now)) continue;
    const auto teller = static_cast<std::size_t>(o.teller);
    Decision d{now, "fls detector", "obstacle told",
               fmt::format("{} has seen an obstacle at {}, {:.1f} m across, which this vehicle has not seen",
                           teller < group_.size() ? group_[teller] : "a vehicle of the group", text_of(o.centre_W),
                           2 * o.radius_m)};
    d.obstacle = o.centre_W;
    out.say(std::move(d));
  }
}

void FlsDetector::start(const MissionPlan& plan, Time now) {
  due_.clear();
  injected_.clear();
  group_.clear();
  for (const GroupMember& member : plan.group) group_.push_back(member.name);
  for (const InjectedMap& map : plan.injected) due_.push_back({now + seconds(map.at_s), map.outlines});
  std::stable_sort(due_.begin(), due_.end(), [](const Due& a, const Due& b) { return a.at < b.at; });
}

void FlsDetector::remember(const Sweep& sweep) {
  const Detection& map = *sweep.map;
  MemorySweep seen;
  seen.time = map.time;
  seen.X_WL = X_WL_seen_;
  if (sweep.sigma_m > 0) seen.sigma_m = sweep.sigma_m;
  seen.jumped = sweep.jumped;
  seen.obstacles = map.obstacles;
  seen.water = {map.cells, map.position, map.heading, map.free};
  if (memory_.add(seen)) taken_in_ = sweep.number;
}

void FlsDetector::say_scan(Time time, const Pose& X_WL, bool posed, Outbox& out) {
  ObstacleScan scan{++number_, time, X_WL, posed, seen_, nullptr};
  const PlanFrame seen = PlanFrame::of(X_WL_seen_);
  const PlanFrame frame = PlanFrame::of(X_WL);
  const bool moved = seen.p_WP != frame.p_WP || seen.heading != frame.heading;
  if (moved) {
    for (Hazard& h : scan.hazards) {
      for (Eigen::Vector2d& p : h.outline) p = frame.to_local(seen.to_world(p));
    }
  }
  if (posed) {
    KnownObstacles known{taken_in_, memory_.known(frame.p_WP, config_.memory_radius_m), {}};
    known.seen_as.assign(memory_.seen_as().begin(), memory_.seen_as().end());
    for (const RememberedObstacle& o : known.obstacles) {
      if (o.whole) continue;
      scan.hazards.push_back({to_local(frame, o.outline_W), o.margin_m, HazardKind::kRemembered, o.id, o.number});
    }
    scan.known = std::make_shared<const KnownObstacles>(std::move(known));
    for (std::size_t i = 0; i < injected_.size(); ++i) {
      scan.hazards.push_back({to_local(frame, injected_[i]), 0, HazardKind::kInjected, static_cast<std::uint32_t>(i)});
    }
  }
  out.say(std::move(scan));
}

}  // namespace isobath
