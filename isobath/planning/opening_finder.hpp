// OpeningFinder: an opening ahead between two bodies, such as the pylons of a bridge, found from the outlines of what a
// sonar has detected, and what a map knows of the water in it (Horner et al. c. 2009, 6; ledger S5-40, S5-43).
//
// The sides of an opening are compact bodies: a bank or a berm across the way is none. Their outlines say the width.
// The height is that of the water which the voxels hold to be clear on the way there.
//
// Frame W (north, east, depth), m. Pure. Costs about 1 us a pair of bodies beside the way, and 5 ns a voxel.
#pragma once

#include <isobath/map/voxel/occupancy_snapshot.hpp>
#include <isobath/planning/hazard_map.hpp>
#include <isobath/planning/helix.hpp>
#include <optional>
#include <span>

namespace isobath {

struct OpeningSearch {
  double min_width_m = 3, max_width_m = 30;
  double max_side_m = 6;      ///< largest extent of a body that counts as a side
  double farthest_m = 75;     ///< from the start of the way
  double depth_m = 0;         ///< at which the vehicle wants to go through
  double least_height_m = 2;  ///< of its face, about that depth, where the map does not know the bed
};

/// An opening as perceived. `opening` is centred on the wanted depth, and as high as there is room both up and down.
struct FoundOpening {
  Opening opening;
  Eigen::Vector2d port, starboard;            ///< north, east of its sides
  int port_number = 0, starboard_number = 0;  ///< Obstacle::number; 0: none
  double top_m = 0, bed_m = 0;                ///< depths between which its face lies
  bool bed_known = false;                     ///< false: too little water was measured on the way there
};

/// The nearest opening that the way from `from` to `to` (north, east) leads through; of several as far, the narrowest.
/// `bodies` in W; pieces with one number are one body.
std::optional<FoundOpening> find_opening(std::span<const Hazard> bodies, const Eigen::Vector2d& from,
                                         const Eigen::Vector2d& to, const OpeningSearch& search,
                                         const OccupancySnapshot& map);

/// Share of the face, less `margin_m` along its edges, whose voxels are measured to be water.
double free_share(const FoundOpening& found, double margin_m, const OccupancySnapshot& map);

}  // namespace isobath
