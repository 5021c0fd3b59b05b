#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/geometry/polygon.hpp>
#include <isobath/geometry/segment.hpp>
#include <isobath/planning/roadmap/road_map.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

Vector2d circle_centre(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const Vector2d u = b - a, v = c - a;
  const double u2 = u.squaredNorm(), v2 = v.squaredNorm(), twice = 2 * cross(u, v);
  return a + Vector2d(v.y() * u2 - u.y() * v2, u.x() * v2 - v.x() * u2) / twice;
}

/// Points of the border are no obstacle together.
bool share_an_obstacle(const DynamicDelaunay& points, int a, int b) {
  for (int p = a; p != DynamicDelaunay::kNone; p = points.twin(p)) {
    for (int q = b; q != DynamicDelaunay::kNone; q = points.twin(q)) {
      if (points.label(p) == points.label(q) && points.label(p) >= 0) return true;
    }
  }
  return false;
}

/// The middle of the shortest way between the outlines of two convex parts.
Vector2d middle_between(const Polygon& a, const Polygon& b) {
  double least2 = INFINITY;
  Vector2d middle = a.front();
  const auto try_corners = [&](const Polygon& corners, const Polygon& sides) {
    for (const Vector2d& p : corners) {
      for (std::size_t i = 0; i < sides.size(); ++i) {
        const Vector2d q = nearest_on_segment(sides[i], sides[(i + 1) % sides.size()], p);
        if ((q - p).squaredNorm() >= least2) continue;
        least2 = (q - p).squaredNorm();
        middle = (p + q) / 2;
      }
    }
  };
  try_corners(a, b);
  try_corners(b, a);
  return middle;
}

}  // namespace

RoadMap::RoadMap(const DynamicDelaunay& points, const GrownObstacles& obstacles, const Eigen::AlignedBox2d& border)
    : points_(points), obstacles_(obstacles) {
  for (std::size_t i = 0; i < obstacles.parts().size(); ++i) {
    const auto label = static_cast<std::size_t>(obstacles.parts()[i].label);
    if (label >= part_of_label_.size()) part_of_label_.resize(label + 1, GrownObstacles::kNone);
    part_of_label_[label] = static_cast<int>(i);
  }
  const auto triangles = points.triangles();
  node_of_.assign(triangles.size(), DynamicDelaunay::kNone);
  nodes_.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!DynamicDelaunay::is_finite(triangles[t])) continue;
    const auto& corner = triangles[t].corner;
    const Vector2d &a = points.at(corner[0]), &b = points.at(corner[1]), &c = points.at(corner[2]);
    const Vector2d centre = circle_centre(a, b, c);
    node_of_[t] = static_cast<int>(nodes_.size());
    nodes_.push_back(centre.allFinite() && border.contains(centre) ? centre : (a + b + c) / 3);
  }
  arcs_.reserve(3 * nodes_.size() / 2);
  has_arcs_.assign(nodes_.size(), 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (node_of_[t] == DynamicDelaunay::kNone) continue;
    for (int k = 0; k < 3; ++k) {
      if (triangles[t].neighbour[k] > static_cast<int>(t)) cross_side(static_cast<int>(t), k);
    }
  }
}

int RoadMap::part_of(int point) const {
  const int label = points_.label(point);
  const bool known = label >= 0 && static_cast<std::size_t>(label) < part_of_label_.size();
  return known ? part_of_label_[static_cast<std::size_t>(label)] : GrownObstacles::kNone;
}

/// Adds the arc over one side of a triangle.
void RoadMap::cross_side(int triangle, int slot) {
  const auto& t = points_.triangles()[static_cast<std::size_t>(triangle)];
  const int from = node_of_[static_cast<std::size_t>(triangle)];
  const int to = node_of_[static_cast<std::size_t>(t.neighbour[slot])];
  const int a = t.corner[(slot + 1) % 3], b = t.corner[(slot + 2) % 3];
  if (to == DynamicDelaunay::kNone || share_an_obstacle(points_, a, b)) return;
  const Vector2d &p = nodes_[static_cast<std::size_t>(from)], &q = nodes_[static_cast<std::size_t>(to)];
  const auto add = [&](const Vector2d& via) {
    double near = INFINITY;
    for (const int corner : {a, b}) {
      for (const Vector2d& end : {p, q}) {
        near = std::min(near, (nearest_on_segment(end, via, points_.at(corner)) - points_.at(corner)).norm());
      }
    }
    arcs_.push_back({from, to, via, (via - p).norm() + (q - via).norm(), near});
    has_arcs_[static_cast<std::size_t>(from)] = has_arcs_[static_cast<std::size_t>(to)] = 1;
  };
  const int in_the_way = obstacles_.blocker(p, q);
  if (in_the_way == GrownObstacles::kNone) {
    add((p + q) / 2);
    return;
  }
  std::array<Vector2d, 2> middles{(points_.at(a) + points_.at(b)) / 2, Vector2d(NAN, NAN)};
  const int part_a = part_of(a), part_b = part_of(b);
  if (part_a >= 0 && part_b >= 0) {
    const auto parts = obstacles_.parts();
    middles[1] = middle_between(parts[static_cast<std::size_t>(part_a)].outline,
                                parts[static_cast<std::size_t>(part_b)].outline);
  }
  for (const Vector2d& via : middles) {
    if (!via.allFinite() || !obstacles_.is_free(p, via) || !obstacles_.is_free(via, q)) continue;
    add(via);
    return;
  }
  shut_.push_back({from, to, {in_the_way, part_a, part_b}});
}

std::vector<int> RoadMap::attach(const Vector2d& p) const {
  std::vector<int> found;
  const int nearest = points_.nearest(p);
  if (nearest == DynamicDelaunay::kNone) return found;
  const auto try_around = [&](int corner) {
    for (const int t : points_.around(corner)) {
      const int node = node_of_[static_cast<std::size_t>(t)];
      if (node == DynamicDelaunay::kNone || !has_arcs_[static_cast<std::size_t>(node)]) continue;
      if (obstacles_.is_free(p, nodes_[static_cast<std::size_t>(node)])) found.push_back(node);
    }
  };
  try_around(nearest);
  if (!found.empty()) return found;
  std::vector<int> beside;
  for (const int t : points_.around(nearest)) {
    for (const int corner : points_.triangles()[static_cast<std::size_t>(t)].corner) {
      if (corner != DynamicDelaunay::kNone && corner != nearest) beside.push_back(corner);
    }
  }
  for (const int corner : beside) try_around(corner);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace isobath
