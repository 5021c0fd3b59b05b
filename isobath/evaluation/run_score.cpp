#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/evaluation/run_score.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

Vector2d place_of(const TrueMotion& motion) { return motion.state.X_WB.translation.head<2>(); }

struct Arrival {
  bool reached = false;
  std::size_t sample = 0;
  double nearest_m = 0;
};

/// Checks the mission points in their order. As many may be left out as the vehicle reported dropped.
Arrival arrival(const std::vector<TrueMotion>& track, const MissionPlan& mission, std::size_t dropped, double within) {
  Arrival arrival;
  const std::size_t points = mission.points.size();
  if (track.empty() || points == 0) return arrival;
  const Vector2d goal = mission.points.back().north_east;
  arrival.nearest_m = (place_of(track.front()) - goal).norm();
  std::size_t next = 0;
  for (std::size_t i = 0; i < track.size(); ++i) {
    const Vector2d p = place_of(track[i]);
    arrival.nearest_m = std::min(arrival.nearest_m, (p - goal).norm());
    for (std::size_t j = next; j < points && j - next <= dropped; ++j) {
      if ((p - mission.points[j].north_east).norm() > within) continue;
      dropped -= j - next;
      next = j + 1;
    }
    if (next < points) continue;
    arrival.reached = true;
    arrival.sample = i;
    return arrival;
  }
  return arrival;
}

double path_length(const std::vector<TrueMotion>& track, std::size_t last) {
  double length = 0;
  for (std::size_t i = 1; i <= last && i < track.size(); ++i)
    length += (place_of(track[i]) - place_of(track[i - 1])).norm();
  return length;
}

/// The first verdict on each opening counts, and of several openings the last that has one.
void judge_openings(const std::vector<Decision>& decisions, RunScore& score) {
  bool judged = false;
  for (const Decision& d : decisions) {
    if (!d.opening) continue;
    if (d.what == "opening") judged = false;
    const bool known = d.what == "opening known";
    if (judged || (!known && d.what != "opening unknown")) continue;
    judged = true;
    score.opening_share = d.opening->free_share;
    score.opening_known_m = known ? d.opening->distance_m : -1;
  }
}

void judge_decisions(const std::vector<Decision>& decisions, const RunTruth& truth, double near_m, RunScore& score) {
  for (const Decision& d : decisions) {
    score.safety_actions += is_safety_action(d);
    if (d.what != "replan") continue;
    ++score.replans;
    if (d.obstacle && !truth.is_near_body(*d.obstacle, to_seconds(d.time), near_m)) ++score.false_replans;
  }
}

/// The reason of the last decision that refused, dropped or aborted something; else that of the mission report.
std::string refusal_of(const LoopResult& result) {
  for (auto d = result.decisions.rbegin(); d != result.decisions.rend(); ++d) {
    if (d->what == "refuse" || d->what == "drop point" || d->what == "abort") return d->reason;
  }
  return result.report.why;
}

}  // namespace

void add_clearance(const TrackTruth& truth, double scale, RunScore& s) {
  if (truth.contact_s >= 0 && (s.contact_s < 0 || truth.contact_s < s.contact_s)) {
    s.contact_s = truth.contact_s;
    s.contact_with = truth.contact_with;
  }
  if (std::isfinite(truth.min_clearance_m) && (s.nearest_body.empty() || truth.min_clearance_m < s.min_clearance_m)) {
    s.min_clearance_m = truth.min_clearance_m;
    s.nearest_body = truth.nearest_body;
  }
  s.collision = s.collision || truth.contact_s >= 0 || truth.min_clearance_m < kCollision_m * scale;
  s.near_miss = s.near_miss || s.collision || truth.min_clearance_m < kNearMiss_m * scale;
  s.encounter = s.encounter || s.near_miss || truth.min_clearance_m < kEncounter_m * scale;
}

bool is_safety_action(const Decision& d) {
  return d.agent == "safety officer" && d.what != "over" && d.what != "report" && d.what != "resume";
}

RunTruth::RunTruth(const Suite& suite, const SuiteRun& run) {
  const Simulator simulator(run.scenario.scene, {}, 1);
  const VehicleModel& vehicle = simulator.vehicle();
  vehicle_ = parameters_of(vehicle);
  hull_length_ = vehicle.length;
  const double reach = vehicle.height / 2 + kAboveAndBelow_m;
  double high = run.scenario.scene.vehicle.start.z(), low = high;
  for (const MissionPoint& p : run.scenario.mission.points) {
    if (p.altitude_m) continue;
    high = std::min(high, p.depth_m);
    low = std::max(low, p.depth_m);
  }
  for (const WorldBody& body : simulator.world().bodies()) {
    if (body.moves) {  // the planner with full truth plans among what lies still
      moving_.push_back({*body.body, body.plan});
      continue;
    }
    if (body.box.max().z() < high - reach || body.box.min().z() > low + reach) continue;
    for (const Polygon& part : body.plan) outlines_.push_back({part, 0, HazardKind::kCharted, 0});
  }
  plan(suite, run);
}

bool RunTruth::is_near_body(const Vector2d& p_W, double time_s, double within_m) const {
  const auto is_near = [&](const Polygon& outline, const Vector2d& p) { return distance_from(outline, p) <= within_m; };
  if (std::any_of(outlines_.begin(), outlines_.end(), [&](const Hazard& h) { return is_near(h.outline, p_W); }))
    return true;
  return std::any_of(moving_.begin(), moving_.end(), [&](const Moving& m) {
    const Vector2d p = p_W - displacement(m.body, time_s).head<2>();
    return std::any_of(m.plan.begin(), m.plan.end(), [&](const Polygon& outline) { return is_near(outline, p); });
  });
}

void RunTruth::plan(const Suite& suite, const SuiteRun& run) {
  const HazardMap map(outlines_);
  RouteConfig config;
  config.cell_m = suite.about.planner_cell_m;
  config.clearance_m = suite.about.clearance_m;
  config.wished_clearance_m = suite.about.clearance_m;  // the shortest route, not the one with most clearance
  config.room_weight = 0;
  RouteTask task;
  const VehicleConfig& from = run.scenario.scene.vehicle;
  task.start = from.start.head<2>();
  task.heading = from.heading.radians();
  task.half_width_m = vehicle_.half_width_m;
  task.turning_radius_m = vehicle_.limits.turning_radius;
  way_ = {task.start};
  for (const MissionPoint& point : run.scenario.mission.points) {
    task.goal = point.north_east;
    const auto route = plan_route(map, task, config);
    if (!route) {
      no_way_ = fmt::format("to {}: {}", point.name, to_text(route.error()));
      way_.clear();
      way_m_ = 0;
      return;
    }
    way_m_ += route->length_m;
    way_.insert(way_.end(), route->points.begin() + 1, route->points.end());
    task.start = point.north_east;
    task.heading.reset();
  }
}

RunScore score(const LoopResult& result, const MissionPlan& mission, const RunTruth& truth, const SuiteConfig& suite) {
  RunScore s;
  add_clearance(result, truth.hull_length() / kReferenceHull_m, s);

  const Arrival end = arrival(result.track, mission, result.report.dropped, suite.goal_m);
  s.goal_reached = end.reached;
  s.goal_distance_m = end.nearest_m;
  s.points_dropped = static_cast<int>(result.report.dropped);
  s.duration_s = result.duration_s;
  const bool ended = result.report.phase == MissionPhase::kAborted || result.report.phase == MissionPhase::kFinished ||
                     result.report.dropped > 0;
  if (!s.goal_reached && !s.collision && ended) s.refused = refusal_of(result);
  const std::size_t last = end.reached ? end.sample : result.track.size();
  s.path_m = path_length(result.track, last);
  if (end.reached) {
    s.goal_s = to_seconds(result.track[end.sample].time);
    const double rest = (place_of(result.track[end.sample]) - mission.points.back().north_east).norm();
    if (truth.way_m() > 0 && s.points_dropped == 0) {
      s.path_ratio = (s.path_m + rest) / truth.way_m();
      const double speed = mission.points.back().speed > 0 ? mission.points.back().speed : mission.speed;
      s.time_ratio = (s.goal_s + rest / speed) * speed / truth.way_m();
    }
  }

  for (const BodyScore& body : result.sight.bodies) {
    if (body.scans_found == 0) {
      ++s.bodies_missed;
      continue;
    }
    s.delay_pings.push_back(body.delay_pings);
    s.first_range_m.push_back(body.first_range_m);
    if (body.compact) s.range_error_m.push_back(body.range_error_rms_m);
  }
  s.scans = result.sight.scans;
  s.false_obstacles = result.sight.false_obstacles;
  s.near_false_obstacles = result.sight.near_false_obstacles;
  s.unseen_false_obstacles = result.sight.unseen_false_obstacles;
  const MotionScore& motion = result.sight.motion;
  s.moving_bodies = motion.bodies;
  s.moving_known = motion.known;
  if (motion.known > 0) s.moving_known_s = motion.known_after_s;
  if (motion.scans > 0) s.ospa_m = motion.ospa_m;
  if (motion.known > 0) s.velocity_rms = motion.velocity_rms;
  judge_decisions(result.decisions, truth, suite.near_body_m, s);
  judge_openings(result.decisions, s);
  return s;
}

}  // namespace isobath
