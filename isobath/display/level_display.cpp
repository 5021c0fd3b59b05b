#include <fmt/format.h>
#include <isobath/display/level_display.hpp>
#include <nlohmann/json.hpp>
#include <utility>

namespace isobath {
namespace {

using nlohmann::ordered_json;

constexpr Duration kOften = std::chrono::seconds(1);

std::string setpoint_text(const Setpoint& s) {
  std::string text = fmt::format("heading {:.0f} deg, depth {:.1f} m, {:.2f} m/s",
                                 s.heading.wrapped_positive().degrees(), s.depth, s.speed);
  if (s.sway_speed != 0) text += fmt::format(", {:.2f} m/s to starboard", s.sway_speed);
  return text;
}

struct CommandText {
  std::string operator()(const MissionOrder& m) const {
    const std::string what = to_text(m.kind);
    return m.plan && !m.plan->title.empty() ? what + ": " + m.plan->title : what + ": " + m.why;
  }
  std::string operator()(const VisitOrder& m) const { return m.why; }
  std::string operator()(const RouteRequest& m) const { return "go to " + m.target.name; }
  std::string operator()(const RoutePlanned& m) const { return m.why; }
  std::string operator()(const FollowOrder& m) const {
    if (m.surface) return "surface";
    if (m.waypoints.empty()) return "hold the position";
    return fmt::format("follow {} way-point{}", m.waypoints.size(), m.waypoints.size() == 1 ? "" : "s");
  }
  std::string operator()(const MotionOrder& m) const {
    return fmt::format("past bodies that move, at {:.2f} m/s", m.velocity_W.norm());
  }
  std::string operator()(const HelmOrder& m) const { return setpoint_text(m.setpoint); }
  std::string operator()(const SafetyAction& m) const {
    return m.kind == SafetyActionKind::kNone ? "no safety action" : fmt::format("{}: {}", to_text(m.kind), m.why);
  }
  template <class Other>
  std::string operator()(const Other&) const {
    return {};
  }
};

}  // namespace

std::string command_text(const Message& message) { return std::visit(CommandText{}, message); }

void LevelDisplay::on_message(const Envelope& envelope) {
  if (const auto* plan = std::get_if<LevelPlan>(&envelope.message)) {
    horizon_s_[static_cast<std::size_t>(plan->level)] = plan->horizon_s;
  }
  if (const auto* step = std::get_if<PlanStep>(&envelope.message)) {
    step_ = text_of_step(*step);
    show(envelope.time, false);
  }
  if (!envelope.link) return;
  put(envelope.link->level,
      {envelope.number, envelope.link->parent, envelope.time, envelope.sender, command_text(envelope.message)});
}

void LevelDisplay::on_servo(Time time, std::uint64_t parent, const std::string& text) {
  put(CommandLevel::kServo, {0, parent, time, kCommandArbiter, text});
}

void LevelDisplay::put(CommandLevel level, Command command) {
  Command& now = levels_[static_cast<std::size_t>(level)];
  const Time time = command.since;
  if (now.text == command.text && now.by == command.by) command.since = now.since;
  now = std::move(command);
  show(time, level >= CommandLevel::kPrimitive);
}

void LevelDisplay::show(Time time, bool often) {
  if (often && shown_ && time >= *shown_ && time - *shown_ < kOften) return;
  if (!shown_ || time > *shown_) shown_ = time;
  ordered_json all = ordered_json::array();
  for (std::size_t i = 0; i < kCommandLevels; ++i) {
    const Command& one = levels_[i];
    if (one.by.empty()) continue;
    all.push_back({{"level", to_text(static_cast<CommandLevel>(i))},
                   {"command", one.text},
                   {"by", one.by},
                   {"since_ns", one.since.time_since_epoch().count()},
                   {"number", one.number},
                   {"parent", one.parent},
                   {"horizon_s", horizon_s_[i]}});
    if (i == static_cast<std::size_t>(CommandLevel::kVehicle)) all.back()["plan"] = step_;
  }
  items_.set(DisplayKind::kLevels, 0, *shown_, all.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
}

}  // namespace isobath
