#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/deviation.hpp>
#include <isobath/geometry/segment.hpp>
#include <isobath/mission/agents/navigator.hpp>
#include <isobath/mission/agents/way_keeping.hpp>
#include <isobath/mission/messages/reason_text.hpp>
#include <isobath/mission/plan/planner_budget.hpp>
#include <isobath/planning/turning.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr Duration kSpaceInterval = std::chrono::milliseconds(450);  // every scan of a sonar that pings twice a second

Vector2d place_of(const Navigation& fix) { return fix.X_WB.translation.head<2>(); }

bool takes_over(SafetyActionKind kind) { return kind != SafetyActionKind::kNone && kind != SafetyActionKind::kSlow; }

double sigma_of(const Navigation& fix) {
  if (!fix.covariance) return 0;
  return greatest_deviation(fix.covariance->topLeftCorner<2, 2>());
}

}  // namespace

Navigator::Navigator(const NavigatorConfig& config, const RouteConfig& route, const VehicleParameters& vehicle,
                     const SpaceRouteConfig& space_route, const OpeningConfig& opening, const TimingTable& timing)
    : config_(config),
      route_(route),
      space_route_(space_route),
      vehicle_(vehicle),
      opening_(opening, vehicle),
      plans_(CommandLevel::kMove, timing.of(CommandLevel::kMove).replan_s) {}

void Navigator::on_message(const Message& message, Time now, Outbox& out) {
  now_ = now;
  if (const auto* fix = std::get_if<Navigation>(&message)) on_fix(*fix, out);
  if (const auto* scan = std::get_if<ObstacleScan>(&message)) on_scan(*scan, out);
  if (const auto* world = std::get_if<WorldSnapshot>(&message)) space_ = world->voxels;
  if (const auto* request = std::get_if<RouteRequest>(&message)) on_request(*request, out);
  if (const auto* order = std::get_if<FollowOrder>(&message)) holds_ = order->waypoints.empty() && !order->surface;
  if (const auto* passed = std::get_if<WaypointPassed>(&message)) on_passage(*passed);
  if (const auto* motion = std::get_if<MotionOrder>(&message)) steered_ = motion->time;
  if (const auto* action = std::get_if<SafetyAction>(&message)) on_action(*action, out);
  if (const auto* chart = std::get_if<ChartedHazards>(&message)) on_chart(*chart, out);
  if (const auto* group = std::get_if<GroupHazards>(&message)) on_group(*group, out);
  if (const auto* health = std::get_if<Health>(&message)) {
    budget_share_ = budget_share(*health).value_or(budget_share_);
  }
  if (const auto* order = std::get_if<MissionOrder>(&message)) {
    if (order->kind == MissionOrder::Kind::kStart) plan_ = order->plan;
  }
}

void Navigator::tick(Time now, Outbox& out) {
  now_ = now;
  const bool past = way_.size() <= 1 && !refused_ && action_ == SafetyActionKind::kNone;
  if (mode_ == Mode::kEmergency && past) {
    enter(Mode::kNormal, "the obstacle is passed; the mission goes on as ordered", out);
  }
  if (look_at_tick_ || (request_ && !refused_ && blind()) || plans_.is_due(now)) look(out);
}

// A jump of the position says nothing about the water between vehicle and obstacle: the last scan, and the corners
// round its obstacles, jump with it (S6-53).
void Navigator::on_fix(const Navigation& fix, Outbox& out) {
  if (!fix.X_WB.is_finite()) return;
  const std::optional<Navigation> before = here_;
  here_ = fix;
  if (!before || fix.time <= before->time) return;
  const double dt = to_seconds(fix.time - before->time);
  const bool fast = before->v_WB.has_value();
  const Vector2d expected = fast ? Vector2d(place_of(*before) + dt * before->v_WB->head<2>()) : place_of(*before);
  const Vector2d jump = place_of(fix) - expected;
  const double may_move = fast ? 0.5 * vehicle_.limits.max_acceleration * dt * dt : vehicle_.limits.max_speed * dt;
  if (!(jump.norm() > config_.jump_m + may_move)) return;
  if (scan_) scan_->X_WL.translation.head<2>() += jump;
  space_.reset();  // it belongs to the old position; the next one does not
  opening_.move(jump);
  for (std::size_t i = 0; i + 1 < way_.size(); ++i) {
    way_[i].north += jump.x();
    way_[i].east += jump.y();
  }
  if (!request_ || way_.empty()) return;
  Decision d =
      decision("position fix", fmt::format("the position jumped by {:.1f} m; the route round the obstacles moves "
                                           "with it, the mission point does not",
                                           jump.norm()));
  if (way_.size() > 1) {
    for (const Waypoint& w : way_) d.way.emplace_back(w.north, w.east);
    passed_ = 0;
    if (then_W_) *then_W_ += jump;
    out.say(RoutePlanned{request_->id, ++version_, way_, true, d.reason, then_W_});
  }
  out.say(std::move(d));
  look(out);
}

void Navigator::on_scan(const ObstacleScan& scan, Outbox& out) {
  if (!scan.X_WL.is_finite()) return;
  scan_ = scan;
  if (!scan.posed && here_) scan_->X_WL = level(here_->X_WB);
  scan_heard_ = now_;
  new_scan_ = true;
  look(out);
  new_scan_ = false;
}

void Navigator::on_chart(const ChartedHazards& chart, Outbox& out) {
  const bool same = chart_.hazards == chart.hazards;
  const bool looked = chart.looked_ahead && chart.looked_ahead != chart_.looked_ahead;
  chart_ = chart;
  if (looked) mapped_ = now_;
  new_scan_ = looked && !scan_;
  if (!same || new_scan_) look(out);
  new_scan_ = false;
}

void Navigator::on_group(const GroupHazards& group, Outbox& out) {
  group_ = group.hazards;
  look(out);
}

void Navigator::on_request(const RouteRequest& request, Outbox& out) {
  const bool again = request_ && request_->target.north_east == request.target.north_east;
  if (!again && here_) leg_from_ = place_of(*here_);
  request_ = request;
  way_.clear();
  opening_.forget();
  refused_.reset();
  goal_blocked_ = shorter_ = 0;
  look(out);
}

void Navigator::on_passage(const WaypointPassed& passed) {
  if (passed.version != version_ || passed.index < passed_) return;
  const std::size_t behind = std::min(passed.index + 1 - passed_, way_.size());
  way_.erase(way_.begin(), way_.begin() + static_cast<std::ptrdiff_t>(behind));
  passed_ += behind;
  if (!passed.last) return;
  holds_ = true;
  request_.reset();
  way_.clear();
}

void Navigator::on_action(const SafetyAction& action, Outbox& out) {
  const bool reflex = action.kind == SafetyActionKind::kStop || action.kind == SafetyActionKind::kTurn;
  if (action.kind != action_ && request_) {
    look_at_tick_ = true;
    if (reflex) enter(Mode::kEmergency, "the Safety Officer acts: " + action.why, out);
  }
  if (takes_over(action_)) wait_for_goal_selector();
  action_ = action.kind;
}

/// It begins, or goes on, when the Safety Officer lets it.
void Navigator::wait_for_goal_selector() {
  if (handed_over_) handed_over_ = now_;
  if (steered_) steered_ = now_;
}

// One cycle: the hazards, whether the point can stay, whether the route can (Ganesan 2015, 5.2).
void Navigator::look(Outbox& out) {
  look_at_tick_ = false;
  if (!here_ || (!request_ && !holds_)) return note_plan(out);
  const PlanFrame frame = plan_frame();
  const Vector2d vehicle = frame.to_local(place_of(*here_));
  std::vector<Hazard> hazards = hazards_in(frame);
  if (holds_) {
    std::vector<Hazard> still = hazards;
    trim_margins(still, vehicle, vehicle_.half_width_m);
    tell_still(still, frame, out);
  }
  if (!request_) return note_plan(out);
  if (const auto refusal = blind()) return refuse(*refusal, out);
  const bool handed_over = hand_over_moving(hazards);
  if (const auto refusal = judge_goal(frame, hazards)) return refuse(*refusal, out);
  trim_margins(hazards, vehicle, vehicle_.half_width_m);
  View view{HazardMap(std::move(hazards)),
            frame,
            {vehicle},
            frame.to_local(request_->target.north_east),
            (here_->X_WB.rotation.heading() - frame.heading).wrapped()};
  for (const Waypoint& w : way_) view.way.push_back(frame.to_local(Vector2d(w.north, w.east)));
  if (handed_over && !holds_) tell_still(view.map.hazards(), frame, out);
  if (way_.empty()) {
    start(view, out);
  } else {
    keep(view, out);
  }
  look_at_opening(view, out);
  note_plan(out);
}

/// Whether the Goal Selector is to know the still hazards; removes those that move while it steers past them. It has
/// kLasts to begin.
bool Navigator::hand_over_moving(std::vector<Hazard>& hazards) {
  const auto moves = [](const Hazard& h) { return h.kind == HazardKind::kMoving; };
  if (std::ranges::none_of(hazards, moves)) {
    handed_over_.reset();
    steered_.reset();
    return false;
  }
  traffic_ = now_;
  if (through_ || opening_.flies()) return false;
  if (!handed_over_) handed_over_ = now_;
  if (takes_over(action_)) wait_for_goal_selector();
  if (is_steered() || now_ - *handed_over_ <= MotionOrder::kLasts) std::erase_if(hazards, moves);
  return true;
}

void Navigator::tell_still(std::span<const Hazard> hazards, const PlanFrame& frame, Outbox& out) const {
  constexpr double kNear_m = 100;
  const Vector2d vehicle = frame.to_local(place_of(*here_));
  std::vector<Hazard> still;
  for (const Hazard& h : hazards) {
    if (h.kind == HazardKind::kMoving || signed_distance(h.outline, vehicle) > kNear_m) continue;
    still.push_back(h);
    for (Vector2d& p : still.back().outline) p = frame.to_world(p);
  }
  out.say(StillHazards{now_, std::make_shared<const std::vector<Hazard>>(std::move(still))});
}

std::optional<Navigator::Refusal> Navigator::blind() const {
  if (config_.map_age_s <= 0) return {};
  if (!scan_ && !chart_.looked_ahead) return Refusal{RouteRefused::Reason::kNoMap, "nothing has been seen yet"};
  double age = INFINITY;
  if (scan_) age = to_seconds(now_ - scan_heard_);
  if (chart_.looked_ahead) age = std::min(age, to_seconds(now_ - mapped_));
  if (age <= config_.map_age_s) return {};
  return Refusal{RouteRefused::Reason::kNoMap, fmt::format("nothing was seen for {:.1f} s", age)};
}

PlanFrame Navigator::plan_frame() const { return PlanFrame::of(scan_ ? scan_->X_WL : level(here_->X_WB)); }

std::vector<Hazard> Navigator::hazards_in(const PlanFrame& frame) const {
  std::vector<Hazard> hazards;
  if (scan_) hazards = scan_->hazards;
  if (chart_.hazards) {
    // What was mapped on the way has the vehicle's own position error.
    const double chart_margin = config_.chart_sigmas * sigma_of(*here_);
    for (const Hazard& h : *chart_.hazards) {
      const bool mapped = h.kind == HazardKind::kMapped || h.kind == HazardKind::kVoxels;
      const double margin = mapped ? 0 : chart_margin;
      hazards.push_back({to_local(frame, h.outline), h.margin_m + margin, h.kind, h.id});
    }
  }
  for (const Hazard& h : group_) hazards.push_back({to_local(frame, h.outline), h.margin_m, h.kind, h.id});
  std::erase_if(hazards, [](const Hazard& h) { return h.outline.empty(); });
  if (!plan_ || plan_->fence.empty()) return hazards;
  // The fence does not move and is no danger: it has a clearance of its own, smaller than that from obstacles.
  const double margin = config_.fence_clearance_m - route_.clearance_m;
  for (std::size_t i = 0; i < plan_->fence.size(); ++i) {
    const Vector2d& next = plan_->fence[(i + 1) % plan_->fence.size()];
    hazards.push_back(
        {to_local(frame, {plan_->fence[i], next}), margin, HazardKind::kFence, static_cast<std::uint32_t>(i)});
  }
  return hazards;
}

bool Navigator::is_steered() const { return steered_ && now_ - *steered_ <= MotionOrder::kLasts; }

/// Moving bodies may lead the vehicle far off its route, which then begins where it is.
void Navigator::begin_here(Outbox& out) {
  const Vector2d here = place_of(*here_), next(way_.front().north, way_.front().east);
  if ((nearest_on_segment(way_from_, next, here) - here).norm() < config_.off_leg_m) return;
  way_from_ = here;
  passed_ = 0;
  out.say(
      RoutePlanned{request_->id, ++version_, way_, way_.size() > 1, "the route begins where the vehicle is", then_W_});
}

void Navigator::keep(View& view, Outbox& out) {
  if (is_steered()) begin_here(out);
  const auto conflict = conflict_ahead(view.map, view.way, least_clearance());
  if (conflict && !leads_through(view, *conflict, out)) return avoid(view, *conflict, out);
  if (!conflict) through_ = false;
  // A helix is longer than it must be, on purpose.
  if (new_scan_ && view.way.size() > 2 && !opening_.flies()) shorten(view, out);
}

void Navigator::avoid(View& view, const Conflict& conflict, Outbox& out) {
  Decision d = about(view, view.way, conflict);
  d.what = "replan";
  auto aside = mended(view.map, view.way, clearance());
  if (aside && (!corners_fit(*aside, turning_radius()) || deviates(view, *aside))) aside.reset();
  const double aside_m = aside ? length_of(*aside) : 0;
  if (aside && aside_m <= length_of(view.way) + config_.switch_m) return take_way(view, *aside, std::move(d), out);
  const auto found = search(view);
  std::optional<double> plane_m;
  if (found) plane_m = found->length_m;
  if (aside) plane_m = std::min(plane_m.value_or(aside_m), aside_m);
  if (const auto through = search_space(view, plane_m)) {
    if (is_as_clear(view, through->clearance_m)) return;
    return take_space_way(view, *through, std::move(d), out);
  }
  if (aside && (!found || aside_m <= found->length_m + config_.switch_m)) {
    return take_way(view, *aside, std::move(d), out);
  }
  if (found) return take_way(view, found->points, std::move(d), out);
  // Among moving bodies the Goal Selector waits, or finds the way, where the plane of this instant is shut.
  if (is_steered() && found.error() != RouteRefusal::kStartBlocked) return;
  if (in_traffic() && found.error() == RouteRefusal::kGoalBlocked && goal_blocked_ < goal_scans()) return;
  Refusal refusal = refusal_of(found.error(), view);
  refusal.why = d.reason + "; " + refusal.why;
  refusal.obstacle = d.obstacle;
  refusal.obstacle_number = d.obstacle_number;
  refuse(refusal, out);
}

void Navigator::shorten(View& view, Outbox& out) {
  const auto found = search(view);
  const bool look = !weighs_risks() && !(now_ >= space_searched_ && now_ - space_searched_ < kSpaceInterval);
  std::optional<SpaceRoutePath> through;
  if (look) {
    through = search_space(view, length_of(view.way));
    space_searched_ = now_;
    space_shorter_ = through.has_value();
  }
  const bool round_nothing = found && length_of(view.way) - found->length_m > config_.shortcut_m;
  if (through || round_nothing) {
    ++shorter_;
  } else if (look || !space_shorter_) {  // a route found in space counts until the next search there
    shorter_ = 0;
  }
  if (shorter_ < config_.sure_scans || (!through && !round_nothing)) return;
  if (through) {
    return take_space_way(view, *through, decision("replan", "the obstacle that the route went round can be passed"),
                          out);
  }
  take_way(view, found->points, decision("replan", "the obstacle that the route went round is gone"), out);
}

void Navigator::start(View& view, Outbox& out) {
  const auto found = search(view);
  Decision d = decision(refused_ ? "resume" : "plan", "the route is clear");
  const Way straight{view.way.front(), view.goal};
  std::optional<SpaceRoutePath> through;
  if (!found || !weighs_risks()) {
    through = search_space(view, found ? std::optional(found->length_m) : std::nullopt);
  }
  if (!found && !through) return refuse(refusal_of(found.error(), view), out);
  if (through || found->points.size() > 2) {
    if (const auto conflict = conflict_ahead(view.map, straight, clearance())) {
      const std::string what = d.what;
      d = about(view, straight, *conflict);
      d.what = what;
    }
  }
  if (through) return take_space_way(view, *through, std::move(d), out);
  take_way(view, found->points, std::move(d), out);
}

void Navigator::take_way(const View& view, const Way& way, Decision d, Outbox& out) {
  const double before = way_.empty() ? (view.goal - view.way.front()).norm() : length_of(view.way);
  std::vector<Waypoint> waypoints;
  const double speed = speed_on(view, way);
  for (std::size_t i = 1; i < way.size(); ++i) {
    const Vector2d p_W = i + 1 < way.size() ? view.frame.to_world(way[i]) : request_->target.north_east;
    waypoints.push_back({p_W.x(), p_W.y(), request_->target.depth_m, speed});
  }
  through_ = false;
  opening_.leave();
  adopt(view, std::move(waypoints), length_of(way) - before, std::move(d), out);
}

void Navigator::adopt(const View& view, std::vector<Waypoint> waypoints, double longer_m, Decision d, Outbox& out) {
  if (!waypoints.empty()) waypoints.back().radius_m = request_->target.radius_m;
  double length = 0;
  Vector2d last = place_of(*here_);
  for (const Waypoint& w : waypoints) {
    d.way.emplace_back(w.north, w.east);
    length += (d.way.back() - last).norm();
    last = d.way.back();
  }
  way_ = std::move(waypoints);
  way_from_ = place_of(*here_);
  passed_ = 0;
  shorter_ = 0;
  refused_.reset();
  const bool avoiding = way_.size() > 1;
  d.reason += avoiding ? fmt::format("; {} by {} way-point{}, {:.1f} m {}", opening_.flies() ? "flown" : "going round",
                                     way_.size() - 1, way_.size() == 2 ? "" : "s", std::abs(longer_m),
                                     longer_m < 0 ? "shorter" : "longer")
                       : fmt::format("; straight to {}, {:.1f} m", name_of(request_->target, request_->point), length);
  if (weighs_risks()) d.reason += "; " + cost_text();
  then_W_ = corner_after(view);
  out.say(RoutePlanned{request_->id, ++version_, way_, avoiding, d.reason, then_W_});
  out.say(std::move(d));
}

void Navigator::refuse(const Refusal& refusal, Outbox& out) {
  using Reason = RouteRefused::Reason;
  const bool first = refused_ != refusal.reason;
  refused_ = refusal.reason;
  way_.clear();
  opening_.leave();
  if (first) {
    out.say(RouteRefused{refusal.reason, request_->id, request_->point, refusal.safe_nearby, refusal.why});
    Decision d = decision("refuse", name_of(request_->target, request_->point) + ": " + refusal.why);
    d.obstacle = refusal.obstacle;
    d.obstacle_number = refusal.obstacle_number;
    out.say(std::move(d));
  }
  // The Executive Officer drops the point, has it moved, or asks again.
  if (refusal.reason == Reason::kGoalBlocked || refusal.reason == Reason::kOutsideFence) return request_.reset();
  if (refusal.reason == Reason::kNoMap || mode_ == Mode::kEmergency) return;
  enter(Mode::kEmergency, refusal.why, out);
  look_at_tick_ = true;
}

void Navigator::enter(Mode mode, const std::string& why, Outbox& out) {
  if (mode == mode_) return;
  mode_ = mode;
  out.say(decision(mode == Mode::kEmergency ? "emergency" : "normal", why));
}

bool Navigator::inside_fence(const Vector2d& p_W, double by_m) const {
  return !plan_ || plan_->fence.empty() || inner_distance(plan_->fence, p_W) >= by_m;
}

}  // namespace isobath
