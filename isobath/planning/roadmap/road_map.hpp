// RoadMap: the dual of the Delaunay triangulation of obstacles as a graph of paths (Rodin, Amin c. 1988, 2.1; ledger
// S3-08, S3-09).
//
// Nodes are the triangles, at the centres of their circles (the Voronoi vertices), or at their centroids where a centre
// lies outside the border. Arcs cross the edges between points of different parts: a straight arc runs midway between
// both. Each arc is tested against the grown obstacles; one that is not free goes through the middle of the gap, or is
// dropped. An edge between two points of one part gives no arc.
//
// Connectivity: if the sides of all parts carry points at most s apart, a path that keeps a distance d from all
// obstacles can be drawn onto the dual, where it keeps sqrt(d^2 - s^2 / 4): the dual runs where the nearest point is as
// far away as possible, and a side is at most that much nearer than its nearest point. So every gap is kept that is
// wider than 2 sqrt(g^2 + s^2 / 4), where g is the growth of the obstacles, radius / cos(pi / sides) at most. A test
// compares this with a flood fill, also where obstacles overlap.
//
// Units: m. At most three arcs a triangle and two triangles a point: O(n) in time and memory; measured exponent 1.02
// from 50 to 800 obstacles of 6 corners, 15 ms for 800 (2.0 GHz, one core). Threads: one at a time, because `attach`
// uses the lists of the triangulation.
#pragma once

#include <array>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <isobath/geometry/dynamic_delaunay.hpp>
#include <isobath/planning/roadmap/grown_obstacles.hpp>
#include <span>
#include <vector>

namespace isobath {

class RoadMap {
 public:
  struct Arc {
    int from = 0, to = 0;       ///< nodes; both ways
    Eigen::Vector2d via{0, 0};  ///< a point on the way; the middle of a straight arc
    double length_m = 0;
    double clearance_m = 0;  ///< the least distance to a point of the triangulation beside the arc
  };
  struct Shut {  ///< an edge between different parts that no arc could cross
    int from = 0, to = 0;
    std::array<int, 3> parts{};  ///< of the grown obstacles: one that is in the way, and those on both sides
  };

  /// Points have the labels of the parts that they outline; negative ones are of the border. Centres of circles are
  /// nodes within `border` only. Points and obstacles must outlive the map and not change.
  RoadMap(const DynamicDelaunay& points, const GrownObstacles& obstacles, const Eigen::AlignedBox2d& border);

  [[nodiscard]] const std::vector<Eigen::Vector2d>& nodes() const { return nodes_; }
  [[nodiscard]] const std::vector<Arc>& arcs() const { return arcs_; }
  [[nodiscard]] const std::vector<Shut>& shut() const { return shut_; }
  /// The nodes with arcs that a free leg joins to p: those around the point nearest to p, whose Voronoi cell holds p.
  /// Where there is none, those around its neighbours.
  [[nodiscard]] std::vector<int> attach(const Eigen::Vector2d& p) const;

 private:
  void cross_side(int triangle, int slot);
  [[nodiscard]] int part_of(int point) const;

  const DynamicDelaunay& points_;
  const GrownObstacles& obstacles_;
  std::vector<int> part_of_label_;
  std::vector<int> node_of_;  ///< by triangle
  std::vector<Eigen::Vector2d> nodes_;
  std::vector<char> has_arcs_;
  std::vector<Arc> arcs_;
  std::vector<Shut> shut_;
};

}  // namespace isobath
