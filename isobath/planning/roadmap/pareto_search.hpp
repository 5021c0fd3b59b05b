// Multi-objective A*: all paths of a graph with vector costs that no other path dominates (NAMOA*, Mandow and Perez de
// la Cruz 2010; Rodin, Amin c. 1988, 2.2; ledger S3-16, S3-17).
//
// A cost has three components, for a road map: length (m), deviation from the straight line (m^2), delay (s). A label
// is a path to a node; of the labels of a node those that another one dominates (no component larger) are dropped, with
// a tolerance if asked for. The heuristic is the least cost from each node to the goal in each component by itself,
// from three searches backwards, which is admissible and consistent. Of paths of equal cost the one found first is
// kept.
//
// The number of labels can grow exponentially with the size of the graph: `max_labels` bounds it, and `complete` says
// whether the search ended before. Costs are finite and not negative: Error otherwise. Cost: 0.5 us a label on a road
// map of 1000 nodes.
#pragma once

#include <array>
#include <cstddef>
#include <Eigen/Core>
#include <span>
#include <vector>

namespace isobath {

using CostVector = std::array<double, 3>;

struct CostArc {
  int from = 0, to = 0;  ///< one way
  CostVector cost{};
};

struct ParetoPath {
  std::vector<int> nodes;
  CostVector cost{};
};

struct ParetoSet {
  std::vector<ParetoPath> paths;  ///< in lexicographic order of their costs
  bool complete = true;           ///< false: the search was stopped at max_labels, and others may be missing
};

struct ParetoOptions {
  double tolerance = 0;  ///< a cost up to this share larger in each component counts as dominated
  std::size_t max_labels = 1'000'000;
};

/// The paths from one node to another; none if there is no path.
ParetoSet pareto_paths(int nodes, std::span<const CostArc> arcs, int from, int to, const ParetoOptions& options = {});

/// The choice among vectors of cost: by a weighted sum if a weight is positive (no weight is negative), then, and
/// without weights, lexicographically: the first component of `order` that differs decides. The choice by positive
/// weights lies in the Pareto set.
struct Preference {
  std::array<int, 3> order{0, 1, 2};
  CostVector weights{0, 0, 0};
};
bool is_preferred(const CostVector& a, const CostVector& b, const Preference& preference);

/// Integral of the distance to the line through start and goal over the leg from a to b, in m^2; of the distance to the
/// start where the goal coincides with it (S3-17; then by the trapezoidal rule).
double deviation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& start,
                 const Eigen::Vector2d& goal);

}  // namespace isobath
