// Track profile: place and depths along the track of a mission against time, from the stored map (Herman 1988, 6;
// ledger S2-D03).
#pragma once

#include <isobath/map/depth/depth_map.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/mission_outcome.hpp>
#include <span>
#include <string>

namespace isobath {

/// PNG; empty for a track of fewer than two places.
struct TrackProfile {
  std::string place;   ///< north and east against time, as estimated
  std::string depths;  ///< of the map and of the chart under the track, and of the vehicle, against time
};
TrackProfile draw_track_profile(std::span<const BelievedPlace> track, const DepthSnapshot& map);
void add_track_profile(HtmlReport& page, const TrackProfile& profile);

}  // namespace isobath
