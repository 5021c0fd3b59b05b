// Pictures of a study of traffic (traffic_study.hpp), as PNG.
#pragma once

#include <isobath/studies/traffic_study.hpp>

namespace isobath {

/// Plan view of one run of our planner: its path with a dot every 10 s, and the bodies at the time of the least gap,
/// each with its track 10 s before and after. The path without a road map beside it, if the request has that method.
std::string traffic_picture(const TrafficRequest& request, int run, int discs, double max_speed);

/// The table of the study, one line a row, with a heading.
std::string traffic_table(const TrafficStudy& study);

/// What the planner's road map did, one line a row, with a heading: runs that arrived, length of the track over the
/// shortest path, runs by level of detail, plans a run, those along the road map, those that mended the plan before,
/// refused paths a run, runs with a step without a path.
std::string traffic_road_table(const TrafficStudy& study);

}  // namespace isobath
