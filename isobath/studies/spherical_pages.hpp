// spherical_pages: the pictures of a spherical survey (Auran, Silven 1995, 4.3; ledger S4-37 to S4-39, S4-D01, S4-D02):
// the room with the path and its numbered scans, the grid from above, the grid in three dimensions, and the features
// found in the scans. PNG; the same survey gives the same bytes.
//
// Cells are the darker, the more probable they are. Each has points on its four outer corners, so that small ones are
// visible. Every 30 degrees a dotted line runs from the vehicle in its horizontal plane.
#pragma once

#include <array>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/spherical_survey.hpp>
#include <string>
#include <vector>

namespace isobath {

/// The view of the grid: along a bearing, and down from the horizon.
struct SphericalCamera {
  Angle looking = Angle::degrees(20), down = Angle::degrees(35);
  double zoom = 1;
};

/// Nearly white for 0, black for 1; the darker, the larger the probability.
Colour state_colour(double probability);
/// The four corners of a cell at its outer radius, in G (S4-38).
std::array<Eigen::Vector3d, 4> corner_points(const SphericalGrid& grid, const SphericalPlace& place);
/// Ends of the lines 30 degrees apart in the horizontal plane, in G, beginning with x' (S4-39).
std::vector<Eigen::Vector3d> reference_lines(double length_m);

std::string spherical_plan_picture(const Scene& scene, const SphericalSurvey& survey);
std::string spherical_above_picture(const Scene& scene, const SphericalSurvey& survey);
/// Detected edges and arcs, echoes that belong to none, and corners with the numbers of the scans that hypothesised and
/// confirmed them (S4-42, S4-45).
std::string spherical_features_picture(const Scene& scene, const SphericalSurvey& survey);
std::string spherical_solid_picture(const SphericalSurvey& survey, const SphericalCamera& camera = {});

}  // namespace isobath
