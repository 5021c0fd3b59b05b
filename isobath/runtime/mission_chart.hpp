// The chart that a mission goes by: what is known of the water before the vehicle is in it, for the chart room (ledger
// S6-32, S1-03, S1-25).
#pragma once

#include <filesystem>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/mission/messages.hpp>
#include <isobath/runtime/scenario.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// Of the stored map, where there is one in `map`: charted and sensed depths, charted and found objects, in its frame.
/// Else of `priors`, as a new map begins with them, around `origin`. Nothing where neither is there, or nobody knows
/// where on the globe the priors are to lie. Throws Error where map or priors cannot be used.
ChartUpdate chart_of(const std::filesystem::path& map, const std::vector<std::string>& priors,
                     const Configuration& configuration, const std::optional<GeoOrigin>& origin);

/// Of what the configuration, or else the scenario, names as prior.
ChartUpdate chart_of(const Scenario& scenario, const Configuration& configuration);

}  // namespace isobath
