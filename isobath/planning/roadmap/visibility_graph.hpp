// VisibilityGraph: the shortest path among grown obstacles (Rodin, Amin c. 1988, 2.1; ledger S3-14).
//
// Nodes are the corners of grown parts that no other part covers. Two nodes are joined if the leg between them is free
// and at both ends both sides of the corner lie on one side of it: a shortest path has no other legs. Legs are tested
// only from nodes that A* expands (a lazy visibility graph), so that a path costs far less than the graph. The planner
// of routes (route_planner.hpp) searches a grid with wished clearances and a turning radius; this one is exact, and
// touches the grown obstacles.
//
// Units: m. The obstacles must outlive the graph. Cost with n corners: `arcs_from` n / 2 tests of legs. Where the water
// is equally dense everywhere a test stops at the first obstacle on the way, and the whole graph takes near O(n^2):
// measured exponent 1.97 from 50 to 200 obstacles, 0.1 s for 200 of 18 corners (2.0 GHz, one core).
#pragma once

#include <Eigen/Core>
#include <isobath/planning/roadmap/grown_obstacles.hpp>
#include <vector>

namespace isobath {

class VisibilityGraph {
 public:
  struct Node {
    Eigen::Vector2d at, before, after;  ///< a corner, and those beside it on its polygon
  };

  explicit VisibilityGraph(const GrownObstacles& obstacles);

  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  /// The nodes that a path may go on to from a node.
  [[nodiscard]] std::vector<int> arcs_from(int node) const;
  /// The corners of the shortest path, both ends included; empty if there is none. Ends must be finite; a covered one
  /// has no path.
  [[nodiscard]] std::vector<Eigen::Vector2d> shortest_path(const Eigen::Vector2d& start,
                                                           const Eigen::Vector2d& goal) const;

 private:
  [[nodiscard]] static bool supports(const Node& node, const Eigen::Vector2d& other);

  const GrownObstacles& obstacles_;
  std::vector<Node> nodes_;
};

}  // namespace isobath
