#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/planning/roadmap/path_finder.hpp>
#include <isobath/planning/roadmap/visibility_graph.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using PathPoints = std::vector<Vector2d>;

constexpr int kBorderLabel = -1;
constexpr int kBorderPoints = 8;    // a side
constexpr double kSamePath = 0.25;  // m between corners of two paths that are taken for one

AlignedBox2d border_around(const PathFinderConfig& c) {
  const bool sound = !c.region.isEmpty() && c.region.min().allFinite() && c.region.max().allFinite() &&
                     c.region.sizes().minCoeff() > 0 && c.region.min().cwiseAbs().maxCoeff() <= 1e8 &&
                     c.region.max().cwiseAbs().maxCoeff() <= 1e8;
  if (!sound) throw Error("the region of a path finder is empty or not finite", {}, "within 1e8 m of the origin");
  if (!(c.radius_m > 0 && c.spacing_m > 0 && c.speed_m_s > 0 && c.wished_clearance_m >= 0 && c.sides >= 3 &&
        c.tolerance >= 0)) {
    throw Error("a setting of a path finder is out of range", {}, "radius, spacing and speed above 0, 3 sides or more");
  }
  const Vector2d beyond = Vector2d::Constant(c.region.sizes().maxCoeff() / 4 + 4 * c.radius_m);
  return {c.region.min() - beyond, c.region.max() + beyond};
}

bool is_same_path(const PathPoints& a, const PathPoints& b) {
  const auto near = [](const Vector2d& p, const Vector2d& q) { return (p - q).norm() < kSamePath; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), near);
}

CostVector cost_of(const PathCandidate& p) { return {p.length_m, p.deviation_m2, p.delay_s}; }

/// The road map with the start and the goal as its last two nodes.
struct Roads {
  std::vector<CostArc> arcs;
  std::vector<std::array<int, 3>> arcs_at;  ///< by node of the map: its arcs, or -1

  explicit Roads(const RoadMap& map) : arcs_at(map.nodes().size(), {-1, -1, -1}) {
    arcs.reserve(2 * map.arcs().size() + 32);
    for (std::size_t i = 0; i < map.arcs().size(); ++i) {
      for (const int node : {map.arcs()[i].from, map.arcs()[i].to}) {
        auto& here = arcs_at[static_cast<std::size_t>(node)];
        *std::find(here.begin(), here.end(), -1) = static_cast<int>(i);
      }
    }
  }
  void join(int a, int b, const CostVector& cost) {
    arcs.push_back({a, b, cost});
    arcs.push_back({b, a, cost});
  }
  /// The arc of the map between two nodes of it.
  [[nodiscard]] const RoadMap::Arc& between(const RoadMap& map, int a, int b) const {
    for (const int i : arcs_at[static_cast<std::size_t>(a)]) {
      if (i < 0) break;
      const RoadMap::Arc& arc = map.arcs()[static_cast<std::size_t>(i)];
      if (arc.from == b || arc.to == b) return arc;
    }
    ISOBATH_ASSERT(false);
  }
};

}  // namespace

const char* to_text(PathRefusal refusal) {
  switch (refusal) {
    case PathRefusal::kStartBlocked: return "the start is too near to an obstacle";
    case PathRefusal::kGoalBlocked: return "the goal is too near to an obstacle";
    case PathRefusal::kNoPath: return "no path keeps the clearance";
  }
  return "";
}

PathFinder::PathFinder(const PathFinderConfig& config)
    : config_(config), border_(border_around(config)), points_(config.max_points) {
  const Vector2d low = border_.min(), size = border_.sizes();
  for (int i = 0; i < kBorderPoints; ++i) {
    const double share = static_cast<double>(i) / kBorderPoints;
    points_.insert(low + Vector2d(share * size.x(), 0), kBorderLabel);
    points_.insert(low + Vector2d(size.x(), share * size.y()), kBorderLabel);
    points_.insert(low + Vector2d((1 - share) * size.x(), size.y()), kBorderLabel);
    points_.insert(low + Vector2d(0, (1 - share) * size.y()), kBorderLabel);
  }
}

// --- obstacles -------------------------------------------------------------------------------------------------------

bool PathFinder::set_obstacle(int id, const Polygon& outline) {
  for (const Vector2d& p : outline) {
    if (!p.allFinite()) throw Error("a corner of an obstacle is not finite", {}, "finite coordinates");
  }
  const bool inside = !outline.empty() && std::all_of(outline.begin(), outline.end(),
                                                      [&](const Vector2d& p) { return config_.region.contains(p); });
  if (!inside) {
    remove_obstacle(id);
    return false;
  }
  Obstacle& obstacle = obstacles_[id];
  obstacle.outline = outline;
  shape(obstacle);
  return true;
}

void PathFinder::remove_obstacle(int id) {
  const auto found = obstacles_.find(id);
  if (found == obstacles_.end()) return;
  clear(found->second);
  obstacles_.erase(found);
}

void PathFinder::clear(Obstacle& obstacle) {
  for (Part& part : obstacle.parts) {
    for (const int p : part.points) points_.remove(p);
    free_labels_.push_back(part.label);
  }
  obstacle.parts.clear();
}

/// Gives an obstacle the parts of its outline at its level of detail. The points of the parts that it had are moved.
void PathFinder::shape(Obstacle& obstacle) {
  std::vector<Polygon> shapes = shape_of(obstacle.outline, obstacle.detail);
  if (shapes.size() != obstacle.parts.size()) clear(obstacle);
  while (obstacle.parts.size() < shapes.size()) {
    if (free_labels_.empty()) free_labels_.push_back(labels_++);
    obstacle.parts.emplace_back().label = free_labels_.back();
    free_labels_.pop_back();
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    obstacle.parts[i].outline = std::move(shapes[i]);
    outline_points(obstacle.parts[i]);
  }
}

void PathFinder::outline_points(Part& part) {
  scratch_.clear();
  const Polygon& outline = part.outline;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2d side = outline[(i + 1) % outline.size()] - outline[i];
    const double pieces = std::max(1.0, std::ceil(side.norm() / config_.spacing_m));
    for (double k = 0; k < pieces; ++k) scratch_.emplace_back(outline[i] + k / pieces * side);
  }
  while (part.points.size() > scratch_.size()) {
    points_.remove(part.points.back());
    part.points.pop_back();
  }
  for (std::size_t i = 0; i < scratch_.size(); ++i) {
    if (i < part.points.size()) {
      points_.move(part.points[i], scratch_[i]);
    } else {
      part.points.push_back(points_.insert(scratch_[i], part.label));
    }
  }
}

GrownObstacles PathFinder::grow() const {
  std::vector<GrownPart> parts;
  for (const auto& [id, obstacle] : obstacles_) {
    for (const Part& part : obstacle.parts) {
      parts.push_back({id, part.label, part.outline, grown_polygon(part.outline, config_.radius_m, config_.sides)});
    }
  }
  return GrownObstacles(std::move(parts));
}

// --- detail ----------------------------------------------------------------------------------------------------------

bool PathFinder::refine(int id) {
  Obstacle& obstacle = obstacles_.at(id);
  if (obstacle.detail == ShapeDetail::kParts) return false;
  obstacle.detail = obstacle.detail == ShapeDetail::kEnclosure ? ShapeDetail::kHull : ShapeDetail::kParts;
  shape(obstacle);
  return true;
}

bool PathFinder::refine_covering(const GrownObstacles& grown, const Vector2d& p) {
  bool refined = false;
  for (const int part : grown.covering(p)) {
    refined = refine(grown.parts()[static_cast<std::size_t>(part)].obstacle) || refined;
  }
  return refined;
}

/// Refines the obstacles that shut the water which can be reached from some nodes.
bool PathFinder::refine_shut(const RoadMap& map, const GrownObstacles& grown, std::span<const int> from) {
  const Roads roads(map);
  std::vector<char> reached(map.nodes().size(), 0);
  std::vector<int> open(from.begin(), from.end());
  for (const int node : open) reached[static_cast<std::size_t>(node)] = 1;
  while (!open.empty()) {
    const int node = open.back();
    open.pop_back();
    for (const int i : roads.arcs_at[static_cast<std::size_t>(node)]) {
      if (i < 0) break;
      const RoadMap::Arc& arc = map.arcs()[static_cast<std::size_t>(i)];
      for (const int next : {arc.from, arc.to}) {
        if (std::exchange(reached[static_cast<std::size_t>(next)], 1) == 0) open.push_back(next);
      }
    }
  }
  std::vector<int> in_the_way;
  for (const RoadMap::Shut& shut : map.shut()) {
    if (reached[static_cast<std::size_t>(shut.from)] == reached[static_cast<std::size_t>(shut.to)]) continue;
    for (const int part : shut.parts) {
      if (part != GrownObstacles::kNone) in_the_way.push_back(grown.parts()[static_cast<std::size_t>(part)].obstacle);
    }
  }
  std::sort(in_the_way.begin(), in_the_way.end());
  in_the_way.erase(std::unique(in_the_way.begin(), in_the_way.end()), in_the_way.end());
  bool refined = false;
  for (const int id : in_the_way) refined = refine(id) || refined;
  return refined;
}

// --- paths -----------------------------------------------------------------------------------------------------------

Result<PathCandidates, PathRefusal> PathFinder::candidates(const Vector2d& start, const Vector2d& goal) {
  for (const Vector2d& p : {start, goal}) {
    if (p.allFinite() && config_.region.contains(p)) continue;
    throw Error("the start or goal of a path is not finite or beyond the region", {}, "", "aim at a place within it");
  }
  while (true) {
    const GrownObstacles grown = grow();
    if (!grown.is_free(start, start)) {
      if (refine_covering(grown, start)) continue;
      return tl::unexpected(PathRefusal::kStartBlocked);
    }
    if (!grown.is_free(goal, goal)) {
      if (refine_covering(grown, goal)) continue;
      return tl::unexpected(PathRefusal::kGoalBlocked);
    }
    const RoadMap map(points_, grown, border_);
    PathCandidates paths = found(map, grown, start, goal);
    if (!paths.paths.empty()) return paths;
    if (refine_shut(map, grown, map.attach(start)) || refine_shut(map, grown, map.attach(goal))) continue;
    return tl::unexpected(PathRefusal::kNoPath);
  }
}

PathCandidates PathFinder::found(const RoadMap& map, const GrownObstacles& grown, const Vector2d& start,
                                 const Vector2d& goal) const {
  Roads roads(map);
  const int first = static_cast<int>(map.nodes().size()), last = first + 1;
  const auto cost = [&](const Vector2d& a, const Vector2d& via, const Vector2d& b, double clearance) {
    const double length = (via - a).norm() + (b - via).norm();
    return CostVector{length, deviation(a, via, start, goal) + deviation(via, b, start, goal),
                      delay(length, clearance)};
  };
  const auto at = [&](int node) -> const Vector2d& {
    return node == first ? start : node == last ? goal : map.nodes()[static_cast<std::size_t>(node)];
  };
  for (const RoadMap::Arc& arc : map.arcs()) {
    roads.join(arc.from, arc.to, cost(at(arc.from), arc.via, at(arc.to), arc.clearance_m));
  }
  for (const int end : {first, last}) {
    for (const int node : map.attach(at(end))) {
      const double clearance = grown.distance(at(end), at(node), 2 * config_.wished_clearance_m);
      roads.join(end, node, cost(at(end), at(node), at(node), clearance));
    }
  }
  const ParetoSet pareto = pareto_paths(last + 1, roads.arcs, first, last, {config_.tolerance, config_.max_labels});
  PathCandidates result;
  result.complete = pareto.complete;
  const auto add = [&](PathPoints points) {
    const bool known = std::any_of(result.paths.begin(), result.paths.end(),
                                   [&](const PathCandidate& p) { return is_same_path(p.points, points); });
    if (!known) result.paths.push_back(measured(grown, std::move(points)));
  };
  PathPoints shortest = VisibilityGraph(grown).shortest_path(start, goal);
  if (!shortest.empty()) add(std::move(shortest));
  for (const ParetoPath& path : pareto.paths) {
    PathPoints points{start};
    for (std::size_t i = 1; i < path.nodes.size(); ++i) {
      const int a = path.nodes[i - 1], b = path.nodes[i];
      if (a < first && b < first) points.push_back(roads.between(map, a, b).via);
      points.push_back(at(b));
    }
    straighten(grown, points);
    add(std::move(points));
  }
  std::stable_sort(result.paths.begin(), result.paths.end(), [&](const PathCandidate& a, const PathCandidate& b) {
    return is_preferred(cost_of(a), cost_of(b), config_.preference);
  });
  if (result.paths.size() > config_.max_candidates) result.paths.resize(config_.max_candidates);
  return result;
}

/// Leaves out corners while the path keeps the clearance that it has, or the wished one.
void PathFinder::straighten(const GrownObstacles& grown, PathPoints& points) const {
  double keep = config_.wished_clearance_m;
  for (std::size_t i = 1; i < points.size(); ++i) keep = grown.distance(points[i - 1], points[i], keep);
  PathPoints straight{points.front()};
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vector2d &from = straight.back(), &to = points[i + 1];
    const bool skips = grown.is_free(from, to) && grown.distance(from, to, keep) >= keep;
    if (!skips) straight.push_back(points[i]);
  }
  straight.push_back(points.back());
  points = std::move(straight);
}

PathCandidate PathFinder::measured(const GrownObstacles& grown, PathPoints points) const {
  PathCandidate path;
  path.clearance_m = 2 * config_.wished_clearance_m;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector2d &a = points[i - 1], &b = points[i];
    const double length = (b - a).norm(), clearance = grown.distance(a, b, 2 * config_.wished_clearance_m);
    path.length_m += length;
    path.deviation_m2 += deviation(a, b, points.front(), points.back());
    path.delay_s += delay(length, clearance);
    path.clearance_m = std::min(path.clearance_m, clearance);
  }
  path.points = std::move(points);
  return path;
}

double PathFinder::delay(double length_m, double clearance_m) const {
  const double slower = config_.wished_clearance_m / std::max(clearance_m, config_.radius_m / 2) - 1;
  return length_m / config_.speed_m_s * std::max(0.0, slower);
}

}  // namespace isobath
