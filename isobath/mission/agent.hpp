// Agent: one role of command and control, deaf to everything but messages and time (Ganesan 2015, 5.1; ledger S6-32,
// S6-33). An agent keeps its own state, knows no other agent, and says what it has to say into the Outbox that it is
// handed. It may throw: whoever runs it takes that for its death, and the others go on.
//
// hear and tick are never called at the same time for one agent; two agents may run in two threads.
#pragma once

#include <cstdint>
#include <isobath/mission/messages.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace isobath {

/// From one turn of an agent to the next.
inline constexpr Duration kTick = std::chrono::milliseconds(100);

enum class AgentLevel : std::uint8_t { kSupervisory, kMission, kVehicle };

/// Where an agent puts what it says; handed on when its turn is over, in order.
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

  /// `now`: the logical time at which it is delivered, not before that of any call before.
  virtual void hear(const Message& message, Time now, Outbox& out) = 0;
  /// Ten times a second of logical time.
  virtual void tick(Time now, Outbox& out) = 0;
};

/// An agent with its place in the ship.
struct Seat {
  std::string name;  ///< "navigator"
  AgentLevel level = AgentLevel::kMission;
  std::unique_ptr<Agent> agent;
};

}  // namespace isobath
