// spherical_pages: the pictures of a spherical survey (Auran, Silven 1995, 4.3; ledger S4-37 to S4-39, S4-D01, S4-D02):
// the room with the path and its numbered scans, the grid from above, the grid in three dimensions, and the features
// found in the scans. PNG; the same survey gives the same bytes.
#pragma once

#include <isobath/report/sphere_pictures.hpp>
#include <isobath/studies/spherical_survey.hpp>
#include <string>

namespace isobath {

std::string spherical_plan_picture(const Scene& scene, const SphericalSurvey& survey);
std::string spherical_above_picture(const Scene& scene, const SphericalSurvey& survey);
/// Detected edges and arcs, echoes that belong to none, and corners with the numbers of the scans that hypothesised and
/// confirmed them (S4-42, S4-45).
std::string spherical_features_picture(const Scene& scene, const SphericalSurvey& survey);
/// The ring of directions that has most of the stored cells, and the orders in which its cells are walked.
struct GridWalks {
  int elevation = 0;           ///< bucket of the ring
  std::size_t ring_cells = 0;  ///< stored
  std::size_t directions = 0;  ///< of the ring, that have cells
  int azimuth = 0;             ///< of the direction with most cells
  std::vector<int> beam;       ///< layers of its cells, by range (S4-07)
  int layer = 0;               ///< that has most of the ring's cells
  std::vector<int> of_layer;   ///< azimuths of the ring's cells in this layer, by direction (S4-08, S4-16)
};
GridWalks walks_of(const SphericalGrid& grid);
/// The stored cells of the ring of directions that has most of them, by direction and layer, with the orders in which
/// they are walked: the cells of a direction by range, those of a layer by direction (S4-07 to S4-10, S4-D05).
std::string spherical_structure_picture(const SphericalSurvey& survey);
/// `grid`: the grid of the survey, or the coarser one.
std::string spherical_solid_picture(const SphericalSurvey& survey, const SphericalGrid& grid,
                                    const SphericalCamera& camera = {});

}  // namespace isobath
