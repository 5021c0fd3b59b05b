// MissionSetup: what a crew is made for, from the files that say so, and the crew itself.
#pragma once

#include <filesystem>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/live_helm.hpp>
#include <isobath/runtime/mission_helm.hpp>
#include <isobath/runtime/mission_outcome.hpp>
#include <isobath/runtime/scenario.hpp>
#include <isobath/runtime/stage_times.hpp>
#include <optional>
#include <vector>

namespace isobath {

/// Name of the vehicle sheet among the attachments of a recording.
inline constexpr const char* kVehicleAttachment = "vehicle_sheet.toml";

/// What a crew is made for.
struct MissionSetup {
  MissionPlan plan;
  VehicleSheet vehicle;
  ChartUpdate chart = {};
};
/// A vehicle's sheet as a file has it: [vehicle].
std::vector<Section> vehicle_sections(VehicleSheet& sheet);

/// For an input that is a scenario or a log: `mission` names a mission file or another scenario, or, empty, leaves it
/// to the scenario itself. The vehicle is the simulator's; of a log the one that it was recorded with, else the
/// default one. Empty where there is no mission point. Throws Error.
std::optional<MissionSetup> mission_setup(const std::filesystem::path& mission, const std::filesystem::path& input,
                                          const Simulator* simulator);
/// All agents, the Safety Officer and those of libraries among them. Throws Error where one cannot be made.
std::vector<Seat> whole_crew(const MissionSetup& setup, const Configuration& configuration);
/// The whole crew at the helm, in one thread, or each agent in its own. `times`: that its seats are timed by; null:
/// they are not. Throws Error where it cannot be made.
std::unique_ptr<MissionHelm> make_mission_helm(const MissionSetup& setup, const Configuration& configuration,
                                               const std::shared_ptr<StageTimes>& times = nullptr);
std::unique_ptr<LiveHelm> make_live_helm(const MissionSetup& setup, const Configuration& configuration,
                                         const std::shared_ptr<StageTimes>& times = nullptr);

/// How many decisions, from the first on, are those that the log holds, and how many it holds; empty where the input is
/// no log with decisions.
struct Recorded {
  std::uint64_t decisions = 0, the_same = 0;
};
std::optional<Recorded> compare_with_log(const std::vector<Decision>& decisions, const std::filesystem::path& input);

}  // namespace isobath
