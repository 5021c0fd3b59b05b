// chart_of: the chart of a mission: what is known of the water before the vehicle enters it. The agent "chart room"
// receives it (ledger S6-32, S1-03, S1-25). setup_of: all that the agents of a scenario are made for.
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/mission/messages/messages.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/scenario/scenario.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// If `map` holds a stored map, the chart is made from it: charted and sensed depths, charted and found objects, in the
/// frame of the map. Otherwise it is made from `priors` around `origin`, as for a new map. The chart is empty if there
/// is neither a map nor a prior, or if `origin` is empty. Throws Error if the map or the priors cannot be used.
WorldSnapshot chart_of(const std::filesystem::path& map, const std::vector<std::string>& priors,
                       const Configuration& configuration, const std::optional<GeoOrigin>& origin);

/// The chart made from the prior that the configuration, or else the scenario, names.
WorldSnapshot chart_of(const Scenario& scenario, const Configuration& configuration);

/// The corners of walls that the same chart shows. Empty if the configuration asks for no fixes by them
/// (corner_fix.on).
std::vector<ChartedCorner> charted_corners(const std::filesystem::path& map, const std::vector<std::string>& priors,
                                           const Configuration& configuration, const std::optional<GeoOrigin>& origin);

/// The mission, the vehicle and the chart of a scenario. Throws Error if its vehicle file or its prior cannot be used.
MissionSetup setup_of(const Scenario& scenario, const Configuration& configuration = {});

}  // namespace isobath
