// Tangential clusters: echoes that share a tangent plane, and the edges where such planes meet (Auran, Silven
// 1995, 3.1, after Mandelbaum and Mintz 1994, in three dimensions; ledger S4-44).
//
// Echoes in directions u_i at ranges R_i lie on a plane of the unit normal n where n.u_i R_i is the same for all. About
// each echo that is fitted by least squares to those within `window` of its direction. From the flattest neighbourhood
// on a plane grows: echoes join that touch it, lie within `gate` deviations of it and face the way that it does; it is
// fitted anew as it grows. An echo between two planes goes to the nearer. Planes whose members are neighbours meet in
// an edge: two clusters make a corner.
//
// A level scan says nothing of how steep a wall is: with `upright` all planes are.
//
// Points are relative to the sonar, in any axes whose z' is up; m. Pure. Cost: every pair of echoes is looked at once,
// n^2 / 2 products: 10 ms for 3000.
#pragma once

#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/map/spherical_grid.hpp>
#include <span>
#include <vector>

namespace isobath {

struct TangentialConfig {
  Angle window = Angle::degrees(7.5);
  double sigma_m = 0.15, sigma_share = 0.003;  ///< of a range: the larger one
  double gate = 3;                             ///< standard deviations of a range, along the normal
  Angle turned = Angle::degrees(35);           ///< of an echo's neighbourhood from its plane, at most
  int least = 8;                               ///< echoes of a plane
  double apart = 3;  ///< neighbours are no farther apart than so many times what the window is wide there
  bool upright = false;
};

struct TangentPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< unit, towards the sonar
  double distance_m = 0;                              ///< of the sonar from it: n.u R = -distance
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< of its echoes
  double rms_m = 0;                                   ///< of its echoes from it
  int support = 0;
};
/// Where two planes meet.
struct TangentEdge {
  std::size_t first = 0, second = 0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();      ///< on both planes, nearest to the echoes between them
  Eigen::Vector3d along = Eigen::Vector3d::UnitZ();  ///< unit
  int support = 0;                                   ///< pairs of neighbours across it
};
struct TangentialClusters {
  std::vector<TangentPlane> planes;  ///< most echoes first
  std::vector<TangentEdge> edges;
  std::vector<int> plane_of;  ///< of each echo, -1: none
};

TangentialClusters tangential_clusters(std::span<const Eigen::Vector3d> echoes, const TangentialConfig& config = {});

/// What has echoed in a grid, at a probability or above: contents of its cells, in G.
std::vector<Eigen::Vector3d> echoes_of(const SphericalGrid& grid, double probability);

}  // namespace isobath
