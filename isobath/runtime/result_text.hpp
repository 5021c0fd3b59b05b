// Obstacles and scans as JSON and GeoJSON: the one place that fixes the names and units of these files.
#pragma once

#include <isobath/geometry/geodesy.hpp>
#include <isobath/map/obstacle.hpp>
#include <isobath/runtime/run.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace isobath {

inline constexpr const char* kBodyFrameSentence =
    "level body frame at the time of the scan: x forward, y starboard, origin at the vehicle, metres; bearings clockwise from forward";

nlohmann::ordered_json to_json(const std::vector<Obstacle>& obstacles);
/// Number, time and, where navigation was there, the vehicle's pose in the world.
nlohmann::ordered_json scan_header(int number, Time time, const Pose& X_WB, bool posed);
/// RFC 7946: one polygon an obstacle, longitude and latitude.
std::string obstacles_geojson(const std::vector<Obstacle>& obstacles, const Pose& X_WL, const GeoOrigin& origin);
/// What was run: input, version, counts, rejections, files. Holds no time of day and no path outside the folder but the
/// input's name.
nlohmann::ordered_json manifest_json(const RunRequest& request, const RunOutcome& outcome);

}  // namespace isobath
