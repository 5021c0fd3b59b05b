// MissionSetup: the plan, vehicle parameters and chart of a mission, read from files, and the agents made for them.
#pragma once

#include <filesystem>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/mission_outcome.hpp>
#include <isobath/runtime/scenario.hpp>
#include <isobath/runtime/serial_helm.hpp>
#include <isobath/runtime/stage_times.hpp>
#include <isobath/runtime/threaded_helm.hpp>
#include <optional>
#include <vector>

namespace isobath {

/// Name of the attachment of a recording that holds the vehicle parameters.
inline constexpr const char* kVehicleAttachment = "vehicle_sheet.toml";

/// What the agents of a mission are made for.
struct MissionSetup {
  MissionPlan plan;
  VehicleParameters vehicle;
  ChartUpdate chart = {};
};
/// The vehicle parameters as the section [vehicle] of a file.
std::vector<Section> vehicle_sections(VehicleParameters& parameters);

/// The setup for an input that is a scenario or a log. `mission` names a mission file or another scenario; if it is
/// empty, the mission of the scenario is used. The vehicle is that of the simulator, or the one recorded in the log, or
/// the default one. Returns nothing if the mission has no points. Throws Error if a file cannot be used.
std::optional<MissionSetup> mission_setup(const std::filesystem::path& mission, const std::filesystem::path& input,
                                          const Simulator* simulator);
/// All agents, including the Safety Officer and the agents loaded from libraries. Throws Error if one cannot be made.
std::vector<AgentSlot> all_agents(const MissionSetup& setup, const Configuration& configuration);
/// The helm with all agents: in one thread (SerialHelm), or each agent in its own (ThreadedHelm). `times` receives the
/// times of the agents' turns; null: they are not timed. Throws Error if the helm cannot be made.
std::unique_ptr<SerialHelm> make_serial_helm(const MissionSetup& setup, const Configuration& configuration,
                                             const std::shared_ptr<StageTimes>& times = nullptr);
std::unique_ptr<ThreadedHelm> make_threaded_helm(const MissionSetup& setup, const Configuration& configuration,
                                                 const std::shared_ptr<StageTimes>& times = nullptr);

/// The number of decisions in the log, and how many of them, from the first on, equal those of this run. Empty if the
/// input is not a log with decisions.
struct Recorded {
  std::uint64_t decisions = 0, the_same = 0;
};
std::optional<Recorded> compare_with_log(const std::vector<Decision>& decisions, const std::filesystem::path& input);

}  // namespace isobath
