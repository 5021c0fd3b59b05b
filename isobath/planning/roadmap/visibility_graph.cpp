#include <algorithm>
#include <cmath>
#include <functional>
#include <isobath/geometry/polygon.hpp>
#include <isobath/planning/roadmap/visibility_graph.hpp>
#include <limits>
#include <queue>
#include <utility>

namespace isobath {

using Eigen::Vector2d;

VisibilityGraph::VisibilityGraph(const GrownObstacles& obstacles) : obstacles_(obstacles) {
  for (const GrownPart& part : obstacles.parts()) {
    const std::size_t n = part.grown.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Vector2d& p = part.grown[i];
      if (!obstacles.is_free(p, p)) continue;
      nodes_.push_back({p, part.grown[(i + n - 1) % n], part.grown[(i + 1) % n]});
    }
  }
}

/// Whether the line through a corner and another place leaves both sides of the corner on one side, or on itself.
bool VisibilityGraph::supports(const Node& node, const Vector2d& other) {
  const Vector2d way = other - node.at;
  const double slack = 1e-9 * way.norm();
  const double before = cross(way, node.before - node.at), after = cross(way, node.after - node.at);
  return (before >= -slack && after >= -slack) || (before <= slack && after <= slack);
}

std::vector<int> VisibilityGraph::arcs_from(int node) const {
  std::vector<int> arcs;
  const Node& here = nodes_[static_cast<std::size_t>(node)];
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& there = nodes_[i];
    if (static_cast<int>(i) == node || !supports(here, there.at) || !supports(there, here.at)) continue;
    if (obstacles_.is_free(here.at, there.at)) arcs.push_back(static_cast<int>(i));
  }
  return arcs;
}

std::vector<Vector2d> VisibilityGraph::shortest_path(const Vector2d& start, const Vector2d& goal) const {
  if (!obstacles_.is_free(start, start) || !obstacles_.is_free(goal, goal)) return {};
  if (obstacles_.is_free(start, goal)) return {start, goal};
  const std::size_t count = nodes_.size(), first = count, last = count + 1;
  const auto at = [&](std::size_t i) -> const Vector2d& {
    return i == first ? start : i == last ? goal : nodes_[i].at;
  };
  const auto bends = [&](std::size_t i, const Vector2d& other) { return i >= count || supports(nodes_[i], other); };
  std::vector<double> cost(count + 2, std::numeric_limits<double>::infinity());
  std::vector<std::size_t> from(count + 2, first);
  std::vector<char> closed(count + 2, 0);
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost[first] = 0;
  open.emplace((goal - start).norm(), first);
  while (!open.empty()) {
    const std::size_t i = open.top().second;
    open.pop();
    if (closed[i]) continue;
    closed[i] = 1;
    if (i == last) break;
    for (std::size_t j = 0; j < count + 2; ++j) {
      if (closed[j]) continue;
      const double through = cost[i] + (at(j) - at(i)).norm();
      if (through >= cost[j] || through + (goal - at(j)).norm() >= cost[last]) continue;
      if (!bends(i, at(j)) || !bends(j, at(i)) || !obstacles_.is_free(at(i), at(j))) continue;
      cost[j] = through;
      from[j] = i;
      open.emplace(through + (goal - at(j)).norm(), j);
    }
  }
  if (!closed[last]) return {};
  std::vector<Vector2d> path{goal};
  for (std::size_t i = last; i != first; i = from[i]) path.push_back(at(from[i]));
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace isobath
