#include <algorithm>
#include <cmath>
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/planning/roadmap/pareto_search.hpp>
#include <limits>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kUnreachable = std::numeric_limits<double>::infinity();

CostVector sum_of(const CostVector& a, const CostVector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

bool dominates(const CostVector& a, const CostVector& b, double tolerance) {
  const double share = 1 + tolerance;
  return a[0] <= share * b[0] && a[1] <= share * b[1] && a[2] <= share * b[2];
}

/// The arcs by one of their ends.
struct ArcIndex {
  ArcIndex(int nodes, std::span<const CostArc> arcs, int CostArc::*end) : first(static_cast<std::size_t>(nodes) + 1) {
    for (const CostArc& arc : arcs) ++first[static_cast<std::size_t>(arc.*end) + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    std::vector<std::size_t> filled(first.begin(), first.end() - 1);
    order.resize(arcs.size());
    for (const CostArc& arc : arcs) order[filled[static_cast<std::size_t>(arc.*end)]++] = &arc;
  }
  [[nodiscard]] std::span<const CostArc* const> at(int node) const {
    const auto i = static_cast<std::size_t>(node);
    return std::span(order).subspan(first[i], first[i + 1] - first[i]);
  }
  std::vector<std::size_t> first;
  std::vector<const CostArc*> order;
};

/// The least cost in each component by itself from every node to the goal.
std::vector<CostVector> ideal_costs(int nodes, std::span<const CostArc> arcs, int goal) {
  const ArcIndex entering(nodes, arcs, &CostArc::to);
  std::vector<CostVector> ideal(static_cast<std::size_t>(nodes), {kUnreachable, kUnreachable, kUnreachable});
  std::vector<std::pair<double, int>> open;
  const auto later = [](const auto& a, const auto& b) { return a > b; };
  for (std::size_t k = 0; k < 3; ++k) {
    ideal[static_cast<std::size_t>(goal)][k] = 0;
    open.assign(1, {0.0, goal});
    while (!open.empty()) {
      std::pop_heap(open.begin(), open.end(), later);
      const auto [cost, node] = open.back();
      open.pop_back();
      if (cost > ideal[static_cast<std::size_t>(node)][k]) continue;
      for (const CostArc* arc : entering.at(node)) {
        double& best = ideal[static_cast<std::size_t>(arc->from)][k];
        if (cost + arc->cost[k] >= best) continue;
        best = cost + arc->cost[k];
        open.emplace_back(best, arc->from);
        std::push_heap(open.begin(), open.end(), later);
      }
    }
  }
  return ideal;
}

struct Label {
  CostVector cost, estimate;
  int node;
  std::int64_t parent;
  bool dropped;
};

class LabelSearch {
 public:
  LabelSearch(int nodes, std::span<const CostArc> arcs, int from, int to, const ParetoOptions& options)
      : leaving_(nodes, arcs, &CostArc::from), ideal_(ideal_costs(nodes, arcs, to)), goal_(to), options_(options) {
    at_node_.resize(static_cast<std::size_t>(nodes));
    if (ideal_[static_cast<std::size_t>(from)][0] < kUnreachable) add({0, 0, 0}, from, -1);
  }

  ParetoSet run() {
    ParetoSet result;
    const auto later = [this](std::size_t a, std::size_t b) { return is_later(a, b); };
    while (!open_.empty()) {
      std::pop_heap(open_.begin(), open_.end(), later);
      const std::size_t i = open_.back();
      open_.pop_back();
      const Label label = labels_[i];
      if (label.dropped || is_beaten_at_goal(label.estimate)) continue;
      if (label.node == goal_) {
        result.paths.push_back({path_of(i), label.cost});
        solutions_.push_back(label.cost);
        continue;
      }
      for (const CostArc* arc : leaving_.at(label.node)) {
        if (ideal_[static_cast<std::size_t>(arc->to)][0] == kUnreachable) continue;
        if (labels_.size() >= options_.max_labels) {
          result.complete = false;
          open_.clear();
          break;
        }
        if (add(sum_of(label.cost, arc->cost), arc->to, static_cast<std::int64_t>(i))) {
          std::push_heap(open_.begin(), open_.end(), later);
        }
      }
    }
    return result;
  }

 private:
  [[nodiscard]] bool is_later(std::size_t a, std::size_t b) const {
    return std::pair(labels_[a].estimate, a) > std::pair(labels_[b].estimate, b);
  }
  [[nodiscard]] bool is_beaten_at_goal(const CostVector& estimate) const {
    return std::any_of(solutions_.begin(), solutions_.end(),
                       [&](const CostVector& s) { return dominates(s, estimate, options_.tolerance); });
  }

  bool add(const CostVector& cost, int node, std::int64_t parent) {
    const CostVector estimate = sum_of(cost, ideal_[static_cast<std::size_t>(node)]);
    auto& here = at_node_[static_cast<std::size_t>(node)];
    for (const std::size_t other : here) {
      if (dominates(labels_[other].cost, cost, options_.tolerance)) return false;
    }
    if (is_beaten_at_goal(estimate)) return false;
    std::erase_if(here, [&](std::size_t other) {
      const bool worse = dominates(cost, labels_[other].cost, 0);
      labels_[other].dropped = labels_[other].dropped || worse;
      return worse;
    });
    here.push_back(labels_.size());
    open_.push_back(labels_.size());
    labels_.push_back({cost, estimate, node, parent, false});
    return true;
  }

  [[nodiscard]] std::vector<int> path_of(std::size_t label) const {
    std::vector<int> nodes;
    for (auto i = static_cast<std::int64_t>(label); i >= 0; i = labels_[static_cast<std::size_t>(i)].parent) {
      nodes.push_back(labels_[static_cast<std::size_t>(i)].node);
    }
    std::reverse(nodes.begin(), nodes.end());
    return nodes;
  }

  ArcIndex leaving_;
  std::vector<CostVector> ideal_;
  int goal_;
  ParetoOptions options_;
  std::vector<Label> labels_;
  std::vector<std::vector<std::size_t>> at_node_;  ///< labels that none dominates
  std::vector<std::size_t> open_;                  ///< a heap of labels in lexicographic order of their estimates
  std::vector<CostVector> solutions_;
};

}  // namespace

ParetoSet pareto_paths(int nodes, std::span<const CostArc> arcs, int from, int to, const ParetoOptions& options) {
  ISOBATH_ASSERT(from >= 0 && from < nodes && to >= 0 && to < nodes);
  for (const CostArc& arc : arcs) {
    ISOBATH_ASSERT(arc.from >= 0 && arc.from < nodes && arc.to >= 0 && arc.to < nodes);
    for (const double c : arc.cost) {
      if (!(c >= 0 && c < kUnreachable)) throw Error("the cost of an arc is negative or not finite", {}, "0 or more");
    }
  }
  ParetoSet result = LabelSearch(nodes, arcs, from, to, options).run();
  std::sort(result.paths.begin(), result.paths.end(),
            [](const ParetoPath& a, const ParetoPath& b) { return a.cost < b.cost; });
  return result;
}

bool is_preferred(const CostVector& a, const CostVector& b, const Preference& preference) {
  double sum_a = 0, sum_b = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    sum_a += preference.weights[k] * a[k];
    sum_b += preference.weights[k] * b[k];
  }
  if (sum_a != sum_b) return sum_a < sum_b;
  for (const int k : preference.order) {
    const auto i = static_cast<std::size_t>(k);
    if (a[i] != b[i]) return a[i] < b[i];
  }
  return false;
}

double deviation(const Vector2d& a, const Vector2d& b, const Vector2d& start, const Vector2d& goal) {
  const Vector2d line = goal - start;
  const double length = (b - a).norm();
  if (line.norm() == 0) return length * ((a - start).norm() + (b - start).norm()) / 2;
  const double e1 = cross(line, a - start) / line.norm(), e2 = cross(line, b - start) / line.norm();
  if ((e1 < 0) == (e2 < 0) || e1 == 0 || e2 == 0) return length * (std::abs(e1) + std::abs(e2)) / 2;
  return length * (e1 * e1 + e2 * e2) / (2 * (std::abs(e1) + std::abs(e2)));  // a triangle on each side of the line
}

}  // namespace isobath
