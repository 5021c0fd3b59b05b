// WaterLabel: whether an obstacle of the plane stands in the water, or is the bottom or the surface that a tall beam
// hears (ledger S6-69; the limitation of Ganesan 2015, 1.2: a fan that lies flat does not tell at what height it
// hears).
//
//   standing  its centre is nearer than the beam's main lobe can meet bottom and surface, both of which are known; or
//             a sensor that tells height has found something between them, 1 m from either; where nobody knows how deep
//             the bottom is, no deeper than 1 m below the sonar
//   bottom    sensors that tell height have measured the water above it, and found something at the bottom alone
//   surface   likewise, below it
//   unknown   none of these: the fan alone cannot tell, and keeps the obstacle
//
// No label lets a vehicle come nearer: it is for those who read. Pure.
#pragma once

#include <isobath/map/obstacle.hpp>
#include <isobath/map/space_grid.hpp>
#include <isobath/sonar/boundary_echoes.hpp>
#include <isobath/sonar/ping.hpp>

namespace isobath {

const char* to_text(WaterLabel label);

/// What a ping tells of the place of its obstacles.
struct HeardFrom {
  Pose X_WB, X_BS;
  Angle height;  ///< of the fan's beams
  WaterColumn water;
};

/// By what the fan can hear where.
WaterLabel label_by_reach(const Obstacle& obstacle, const HeardFrom& from);

/// By what sensors that tell height have found under and over its outline.
WaterLabel label_by_heights(const Obstacle& obstacle, const HeardFrom& from, const SpaceGrid& space);

/// `space`: null where no sensor tells height.
void label_obstacles(std::vector<Obstacle>& obstacles, const HeardFrom& from, const SpaceGrid* space);

}  // namespace isobath
