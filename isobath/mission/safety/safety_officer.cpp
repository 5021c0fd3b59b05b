#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/safety/safety_officer.hpp>

namespace isobath {
namespace {

constexpr const char* kName = "safety officer";
constexpr double kOtherHeading = 0.035;      // rad: a set-point that differs by less is the same
constexpr double kOtherDepth = 0.2;          // m
constexpr double kOtherSpeed = 0.02;         // m/s
constexpr double kLead = 2, kLeastLead = 1;  // rad: in a circle, the set-point is so far ahead of the heading
constexpr double kLeastUnknown = 0.3;        // m/s: least standard deviation of a current before any measurement
constexpr double kRise = 0.5;                // m, beyond the altitude at which it is no longer too low

ImminentCollisionConfig imminent_config(const SafetyConfig& config, const VehicleParameters& vehicle) {
  ImminentCollisionConfig c;
  c.reaction_s = config.reaction_s;
  c.braking = std::max(vehicle.braking, 0.001);
  c.margin_m = config.collision_margin_m;
  return c;
}

bool same(const SafetyAction& a, const SafetyAction& b) {
  if (a.kind != b.kind || a.fault != b.fault) return false;
  const bool steers = a.kind == SafetyActionKind::kTurn || a.kind == SafetyActionKind::kSurface;
  if (!steers) return true;
  return abs((a.setpoint.heading - b.setpoint.heading).wrapped()).radians() < kOtherHeading &&
         std::abs(a.setpoint.depth - b.setpoint.depth) < kOtherDepth &&
         std::abs(a.setpoint.speed - b.setpoint.speed) < kOtherSpeed;
}

}  // namespace

SafetyOfficer::SafetyOfficer(const SafetyConfig& config, const VehicleParameters& vehicle)
    : config_(config),
      vehicle_(vehicle),
      imminent_(imminent_config(config, vehicle), SensorTable::kMax),
      current_(std::max(config.unknown_current, kLeastUnknown)) {}

void SafetyOfficer::tick(Time now, Outbox& out) {
  set_clock(now);
  told_ = false;
  check_sonars();
  check_navigation();
  check_altitude();
  check_way();
  check_route();
  check_limits();
  check_host();
  check_collision();
  for (const FaultRow& about : fault_table()) settle(about, now, out);
  act(now, out);
}

void SafetyOfficer::settle(const FaultRow& about, Time now, Outbox& out) {
  Row& own = row(about.fault);
  const bool aborts = about.fault != Fault::kLinkLost || config_.link_policy != LinkPolicy::kContinue;
  const auto end_mission = [&] {
    return under_way() && aborts && !own.aborted && about.abort.due(clock_s_ - own.since_s, config_);
  };
  if (own.cause) {
    own.last_cause_s = clock_s_;
    if (!own.raised) {
      own.raised = true;
      own.since_s = clock_s_;
      own.aborted = false;
      own.aborted = end_mission();
      report(about, true, own.aborted, now, out);
    }
  } else if (own.raised && about.over != Over::kNever &&
             (about.over == Over::kAtOnce || clock_s_ - own.last_cause_s >= config_.clear_after_s)) {
    own.raised = false;
    report(about, false, own.aborted, now, out);
  }
  if (own.raised && end_mission()) {
    own.aborted = true;
    report(about, true, true, now, out);
  }
  own.cause = false;
}

void SafetyOfficer::report(const FaultRow& about, bool active, bool abort, Time now, Outbox& out) {
  const Row& own = row(about.fault);
  SafetyReport report;
  report.fault = about.name;
  report.active = active;
  report.abort = abort;
  report.end = end_of(about.fault);
  report.why = own.why;
  out.say(report);
  Decision decision;
  decision.time = now;
  decision.agent = kName;
  const SafetyActionKind kind = asked(about);
  decision.what = !active ? "over" : abort ? "abort" : kind == SafetyActionKind::kNone ? "report" : to_text(kind);
  decision.reason = active ? fmt::format("{}: {}", about.name, own.why)
                           : fmt::format("{}: over after {:.1f} s", about.name, clock_s_ - own.since_s);
  decision.obstacle = own.place;
  decision.margin_m = own.margin_m;
  out.say(decision);
  told_ = true;
}

MissionEnd SafetyOfficer::end_of(Fault fault) const {
  const MissionEnd planned = plan_ ? plan_->at_end : MissionEnd::kSurface;
  switch (fault) {
    case Fault::kLeak: return MissionEnd::kSurface;
    case Fault::kBatteryLow: return planned == MissionEnd::kHold ? MissionEnd::kSurface : planned;
    case Fault::kMissionTooLong: return planned;
    case Fault::kLinkLost:
      return config_.link_policy == LinkPolicy::kReturn ? MissionEnd::kReturn : MissionEnd::kSurface;
    default: return config_.abort_end;
  }
}

SafetyActionKind SafetyOfficer::asked(const FaultRow& about) const {
  const Row& own = rows_[static_cast<std::size_t>(about.fault)];
  const bool instead = vehicle_.min_speed > 0 && about.unstoppable != SafetyActionKind::kNone;
  SafetyActionKind kind = instead ? about.unstoppable : about.action;
  if (about.later != SafetyActionKind::kNone && about.later_after.due(clock_s_ - own.since_s, config_)) {
    kind = about.later;
  }
  if (about.fault == Fault::kCollisionUnavoidable && hemmed_in_) kind = SafetyActionKind::kSurface;
  if (about.fault == Fault::kCollisionAhead && stopped_) kind = SafetyActionKind::kTurn;
  const bool stops = kind == SafetyActionKind::kStop || about.fault == Fault::kCollisionAhead;
  if (stops && (vehicle_.min_speed > 0 || surfacing_)) kind = SafetyActionKind::kSurface;
  return kind;
}

SafetyAction SafetyOfficer::strongest() const {
  SafetyAction action;
  for (const FaultRow& about : fault_table()) {
    const Row& own = rows_[static_cast<std::size_t>(about.fault)];
    if (!own.raised || asked(about) <= action.kind) continue;
    action.kind = asked(about);
    action.fault = about.name;
    action.why = own.why;
  }
  action.setpoint = turned(action);
  return action;
}

/// The heading away from a collision, else from the fence.
std::optional<Angle> SafetyOfficer::way_out() const {
  if (raised(Fault::kCollisionUnavoidable) && turn_) return turn_;
  if (raised(Fault::kFenceAhead) || raised(Fault::kFenceBreach)) return inward_;
  return {};
}

/// The speed of an escape of a vehicle that cannot stop: at least that at which it turns fastest. Slower it turns on
/// the same circle (fins turn it by the water that flows past them), and a current carries it farther meanwhile.
double SafetyOfficer::escape_speed(double ordered) const {
  if (vehicle_.min_speed <= 0) return ordered;
  const double turns_fastest = vehicle_.limits.max_yaw_rate.radians() * vehicle_.limits.turning_radius;
  return std::max(ordered, std::min(turns_fastest, vehicle_.limits.max_speed));
}

/// The set-point that goes with an action; never faster than the last order, but for an escape.
Setpoint SafetyOfficer::turned(const SafetyAction& action) const {
  const Angle heading = fix_ ? fix_->navigation.X_WB.rotation.heading() : order_ ? order_->heading : Angle{};
  const double depth = fix_ ? fix_->navigation.X_WB.translation.z() : order_ ? order_->depth : 0;
  const double ordered = order_ ? order_->speed : 0;
  Setpoint s{order_ ? order_->heading : heading, order_ ? order_->depth : std::max(0.0, depth), 0, 0};
  switch (action.kind) {
    case SafetyActionKind::kNone: return {};
    case SafetyActionKind::kSlow: s.speed = config_.slow_speed; return s;
    case SafetyActionKind::kStop: return {heading, std::max(0.0, depth), 0, 0};
    case SafetyActionKind::kSurface: {  // in a circle, or on the heading of that instant; away from an obstacle
      const bool held = action_.kind == SafetyActionKind::kSurface;
      const std::optional<Angle> away = way_out();
      const double speed = away ? escape_speed(ordered) : std::min(ordered, vehicle_.min_speed);
      Angle kept = held ? action_.setpoint.heading : heading;
      if (circle_ != 0) {
        const double lead = circle_ * (kept - heading).wrapped().radians();
        if (lead < kLeastLead) kept = (heading + Angle::radians(circle_ * kLead)).wrapped();
      }
      return {away.value_or(kept), 0, vehicle_.min_speed > 0 ? speed : 0, 0};
    }
    case SafetyActionKind::kTurn: break;
  }
  if (raised(Fault::kTooLow)) {
    const double least = (plan_ ? plan_->limits.min_altitude_m : 0) / std::max(config_.clear_share, 0.1);
    const double lack = least - altitude_.last_m;  // a plan that came since may ask for what is no number
    s.depth = std::clamp(depth - (std::isfinite(lack) ? lack : 0) - kRise, 0.0, std::max(0.0, depth));
    const bool may_rise = depth > kOtherDepth;  // else every metre ahead brings it nearer to a rising bottom
    s.speed = may_rise ? std::min(ordered, std::max(config_.slow_speed, vehicle_.min_speed)) : 0;
  }
  for (const FaultRow& about : fault_table()) {
    const bool stops =
        raised(about.fault) && (about.fault == Fault::kCollisionAhead || asked(about) == SafetyActionKind::kStop);
    if (stops) s.speed = std::min(s.speed, 0.0);
  }
  if (const std::optional<Angle> away = way_out()) {
    s.heading = *away;
    s.speed = escape_speed(ordered);
  }
  return s;
}

void SafetyOfficer::act(Time now, Outbox& out) {
  SafetyAction next = strongest();
  if (same(next, action_)) return;
  const bool other = next.kind != action_.kind || next.fault != action_.fault;
  action_ = std::move(next);
  out.say(action_);
  if (told_ || !other) return;
  const char* what = action_.kind == SafetyActionKind::kNone ? "resume" : to_text(action_.kind);
  out.say(Decision{now, kName, what, fmt::format("{}: {}", action_.fault, action_.why)});
}

}  // namespace isobath
