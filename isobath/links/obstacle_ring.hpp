// The surroundings of the vehicle as MAVLink states them: the nearest obstacle in each 5 degrees from the bow. A
// direction in which the grid holds cells that were not looked at is unknown, not clear.
#pragma once

#include <isobath/io/formats/mavlink/mavlink_messages.hpp>
#include <isobath/links/front_seat.hpp>
#include <vector>

namespace isobath {

mavlink::ObstacleDistance obstacle_ring(const Surroundings& around, const Navigation& fix, Time now);
/// The ring's obstacles as points at the vehicle's depth.
std::vector<mavlink::ObstacleDistance3d> ring_points(const mavlink::ObstacleDistance& ring);
/// Distance to the nearest obstacle, at most the reach.
double nearest_m(const Surroundings& around, const Navigation& fix);

}  // namespace isobath
