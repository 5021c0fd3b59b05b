// TrafficGaps: how wide the water is that leads across a scene of moving discs, at each time: the widest way from start
// to goal is as wide as its narrowest gap between two discs (Rodin, Amin c. 1988, 2.1; ledger S3-07, S3-08). It says
// how hard a scene is, whatever the method.
//
// The centres of the discs are points of a kinetic Delaunay triangulation, which keeps itself valid by flips while they
// move; points 5 m apart along the sides of the field close it. A way across leads from triangle to triangle, and its
// gaps are the edges that it crosses: the distance of both points less the radii. A gap between two discs that touches
// no third one is an edge of the triangulation where the discs are of one size; among discs of different sizes the
// result may be off by the difference of two radii. Units: m, s. One thread.
#pragma once

#include <isobath/geometry/kinetic_delaunay.hpp>
#include <isobath/studies/traffic_scene.hpp>

namespace isobath {

class TrafficGaps {
 public:
  explicit TrafficGaps(const TrafficScene& scene);

  /// Follows the discs of the scene to its time.
  void follow(const TrafficScene& scene);
  /// Width of the widest way between two places; 0 or below where discs shut all ways.
  [[nodiscard]] double widest_m(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  /// Number of flips of edges so far.
  [[nodiscard]] std::int64_t flips() const { return flips_; }

 private:
  [[nodiscard]] int triangle_at(const Eigen::Vector2d& p) const;

  KineticDelaunay kinetic_;
  std::vector<int> points_;  ///< of the discs
  std::vector<Eigen::Vector2d> velocities_;
  std::vector<double> radius_m_;  ///< by point
  std::int64_t flips_ = 0;
};

}  // namespace isobath
