#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/command/bus.hpp>
#include <isobath/mission/command/command_arbiter.hpp>
#include <utility>

namespace isobath {
namespace {

bool finite_setpoint(const Setpoint& s) {
  return std::isfinite(s.heading.radians()) && std::isfinite(s.depth) && std::isfinite(s.speed) &&
         std::isfinite(s.sway_speed);
}

Setpoint slowed(Setpoint s, double limit) {
  s.speed = std::clamp(s.speed, -limit, limit);
  s.sway_speed = std::clamp(s.sway_speed, -limit, limit);
  return s;
}

bool same(const Setpoint& a, const Setpoint& b) {
  return a.depth == b.depth && a.speed == b.speed && a.sway_speed == b.sway_speed;
}

}  // namespace

const char* to_text(HelmState state) {
  switch (state) {
    case HelmState::kWaiting: return "wait";
    case HelmState::kOrders: return "follow orders";
    case HelmState::kSlow: return "slow";
    case HelmState::kStop: return "stop";
    case HelmState::kTurn: return "turn";
    case HelmState::kSurface: return "surface";
  }
  return "";
}

std::vector<Field> fields(CommandArbiterConfig& c) {
  return {
      Field::real("order_timeout_s", &c.order_timeout_s, {0.1, 60}, "s",
                  "The vehicle stops when it has had no order for this long.")
          .was("order_patience"),
      Field::text("safety_officer", &c.safety_officer,
                  "The agent whose loss makes the vehicle surface; empty: no such agent."),
  };
}

void CommandArbiter::on_action(SafetyAction action) {
  const bool steers = action.kind == SafetyActionKind::kTurn || action.kind == SafetyActionKind::kSlow;
  const bool backwards = action.kind == SafetyActionKind::kSlow && action.setpoint.speed < 0;
  if (steers && (!finite_setpoint(action.setpoint) || backwards)) {
    ++refused_;
    action.kind = SafetyActionKind::kStop;
  }
  action_ = std::move(action);
}

void CommandArbiter::on_message(const Message& message, Time now, std::uint64_t number) {
  if (const auto* command = std::get_if<OperatorCommand>(&message)) {
    if (command->kind == OperatorCommand::Kind::kStart && !first_) first_ = now;
  }
  if (const auto* order = std::get_if<MissionOrder>(&message)) {
    const bool starts = order->kind == MissionOrder::Kind::kStart && order->plan;
    if (starts) deepest_ = std::min(vehicle_.limits.max_depth, order->plan->limits.max_depth_m);
  }
  if (const auto* order = std::get_if<HelmOrder>(&message)) {
    if (!finite_setpoint(order->setpoint)) {
      ++refused_;
      return;
    }
    order_ = *order;
    ordered_ = now;
    order_number_ = number;
  } else if (const auto* action = std::get_if<SafetyAction>(&message)) {
    action_number_ = number;
    on_action(*action);
  } else if (const auto* lost = std::get_if<AgentLost>(&message)) {
    if (!config_.safety_officer.empty() && lost->agent == config_.safety_officer) safety_lost_ = lost->why;
  } else if (const auto* navigation = std::get_if<Navigation>(&message)) {
    if (!navigation->X_WB.is_finite()) return;
    here_ = *navigation;
  }
}

CommandArbiter::Verdict CommandArbiter::judge(Time now) const {
  if (safety_lost_) {
    return {HelmState::kSurface, config_.safety_officer,
            fmt::format("the {} is lost: {}", config_.safety_officer, *safety_lost_)};
  }
  const auto acted = [&](HelmState state) { return Verdict{state, action_.fault, action_.why}; };
  if (action_.kind == SafetyActionKind::kSurface) return acted(HelmState::kSurface);
  if (action_.kind == SafetyActionKind::kTurn) return acted(HelmState::kTurn);
  if (action_.kind == SafetyActionKind::kStop) return acted(HelmState::kStop);
  const Time since = order_ ? ordered_ : first_.value_or(now);
  if (now - since > seconds(config_.order_timeout_s)) {
    return {HelmState::kStop, "no order", fmt::format("no order for the vehicle for {} s", config_.order_timeout_s)};
  }
  if (!order_) return {HelmState::kWaiting, "", "no order has come yet"};
  if (action_.kind == SafetyActionKind::kSlow) return acted(HelmState::kSlow);
  return {HelmState::kOrders, "", "no fault overrides the order"};
}

Setpoint CommandArbiter::setpoint() const {
  Setpoint s = kept_.value_or(last_);
  s.speed = 0;
  s.sway_speed = 0;
  switch (state_) {
    case HelmState::kWaiting: return s;
    case HelmState::kOrders: return order_->setpoint;
    case HelmState::kSlow: return slowed(order_->setpoint, std::max(action_.setpoint.speed, vehicle_.min_speed));
    case HelmState::kTurn:
      s = action_.setpoint;
      if (vehicle_.min_speed > 0) s.speed = std::max(s.speed, vehicle_.min_speed);  // others may go astern
      return s;
    case HelmState::kStop:
    case HelmState::kSurface:
      s.speed = vehicle_.min_speed;
      if (state_ == HelmState::kSurface || vehicle_.min_speed > 0) s.depth = 0;
      if (state_ == HelmState::kSurface && !safety_lost_ && finite_setpoint(action_.setpoint)) {
        s.heading = action_.setpoint.heading;
        if (vehicle_.min_speed > 0) s.speed = std::max(s.speed, action_.setpoint.speed);
      }
      return s;
  }
  return s;
}

/// Sway is reduced where both speeds together would be too fast.
Setpoint CommandArbiter::allowed(Setpoint s) const {
  const double most = vehicle_.limits.max_speed;
  s.depth = std::clamp(s.depth, 0.0, deepest_);
  s.speed = std::clamp(s.speed, -most, most);
  const double side = std::sqrt(std::max(0.0, most * most - s.speed * s.speed));
  s.sway_speed = std::clamp(s.sway_speed, -side, side);
  return s;
}

// The faster it drifts across the hull, the farther the turn; with the bow to the current it drifts no more.
void CommandArbiter::stem_current() {
  constexpr double kStanding = 0.3, kDrift = 0.03;  // m/s
  constexpr double kTurn_per_drift = 5;             // rad per m/s
  constexpr double kMaxTurn = 1;                    // rad
  if (!here_ || !here_->v_WB || !here_->v_WB->allFinite()) return;
  const Angle heading = here_->X_WB.rotation.heading();
  const Eigen::Vector2d v_W = here_->v_WB->head<2>();
  const double ahead = v_W.dot(Eigen::Vector2d(cos(heading), sin(heading)));
  const double across = v_W.dot(Eigen::Vector2d(-sin(heading), cos(heading)));
  if (std::abs(ahead) > kStanding || std::abs(across) < std::max(kDrift, here_->v_sigma.value_or(0))) return;
  kept_->heading = (heading - Angle::radians(std::clamp(kTurn_per_drift * across, -kMaxTurn, kMaxTurn))).wrapped();
}

Setpoint CommandArbiter::steer(Time now) {
  Verdict verdict = judge(now);
  if (verdict.state != state_) kept_.reset();
  if (verdict.state != state_ || verdict.fault != fault_) {
    change_ = Decision{now, kCommandArbiter, to_text(verdict.state), verdict.why};
    state_ = verdict.state;
    fault_ = std::move(verdict.fault);
  }
  if (!kept_ && here_) kept_ = Setpoint{here_->X_WB.rotation.heading(), here_->X_WB.translation.z(), 0, 0};
  if (state_ == HelmState::kStop && vehicle_.min_speed <= 0) stem_current();
  const Setpoint wanted = setpoint();
  last_ = allowed(wanted);
  limited_ += same(wanted, last_) ? 0 : 1;
  return last_;
}

std::uint64_t CommandArbiter::served() const {
  switch (state_) {
    case HelmState::kOrders:
    case HelmState::kSlow: return order_number_;
    case HelmState::kTurn: return action_number_;
    case HelmState::kStop:
    case HelmState::kSurface: return action_.kind == SafetyActionKind::kNone ? 0 : action_number_;
    case HelmState::kWaiting: break;
  }
  return 0;
}

std::optional<Decision> CommandArbiter::take_change() { return std::exchange(change_, std::nullopt); }

}  // namespace isobath
