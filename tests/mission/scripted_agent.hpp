// ScriptedAgent: does what a test tells it to. Messages of the tests are task calls with numbers: they mean nothing to
// the agents.
#pragma once

#include <fmt/format.h>
#include <functional>
#include <isobath/mission/command/bus.hpp>
#include <tests/mission/agent_script.hpp>

namespace isobath::test {

using isobath::at;

struct ScriptedAgent : Agent {
  using Hear = std::function<void(const Message&, Time, Outbox&)>;
  using Tick = std::function<void(Time, Outbox&)>;
  explicit ScriptedAgent(Hear h, Tick t = {}) : on_hear(std::move(h)), on_tick(std::move(t)) {}

  void on_message(const Message& message, Time now, Outbox& out) override {
    if (on_hear) on_hear(message, now, out);
  }
  void tick(Time now, Outbox& out) override {
    if (on_tick) on_tick(now, out);
  }

  Hear on_hear;
  Tick on_tick;
};

inline AgentSlot slot(std::string name, ScriptedAgent::Hear hear, ScriptedAgent::Tick tick = {}) {
  return {std::move(name), AgentLevel::kMission, std::make_unique<ScriptedAgent>(std::move(hear), std::move(tick))};
}
template <class... Slots>
std::vector<AgentSlot> slots(Slots&&... each) {
  std::vector<AgentSlot> all;
  (all.push_back(std::forward<Slots>(each)), ...);
  return all;
}

inline Message call(std::uint32_t id) { return TaskCall{id, "", {}}; }
/// Of a task call; 0: it is none.
inline std::uint32_t id_of(const Message& message) {
  const auto* task = std::get_if<TaskCall>(&message);
  return task ? task->id : 0;
}
/// "task call 3", "agent lost pilot", "decision cut".
inline std::string text_of(const Message& message) {
  std::string text = message_name(message);
  if (const auto* task = std::get_if<TaskCall>(&message)) text += fmt::format(" {}", task->id);
  if (const auto* lost = std::get_if<AgentLost>(&message)) text += " " + lost->agent + (lost->hung ? " hung" : "");
  if (const auto* decision = std::get_if<Decision>(&message)) text += " " + decision->what;
  return text;
}

}  // namespace isobath::test
