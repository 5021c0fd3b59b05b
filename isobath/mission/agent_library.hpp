// Agents from shared libraries: a new agent is loaded by configuration, not compiled in (Ganesan 2015, 5.1; ledger
// S6-33).
//
//   [[agent]]                                 // my_agent.cpp, built as a shared library against these headers
//   name = "lookout"                          #include <isobath/mission/agent_library.hpp>
//   level = "mission"                         class Lookout : public isobath::Agent { ... };
//   library = "liblookout.so"                 ISOBATH_AGENT(Lookout)
//
// A library that was built against other messages is refused: interface version, number of message types and size of a
// message must be the same. This guards against mistakes, not against malice: a library is code, and runs as such.
//
// Libraries stay loaded for good: what an agent has said may outlive it, and is released by code of its library.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/mission/agent.hpp>

namespace isobath {

/// What both sides must agree on. To be counted up when a message or Agent changes its meaning, not its size.
inline constexpr std::uint32_t kAgentInterface = 1;

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
/// [[agent]] tables; what is read goes to the end of `agents`, which must outlive the reading.
SectionList agent_list(std::vector<AgentFile>& agents);

/// Throws Error with the place where there is no such file, it is no library or has no agent, it was built against
/// another interface, or its agent throws when it is made.
Seat load_agent(const AgentFile& agent);

}  // namespace isobath

#define ISOBATH_AGENT(Type)                                                                      \
  extern "C" __attribute__((visibility("default"))) const isobath::AgentEntry isobath_agent;     \
  const isobath::AgentEntry isobath_agent = {                                                    \
      isobath::kAgentInterface, std::variant_size_v<isobath::Message>, sizeof(isobath::Message), \
      []() -> std::unique_ptr<isobath::Agent> { return std::make_unique<Type>(); }};
