#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/agents/captain.hpp>
#include <isobath/mission/messages/reason_text.hpp>
#include <isobath/mission/plan/sailing_time.hpp>
#include <numeric>

namespace isobath {
namespace {

constexpr double kWayBackReserve = 1.1, kWayBackReserve_s = 10;  // the way back may lead round something

// Without these agents the vehicle is not controlled, or sees nothing.
bool matters(const std::string& agent) {
  constexpr const char* kNeeded[] = {"executive officer", "navigator", "pilot", "fls detector", "safety officer"};
  return std::find(std::begin(kNeeded), std::end(kNeeded), agent) != std::end(kNeeded);
}

}  // namespace

std::vector<Field> fields(CaptainConfig& c) {
  return {Field::real("bid_s", &c.bid_s, {0, 600}, "s", "How long back-seat drivers may bid for a task.")};
}

void Captain::on_message(const Message& message, Time now, Outbox& out) {
  now_ = now;
  if (const auto* command = std::get_if<OperatorCommand>(&message)) on(*command, out);
  if (const auto* report = std::get_if<SafetyReport>(&message)) on(*report, out);
  if (const auto* lost = std::get_if<AgentLost>(&message)) on(*lost, out);
  if (const auto* refused = std::get_if<RouteRefused>(&message)) on(*refused, out);
  if (const auto* report = std::get_if<PointReport>(&message)) on(*report, out);
  if (const auto* report = std::get_if<MissionReport>(&message)) on(*report, out);
  if (const auto* bid = std::get_if<TaskBid>(&message)) on(*bid);
  if (const auto* visits = std::get_if<VisitOrder>(&message)) {
    if (visits->given_up && plan_) return abort(plan_->if_dropped, visits->why, out);
    take_order(*visits);
    plan(true, out);
  }
  if (const auto* fix = std::get_if<Navigation>(&message)) {
    if (fix->X_WB.is_finite()) here_ = *fix;
  }
}

void Captain::tick(Time now, Outbox& out) {
  now_ = now;
  if (bids_until_ && now >= *bids_until_) award(out);
  if (plans_.is_due(now)) plan(false, out);
  if (!under_way() || aborted_ || !plan_ || plan_->limits.max_duration_s <= 0) return;
  turn_back_in_time(out);
  const double lasted = to_seconds(now - started_);
  if (lasted <= plan_->limits.max_duration_s) return;
  abort(MissionEnd::kSurface,
        fmt::format("the mission has lasted {:.1f} s, {:.1f} s allowed", lasted, plan_->limits.max_duration_s), out);
}

void Captain::take_order(const VisitOrder& order) {
  left_ = order.points;
  std::erase_if(left_, [this](std::size_t point) { return !plan_ || point >= plan_->points.size(); });
}

double Captain::way_home_s() const {
  return here_ ? (home_W_ - here_->X_WB.translation.head<2>()).norm() / plan_->speed : 0;
}

/// The rest of the mission: how long it takes.
void Captain::plan(bool changed, Outbox& out) {
  double left_s = 0;
  if (under_way() && plan_) {
    std::optional<Eigen::Vector2d> from;
    if (here_) from = here_->X_WB.translation.head<2>();
    left_s = sailing_time_s(plan_->points, left_, from, plan_->speed);
    if (plan_->at_end == MissionEnd::kReturn) {
      left_s += left_.empty() ? way_home_s() : (home_W_ - plan_->points[left_.back()].north_east).norm() / plan_->speed;
    }
  }
  plans_.note(now_, left_s, changed, out);
}

void Captain::turn_back_in_time(Outbox& out) {
  if (plan_->at_end != MissionEnd::kReturn || !here_ || left_.empty()) return;
  const double left_s = plan_->limits.max_duration_s - to_seconds(now_ - started_), back_s = way_home_s();
  if (left_s > kWayBackReserve * back_s + kWayBackReserve_s) return;
  abort(MissionEnd::kReturn,
        fmt::format("{:.0f} s are left, and the way back takes {:.0f} s; {} point{} will not be visited", left_s,
                    back_s, left_.size(), left_.size() == 1 ? "" : "s"),
        out);
}

void Captain::on(const OperatorCommand& command, Outbox& out) {
  using Kind = OperatorCommand::Kind;
  switch (command.kind) {
    case Kind::kStart: return start(command, out);
    case Kind::kAbort: return abort(MissionEnd::kHold, "the operator ended the mission", out);
    case Kind::kHold:
      if (phase_ == MissionPhase::kUnderWay) order(MissionOrder::Kind::kHold, "hold", "the operator asks for it", out);
      return;
    case Kind::kResume:
      if (phase_ == MissionPhase::kHolding) {
        order(MissionOrder::Kind::kResume, "resume", "the operator asks for it", out);
      }
      return;
    case Kind::kAcknowledge: return decide("acknowledge", "the operator has seen the alarms", out);
    case Kind::kNewMission: return replace(command, out);
    case Kind::kReturn: return send_home(command, out);
    case Kind::kHandOver: return decide("command", command.by, out);
    case Kind::kBeat: return;
  }
}

void Captain::start(const OperatorCommand& command, Outbox& out) {
  const bool another = command.plan && under_way();
  if (another && command.plan == plan_) return;  // the link repeats a command that was not acknowledged
  const std::string problem = another ? "a mission is under way" : problem_of(command.plan.get());
  if (!problem.empty()) {
    decide("refuse mission", problem, out);
    if (under_way()) return;
    phase_ = MissionPhase::kAborted;
    out.say(MissionReport{phase_, 0, 0, problem});
    return tell("mission refused: " + problem, out);
  }
  begin(command.plan);
  if (here_) home_W_ = here_->X_WB.translation.head<2>();
  order(MissionOrder::Kind::kStart, "start", "the operator asks for it", out);
}

/// Why the vehicle cannot take it; empty: it can.
std::string Captain::problem_of(const MissionPlan* plan) const {
  if (plan == nullptr) return "there is no mission";
  if (!faults_.empty()) return "a fault is active: " + *faults_.begin();
  try {
    check_mission(*plan);
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

void Captain::begin(std::shared_ptr<const MissionPlan> plan) {
  plan_ = std::move(plan);
  aborted_.reset();
  started_ = now_;
  point_ = 0;
  left_.resize(plan_->search.on() ? 0 : plan_->points.size());
  std::iota(left_.begin(), left_.end(), std::size_t{0});
}

void Captain::replace(const OperatorCommand& command, Outbox& out) {
  std::string problem = problem_of(command.plan.get());
  if (problem.empty() && plan_ && plan_->search.on()) problem = "the vehicles of a group share the mission";
  const bool fenced = problem.empty() && here_ && !command.plan->fence.empty();
  if (fenced && !encloses(command.plan->fence, here_->X_WB.translation.head<2>())) {
    problem = "the vehicle is outside the fence of the new mission";
  }
  if (!problem.empty()) {
    decide("refuse mission", problem + (under_way() ? "; the mission under way goes on" : ""), out);
    return tell("new mission refused: " + problem, out);
  }
  if (!plan_ && here_) home_W_ = here_->X_WB.translation.head<2>();
  begin(command.plan);
  bids_until_.reset();
  const std::size_t points = plan_->points.size();
  const std::string why = fmt::format("{} point{}, sent by {}", points, points == 1 ? "" : "s",
                                      command.by.empty() ? "the operator" : command.by);
  decide("new mission", why, out);
  out.say(MissionOrder{MissionOrder::Kind::kStart, plan_, MissionEnd::kHold, why, true});
}

/// The place where the first mission started becomes the only point, at the depth of the last one.
void Captain::send_home(const OperatorCommand& command, Outbox& out) {
  if (!plan_) return decide("refuse return", "the vehicle has not started yet", out);
  auto home = std::make_shared<MissionPlan>(*plan_);
  const MissionPoint& last = plan_->points.back();
  MissionPoint start;
  start.name = "the start";
  start.north_east = home_W_;
  start.depth_m = last.depth_m;
  start.altitude_m = last.altitude_m;
  home->points = {start};
  home->injected.clear();
  home->at_end = MissionEnd::kHold;
  replace({OperatorCommand::Kind::kNewMission, std::move(home), command.by}, out);
}

void Captain::on(const SafetyReport& report, Outbox& out) {
  if (!report.abort) return;
  if (!report.active) {
    faults_.erase(report.fault);
    return;
  }
  faults_.insert(report.fault);
  abort(report.end, report.fault + ": " + report.why, out);
}

void Captain::on(const AgentLost& lost, Outbox& out) {
  const std::string what = fmt::format("the {} {}: {}", lost.agent, lost.hung ? "hangs" : "died", lost.why);
  if (matters(lost.agent)) {
    faults_.insert(what);
    return abort(MissionEnd::kSurface, what, out);
  }
  decide("go on", what + "; the mission goes on without it", out);
  bids_.erase(lost.agent);
  if (lost.agent == awarded_) award(out);
}

// S6-65. The Executive Officer drops a point that is not moved.
void Captain::on(const RouteRefused& refused, Outbox& out) {
  if (refused.reason != RouteRefused::Reason::kGoalBlocked || !refused.safe_nearby) return;
  if (!plan_ || refused.point >= plan_->points.size()) return;
  const MissionPoint& point = plan_->points[refused.point];
  const double distance = (*refused.safe_nearby - point.north_east).norm();
  if (distance > point.move_m) return;
  decide("move point",
         fmt::format("{}: {}; it moves by {:.1f} m to {} ({:.1f} m allowed)", name_of(point, refused.point),
                     refused.why, distance, text_of(*refused.safe_nearby), point.move_m),
         out);
  out.say(PointMoved{refused.point, *refused.safe_nearby});
}

void Captain::on(const PointReport& report, Outbox& out) {
  if (!plan_ || report.point >= plan_->points.size()) return;
  point_ = report.point;
  const bool left = report.kind == PointReport::Kind::kReached || report.kind == PointReport::Kind::kDropped;
  if (left) std::erase(left_, report.point);
  const MissionPoint& point = plan_->points[report.point];
  const std::string name = name_of(point, report.point);
  switch (report.kind) {
    case PointReport::Kind::kTaken: return tell("on the way to " + name, out);
    case PointReport::Kind::kAvoiding: return tell("avoiding on the way to " + name + ": " + report.why, out);
    case PointReport::Kind::kDropped: return tell(name + " is dropped: " + report.why, out);
    case PointReport::Kind::kTold: return tell(report.why, out);
    case PointReport::Kind::kReached: return tell(name + " is reached", out);
    case PointReport::Kind::kTask: return call(report.why, point, out);
  }
}

void Captain::call(const std::string& task, const MissionPoint& at, Outbox& out) {
  call_ = {++calls_, task, at};
  bids_.clear();
  awarded_.clear();
  bids_until_ = now_ + seconds(config_.bid_s);
  out.say(call_);
}

void Captain::on(const MissionReport& report, Outbox& out) {
  if (report.phase == phase_) return;
  phase_ = report.phase;
  plan(true, out);
  const std::string text = fmt::format("mission {}: {} of {} points reached, {} dropped; {}", to_text(report.phase),
                                       report.reached, plan_ ? plan_->points.size() : 0, report.dropped, report.why);
  tell(text, out);
  const bool over = phase_ == MissionPhase::kFinished || phase_ == MissionPhase::kAborted;
  if (over) decide(to_text(phase_), text, out);
}

void Captain::on(const TaskBid& bid) {
  if (!bids_until_ || bid.id != call_.id || bid.driver.empty() || !(bid.suitability > 0)) return;
  if (std::isfinite(bid.suitability)) bids_[bid.driver] = bid.suitability;
}

void Captain::award(Outbox& out) {
  bids_until_.reset();
  const auto best = std::max_element(bids_.begin(), bids_.end(), [](const auto& a, const auto& b) {
    return a.second < b.second;  // of equal bids the first, and bids are sorted by name
  });
  awarded_ = best == bids_.end() ? "" : best->first;
  decide("award task",
         awarded_.empty() ? fmt::format("no driver bids for {}; the mission goes on", call_.task)
                          : fmt::format("{} does {}: suitability {:.3g}, the highest of {}", awarded_, call_.task,
                                        best->second, bids_.size()),
         out);
  out.say(TaskAward{call_.id, awarded_});
}

void Captain::abort(MissionEnd end, const std::string& why, Outbox& out) {
  if (aborted_ && (*aborted_ == end || *aborted_ == MissionEnd::kSurface)) return;
  const bool nothing_to_end = phase_ == MissionPhase::kFinished && end != MissionEnd::kSurface;
  if (nothing_to_end) return;
  aborted_ = end;
  bids_until_.reset();
  decide("abort", why + "; the mission ends: " + to_text(end), out);
  out.say(MissionOrder{MissionOrder::Kind::kAbort, plan_, end, why});
}

void Captain::order(MissionOrder::Kind kind, const char* what, const std::string& why, Outbox& out) {
  decide(what, why, out);
  out.say(MissionOrder{kind, plan_, MissionEnd::kHold, why});
}

void Captain::decide(const char* what, std::string reason, Outbox& out) const {
  out.say(Decision{now_, "captain", what, std::move(reason)});
}

void Captain::tell(const std::string& text, Outbox& out) const {
  out.say(StatusReport{phase_, point_, plan_ ? plan_->points.size() : 0, text});
}

}  // namespace isobath
