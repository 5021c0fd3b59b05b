#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/agents/goal_selector.hpp>
#include <isobath/mission/messages/reason_text.hpp>
#include <numbers>

namespace isobath {

using Eigen::Vector2d;

namespace {

constexpr double kFreshFix_s = 2, kFreshHazards_s = 10;
constexpr double kReach_m = 5;       ///< nearest approach within which a body counts
constexpr double kCourse = 0.3;      ///< m/s, above which the course over ground counts, not the heading
constexpr double kSlack = 0.05;      ///< m/s between minimum and maximum speed of a planner
constexpr double kOffCourse = 0.5;   ///< rad
constexpr double kCorner_m = 3;      ///< within which a corner of the route is reached
constexpr double kTell_m = 10;       ///< passages that are nearer are told
constexpr double kSpot = 0.5;        ///< m, turning radius of a vehicle that turns on the spot
constexpr double kAstern = -0.3827;  ///< cosine of 112.5 degrees off the course: seen from there on, a body overtakes
constexpr double kPlanStep_s = 1;    ///< between the places of a plan that a decision shows (docs/live-page.md)

/// A body that lies still, with this outline about the mean of its corners. One corner is a disc.
MovingBody body_of(const Polygon& outline_W, int number) {
  MovingBody body;
  body.number = number;
  for (const Vector2d& p : outline_W) body.p_W += p / static_cast<double>(outline_W.size());
  if (outline_W.size() > 1) {
    for (const Vector2d& p : outline_W) body.outline.push_back(p - body.p_W);
  }
  return body;
}

/// The outline of a body that moves includes the uncertainty of its position.
MovingBody body_of(const Obstacle& obstacle, const Detection& map) {
  MovingBody body = body_of(world_outline(obstacle, map.X_WB), obstacle.number);
  body.velocity_W = obstacle.motion.velocity_W;
  body.velocity_covariance = obstacle.motion.velocity_covariance;
  body.time = map.time;
  return body;
}

/// What the rules of the sea ask of the vehicle toward a body.
std::string rule_text(const SteeringDuty& duty) {
  switch (duty.role) {
    case SteeringRole::kHeadOn:
      return fmt::format("obstacle {} is met head-on, the vehicle turns to starboard (rule 14)", duty.number);
    case SteeringRole::kOvertaking:
      return fmt::format("the vehicle overtakes obstacle {} and keeps clear of it (rule 13)", duty.number);
    case SteeringRole::kGiveWay:
      return fmt::format("obstacle {} crosses from starboard, the vehicle gives way (rule 15)", duty.number);
    case SteeringRole::kOvertaken:
      return duty.acts ? fmt::format("the vehicle acts, for obstacle {}, which overtakes it, does not (rule 17 a ii)",
                                     duty.number)
                       : fmt::format("obstacle {} overtakes, the vehicle stands on (rule 17)", duty.number);
    case SteeringRole::kStandOn:
      return duty.acts ? fmt::format("the vehicle acts, for obstacle {} from port does not (rule 17 a ii)", duty.number)
                       : fmt::format("obstacle {} crosses from port, the vehicle stands on (rule 17)", duty.number);
    case SteeringRole::kNone: break;
  }
  return "";
}

MovingBody body_of(const Hazard& hazard) {
  MovingBody body = body_of(hazard.outline, hazard.obstacle);
  body.radius_m = std::max(0.0, hazard.margin_m);
  return body;
}

}  // namespace

std::vector<Field> fields(GoalSelectorConfig& c) {
  std::vector<Field> all = {
      Field::flag("on", &c.on, "Whether motions past moving bodies are planned in time."),
      Field::real("track_m", &c.track_m, {0.05, 100}, "m",
                  "Distance from the plan at which it is made anew from the vehicle's place."),
      Field::real("max_growth_m", &c.max_growth_m, {0, 1000}, "m",
                  "The uncertainty of its velocity lets a body grow by at most this within the horizon."),
      Field::real("turn_reserve", &c.turn_reserve, {1, 10}, "1", "Turning radius of a plan, in that of the vehicle."),
      Field::real("pursued_speed", &c.pursued_speed, {1, 10}, "1",
                  "Speed of a plan while a body comes from astern, in that of the order, as far as the vehicle can."),
      Field::real("pursued_margin_m", &c.pursued_margin_m, {0, 100}, "m",
                  "The margin of such a plan, if it is larger."),
      Field::real("blocked_replan_s", &c.blocked_replan_s, {0.1, 60}, "s",
                  "Time between two searches while there is no free motion."),
  };
  for (Field& field : fields(c.planner)) all.push_back(std::move(field));
  return all;
}

const char* to_text(TrafficSituation situation) {
  switch (situation) {
    case TrafficSituation::kClear: return "clear";
    case TrafficSituation::kCrossing: return "crossing traffic";
    case TrafficSituation::kPursued: return "pursued";
    case TrafficSituation::kBlocked: break;
  }
  return "blocked";
}

GoalSelector::GoalSelector(const GoalSelectorConfig& config, const VehicleParameters& vehicle)
    : config_(config), vehicle_(vehicle) {}

void GoalSelector::on_message(const Message& message, Time now, Outbox&) {
  if (!config_.on) return;
  if (const auto* fix = std::get_if<Navigation>(&message)) {
    if (fix->X_WB.is_finite()) here_ = *fix;
  }
  if (const auto* sweep = std::get_if<Sweep>(&message)) take_bodies(*sweep);
  if (const auto* hazards = std::get_if<StillHazards>(&message)) {
    still_ = Still{now, HazardMap(*hazards->hazards), {}};
    for (const Hazard& hazard : still_->map.hazards()) still_->bodies.push_back(body_of(hazard));
  }
  if (const auto* order = std::get_if<FollowOrder>(&message)) {
    order_ = *order;
    passed_ = 0;
    if (hold_W_) still_.reset();  // on a route the Navigator decides anew who avoids what
    hold_W_.reset();
    if (!order->waypoints.empty()) went_ = order->waypoints.back().speed;
    if (order->waypoints.empty() && !order->surface) begin_hold();
  }
  if (const auto* passed = std::get_if<WaypointPassed>(&message)) {
    if (passed->version == order_.version) passed_ = std::max(passed_, passed->index + 1);
    if (passed_ == order_.waypoints.size() && !order_.surface && !hold_W_) begin_hold();
  }
  if (const auto* action = std::get_if<SafetyAction>(&message)) {
    overruled_ = action->kind != SafetyActionKind::kNone && action->kind != SafetyActionKind::kSlow;
  }
}

void GoalSelector::take_bodies(const Sweep& sweep) {
  if (!sweep.posed) return;
  moving_.clear();
  const bool traffic = std::ranges::any_of(sweep.map->obstacles, &Obstacle::moves);
  for (const Obstacle& obstacle : sweep.map->obstacles) {
    const bool counts = obstacle.moves() || (traffic && obstacle.may_move);
    if (counts && !obstacle.outline.empty()) moving_.push_back(bounded(body_of(obstacle, *sweep.map)));
  }
}

MovingBody GoalSelector::bounded(MovingBody body) const {
  const double growth_m = predicted_growth(body, config_.planner.search.horizon_s, config_.planner.sigmas);
  if (growth_m > config_.max_growth_m) body.velocity_covariance *= std::pow(config_.max_growth_m / growth_m, 2);
  return body;
}

void GoalSelector::begin_hold() {
  if (here_) hold_W_ = here_->X_WB.translation.head<2>();
}

bool GoalSelector::may_steer(Time now) const {
  const bool has_goal = hold_W_ || (!order_.surface && passed_ < order_.waypoints.size());
  return config_.on && !overruled_ && has_goal && here_ && here_->v_WB && to_seconds(now - here_->time) < kFreshFix_s &&
         still_ && to_seconds(now - still_->heard) < kFreshHazards_s;
}

double GoalSelector::ordered_speed() const { return hold_W_ ? went_ : order_.waypoints[passed_].speed; }

bool GoalSelector::in_reach(const MovingBody& body, Time now) const {
  const Vector2d p_W = body.p_W + to_seconds(now - body.time) * body.velocity_W;
  const double own_speed = std::max(speed_, ordered_speed());
  const TrafficConfig& planner = config_.planner;
  const double reach_s =
      planner.rules.on ? std::max(planner.search.horizon_s, planner.rules.risk_s) : planner.search.horizon_s;
  const double nearer_m = (own_speed + body.velocity_W.norm()) * reach_s;
  return (p_W - here_->X_WB.translation.head<2>()).norm() - circumscribed_radius(body) - nearer_m < kReach_m;
}

/// That of the plan while the vehicle follows it, else the vehicle's.
MotionState GoalSelector::own_state(Time now) const {
  const double age_s = to_seconds(now - here_->time);
  const Vector2d v_W = here_->v_WB->head<2>();
  MotionState own;
  own.p_W = here_->X_WB.translation.head<2>() + age_s * v_W;
  own.speed = v_W.norm();
  own.heading = own.speed > kCourse ? std::atan2(v_W.y(), v_W.x()) : here_->X_WB.rotation.heading().radians();
  const Trajectory& plan = planner_->plan().trajectory;
  const double from_s = to_seconds(now - planner_->plan().start);
  if (!plan.segments.empty() && from_s >= 0 && from_s < plan.duration_s()) {
    const MotionState there = plan.at(from_s);
    const double turned = std::abs(std::remainder(own.heading - there.heading, 2 * std::numbers::pi));
    if ((own.p_W - there.p_W).norm() < config_.track_m && turned < kOffCourse) return there;
  }
  own.speed = std::clamp(own.speed, vehicle_.min_speed, speed_);
  return own;
}

std::size_t GoalSelector::waypoint_in_sight() const {
  const Vector2d here = here_->X_WB.translation.head<2>();
  const double room_m = vehicle_.hull_radius_m + config_.planner.margin_m;
  for (std::size_t i = order_.waypoints.size() - 1; i > passed_; --i) {
    if (still_->map.leg_is_clear(here, {order_.waypoints[i].north, order_.waypoints[i].east}, room_m)) return i;
  }
  return passed_;
}

double GoalSelector::turning_radius_m() const {
  return config_.turn_reserve * std::max(vehicle_.limits.turning_radius, kSpot);
}

/// With the parameters of the situation, for a vehicle at most as fast as this.
void GoalSelector::make_planner(double speed) {
  TrafficVehicle v;
  v.radius_m = vehicle_.hull_radius_m;
  v.turning_radius_m = turning_radius_m();
  v.max_turn_rate = vehicle_.limits.max_yaw_rate.radians() / config_.turn_reserve;
  v.min_speed = vehicle_.min_speed;
  v.max_speed = speed;
  v.acceleration = vehicle_.limits.max_acceleration;
  v.braking = vehicle_.braking;
  TrafficConfig rules = config_.planner;
  if (situation_ == TrafficSituation::kPursued) rules.margin_m = std::max(rules.margin_m, config_.pursued_margin_m);
  if (hold_W_) {
    rules.search.clear_s = kHold_s;
    rules.replan_s = kHold_s / 2;  // it is where it shall be: another plan would only be another circle
  }
  if (situation_ == TrafficSituation::kBlocked) rules.replan_s = std::min(rules.replan_s, config_.blocked_replan_s);
  TrafficPlanner planner(rules, v);
  if (planner_) planner.continue_from(*planner_);
  planner_.emplace(std::move(planner));
  planned_for_ = situation_;
  planned_hold_ = hold_W_.has_value();
  speed_ = speed;
}

/// A planner for the speed of the order; its goal is a way-point of the order, or the place that is held.
void GoalSelector::aim() {
  waypoint_ = hold_W_ ? 0 : waypoint_in_sight();
  MotionGoal goal{hold_W_.value_or(Vector2d::Zero()), kCorner_m};
  double wanted = went_;
  if (hold_W_) {
    // Both circles of a vehicle that cannot stop lie within this.
    if (vehicle_.min_speed > 0) goal.radius_m += 2 * turning_radius_m();
  } else {
    const Waypoint& w = order_.waypoints[waypoint_];
    goal.place_W = {w.north, w.east};
    if (waypoint_ + 1 == order_.waypoints.size() && w.radius_m > 0) goal.radius_m = w.radius_m;
    wanted = w.speed;
  }
  if (situation_ == TrafficSituation::kPursued) wanted *= config_.pursued_speed;
  const double speed = std::clamp(wanted, vehicle_.min_speed + kSlack, vehicle_.limits.max_speed);
  // Clear and crossing traffic have the same parameters.
  const bool differs = planned_for_ != situation_ && std::max(planned_for_, situation_) > TrafficSituation::kCrossing;
  if (!planner_ || speed != speed_ || differs || planned_hold_ != hold_W_.has_value()) make_planner(speed);
  if (goal_ == goal) return;
  goal_ = goal;
  planner_->set_goal(goal.place_W, goal.radius_m);
}

/// A body from astern that would come near, both keeping their velocities; null: none does.
const MovingBody* GoalSelector::pursuer(Time now) const {
  const Vector2d v_W = here_->v_WB->head<2>();
  const PlaneMotion own{here_->X_WB.translation.head<2>() + to_seconds(now - here_->time) * v_W, v_W};
  if (!(v_W.norm() > kCourse)) return nullptr;
  for (const MovingBody& body : bodies_) {
    if (config_.planner.rules.on && !(planner_ && planner_->rules().acts_for(body.number))) continue;
    const PlaneMotion there{body.p_W + to_seconds(now - body.time) * body.velocity_W, body.velocity_W};
    const Vector2d to = there.p_W - own.p_W;
    if (to.dot(v_W) > kAstern * to.norm() * v_W.norm()) continue;
    const NearestPass nearest = nearest_pass(own, there);
    if (!(nearest.in_s > 0 && nearest.in_s < config_.planner.search.horizon_s)) continue;
    const double room_m = vehicle_.hull_radius_m + circumscribed_radius(body) + kNear_m;
    if (nearest.distance_m < room_m) return &body;
  }
  return nullptr;
}

/// From the bodies within reach and the last plan.
GoalSelector::Assessment GoalSelector::assess(Time now) const {
  if (bodies_.empty()) return {TrafficSituation::kClear, "no body that moves is within reach"};
  const bool planned = planner_ && situation_ != TrafficSituation::kClear;
  if (planned && !planner_->plan().reason.empty()) return {TrafficSituation::kBlocked, planner_->plan().reason};
  if (const MovingBody* body = pursuer(now)) {
    return {TrafficSituation::kPursued,
            fmt::format("obstacle {} comes from astern at {:.1f} m/s", body->number, body->velocity_W.norm()), body};
  }
  return {TrafficSituation::kCrossing,
          fmt::format("{} that move{} within reach",
                      bodies_.size() == 1 ? "a body" : fmt::format("{} bodies", bodies_.size()),
                      bodies_.size() == 1 ? "s is" : " are")};
}

void GoalSelector::enter(const Assessment& assessment, Time now, Outbox& out) {
  if (assessment.situation >= situation_) situation_held_ = now;
  if (assessment.situation == situation_) return;
  if (assessment.situation < situation_ && to_seconds(now - situation_held_) < kSituation_s) return;
  situation_ = assessment.situation;
  situation_held_ = now;
  Decision d{now, "goal selector", "situation", fmt::format("{}: {}", to_text(situation_), assessment.why)};
  if (assessment.body) {
    d.obstacle = assessment.body->p_W;
    d.obstacle_number = assessment.body->number;
  }
  out.say(std::move(d));
}

void GoalSelector::tick(Time now, Outbox& out) {
  if (!may_steer(now)) return;
  bodies_.clear();
  for (const MovingBody& body : moving_) {
    if (in_reach(body, now)) bodies_.push_back(body);
  }
  enter(assess(now), now, out);
  const bool circles = hold_W_ && vehicle_.min_speed > 0;
  const Vector2d here_W = here_->X_WB.translation.head<2>();
  const double near_m = 4 * turning_radius_m() + kReach_m;
  const auto is_near = [&](const MovingBody& body) {
    return (body.p_W - here_W).norm() - circumscribed_radius(body) < near_m && distance_to(body, here_W, 0) < near_m;
  };
  if (bodies_.empty() && !(circles && std::ranges::any_of(still_->bodies, is_near))) return;
  aim();
  bodies_.insert(bodies_.end(), still_->bodies.begin(), still_->bodies.end());
  const TrafficPlan& plan = planner_->step(own_state(now), now, bodies_);
  if (plan.action == TrafficAction::kRefuse) return;
  const Time at = now + seconds(vehicle_.heading_lag_s);
  const MotionState here = plan.trajectory.at(to_seconds(now - plan.start)),
                    there = plan.trajectory.at(to_seconds(at - plan.start));
  const Vector2d velocity_W = there.speed * Vector2d(std::cos(there.heading), std::sin(there.heading));
  out.say(MotionOrder{order_.version, waypoint_, now, here.p_W, velocity_W, at});
  tell(now, out);
  tell_rules(now, out);
}

void GoalSelector::tell_rules(Time now, Outbox& out) {
  const TrafficPlan& plan = planner_->plan();
  for (const SteeringDuty& duty : plan.duties) {
    if (std::ranges::find(told_duties_, duty) != told_duties_.end()) continue;
    Decision d{now, "goal selector", "rule of the road", rule_text(duty)};
    const auto body = std::ranges::find(moving_, duty.number, &MovingBody::number);
    if (body != moving_.end()) d.obstacle = body->p_W;
    d.obstacle_number = duty.number;
    out.say(std::move(d));
  }
  told_duties_ = plan.duties;
  if (!plan.departs || (told_departure_ && to_seconds(now - *told_departure_) < kTellAgain_s)) return;
  told_departure_ = now;
  out.say(Decision{now, "goal selector", "rule of the road",
                   "no motion keeps clear and follows the rules: the plan departs from them (rule 2 b)"});
}

void GoalSelector::tell(Time now, Outbox& out) {
  const TrafficPlan& plan = planner_->plan();
  if (plan.number == told_plan_) return;
  told_plan_ = plan.number;
  std::erase_if(told_, [&](const auto& one) { return to_seconds(now - one.second) > kTellAgain_s; });
  const MovingBody* nearest = nullptr;
  ClosestApproach approach;
  for (const Passage& passage : planner_->passages(now, kTell_m)) {
    const auto body = std::ranges::find(moving_, passage.number, &MovingBody::number);
    if (body == moving_.end() || (nearest && passage.gap_m >= approach.gap_m)) continue;
    if (planner_->rules().stands_on_for(passage.number)) continue;  // the plan leaves it out
    nearest = &*body;
    approach = {passage.time_s, passage.gap_m};
  }
  if (!nearest || told_.contains(nearest->number)) return;
  told_[nearest->number] = now;
  const Angle course = Angle::radians(std::atan2(nearest->velocity_W.y(), nearest->velocity_W.x())).wrapped_positive();
  Decision d{now, "goal selector", to_text(plan.action), {}};
  d.obstacle = nearest->p_W;
  d.obstacle_number = nearest->number;
  d.approach = approach;
  d.reason =
      fmt::format("{}obstacle {}, which moves at {:.1f} m/s to {:03.0f} deg, comes as near as {:.1f} m in {:.0f} s",
                  plan.reason.empty() ? "" : plan.reason + "; ", nearest->number, nearest->velocity_W.norm(),
                  course.degrees(), std::max(0.0, approach.gap_m), approach.in_s);
  const double shown_s =
      std::min(plan.trajectory.duration_s(), std::max(config_.planner.search.horizon_s, approach.in_s));
  for (double t = 0; t <= shown_s; t += kPlanStep_s) d.way.push_back(plan.trajectory.at(t).p_W);
  out.say(std::move(d));
}

}  // namespace isobath
