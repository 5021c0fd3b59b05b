#include <algorithm>
#include <fmt/format.h>
#include <isobath/mission/agents/executive_officer.hpp>
#include <isobath/mission/messages/reason_text.hpp>
#include <isobath/mission/plan/sailing_time.hpp>
#include <numeric>
#include <set>
#include <utility>

namespace isobath {
namespace {

constexpr int kMaxCycles = 1000;  // of a graph in one instant: a graph that runs in a circle must not hang the vehicle

int as_int(std::size_t point) { return static_cast<int>(point); }

/// The point that the action names, if it is one of so many.
std::optional<std::size_t> point_of_action(const PlanAction& action, std::size_t points) {
  const auto number = action.number("point");
  if (!number || *number < 0 || *number >= static_cast<double>(points)) return std::nullopt;
  return static_cast<std::size_t>(*number);
}

}  // namespace

std::vector<Field> fields(ExecutiveConfig& c) {
  return {
      Field::real("route_timeout_s", &c.route_timeout_s, {0, 1e6}, "s",
                  "Total time without a route to a point after which the point is dropped.")
          .was("patience_s"),
      Field::real("move_wait_s", &c.move_wait_s, {0, 600}, "s",
                  "How long the Captain may take to move a blocked point."),
      Field::real("task_wait_s", &c.task_wait_s, {0, 1e6}, "s", "Maximum duration of a task."),
      Field::real("surface_wait_s", &c.surface_wait_s, {0, 1e6}, "s", "Maximum duration of surfacing."),
      Field::integer("approaches", &c.approaches, {1, 100}, "1",
                     "Maximum number of approaches to a point that is passed abeam."),
  };
}

void ExecutiveOfficer::on_message(const Message& message, Time now, Outbox& out) {
  now_ = now;
  if (const auto* fix = std::get_if<Navigation>(&message)) here_ = *fix;
  if (const auto* order = std::get_if<MissionOrder>(&message)) on(*order, out);
  if (const auto* visits = std::get_if<VisitOrder>(&message)) on(*visits, out);
  if (const auto* moved = std::get_if<PointMoved>(&message)) on(*moved, out);
  if (const auto* route = std::get_if<RoutePlanned>(&message)) on(*route, out);
  if (const auto* refused = std::get_if<RouteRefused>(&message)) on(*refused, out);
  if (const auto* passed = std::get_if<WaypointPassed>(&message)) on(*passed, out);
  if (const auto* health = std::get_if<Health>(&message)) {
    if (health->source == "vehicle" && health->battery_share >= 0) battery_share_ = health->battery_share;
  }
  if (const auto* scan = std::get_if<ObstacleScan>(&message)) note_range(*scan);
  if (const auto* wait = std::get_if<PassageWait>(&message)) on(*wait, out);
  if (const auto* call = std::get_if<TaskCall>(&message)) call_ = call->id;
  if (const auto* award = std::get_if<TaskAward>(&message)) on(*award);
  if (const auto* plan = std::get_if<TaskPlan>(&message)) on(*plan, out);
  if (const auto* lost = std::get_if<AgentLost>(&message)) {
    if (lost->agent == "captain") end(MissionEnd::kSurface, "the Captain is lost: " + lost->why, out);
    if (lost->agent == "commodore" && is_shared() && busy()) {
      VisitOrder rest = visits_ordered_;
      rest.last = true;
      visit(rest, out);
    }
  }
  cycle(out);
}

void ExecutiveOfficer::tick(Time now, Outbox& out) {
  now_ = now;
  const double dt = last_tick_ ? to_seconds(now - *last_tick_) : 0;
  last_tick_ = now;
  if (no_way_ && !paused_ && !waits_for_turn_) {
    facts_[{"waited", as_int(errand_ == Errand::kReturn ? points_.size() : point_)}] += dt;
  }
  if (move_until_ && now >= *move_until_) drop(no_way_why_, false, out);
  cycle(out);
  if (plans_.is_due(now)) plan_again(out);
}

/// The points to which the present plan graph leads, from the present one on.
std::vector<std::size_t> ExecutiveOfficer::points_left() const {
  std::vector<std::size_t> points;
  if (!executor_ || !executor_->started()) return points;
  const PlanGraph& graph = executor_->graph();
  std::vector<char> seen(graph.nodes.size(), 0);
  std::deque<std::size_t> open{executor_->node()};
  seen[executor_->node()] = 1;
  for (; !open.empty(); open.pop_front()) {
    const std::size_t node = open.front();
    const auto point = point_of_action(graph.nodes[node].action, points_.size());
    if (point && std::ranges::find(points, *point) == points.end()) points.push_back(*point);
    for (const PlanArc& arc : graph.arcs) {
      if (arc.from == node && !std::exchange(seen[arc.to], 1)) open.push_back(arc.to);
    }
  }
  return points;
}

double ExecutiveOfficer::time_for(const std::vector<std::size_t>& points) const {
  std::optional<Eigen::Vector2d> from;
  if (here_) from = here_->X_WB.translation.head<2>();
  return sailing_time_s(points_, points, from, plan_->speed);
}

void ExecutiveOfficer::plan_again(Outbox& out) {
  if (!plan_ || !executor_ || !busy()) return plans_.note(now_, 0, false, out);
  const std::vector<std::size_t> left = points_left();
  const bool last = !is_shared() || visits_ordered_.last;
  if (!left.empty() && !executor_->finished()) {
    const PlanAction* other = executor_->update(visit_graph(*plan_, left, last, config_), now_);
    other_graph_ = true;
    if (other && !paused_) act(*other, out);
  }
  plans_.note(now_, time_for(left), false, out);
}

/// The point that follows the present one, if the vehicle goes on to it as soon as it is there.
std::optional<Eigen::Vector2d> ExecutiveOfficer::next_W() const {
  if (errand_ != Errand::kPoint || !executor_ || !executor_->started()) return std::nullopt;
  const PlanGraph& graph = executor_->graph();
  const PlanEvent there = PlanEvent::fact("point reached", as_int(point_));
  for (const PlanArc& arc : graph.arcs) {
    if (arc.from != executor_->node() || arc.event != there) continue;
    const PlanAction& next = graph.nodes[arc.to].action;
    const auto point = point_of_action(next, points_.size());
    return next.name == "go to" && point ? std::optional(points_[*point].north_east) : std::nullopt;
  }
  return std::nullopt;
}

void ExecutiveOfficer::on(const MissionOrder& order, Outbox& out) {
  switch (order.kind) {
    case MissionOrder::Kind::kStart: return start(order, out);
    case MissionOrder::Kind::kAbort: return end(order.end, order.why, out);
    case MissionOrder::Kind::kHold:
      if (!busy() || paused_) return;
      paused_ = true;
      stop(out);
      return report(MissionPhase::kHolding, order.why, out);
    case MissionOrder::Kind::kResume:
      if (!paused_) return;
      paused_ = false;
      report(MissionPhase::kUnderWay, order.why, out);
      // The Commodore may have ordered other points meanwhile.
      if (is_shared()) return act(executor_->graph().nodes[executor_->node()].action, out);
      if (errand_ != Errand::kNone) return go(errand_, target_, out);
      if (present_action() != nullptr && present_action()->name == "step") act(*present_action(), out);
  }
}

void ExecutiveOfficer::start(const MissionOrder& order, Outbox& out) {
  if (!order.plan || (busy() && !order.replaces)) return;
  const bool same_home = order.replaces && plan_;
  plan_ = order.plan;
  points_ = plan_->points;
  facts_.clear();
  reached_ = dropped_ = 0;
  paused_ = false;
  errand_ = Errand::kNone;
  no_way_ = false;
  move_until_.reset();
  visits_.clear();
  if (here_ && !same_home) home_ = here_->X_WB.translation.head<2>();
  visits_ordered_ = {};
  executor_.emplace(is_shared() ? visit_graph(*plan_, {}, false, config_) : mission_graph(*plan_, config_));
  other_graph_ = true;
  decide("start",
         fmt::format("{}, {} points, by a plan graph of {} nodes", plan_->title.empty() ? "mission" : plan_->title,
                     points_.size(), executor_->graph().nodes.size()),
         out);
  report(MissionPhase::kUnderWay, order.why, out);
  act(executor_->start(now_), out);
}

void ExecutiveOfficer::end(MissionEnd how, const std::string& why, Outbox& out) {
  paused_ = false;
  errand_ = Errand::kNone;
  no_way_ = false;
  look({}, out);
  move_until_.reset();
  executor_.emplace(end_graph(how, points_.size(), config_));
  other_graph_ = true;
  report(MissionPhase::kAborted, why, out);
  act(executor_->start(now_), out);
}

void ExecutiveOfficer::on(const VisitOrder& order, Outbox& out) {
  if (!is_shared() || !busy() || phase_ == MissionPhase::kAborted || order.given_up) return;
  std::set<std::size_t> once;
  for (const std::size_t point : order.points) {
    if (point >= points_.size() || !once.insert(point).second) return;
  }
  visits_ordered_ = order;
  visit(order, out);
}

// What was reached before under another order is to be visited again.
void ExecutiveOfficer::visit(const VisitOrder& order, Outbox& out) {
  const bool on_the_way = errand_ == Errand::kPoint;
  for (const std::size_t point : order.points) {
    if (on_the_way && point == point_) continue;
    for (const char* fact : {"point reached", "point dropped", "task done", "waited"}) {
      facts_.erase({fact, as_int(point)});
    }
  }
  PlanGraph graph = visit_graph(*plan_, order.points, order.last, config_);
  decide("visit", order.why, out);
  other_graph_ = true;
  plans_.note(now_, time_for(order.points), true, out);
  // To go on with a point that is not the first would skip those before it.
  const bool turns = on_the_way && !order.points.empty() && order.points.front() != point_;
  if (turns) {
    executor_.emplace(std::move(graph));
    const PlanAction& first = executor_->start(now_);
    if (!paused_) act(first, out);
    return;
  }
  const PlanAction* action = executor_->update(std::move(graph), now_);
  if (action && !paused_) act(*action, out);
}

void ExecutiveOfficer::on(const PointMoved& moved, Outbox& out) {
  if (moved.point >= points_.size()) return;
  points_[moved.point].north_east = moved.north_east;
  if (errand_ != Errand::kPoint || point_ != moved.point) return;
  move_until_.reset();
  if (!paused_) go(Errand::kPoint, points_[point_], out);
}

/// Before a passage the vehicle waits as on the order of the operator, but by itself.
void ExecutiveOfficer::on(const PassageWait& wait, Outbox& out) {
  if (wait.waits == waits_for_turn_) return;
  waits_for_turn_ = wait.waits;
  if (errand_ == Errand::kNone || paused_ || !busy()) return;
  report(wait.waits ? MissionPhase::kHolding : MissionPhase::kUnderWay, wait.why, out);
  if (wait.waits) return stop(out);
  go(errand_, target_, out);
}

void ExecutiveOfficer::on(const RoutePlanned& route, Outbox& out) {
  if (waits_for_turn_ || errand_ == Errand::kNone || paused_ || route.request != request_) return;
  if (no_way_ && phase_ == MissionPhase::kHolding) report(MissionPhase::kUnderWay, route.why, out);
  no_way_ = false;
  version_ = route.version;
  out.say(FollowOrder{version_, route.waypoints, target_.altitude_m, false, route.then_W});
  if (route.avoiding) out.say(PointReport{PointReport::Kind::kAvoiding, point_, route.why});
}

void ExecutiveOfficer::on(const RouteRefused& refused, Outbox& out) {
  if (waits_for_turn_ || errand_ == Errand::kNone || paused_ || refused.request != request_) return;
  using Reason = RouteRefused::Reason;
  no_way_why_ = refused.why;
  stop(out);
  const bool for_good = refused.reason == Reason::kGoalBlocked || refused.reason == Reason::kOutsideFence;
  if (for_good && errand_ == Errand::kPoint && refused.safe_nearby) {
    move_until_ = now_ + seconds(config_.move_wait_s);
    return;
  }
  if (for_good && errand_ != Errand::kReturn) return give_up_leg(refused.why, out);
  no_way_ = true;
  if (phase_ == MissionPhase::kUnderWay) report(MissionPhase::kHolding, refused.why, out);
}

void ExecutiveOfficer::on(const WaypointPassed& passed, Outbox& out) {
  if (errand_ == Errand::kNone || paused_ || no_way_ || passed.version != version_ || !passed.last) return;
  arrive(passed.reached, out);
}

void ExecutiveOfficer::on(const TaskAward& award) {
  if (award.id == call_ && award.driver.empty()) note("task done", point_);
}

void ExecutiveOfficer::on(const TaskPlan& plan, Outbox& out) {
  const PlanAction* action = present_action();
  const bool wanted = action != nullptr && (action->name == "task" || action->name == "step");
  if (!wanted || plan.id != call_ || errand_ == Errand::kTask) return;
  visits_.assign(plan.waypoints.begin(), plan.waypoints.end());
  visits_drop_distance_m_ = plan.drop_distance_m;
  decide("task", fmt::format("{} does {} with {} way-points", plan.driver, asked_task_, visits_.size()), out);
  give_up_leg("", out);
}

void ExecutiveOfficer::cycle(Outbox& out) {
  if (!executor_ || paused_) return;
  for (int step = 0; step < kMaxCycles; ++step) {
    const PlanAction* action = executor_->cycle(now_, *this);
    if (action == nullptr) break;
    act(*action, out);
  }
  tell_step(out);
}

/// Once a node is reached, or the graph is another one.
void ExecutiveOfficer::tell_step(Outbox& out) {
  if (!executor_->started()) return;
  const bool other = std::exchange(other_graph_, false) && (!told_graph_ || *told_graph_ != executor_->graph());
  if (!other && executor_->node() == told_node_) return;
  if (other) told_graph_ = std::make_shared<const PlanGraph>(executor_->graph());
  told_node_ = executor_->node();
  out.say(PlanStep{told_graph_, told_node_, other});
}

void ExecutiveOfficer::act(const PlanAction& action, Outbox& out) {
  const auto point = point_of_action(action, points_.size());
  const bool known = point.has_value();
  if (known) point_ = *point;
  if (action.name != "step") look({}, out);
  if (action.name == "go to" && known) {
    approaches_ = 1;
    out.say(PointReport{PointReport::Kind::kTaken, point_, name_of(points_[point_], point_)});
    return go(Errand::kPoint, points_[point_], out);
  }
  if (action.name == "return") {
    MissionPoint home;
    home.name = "the start";
    home.north_east = home_;
    home.depth_m = points_.empty() ? 0 : points_.back().depth_m;
    approaches_ = 1;
    return go(Errand::kReturn, home, out);
  }
  if (action.name == "drop" && known) return drop(no_way_why_, true, out);
  errand_ = Errand::kNone;
  no_way_ = false;
  if (action.name == "surface") {
    out.say(FollowOrder{0, {}, {}, true});
    return decide("surface", "the mission ends at the surface", out);
  }
  const auto step = action.number("step");
  if (action.name == "step" && known && step && *step >= 0 && *step < static_cast<double>(plan_->steps.size())) {
    return begin_step(plan_->steps[static_cast<std::size_t>(*step)], out);
  }
  // A vehicle that was at its waiting place circles there already.
  if (action.name == "wait" && known && is_near(points_[point_])) return;
  stop(out);
  if (action.name == "task" && known) return ask_driver(points_[point_].task, out);
  if (action.name == "finish" && phase_ != MissionPhase::kAborted) {
    report(MissionPhase::kFinished, fmt::format("{} points reached, {} dropped", reached_, dropped_), out);
  }
}

/// Gives pilot, sonar and link what the step asks of them.
void ExecutiveOfficer::begin_step(const TaskStep& step, Outbox& out) {
  facts_.erase({"task done", as_int(point_)});
  visits_.clear();
  const auto scan = scan_of(step);
  std::string what = fmt::format("{}, {}: the pilot's part is \"{}\"", step.task, step.name, step.pilot);
  if (scan) what += fmt::format("; the sonar scans {:.0f} deg", step.sector.degrees());
  if (!step.tell.empty()) what += fmt::format("; the operator is told \"{}\"", step.tell);
  decide("step", std::move(what), out);
  look(scan, out);
  if (!step.tell.empty()) out.say(PointReport{PointReport::Kind::kTold, point_, step.tell});
  if (step.pilot == "surface") return out.say(FollowOrder{0, {}, {}, true});
  if (step.pilot == "go") {
    const MissionPoint& p = points_[point_];
    visits_ = {{p.north_east.x(), p.north_east.y(), p.depth_m, p.speed > 0 ? p.speed : plan_->speed}};
    visits_drop_distance_m_ = p.drop_distance_m;
    return give_up_leg("", out);
  }
  stop(out);
  if (step.pilot != "hold") ask_driver(step.pilot, out);
}

/// Orders how the scanning sonar looks, if that changes.
void ExecutiveOfficer::look(const std::optional<ScanCommand>& scan, Outbox& out) {
  if (!scan && !looks_as_ordered_) return;
  looks_as_ordered_ = scan.has_value();
  out.say(SonarOrder{scan});
}

void ExecutiveOfficer::ask_driver(const std::string& task, Outbox& out) {
  call_.reset();
  asked_task_ = task;
  out.say(PointReport{PointReport::Kind::kTask, point_, task});
}

void ExecutiveOfficer::note_range(const ObstacleScan& scan) {
  if (!plan_ || plan_->steps.empty()) return;
  range_m_.reset();
  for (const Hazard& hazard : scan.hazards) {
    const double away_m = std::max(0.0, signed_distance(hazard.outline, Eigen::Vector2d::Zero()) - hazard.margin_m);
    range_m_ = std::min(range_m_.value_or(away_m), away_m);
  }
}

const PlanAction* ExecutiveOfficer::present_action() const {
  return executor_ && executor_->started() ? &executor_->graph().nodes[executor_->node()].action : nullptr;
}

bool ExecutiveOfficer::is_near(const MissionPoint& point) const {
  return here_ && (here_->X_WB.translation.head<2>() - point.north_east).norm() <= kAtWaitingPlace_m;
}

void ExecutiveOfficer::go(Errand errand, const MissionPoint& target, Outbox& out) {
  errand_ = errand;
  target_ = target;
  no_way_ = false;
  move_until_.reset();
  version_ = 0;
  const bool last = errand != Errand::kPoint || point_ + 1 == points_.size();
  out.say(RouteRequest{++request_, point_, target_, last, next_W()});
}

void ExecutiveOfficer::arrive(bool reached_it, Outbox& out) {
  if (!reached_it && approaches_ < config_.approaches) {
    ++approaches_;
    decide("approach again", name_of(target_, point_) + " was passed abeam", out);
    return go(errand_, target_, out);
  }
  if (!reached_it && errand_ == Errand::kPoint) return drop("it was passed abeam", false, out);
  const Errand errand = errand_;
  if (errand == Errand::kTask) return give_up_leg("", out);
  errand_ = Errand::kNone;
  if (errand == Errand::kReturn) {
    facts_[{"returned", -1}] = 1;
    return;
  }
  ++reached_;
  note("point reached", point_);
  out.say(PointReport{PointReport::Kind::kReached, point_, name_of(target_, point_)});
}

void ExecutiveOfficer::drop(const std::string& why, bool no_way, Outbox& out) {
  errand_ = Errand::kNone;
  no_way_ = false;
  move_until_.reset();
  ++dropped_;
  note("point dropped", point_);
  out.say(PointReport{PointReport::Kind::kDropped, point_, why, no_way});
  decide("drop point", name_of(points_[point_], point_) + ": " + why, out);
}

// Drops a mission point; within a task, goes on to the next place.
void ExecutiveOfficer::give_up_leg(const std::string& why, Outbox& out) {
  if (errand_ == Errand::kPoint) return drop(why, false, out);
  if (visits_.empty()) {
    errand_ = Errand::kNone;
    return note("task done", point_);
  }
  MissionPoint visit = points_[point_];
  const Waypoint w = visits_.front();
  visits_.pop_front();
  visit.north_east = {w.north, w.east};
  visit.depth_m = w.depth;
  visit.speed = w.speed;
  visit.radius_m = w.radius_m;
  visit.drop_distance_m = visits_drop_distance_m_;
  visit.move_m = 0;
  approaches_ = 1;
  go(Errand::kTask, visit, out);
}

void ExecutiveOfficer::stop(Outbox& out) { out.say(FollowOrder{0, {}, {}, false}); }

void ExecutiveOfficer::report(MissionPhase phase, const std::string& why, Outbox& out) {
  phase_ = phase;
  out.say(MissionReport{phase, reached_, dropped_, why});
}

void ExecutiveOfficer::decide(const char* what, std::string reason, Outbox& out) const {
  out.say(Decision{now_, "executive officer", what, std::move(reason)});
}

std::optional<double> ExecutiveOfficer::value(const std::string& quantity, std::optional<int> of) const {
  if (quantity == "depth" && !of) return here_ ? std::optional(here_->X_WB.translation.z()) : std::nullopt;
  if (quantity == "sigma" && !of) return here_ ? sigma_m_of(*here_) : std::nullopt;
  if (quantity == "battery" && !of) return battery_share_;
  if (quantity == "range" && !of) return range_m_;
  const auto fact = facts_.find({quantity, of.value_or(-1)});
  return fact == facts_.end() ? std::nullopt : std::optional(fact->second);
}

}  // namespace isobath
