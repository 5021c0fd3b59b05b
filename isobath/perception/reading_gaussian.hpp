// ReadingGaussian: probability density of the echo position of a range reading with a conical beam, and the cells of a
// spherical grid that it covers (Auran, Silven 1995, 4.1 and equation 1; ledger S4-25, S4-26, S4-28, S4-E03, S4-E06).
//
// Errors in range and in angle are normal and independent. The angle gamma to the axis of the beam is that of the great
// circle, so a beam at 60 degrees of elevation is as round as a level one:
//   p(r, n | R, u) = exp(-((r - R)^2 / dR^2 + gamma^2 / dTH^2) / 2) / ((2 pi)^(3/2) dR dTH^2)    per dr dOmega.
// dR = max(0.15 m, 0.003 R), the larger of the two figures in the paper. dTH = width / 2.355 for a half-power width.
// Pure; lengths in m, angles in rad.
#pragma once

#include <Eigen/Core>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <vector>

namespace isobath {

struct ReadingGaussian {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< u, unit
  double range_m = 0;                               ///< R
  double sigma_m = 0.15;                            ///< dR
  double sigma_rad = 0.0185;                        ///< dTH
};

/// A cell that a reading touches.
struct TouchedCell {
  SphericalPlace place;
  double mass = 0;      ///< probability mass in the cell: products of differences of error functions
  double response = 0;  ///< density at the cell's middle over its peak, in [0, 1] (S4-E04)
};

/// The cells within `factor` standard deviations of a reading in range and in both angles, limited to the `most` of
/// greatest mass, in order of beams. `reading` is in the axes T of the grid, from its origin.
void touched_cells(const SphericalGrid& grid, const ReadingGaussian& reading, double factor, int most,
                   std::vector<TouchedCell>& touched);
/// A direction that a beam touches, and its share of the power on the beam's axis: the mean over the density of an echo
/// of this beam within the direction, so that it does not depend on the width of directions.
struct TouchedDirection {
  SphericalDirection direction;
  double share = 0;
};
void touched_directions(const SphericalGrid& grid, const ReadingGaussian& reading, double factor,
                        std::vector<TouchedDirection>& touched);

}  // namespace isobath
