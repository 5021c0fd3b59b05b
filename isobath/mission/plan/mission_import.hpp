// Missions of other programs: QGroundControl plans and MOOS-IvP behaviour files (ledger S6-43).
//
// Input is untrusted. Items that a plan cannot hold are counted by name and reason in MissionPlan::import. An item
// whose loss would silently change the route (a fence corner or a vertex that cannot be read) is an Error. Plans are
// returned unchecked.
//
// QGroundControl (docs.qgroundcontrol.com, Plan File Format; commands and frames of MAVLink): JSON, fileType "Plan".
// The reader takes way-points, loiters (a hold, or the task "circle"), delays, changes of speed, landing (to the
// surface) and return; the way-points of surveys and corridor scans; the first inclusion fence, a circle as a polygon
// inside it; exclusion fences, as obstacles from the start, by their convex hulls. A negative altitude is a depth below
// the planned home, or below the sea where there is no home; an altitude over terrain is an altitude over the bottom.
//
// MOOS-IvP (pHelmIvP; BHV_Waypoint, BHV_OpRegion, BHV_ConstantDepth): `points = 60,10 : 60,-40` or
// `points = pts={60,10:60,-40}`, x east and y north. Lists follow one another as in the file, whatever their conditions
// are. The reader also takes speed, order, repeat, and polygon, max_depth, min_altitude and max_time of the region.
// Points lie at the depth of BHV_ConstantDepth, or at the default depth of a mission point.
#pragma once

#include <isobath/mission/plan/mission_plan.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace isobath {

/// A point on the globe in metres of the mission; throws Error where it is invalid, or farther than 100 km away.
Eigen::Vector2d metres_of(const LocalPlane& plane, const GeoPoint& point, const Place& place);

/// Whether the text starts like a JSON object.
bool looks_like_json(std::string_view text);
MissionPlan import_qground_plan(std::string_view text, const std::string& file);

/// Whether the text has lines "key = value" with a behaviour or a list of points, and no line in square brackets.
bool looks_like_moos(std::string_view text);
MissionPlan import_moos(std::string_view text, const std::string& file, std::optional<GeoOrigin> origin = {});
/// LatOrigin and LongOrigin of a .moos file, if it has both and they are valid.
std::optional<GeoOrigin> moos_origin(std::string_view text);

}  // namespace isobath
