#include <dlfcn.h>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <isobath/mission/command/agent_library.hpp>
#include <system_error>

namespace isobath {
namespace {

std::string last_problem() {
  const char* text = dlerror();
  return text ? text : "";
}

const AgentEntry& entry_of(const std::string& library, const Place& place) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(library, unreadable)) {
    throw Error("no such file: '" + library + "'", place, "a shared library");
  }
  const std::string path = std::filesystem::absolute(library).string();  // dlopen would look for a bare name elsewhere
  void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (!handle) throw Error("'" + library + "' cannot be loaded", place, "a shared library", last_problem());
  const void* symbol = dlsym(handle, "isobath_agent");
  if (!symbol) {
    throw Error("'" + library + "' exports no agent", place, "a library with ISOBATH_AGENT(...)", last_problem());
  }
  const auto& entry = *static_cast<const AgentEntry*>(symbol);
  const AgentEntry ours;
  if (entry.interface != ours.interface || entry.message_types != ours.message_types ||
      entry.message_bytes != ours.message_bytes) {
    throw Error(
        fmt::format("'{}' was built for another interface: version {}, {} message types of {} bytes", library,
                    entry.interface, entry.message_types, entry.message_bytes),
        place,
        fmt::format("version {}, {} message types of {} bytes", ours.interface, ours.message_types, ours.message_bytes),
        "build it again with the headers of this version");
  }
  return entry;
}

}  // namespace

std::vector<Field> fields(AgentFile& a) {
  return {
      Field::text("name", &a.name, "Name of the agent."),
      Field::choice("level", &a.level,
                    {{"supervisory", AgentLevel::kSupervisory},
                     {"mission", AgentLevel::kMission},
                     {"vehicle", AgentLevel::kVehicle}},
                    "Level of the agent."),
      Field::file("library", &a.library, "Shared library that contains the agent."),
  };
}

SectionList agent_list(std::vector<AgentFile>& agents) {
  return {"agent", "An agent that is loaded from a shared library.", [&agents](const Place& place) {
            agents.emplace_back();
            agents.back().place = place;
            return fields(agents.back());
          }};
}

AgentSlot load_agent(const AgentFile& agent) {
  const AgentEntry& entry = entry_of(agent.library, agent.place);
  try {
    return {agent.name, agent.level, entry.make()};
  } catch (const std::exception& e) {
    throw Error("the agent '" + agent.name + "' could not be created: " + e.what(), agent.place);
  }
}

}  // namespace isobath
