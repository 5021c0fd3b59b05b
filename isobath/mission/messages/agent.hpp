// Agent: one role of command and control, whose only inputs are messages and time (Ganesan 2015, 5.1; ledger S6-32,
// S6-33). An agent keeps its own state, knows no other agent, and puts its messages into the Outbox that it is given.
// It may throw: the executor then counts it as dead, and the other agents go on.
//
// `on_message` and `tick` are never called at the same time for one agent; two agents may run in two threads.
#pragma once

#include <cstdint>
#include <isobath/mission/messages/messages.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace isobath {

/// Interval between two ticks of an agent.
inline constexpr Duration kTick = std::chrono::milliseconds(100);

enum class AgentLevel : std::uint8_t { kSupervisory, kMission, kVehicle };

/// Collects the messages of one turn; they are posted in order when the turn is over.
class Outbox {
 public:
  template <class T>
  void say(T message) {
    said_.emplace_back(std::move(message));
  }
  [[nodiscard]] std::vector<Message>& said() { return said_; }

 private:
  std::vector<Message> said_;
};

class Agent {
 public:
  Agent() = default;
  Agent(const Agent&) = delete;
  Agent& operator=(const Agent&) = delete;
  virtual ~Agent() = default;

  /// `now`: the logical time of delivery, never before that of an earlier call.
  virtual void on_message(const Message& message, Time now, Outbox& out) = 0;
  /// Called ten times a second of logical time.
  virtual void tick(Time now, Outbox& out) = 0;
};

/// An agent with its name and its level.
struct AgentSlot {
  std::string name;  ///< "navigator"
  AgentLevel level = AgentLevel::kMission;
  std::unique_ptr<Agent> agent;
};

}  // namespace isobath
