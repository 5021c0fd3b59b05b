// sphere_pictures: the pictures of a spherical grid (Auran, Silven 1995, 4.3; ledger S4-37 to S4-39, S4-D02): from
// above and in three dimensions. PNG; the same grid gives the same bytes.
//
// Cells are the darker, the more probable they are. Each has points on its four outer corners, so that small ones are
// visible. Every 30 degrees a dotted line runs from the vehicle in its horizontal plane.
#pragma once

#include <array>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <isobath/report/plot/picture.hpp>
#include <string>
#include <utility>
#include <vector>

namespace isobath {

/// The view of the grid: along a bearing, and down from the horizon.
struct SphericalCamera {
  Angle looking = Angle::degrees(20), down = Angle::degrees(35);
  double zoom = 1;
};

/// What is drawn beside the grid. Places are in G, plan places (north, east) of the vehicle, m.
struct SphereView {
  const SphericalGrid& grid;
  std::string title;
  Angle course;               ///< of the vehicle, in the axes of the grid
  Eigen::AlignedBox2d shown;  ///< of the picture from above; empty: around the occupied cells
  bool course_up = false;     ///< whether y' points ahead, not north
  double band_m = 0;          ///< from above: only what lies within this distance of the vehicle's level; 0: everything
  std::vector<std::vector<Eigen::Vector2d>> walls = {};  ///< true ones
  std::vector<Eigen::Vector3d> path = {};
  std::vector<std::pair<Eigen::Vector3d, std::string>> scans = {};  ///< places with their numbers
};

/// Nearly white for 0, black for 1; the darker, the larger the probability.
Colour state_colour(double probability);
/// The four corners of a cell at its outer radius, in G (S4-38).
std::array<Eigen::Vector3d, 4> corner_points(const SphericalGrid& grid, const SphericalPlace& place);
/// Ends of the lines 30 degrees apart in the horizontal plane, in G, beginning with x' (S4-39).
std::vector<Eigen::Vector3d> reference_lines(double length_m);
PlanExtent with_margin(const Eigen::AlignedBox2d& box);

std::string sphere_above_picture(const SphereView& view);
std::string sphere_solid_picture(const SphereView& view, const SphericalCamera& camera = {});

}  // namespace isobath
