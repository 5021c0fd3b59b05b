// Agents from shared libraries: the configuration loads an agent that is not compiled in (Ganesan 2015, 5.1; ledger
// S6-33).
//
//   [[agent]]                                 // my_agent.cpp, built as a shared library against these headers
//   name = "lookout"                          #include <isobath/mission/command/agent_library.hpp>
//   level = "mission"                         class Lookout : public isobath::Agent { ... };
//   library = "liblookout.so"                 ISOBATH_AGENT(Lookout)
//
// A library that was built against other messages is refused: interface version, number of message types and size of a
// message must be the same. This guards against mistakes, not against malice: a library is code, and runs as such.
//
// Libraries are never unloaded: a message may outlive its agent, and code of the agent's library releases it.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/mission/messages/agent.hpp>

namespace isobath {

/// Both sides must have the same number. Raise it when a message or Agent changes its meaning but not its size.
inline constexpr std::uint32_t kAgentInterface = 2;

/// What a library exports as `isobath_agent`.
struct AgentEntry {
  std::uint32_t interface = kAgentInterface;
  std::uint32_t message_types = std::variant_size_v<Message>;
  std::uint32_t message_bytes = sizeof(Message);
  std::unique_ptr<Agent> (*make)() = nullptr;
};

struct AgentFile {
  Place place;  ///< in the configuration
  std::string name;
  AgentLevel level = AgentLevel::kMission;
  std::string library;
};
std::vector<Field> fields(AgentFile& agent);
/// [[agent]] tables. Each one that is read is appended to `agents`, which must outlive the reading.
SectionList agent_list(std::vector<AgentFile>& agents);

/// Throws Error with the place where the file does not exist, is no library or exports no agent, where it was built for
/// another interface, or where its agent throws in its constructor.
AgentSlot load_agent(const AgentFile& agent);

}  // namespace isobath

#define ISOBATH_AGENT(Type)                                                                      \
  extern "C" __attribute__((visibility("default"))) const isobath::AgentEntry isobath_agent;     \
  const isobath::AgentEntry isobath_agent = {                                                    \
      isobath::kAgentInterface, std::variant_size_v<isobath::Message>, sizeof(isobath::Message), \
      []() -> std::unique_ptr<isobath::Agent> { return std::make_unique<Type>(); }};
