// ReadingGaussian: where a range reading of a conical beam says that its echo comes from (Auran, Silven 1995, 4.1 and
// equation 1; ledger S4-25, S4-26, S4-28, S4-E03, S4-E06), and which cells of a spherical grid that is.
//
// Errors in range and in angle are normal and independent; the angle gamma to the axis of the beam is that of the great
// circle, so that a beam at 60 degrees of elevation is as round as a level one:
//   p(r, n | R, u) = exp(-((r - R)^2 / dR^2 + gamma^2 / dTH^2) / 2) / ((2 pi)^(3/2) dR dTH^2)    per dr dOmega.
// dR = max(0.15 m, 0.003 R): of the two figures that the paper quotes the larger. dTH = width / 2.355 of a half-power
// width. Pure; lengths in m, angles in rad.
#pragma once

#include <Eigen/Core>
#include <isobath/map/spherical_grid.hpp>
#include <vector>

namespace isobath {

struct ReadingGaussian {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< u, unit
  double range_m = 0;                               ///< R
  double sigma_m = 0.15;                            ///< dR
  double sigma_rad = 0.0185;                        ///< dTH

  /// Of the plane (S4-25): one angle, per dr dtheta.
  [[nodiscard]] double density_in_plane(double range_m, Angle from_axis) const;
  /// Per dr dOmega.
  [[nodiscard]] double density(double range_m, double from_axis_rad) const;
  /// Density over its peak, in [0, 1] (S4-E04); `p` from where the beam starts.
  [[nodiscard]] double response(const Eigen::Vector3d& p) const;
};

/// A cell that a reading touches.
struct TouchedCell {
  SphericalPlace place;
  double mass = 0;      ///< of the density that lies in the cell: products of differences of error functions
  double response = 0;  ///< at the cell's middle
};

/// The cells that come nearer to a reading than `factor` standard deviations in range and across both ways, of these
/// the `most` of the greatest mass, in order of beams. `reading` is in the axes T of the grid, and from its origin.
void touched_cells(const SphericalGrid& grid, const ReadingGaussian& reading, double factor, int most,
                   std::vector<TouchedCell>& touched);
/// A direction that a beam touches, and how much of a beam's power, of that on its axis, goes there: the mean over what
/// an echo of this beam says of the direction, so that it does not depend on how wide directions are.
struct TouchedDirection {
  SphericalDirection direction;
  double share = 0;
};
void touched_directions(const SphericalGrid& grid, const ReadingGaussian& reading, double factor,
                        std::vector<TouchedDirection>& touched);

}  // namespace isobath
