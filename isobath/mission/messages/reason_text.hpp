// Texts for the reasons of agents: of places, obstacles and points.
#pragma once

#include <isobath/mission/messages/messages.hpp>
#include <string>

namespace isobath {

/// "obstacle 3", "remembered obstacle 3", "an obstacle" where it has no number, "the fence" ...
std::string text_of(const Hazard& hazard);
/// Where a place lies as seen from a vehicle: "12 m ahead to port". All in one frame.
std::string direction_of(const Eigen::Vector2d& place, const Eigen::Vector2d& vehicle, Angle heading);
/// "north 44.6, east 3.9 m".
std::string text_of(const Eigen::Vector2d& north_east);
/// The name of the point, or "point 2" (from 1) where it has none.
std::string name_of(const MissionPoint& point, std::size_t index);

}  // namespace isobath
