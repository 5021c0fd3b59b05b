// WaterLabel: whether an obstacle of the plane stands in the water, or is an echo of the bottom or the surface in a
// tall beam (ledger S6-69; the limitation of Ganesan 2015, 1.2: a horizontal fan does not measure the height of an
// echo).
//
//   standing  its centre is nearer than the ranges at which the beam's main lobe can meet bottom and surface, if both
//             are known; or sensors that measure height have found something between them, 1 m from either; if the
//             depth of the bottom is unknown, no deeper than 1 m below the sonar
//   bottom    sensors that measure height have measured the water above it, and found something only at the bottom
//   surface   the same, below the surface
//   unknown   none of these: the fan alone cannot decide, and keeps the obstacle
//
// No label lets a vehicle come nearer to an obstacle; labels are for people. Pure.
#pragma once

#include <isobath/map/occupancy/obstacle.hpp>
#include <isobath/map/voxel/occupancy_snapshot.hpp>
#include <isobath/sonar/boundary_echoes.hpp>
#include <isobath/sonar/ping.hpp>

namespace isobath {

/// Geometry of a ping for the label of its obstacles.
struct HeardFrom {
  Pose X_WB, X_BS;
  Angle height;  ///< height of the fan's beams
  WaterColumn water;
};

/// Label from the ranges at which the fan can receive bottom and surface.
WaterLabel label_by_reach(const Obstacle& obstacle, const HeardFrom& from);

/// Label from the voxels that sensors with height have measured within the obstacle's outline.
WaterLabel label_by_heights(const Obstacle& obstacle, const HeardFrom& from, const OccupancySnapshot& space);

/// `space`: null if no sensor measures height.
void label_obstacles(std::vector<Obstacle>& obstacles, const HeardFrom& from, const OccupancySnapshot* space);

}  // namespace isobath
