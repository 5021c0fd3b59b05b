#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/planning/roadmap/obstacle_shapes.hpp>
#include <isobath/planning/roadmap/visibility_graph.hpp>
#include <isobath/studies/traffic_scene.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double kLowX = -20, kHighX = 160, kLowY = -60, kHighY = 60, kFreeStart_m = 15;
constexpr double kLaneX = 75, kLaneWidth_m = 25, kLaneEnd_m = 150;
constexpr int kFirstStructure = 10'000;  // their numbers
constexpr int kLookSteps = 10;           // from look to look at an unknown map
constexpr int kReachSides = 24;

void reflect(double& position, double& velocity, double low, double high) {
  if (position < low) {
    position = 2 * low - position;
    velocity = -velocity;
  } else if (position > high) {
    position = 2 * high - position;
    velocity = -velocity;
  }
}

Polygon wall_outline(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

/// The part of a convex polygon within a convex polygon; empty if there is none.
Polygon part_within(Polygon polygon, const Polygon& window) {
  for (std::size_t i = 0; i < window.size() && !polygon.empty(); ++i) {
    const Vector2d &from = window[i], side = window[(i + 1) % window.size()] - from;
    Polygon kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vector2d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
      const double in_a = cross(side, a - from), in_b = cross(side, b - from);
      if (in_a >= 0) kept.push_back(a);
      if ((in_a < 0) != (in_b < 0)) kept.push_back(a + in_a / (in_a - in_b) * (b - a));
    }
    polygon = std::move(kept);
  }
  return polygon.size() < 3 ? Polygon{} : polygon;
}

MovingBody structure_of(int number, const Polygon& outline_W) {
  MovingBody body;
  body.number = number;
  for (const Vector2d& corner : outline_W) body.p_W += corner / static_cast<double>(outline_W.size());
  for (const Vector2d& corner : outline_W) body.outline.push_back(corner - body.p_W);
  return body;
}

}  // namespace

std::string to_text(TrafficScenery scenery) {
  switch (scenery) {
    case TrafficScenery::kOpen: return "open";
    case TrafficScenery::kWalls: return "walls";
    case TrafficScenery::kQuay: return "quay";
    case TrafficScenery::kHarbour: return "harbour";
    case TrafficScenery::kBar: return "bar";
    case TrafficScenery::kCrossing: break;
  }
  return "crossing";
}

TrafficScene::TrafficScene(TrafficScenery scenery, std::uint64_t run, int discs, double max_speed) : scenery_(scenery) {
  Random random(run * 1000003 + static_cast<std::uint64_t>(discs) * 7919 +
                static_cast<std::uint64_t>(static_cast<int>(100 * max_speed)));
  switch (scenery) {
    case TrafficScenery::kWalls: add_walls(random); break;
    case TrafficScenery::kQuay: add_quay(random); break;
    case TrafficScenery::kHarbour: add_harbour(random); break;
    case TrafficScenery::kBar: add_bar(random); break;
    case TrafficScenery::kCrossing: add_lanes(random, discs, max_speed); return;
    case TrafficScenery::kOpen: break;
  }
  add_discs(random, discs, max_speed);
}

// --- what the scenes hold --------------------------------------------------------------------------------------------

void TrafficScene::add_structure(const Polygon& outline_W) {
  structures_.push_back(structure_of(kFirstStructure + static_cast<int>(structures_.size()), outline_W));
  for (Polygon& part : convex_parts(outline_W)) parts_.push_back(std::move(part));
  seen_parts_.resize(parts_.size());
}

void TrafficScene::add_walls(Random& random) {
  for (const double about : {35.0, 70.0, 105.0}) {
    const double x = about + random.uniform(-6, 6), thick = random.uniform(1, 2);
    struct Gap {
      double low, high;
    };
    std::array<Gap, 3> gaps{};
    const double middle = random.uniform(-45, 45), wide = random.uniform(3, 7);
    gaps[0] = {middle - wide, middle + wide};
    for (std::size_t i = 1; i < gaps.size(); ++i) {
      do {
        const double low = random.uniform(-58, 56);
        gaps[i] = {low, low + random.uniform(0.5, 0.95)};
      } while (std::any_of(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(i),
                           [&](const Gap& g) { return gaps[i].low < g.high + 2 && gaps[i].high > g.low - 2; }));
    }
    std::sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.low < b.low; });
    double from = kLowY;
    for (const Gap& gap : gaps) {
      add_structure(wall_outline(x, from, x + thick, gap.low));
      from = gap.high;
    }
    add_structure(wall_outline(x, from, x + thick, kHighY));
  }
}

void TrafficScene::add_quay(Random& random) {
  const double thick = 1.5, depth = random.uniform(20, 40), half = random.uniform(8, 18);
  const double x = random.uniform(40, 60), y = random.uniform(-4, 4), base = x + depth;
  add_structure({{x, y - half - thick},
                 {base + thick, y - half - thick},
                 {base + thick, y + half + thick},
                 {x, y + half + thick},
                 {x, y + half},
                 {base, y + half},
                 {base, y - half},
                 {x, y - half}});
}

void TrafficScene::add_harbour(Random& random) {
  const double thick = 1.5, inner = random.uniform(12, 18), outer = inner + thick, mouth = random.uniform(3, 8);
  const double low = random.uniform(2 - inner, inner - 2 - mouth), high = low + mouth;
  const auto quarters = static_cast<int>(random.index(4));
  Polygon outline = {{outer, high},    {outer, outer},  {-outer, outer}, {-outer, -outer},
                     {outer, -outer},  {outer, low},    {inner, low},    {inner, -inner},
                     {-inner, -inner}, {-inner, inner}, {inner, inner},  {inner, high}};
  for (Vector2d& corner : outline) {
    for (int k = 0; k < quarters; ++k) corner = Vector2d(-corner.y(), corner.x());
    corner += goal();
  }
  add_structure(outline);
}

void TrafficScene::add_bar(Random& random) {
  MovingBody bar;
  bar.number = kFirstStructure;
  const double x = random.uniform(45, 95), y = random.uniform(-3, 3), half = random.uniform(10, 25);
  bar.p_W = {x, y};
  const double angle = random.uniform(0, pi), rate = random.uniform(0.04, 0.2);
  bar.turn_rate = random.index(2) == 0 ? rate : -rate;
  const Vector2d along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());
  bar.outline = {half * along + 0.4 * across, -half * along + 0.4 * across, -half * along - 0.4 * across,
                 half * along - 0.4 * across};
  structures_.push_back(bar);
}

void TrafficScene::add_lanes(Random& random, int discs, double max_speed) {
  for (int i = 0; i < discs; ++i) {
    MovingBody disc;
    disc.number = i;
    const double side = i % 2 == 0 ? -1 : 1;
    const double x = kLaneX + side * random.uniform(0, kLaneWidth_m), y = random.uniform(-kLaneEnd_m, kLaneEnd_m);
    disc.p_W = {x, y};
    disc.radius_m = random.uniform(0.5, 3);
    disc.velocity_W = {0, -side * max_speed * random.uniform(0.5, 1)};
    discs_.push_back(disc);
  }
}

void TrafficScene::add_discs(Random& random, int discs, double max_speed) {
  for (int i = 0; i < discs; ++i) {
    MovingBody disc;
    disc.number = i;
    do {
      const double x = random.uniform(kLowX, kHighX), y = random.uniform(kLowY, kHighY);
      disc.p_W = {x, y};
      disc.radius_m = random.uniform(0.5, 3);
    } while (disc.p_W.norm() < kFreeStart_m + disc.radius_m || touches_structure(disc));
    const double speed = max_speed * random.uniform(0.2, 1), direction = random.uniform(0, 2 * pi);
    disc.velocity_W = speed * Vector2d(std::cos(direction), std::sin(direction));
    discs_.push_back(disc);
  }
}

// --- time ------------------------------------------------------------------------------------------------------------

bool TrafficScene::touches_structure(const MovingBody& disc) const {
  return std::ranges::any_of(structures_, [&](const MovingBody& structure) {
    return structure.turn_rate == 0 && distance_to(structure, disc.p_W, 0) < disc.radius_m;
  });
}

void TrafficScene::step() {
  now_ += seconds(kStep_s);
  ++steps_;
  for (MovingBody& disc : discs_) {
    disc.p_W += kStep_s * disc.velocity_W;
    disc.time = now_;
    if (scenery_ == TrafficScenery::kCrossing) {  // they leave a lane at its end and enter it at its beginning
      disc.p_W.y() = std::remainder(disc.p_W.y(), 2 * kLaneEnd_m);
      continue;
    }
    reflect(disc.p_W.x(), disc.velocity_W.x(), kLowX, kHighX);
    reflect(disc.p_W.y(), disc.velocity_W.y(), kLowY, kHighY);
  }
}

void TrafficScene::see_parts(const Vector2d& p, double reach_m) {
  const Polygon window = grown_polygon({p}, reach_m * std::cos(pi / kReachSides), kReachSides);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Polygon part = part_within(parts_[i], window);
    part.insert(part.end(), seen_parts_[i].begin(), seen_parts_[i].end());
    seen_parts_[i] = convex_hull(std::move(part));
  }
}

void TrafficScene::sense(const Vector2d& p, double reach_m, bool is_known, std::vector<MovingBody>& seen) {
  seen.clear();
  for (const MovingBody& disc : discs_) {
    if ((disc.p_W - p).norm() <= reach_m) seen.push_back(disc);
  }
  for (const MovingBody& structure : structures_) {
    const bool is_bar = structure.turn_rate != 0;
    if (is_bar ? (structure.p_W - p).norm() <= reach_m : is_known) seen.push_back(structure);
  }
  if (is_known) return;
  if (steps_ % kLookSteps == 0) see_parts(p, reach_m);
  for (std::size_t i = 0; i < seen_parts_.size(); ++i) {
    if (seen_parts_[i].size() > 2) seen.push_back(structure_of(kFirstStructure + static_cast<int>(i), seen_parts_[i]));
  }
}

double TrafficScene::gap(const Vector2d& p) const {
  double least = std::numeric_limits<double>::infinity();
  for (const MovingBody& disc : discs_) least = std::min(least, (disc.p_W - p).norm() - disc.radius_m - kRadius_m);
  for (const MovingBody& structure : structures_) {
    least = std::min(least, distance_to(structure, p, to_seconds(now_ - structure.time)) - kRadius_m);
  }
  return least;
}

double TrafficScene::free_time_s() const {
  std::vector<GrownPart> grown;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const int number = static_cast<int>(i);
    grown.push_back({number, number, parts_[i], grown_polygon(parts_[i], kRadius_m, kReachSides)});
  }
  const GrownObstacles obstacles(std::move(grown));
  const std::vector<Vector2d> path = VisibilityGraph(obstacles).shortest_path({0, 0}, goal());
  double length_m = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length_m += (path[i] - path[i - 1]).norm();
  return (length_m - kArrival_m) / kSpeed;
}

}  // namespace isobath
