// mission_setup: the plan and the vehicle parameters of a mission, read from a scenario, a mission file or a log; and
// the decisions of a run compared with those of the log that it replays.
#pragma once

#include <filesystem>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/scenario/scenario.hpp>
#include <optional>
#include <vector>

namespace isobath {

/// The setup for an input that is a scenario (`scenario`) or a log. `mission` names a mission file or another scenario;
/// if it is empty, the mission of the scenario is used. It is moved to the plane of the scene's origin. The vehicle is
/// that of the simulator, or the one recorded in the log, or the default one. Returns nothing if the mission has no
/// points. Throws Error if a file cannot be used.
std::optional<MissionSetup> mission_setup(const std::filesystem::path& mission, const Scenario* scenario,
                                          const std::filesystem::path& input, const Simulator* simulator);

/// Throws Error unless the mission and the input have the same origin, to a metre.
void check_frame(const MissionPlan& plan, const std::optional<GeoOrigin>& heard);

/// The number of decisions in the log, and how many of them, from the first on, equal those of this run. Empty if the
/// input is not a log with decisions.
struct Recorded {
  std::uint64_t decisions = 0, the_same = 0;
};
std::optional<Recorded> compare_with_log(const std::vector<Decision>& decisions, const std::filesystem::path& input);

}  // namespace isobath
