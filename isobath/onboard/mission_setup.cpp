#include <isobath/mission/agents/standard_agents.hpp>
#include <isobath/mission/safety/safety_officer.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <utility>

namespace isobath {

std::vector<Section> vehicle_sections(VehicleParameters& parameters) {
  return {{"vehicle", "Parameters of the vehicle that the agents use.", fields(parameters)}};
}

std::vector<AgentSlot> all_agents(const MissionSetup& setup, const OnboardConfiguration& configuration) {
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
std::unique_ptr<AnyHelm> make_helm(const MissionSetup& setup, const OnboardConfiguration& configuration,
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

std::unique_ptr<SerialHelm> make_serial_helm(const MissionSetup& setup, const OnboardConfiguration& configuration,
                                             const std::shared_ptr<StageTimes>& times) {
  return make_helm<SerialHelm>(setup, configuration, times);
}

std::unique_ptr<ThreadedHelm> make_threaded_helm(const MissionSetup& setup, const OnboardConfiguration& configuration,
                                                 const std::shared_ptr<StageTimes>& times) {
  return make_helm<ThreadedHelm>(setup, configuration, times);
}

}  // namespace isobath
