// Missions of other programs: QGroundControl plans and MOOS-IvP behaviour files (ledger S6-43).
//
// Input is untrusted. What a plan cannot hold is counted by name and reason in MissionPlan::import; what would change
// the way without a word (a corner of a fence or a vertex that cannot be read) is an Error. Plans come back unchecked.
//
// QGroundControl (docs.qgroundcontrol.com, Plan File Format; commands and frames of MAVLink): JSON, fileType "Plan".
// Way-points, loiters (a hold, or the task "circle"), delays, changes of speed, landing (to the surface) and return;
// what surveys and corridor scans were laid out to; the first fence that keeps in, a circle as a polygon inside of it;
// fences that keep out, as obstacles from the start, by their convex hulls. A negative altitude is a depth: below the
// planned home, or below the sea where there is none; altitudes over terrain are those over the bottom.
//
// MOOS-IvP (pHelmIvP; BHV_Waypoint, BHV_OpRegion, BHV_ConstantDepth): `points = 60,10 : 60,-40` or
// `points = pts={60,10:60,-40}`, x east and y north, one list after the other as the file has them, whatever their
// conditions are; speed, order, repeat; polygon, max_depth, min_altitude and max_time of the region. Points lie at the
// depth of BHV_ConstantDepth, else at that of any mission point.
#pragma once

#include <isobath/mission/mission_plan.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace isobath {

/// A point on the globe as metres of the mission; throws Error where it is none, or further than 100 km.
Eigen::Vector2d metres_of(const LocalPlane& plane, const GeoPoint& point, const Place& place);

/// Text that starts like a JSON object.
bool looks_like_json(std::string_view text);
MissionPlan import_qground_plan(std::string_view text, const std::string& file);

/// Lines "key = value" with a behaviour or a list of points, and none in square brackets.
bool looks_like_moos(std::string_view text);
MissionPlan import_moos(std::string_view text, const std::string& file, std::optional<GeoOrigin> origin = {});
/// LatOrigin and LongOrigin of a .moos file, if it has both and they are a place.
std::optional<GeoOrigin> moos_origin(std::string_view text);

}  // namespace isobath
