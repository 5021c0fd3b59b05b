// CloserLook: the echoes of one target of a spherical survey in a grid of their own, whose directions and layers are
// several times as fine (Auran, Silven 1995, 4.2: zoom; ledger S4-17, S4-18). It tells targets apart that share cells
// of the survey's grid.
//
// An echo that was heard at a range r0 has an error across the beam of r0 sigma_ang, and along it of sigma_R. The finer
// grid gets it as a beam from the last position that is as wide there as the larger of the two: what was heard from
// nearby is narrow. A peak is a group of connected cells with at least half the echoes per cell of the fullest one.
// Cost: a grid for each target; an echo changes up to 10,000 cells.
#pragma once

#include <isobath/studies/spherical_survey.hpp>
#include <memory>
#include <vector>

namespace isobath {

struct CloserLook {
  std::size_t target = 0;               ///< index in SurveyFeatures::targets
  std::unique_ptr<SphericalGrid> grid;  ///< at the last position
  std::vector<SphericalCluster> peaks;  ///< the largest first
};
/// `finer` times as many directions and layers, for each target with at least `min_echoes` echoes.
std::vector<CloserLook> closer_looks(const SphericalSurvey& survey, const SphericalSurveyConfig& config, int finer,
                                     std::size_t min_echoes);

/// A point of the survey's grid, or of a closer one, in W.
Eigen::Vector3d point_in_world(const SphericalSurvey& survey, const Eigen::Vector3d& p_G);

}  // namespace isobath
