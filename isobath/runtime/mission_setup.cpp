#include <array>
#include <fstream>
#include <isobath/io/native_log.hpp>
#include <isobath/mission/mission_file.hpp>
#include <isobath/mission/safety_officer.hpp>
#include <isobath/mission/standard_agents.hpp>
#include <isobath/runtime/mission_setup.hpp>

namespace isobath {
namespace {

namespace fs = std::filesystem;

bool is_mcap(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 16> head{};
  in.read(head.data(), head.size());
  return looks_like_mcap({reinterpret_cast<const std::uint8_t*>(head.data()), static_cast<std::size_t>(in.gcount())});
}

}  // namespace

std::vector<Section> vehicle_sections(VehicleParameters& parameters) {
  return {{"vehicle", "Parameters of the vehicle that the agents use.", fields(parameters)}};
}

std::optional<MissionSetup> mission_setup(const fs::path& mission, const fs::path& input, const Simulator* simulator) {
  MissionSetup setup;
  if (!mission.empty()) {
    const std::string text = text_of_file(mission.string());
    setup.plan =
        looks_like_scene(text) ? parse_scenario(text, mission.string()).mission : load_mission(mission.string());
  } else if (simulator) {
    setup.plan = open_scenario(input).mission;
  }
  if (setup.plan.points.empty()) return std::nullopt;
  if (simulator) {
    setup.vehicle = parameters_of(simulator->vehicle());
  } else if (const auto text = is_mcap(input) ? attachment_in(input, kVehicleAttachment) : std::nullopt) {
    std::vector<Section> vehicle = vehicle_sections(setup.vehicle);
    read_toml(*text, input.string() + ": " + kVehicleAttachment, vehicle);
  }
  return setup;
}

std::vector<AgentSlot> all_agents(const MissionSetup& setup, const Configuration& configuration) {
  std::vector<AgentSlot> slots = standard_agents(configuration.mission, setup.vehicle);
  if (!configuration.executor.arbiter.safety_officer.empty()) {
    slots.push_back({configuration.executor.arbiter.safety_officer, AgentLevel::kSupervisory,
                     std::make_unique<SafetyOfficer>(configuration.safety, setup.vehicle)});
  }
  for (const AgentFile& agent : configuration.agents) slots.push_back(load_agent(agent));
  return slots;
}

namespace {

template <class AnyHelm>
std::unique_ptr<AnyHelm> make_helm(const MissionSetup& setup, const Configuration& configuration,
                                   const std::shared_ptr<StageTimes>& times) {
  std::vector<AgentSlot> slots = all_agents(setup, configuration);
  for (AgentSlot& slot : slots) {
    const bool plans = slot.name == "navigator";
    if (times) slot = timed(std::move(slot), times, plans);
  }
  return std::make_unique<AnyHelm>(std::move(slots), setup.vehicle, configuration.executor,
                                   std::make_shared<const MissionPlan>(setup.plan), setup.chart,
                                   configuration.safety.echo_contrast);
}

}  // namespace

std::unique_ptr<SerialHelm> make_serial_helm(const MissionSetup& setup, const Configuration& configuration,
                                             const std::shared_ptr<StageTimes>& times) {
  return make_helm<SerialHelm>(setup, configuration, times);
}

std::unique_ptr<ThreadedHelm> make_threaded_helm(const MissionSetup& setup, const Configuration& configuration,
                                                 const std::shared_ptr<StageTimes>& times) {
  return make_helm<ThreadedHelm>(setup, configuration, times);
}

std::optional<Recorded> compare_with_log(const std::vector<Decision>& decisions, const fs::path& input) {
  if (!is_mcap(input)) return std::nullopt;
  const std::vector<std::string> recorded = decisions_in(input);
  if (recorded.empty()) return std::nullopt;
  Recorded found{recorded.size(), 0};
  while (found.the_same < std::min(recorded.size(), decisions.size()) &&
         recorded[found.the_same] == decision_json(decisions[found.the_same])) {
    ++found.the_same;
  }
  return found;
}

}  // namespace isobath
