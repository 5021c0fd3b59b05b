// Tangential clusters: groups of echoes that share a tangent plane, and the edges where such planes meet (Auran, Silven
// 1995, 3.1, after Mandelbaum and Mintz 1994, in three dimensions; ledger S4-44).
//
// Echoes in directions u_i at ranges R_i lie on a plane of unit normal n if n.u_i R_i is the same for all. A local
// plane is fitted by least squares around each echo, to the echoes within `window` of its direction. Planes grow from
// the flattest neighbourhoods: neighbouring echoes join that lie within `gate` deviations of the plane and have a
// similar local normal; the plane is refitted as it grows. An echo between two planes goes to the nearer one. Planes
// with neighbouring members meet in an edge: two clusters form a corner.
//
// A level scan does not show the slope of a wall: with `upright` all planes are vertical.
//
// Points are relative to the sonar, in any axes whose z' is up; m. Pure. Cost: each pair of echoes is tested once,
// n^2 / 2 products: 10 ms for 3000.
#pragma once

#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <span>
#include <vector>

namespace isobath {

struct TangentialConfig {
  Angle window = Angle::degrees(7.5);
  double sigma_m = 0.15, sigma_share = 0.003;  ///< standard deviation of a range: the larger one
  double gate = 3;                             ///< standard deviations of a range, along the normal
  Angle turned = Angle::degrees(35);           ///< maximum angle between an echo's local plane and its plane
  int least = 8;                               ///< minimum number of echoes of a plane
  double apart = 3;  ///< maximum distance of neighbours, in widths of the window at that range
  bool vertical = false;
};

struct TangentPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< unit, towards the sonar
  double distance_m = 0;                              ///< distance of the sonar from the plane: n.u R = -distance
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< centre of its echoes
  double rms_m = 0;                                   ///< rms distance of its echoes from the plane
  int support = 0;
};
/// Where two planes meet.
struct TangentEdge {
  std::size_t first = 0, second = 0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();      ///< point on both planes, nearest to the echoes between them
  Eigen::Vector3d along = Eigen::Vector3d::UnitZ();  ///< unit
  int support = 0;                                   ///< pairs of neighbours across it
};
struct TangentialClusters {
  std::vector<TangentPlane> planes;  ///< most echoes first
  std::vector<TangentEdge> edges;
  std::vector<int> plane_of;  ///< plane of each echo, -1: none
};

TangentialClusters tangential_clusters(std::span<const Eigen::Vector3d> echoes, const TangentialConfig& config = {});

/// Echo positions in G of the cells of a grid that have a probability of at least `probability`.
std::vector<Eigen::Vector3d> echoes_of(const SphericalGrid& grid, double probability);

}  // namespace isobath
