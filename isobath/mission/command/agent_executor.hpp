// AgentExecutor: what runs agents, seen from outside: it receives messages for all of them, and faults for tests and
// simulators. Executor runs the agents one after the other, ThreadedExecutor each in a thread of its own.
#pragma once

#include <isobath/mission/messages/messages.hpp>
#include <string_view>

namespace isobath {

class AgentExecutor {
 public:
  AgentExecutor() = default;
  AgentExecutor(const AgentExecutor&) = delete;
  AgentExecutor& operator=(const AgentExecutor&) = delete;
  virtual ~AgentExecutor() = default;

  /// Sends a message to all agents. Returns false where it was refused.
  virtual bool on_message(Message sensed, Time now) = 0;

  [[nodiscard]] virtual bool has(std::string_view name) const = 0;  ///< whether there is such an agent
  /// Faults: an agent hangs or dies. The name must be that of an agent.
  virtual void hang(std::string_view name) = 0;
  virtual void kill(std::string_view name) = 0;
};

}  // namespace isobath
