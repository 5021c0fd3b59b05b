// The pictures of a spherical survey (Auran, Silven 1995, 4.3; ledger S4-37 to S4-39, S4-D01, S4-D02): the room with
// the path and its numbered scans, the grid from above, the grid in three dimensions, and what the scans were told as.
// PNG; the same bytes for the same survey.
//
// Cells are as dark as they are probable. Each has points on its four outer corners, so that small ones are seen; every
// 30 degrees a dotted line runs from the vehicle, in its own plane.
#pragma once

#include <array>
#include <isobath/runtime/picture.hpp>
#include <isobath/runtime/spherical_survey.hpp>
#include <string>
#include <vector>

namespace isobath {

/// Where the grid is looked at from: over the horizon, looking along a bearing.
struct SphericalCamera {
  Angle looking = Angle::degrees(20), down = Angle::degrees(35);
  double zoom = 1;
};

/// White for 0, black for 1, the darker the larger.
Colour state_colour(double probability);
/// At the outer radius, azimuth edges by elevation edges, in G (S4-38).
std::array<Eigen::Vector3d, 4> corner_points(const SphericalGrid& grid, const SphericalPlace& place);
/// Ends of the lines 30 degrees apart in the horizontal plane, in G, from x' on (S4-39).
std::vector<Eigen::Vector3d> reference_lines(double length_m);

std::string spherical_plan_picture(const Scene& scene, const SphericalSurvey& survey);
std::string spherical_above_picture(const Scene& scene, const SphericalSurvey& survey);
/// Edges and arcs as they were heard, echoes without one, and corners with the numbers of the scans that hypothesised
/// and confirmed them (S4-42, S4-45).
std::string spherical_features_picture(const Scene& scene, const SphericalSurvey& survey);
std::string spherical_solid_picture(const SphericalSurvey& survey, const SphericalCamera& camera = {});

}  // namespace isobath
