// MissionSetup: the plan, vehicle parameters and chart of a mission, and the agents made for them.
#pragma once

#include <isobath/mission/plan/mission_plan.hpp>
#include <isobath/onboard/onboard_configuration.hpp>
#include <isobath/onboard/serial_helm.hpp>
#include <isobath/onboard/stage_times.hpp>
#include <isobath/onboard/threaded_helm.hpp>
#include <memory>
#include <vector>

namespace isobath {

/// Name of the attachment of a recording that holds the vehicle parameters.
inline constexpr const char* kVehicleAttachment = "vehicle_sheet.toml";

/// What the agents of a mission are made for.
struct MissionSetup {
  MissionPlan plan;
  VehicleParameters vehicle;
  WorldSnapshot chart = {};
};
/// The vehicle parameters as the section [vehicle] of a file.
std::vector<Section> vehicle_sections(VehicleParameters& parameters);

/// All agents, including the Safety Officer and the agents loaded from libraries. Throws Error if one cannot be made.
std::vector<AgentSlot> all_agents(const MissionSetup& setup, const OnboardConfiguration& configuration);
/// The helm with all agents: in one thread (SerialHelm), or each agent in its own (ThreadedHelm). `times` receives the
/// times of the agents' turns; null: they are not timed. Throws Error if the helm cannot be made.
std::unique_ptr<SerialHelm> make_serial_helm(const MissionSetup& setup, const OnboardConfiguration& configuration,
                                             const std::shared_ptr<StageTimes>& times = nullptr);
std::unique_ptr<ThreadedHelm> make_threaded_helm(const MissionSetup& setup, const OnboardConfiguration& configuration,
                                                 const std::shared_ptr<StageTimes>& times = nullptr);

}  // namespace isobath
