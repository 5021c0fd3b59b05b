#include <algorithm>
#include <cmath>
#include <isobath/mission/agents/pilot.hpp>
#include <utility>

namespace isobath {

using Eigen::Vector2d;

std::vector<Field> fields(PilotConfig& c) {
  return {
      Field::real("point_radius", &c.point_radius, {0.1, 1000}, "m",
                  "Distance within which a mission point is reached."),
      Field::real("hold_speed", &c.hold_speed, {0.01, 10}, "m/s", "Maximum speed for holding a position."),
      Field::real("silent_s", &c.silent_s, {0.1, 3600}, "s", "Without navigation for this long the vehicle stops."),
      Field::real("motion_s", &c.motion_s, {0.1, 60}, "s",
                  "Time in which an error of place is made good on a motion past bodies that move."),
  };
}

Pilot::Pilot(const PilotConfig& config, const GuidanceConfig& guidance, const StationConfig& station,
             const DepthKeeperConfig& depth, const VehicleParameters& vehicle, const TimingTable& timing)
    : config_(config),
      guidance_(guidance),
      depth_config_(depth),
      vehicle_(vehicle),
      station_(station, vehicle),
      depth_(depth, vehicle),
      plans_(CommandLevel::kPrimitive, timing.of(CommandLevel::kPrimitive).replan_s) {}

void Pilot::on_message(const Message& message, Time, Outbox&) {
  if (const auto* order = std::get_if<FollowOrder>(&message)) on(*order);
  if (const auto* reading = std::get_if<RangeReading>(&message)) on(*reading);
  if (const auto* motion = std::get_if<MotionOrder>(&message)) {
    const bool may_move = task_ == Task::kFollow || task_ == Task::kHold;
    if (may_move && motion->version == order_.version && motion->place_W.allFinite()) motion_ = *motion;
  }
  if (const auto* fix = std::get_if<Navigation>(&message)) {
    if (fix->X_WB.is_finite()) here_ = *fix;
  }
  if (const auto* order = std::get_if<MissionOrder>(&message)) {
    if (order->kind == MissionOrder::Kind::kStart && order->plan) take_limits(order->plan->limits);
  }
  if (const auto* lost = std::get_if<AgentLost>(&message)) {
    if (lost->agent == "executive officer") on(FollowOrder{0, {}, {}, true});
  }
}

void Pilot::tick(Time now, Outbox& out) {
  const double dt = last_tick_ ? to_seconds(now - *last_tick_) : 0.1;
  last_tick_ = now;
  if (!here_ || dt <= 0) return;
  plans_.note(now, horizon_s(), false, out);
  if (to_seconds(now - here_->time) > config_.silent_s || task_ == Task::kNone) {
    out.say(HelmOrder{at_rest()});
    return;
  }
  rest_.reset();
  if (here_->v_WB) drift_.update(here_->X_WB.rotation.heading(), *here_->v_WB, guidance_.drift_time, dt);
  const Setpoint wanted = task_ == Task::kFollow ? follow(dt, now, out) : hold(dt, now);
  out.say(HelmOrder{task_ == Task::kSurface ? wanted : at_its_depth(wanted, now)});
}

void Pilot::on(const FollowOrder& order) {
  order_ = order;
  told_ = first_ = 0;
  if (motion_) motion_->waypoint = 0;  // the last motion holds until the next one is ordered
  if (order.waypoints.empty() || order.surface) return hold_where_it_stops();
  task_ = Task::kFollow;
  went_ = order.waypoints.back().speed;
  if (line_of_sight_) {
    line_of_sight_->follow(order.waypoints);
  } else {
    line_of_sight_.emplace(guidance_, order.waypoints, vehicle_);
  }
  line_of_sight_->go_on_to(order.then_W);
}

/// Along the way-points that are left, and on to the next point.
double Pilot::horizon_s() const {
  if (task_ != Task::kFollow) return 0;
  Vector2d last = here_->X_WB.translation.head<2>();
  double time_s = 0;
  for (std::size_t i = told_; i < order_.waypoints.size(); ++i) {
    const Waypoint& w = order_.waypoints[i];
    time_s += (Vector2d(w.north, w.east) - last).norm() / std::max(w.speed, 0.01);
    last = {w.north, w.east};
  }
  if (order_.then_W) time_s += (*order_.then_W - last).norm() / std::max(order_.waypoints.back().speed, 0.01);
  return time_s;
}

void Pilot::on(const RangeReading& reading) {
  if (!here_) return;
  depth_.on_altimeter({reading.time, reading.range_m, reading.max_range_m, reading.width, reading.X_BS}, here_->X_WB);
}

void Pilot::take_limits(const MissionLimits& limits) {
  depth_config_.min_depth = limits.min_depth_m;
  depth_config_.max_depth = limits.max_depth_m;
  depth_config_.min_altitude = limits.min_altitude_m;
  depth_ = DepthKeeper(depth_config_, vehicle_);
}

// Holds where the vehicle comes to rest under full braking: to hold the place of the order it would have to turn back.
// A vehicle that cannot stop is on its circle at once: with the place of the order in the middle, it would first go
// straight on, maybe into water that no sonar has seen.
void Pilot::hold_where_it_stops() {
  task_ = order_.surface ? Task::kSurface : Task::kHold;
  if (!here_) return;
  Vector2d place = here_->X_WB.translation.head<2>();
  const bool can_stop = vehicle_.min_speed <= 0 && vehicle_.braking > 0;
  if (here_->v_WB && can_stop) {
    const Vector2d v = here_->v_WB->head<2>();
    place += v * (v.norm() / (2 * vehicle_.braking));
  }
  const double depth = order_.surface ? 0 : here_->X_WB.translation.z();
  const Angle heading = here_->X_WB.rotation.heading();
  place += station_.radius(hold_speed()) * Vector2d(-sin(heading), cos(heading));
  station_.hold({place.x(), place.y(), depth, hold_speed()});
}

/// A vehicle that cannot hover circles as fast as it went: fins need flow to steer.
double Pilot::hold_speed() const {
  return vehicle_.min_speed > 0 ? std::max({config_.hold_speed, vehicle_.min_speed, went_}) : config_.hold_speed;
}

bool Pilot::is_steered(Time now) const { return motion_ && now - motion_->time <= MotionOrder::kLasts; }

/// The vehicle leaves its place for a motion past bodies that move, and comes back afterwards.
Setpoint Pilot::hold(double dt, Time now) {
  if (task_ == Task::kSurface || !is_steered(now)) return station_.step(here_->X_WB, here_->v_WB, dt);
  return along_motion(station_.place().depth, std::max(went_, hold_speed()), now);
}

Setpoint Pilot::follow(double dt, Time now, Outbox& out) {
  if (is_steered(now)) return follow_motion(now, out);
  if (std::exchange(motion_, std::nullopt)) {
    first_ = told_;
    line_of_sight_->follow({order_.waypoints.begin() + static_cast<std::ptrdiff_t>(first_), order_.waypoints.end()});
    line_of_sight_->go_on_to(order_.then_W);
  }
  const Setpoint wanted = line_of_sight_->step(here_->X_WB, here_->v_WB, dt);
  report(out);
  if (task_ == Task::kFollow) return wanted;
  return station_.step(here_->X_WB, here_->v_WB, dt);
}

// The velocity of the motion, as it will be when the heading has followed, and back to its place, with the present
// drift. A vehicle that is ahead of the motion slows down.
Setpoint Pilot::along_motion(double depth, double max_speed, Time now) const {
  constexpr double kStanding = 0.1;
  const Vector2d here = here_->X_WB.translation.head<2>();
  const Angle heading = here_->X_WB.rotation.heading();
  Setpoint wanted{heading, depth, vehicle_.min_speed, 0};
  const Vector2d place = motion_->place_W + to_seconds(now - motion_->time) * motion_->velocity_W;
  const Vector2d v_W = motion_->velocity_W + (place - here) / config_.motion_s;
  if (v_W.norm() > kStanding && v_W.dot(Vector2d(cos(heading), sin(heading))) > -kStanding) {
    wanted.speed = std::clamp(v_W.norm(), vehicle_.min_speed, std::max(max_speed, vehicle_.min_speed));
    wanted.heading = (Angle::radians(std::atan2(v_W.y(), v_W.x())) - drift_.crab(heading, wanted.speed)).wrapped();
  }
  return wanted;
}

Setpoint Pilot::follow_motion(Time now, Outbox& out) {
  const std::vector<Waypoint>& all = order_.waypoints;
  const std::size_t last = all.size() - 1;
  const auto place_of = [](const Waypoint& w) { return Vector2d(w.north, w.east); };
  const Vector2d here = here_->X_WB.translation.head<2>();
  while (told_ < last) {
    const Vector2d corner = place_of(all[told_]), next = place_of(all[told_ + 1]);
    const bool reached = distance_to(all[told_]) <= guidance_.acceptance_radius;
    if (!reached && told_ >= motion_->waypoint && (here - corner).dot(next - corner) <= 0) break;
    pass(reached, out);
  }
  const Waypoint& goal = all[told_];
  const Setpoint wanted = along_motion(goal.depth, goal.speed, now);
  if (told_ == last && distance_to(goal) <= radius_of(goal)) pass(true, out);
  return wanted;
}

void Pilot::report(Outbox& out) {
  const std::vector<Waypoint>& all = order_.waypoints;
  const std::size_t last = all.size() - 1, next = first_ + line_of_sight_->next();
  while (told_ < std::min(next, last)) pass(distance_to(all[told_]) <= guidance_.acceptance_radius, out);
  if (next < last) return;
  const bool reached = distance_to(all.back()) <= radius_of(all.back());
  if (reached || line_of_sight_->finished()) pass(reached, out);
}

/// The way-point ahead lies behind from now on.
void Pilot::pass(bool reached, Outbox& out) {
  const bool last = told_ + 1 == order_.waypoints.size();
  out.say(WaypointPassed{order_.version, told_, reached, last});
  if (!last) {
    ++told_;
    return;
  }
  Waypoint place = order_.waypoints.back();
  place.speed = hold_speed();
  station_.hold(place);
  task_ = Task::kHold;
}

double Pilot::radius_of(const Waypoint& last) const { return last.radius_m > 0 ? last.radius_m : config_.point_radius; }

double Pilot::distance_to(const Waypoint& place) const {
  return (Vector2d(place.north, place.east) - here_->X_WB.translation.head<2>()).norm();
}

// Heading and depth of the instant when it came to rest: to follow each new estimate would turn it with the errors.
Setpoint Pilot::at_rest() {
  if (!rest_) rest_ = Setpoint{here_->X_WB.rotation.heading(), here_->X_WB.translation.z(), vehicle_.min_speed, 0};
  return *rest_;
}

Setpoint Pilot::at_its_depth(Setpoint wanted, Time now) {
  const Eigen::Vector3d v_W = here_->v_WB.value_or(Eigen::Vector3d::Zero());
  const DepthOrder order = depth_.step({wanted.depth, order_.altitude_m}, here_->X_WB, v_W, now);
  wanted.depth = order.depth;
  wanted.speed = std::max(std::min(wanted.speed, order.max_speed), vehicle_.min_speed);
  return wanted;
}

}  // namespace isobath
