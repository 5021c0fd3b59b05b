// Clusters of a spherical grid: connected occupied cells, which are how one object appears (Auran, Silven 1995, 4.1;
// ledger S4-29); the same grid at another resolution (S4-17); and known objects in it (S4-15).
#pragma once

#include <array>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <span>
#include <vector>

namespace isobath {

/// Connected cells: neighbours in azimuth (which wraps), elevation and layer, corners included. At a pole all azimuths
/// are neighbours.
struct SphericalCluster {
  std::vector<SphericalPlace> cells;  ///< in the order of beams
  std::uint64_t echoes = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< of the cells' contents, equally weighted, in G
  double nearest_m = 0;                                ///< of the contents
};
/// Clusters of cells at `probability` or above; the largest first, then in the order of beams.
std::vector<SphericalCluster> clusters(const SphericalGrid& grid, double probability);

/// The probability of a coarser cell from its parts: 1 - prod(1 - P), or the largest P.
enum class ZoomRule : std::uint8_t { kAny, kLargest };
/// Fills an empty `coarse` with the same contents; contents beyond its range are left out.
void zoom(const SphericalGrid& grid, ZoomRule rule, SphericalGrid& coarse);

/// A triangle of a known surface, in G: makes a locked, flagged cell wherever the triangle passes (S4-15).
void add_known_triangle(SphericalGrid& grid, const std::array<Eigen::Vector3d, 3>& corners_G);

}  // namespace isobath
