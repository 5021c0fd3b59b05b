// Words: texts for places, obstacles and points in the reasons of agents.
#pragma once

#include <isobath/mission/messages/messages.hpp>
#include <string>

namespace isobath {

/// "an obstacle", "a remembered obstacle", "the fence" ...
const char* text_of(HazardKind kind);
/// "north 44.6, east 3.9 m".
std::string text_of(const Eigen::Vector2d& north_east);
/// The name of the point, or "point 2" (from 1) where it has none.
std::string name_of(const MissionPoint& point, std::size_t index);

}  // namespace isobath
