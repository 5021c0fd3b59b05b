// AgentExecutor: what runs agents, seen from outside: it receives messages for all of them, and faults for tests and
// simulators. Executor runs the agents one after the other, ThreadedExecutor each in a thread of its own.
#pragma once

#include <cstdint>
#include <isobath/mission/messages/agent.hpp>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// What an agent has sent so far: its node in the graph of agents and messages (Ganesan 2015, 5.1; ledger S6-32).
struct AgentReport {
  std::string name;
  AgentLevel level = AgentLevel::kMission;
  std::map<std::string, std::uint64_t> sent;  ///< number of messages, by the names of their types
};
const char* to_text(AgentLevel level);

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
  /// All agents in the order in which they receive messages.
  [[nodiscard]] virtual std::vector<AgentReport> crew() const = 0;
};

}  // namespace isobath
