#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <isobath/world/map_features.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr const char* kPoints = "points";
constexpr const char* kDepth = "depth";
constexpr const char* kClearTo = "clear to";

/// To a millimetre: "12.500 -3.250 13.000 -3.000".
std::string points_text(const std::vector<Vector2d>& points) {
  std::string text;
  for (const Vector2d& p : points) fmt::format_to(std::back_inserter(text), "{:.3f} {:.3f} ", p.x(), p.y());
  return text;
}

/// Parsing stops at the first text that is not a finite number.
std::vector<Vector2d> points_of(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at < end) {
    double value = 0;
    const auto [next, failed] = std::from_chars(at, end, value);
    if (failed != std::errc() || !std::isfinite(value)) break;
    numbers.push_back(value);
    at = next < end && *next == ' ' ? next + 1 : next;
  }
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) points.emplace_back(numbers[i], numbers[i + 1]);
  return points;
}

bool is_wall(const std::string& kind) {
  constexpr std::array kWalls{PriorLineKind::kCoast, PriorLineKind::kStructure, PriorLineKind::kObstruction};
  return std::any_of(kWalls.begin(), kWalls.end(), [&](PriorLineKind wall) { return kind == to_text(wall); });
}
void add_walls(const std::vector<Vector2d>& points, std::vector<ChartedWall>& walls) {
  for (std::size_t i = 0; i + 1 < points.size(); ++i) walls.push_back({points[i], points[i + 1]});
}

bool blocks(PriorPointKind kind) { return kind != PriorPointKind::kLand; }
bool blocks(PriorLineKind kind) { return kind == PriorLineKind::kStructure || kind == PriorLineKind::kObstruction; }
/// 0 if the chart does not say: the object then reaches up to the surface.
double highest_of(const PriorPoint& point) { return point.depth_m.value_or(point.clear_to_m.value_or(0)); }

void store_point(ObjectStore& store, const PriorPoint& point, Time time) {
  MapObject object;
  object.capabilities = kChartedObject | (blocks(point.kind) ? kBlocksPassage : 0);
  object.kind = to_text(point.kind);
  object.name = point.name;
  object.p_W = {point.north_east.x(), point.north_east.y(), highest_of(point)};
  object.covariance(2, 2) = point.sigma_m * point.sigma_m;
  const ObjectId id = store.create(object);
  if (point.depth_m) store.put(id, kDepth, {time, *point.depth_m});
  if (point.clear_to_m) store.put(id, kClearTo, {time, *point.clear_to_m});
  for (const auto& [name, value] : point.attributes) store.put(id, name, {time, value});
}

void store_line(ObjectStore& store, const PriorLine& line, Time time) {
  if (line.points.size() < 2) return;
  MapObject object;
  object.capabilities = kChartedObject | kLineFeature | (blocks(line.kind) ? kBlocksPassage : 0);
  object.kind = to_text(line.kind);
  object.name = line.name;
  object.p_W = {line.points.front().x(), line.points.front().y(), line.depth_m.value_or(0)};
  const ObjectId id = store.create(object);
  if (line.depth_m) store.put(id, kDepth, {time, *line.depth_m});
  store.put(id, kPoints, {time, points_text(line.points)});
}

}  // namespace

std::size_t store_features(ObjectStore& store, const std::vector<Prior>& priors, Time time) {
  ObjectStore::Transaction all(store);
  std::size_t count = 0;
  for (const Prior& prior : priors) {
    for (const PriorPoint& point : prior.points) store_point(store, point, time);
    for (const PriorLine& line : prior.lines) store_line(store, line, time);
    count += prior.points.size() + prior.lines.size();
    for (const PriorArea& area : prior.areas) {
      if (area.kind != PriorAreaKind::kWater) continue;
      for (Polygon ring : area.rings) {
        ring.push_back(ring.front());
        store_line(store, {PriorLineKind::kCoast, ring, 0.0, area.name}, time);
        ++count;
      }
    }
  }
  all.commit();
  return count;
}

Eigen::AlignedBox2d box_of(const DepthArea& area) {
  const double side = std::ldexp(area.grid.pixel_m, area.levels);
  const Vector2d south_west{area.grid.corner_m.x() - side, area.grid.corner_m.y()};  // corner_m is the north-west one
  return {south_west, south_west + Vector2d(side, side)};
}

MapFeatures::MapFeatures(const DepthArea& area)
    : points(box_of(area).min(), box_of(area).sizes().x()), segments(box_of(area).min(), box_of(area).sizes().x()) {}

MapFeatures load_features(const ObjectStore& store, const DepthArea& area) {
  MapFeatures features(area);
  for (const MapObject& object : store.find(store.with_any(kChartedObject | kFoundObject))) {
    if ((object.capabilities & kLineFeature) == 0) {
      features.points.insert({features.objects.size(), object.p_W.head<2>(), object.capabilities});
      features.objects.push_back(object);
      continue;
    }
    const auto entry = store.latest(object.id, kPoints);
    const auto* text = entry ? std::get_if<std::string>(&entry->value) : nullptr;
    MapFeatures::Line line{object.id, object.kind, object.name, object.p_W.z(), {}, false};
    if (text != nullptr) line.points = points_of(*text);
    line.blocks = (object.capabilities & kBlocksPassage) != 0;
    for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
      features.segments.insert({features.lines.size() << 32 | i, line.points[i], line.points[i + 1]});
    }
    features.lines.push_back(std::move(line));
  }
  return features;
}

std::vector<ChartObstacle> obstacles_near(const MapFeatures& features, const Eigen::AlignedBox2d& window,
                                          double radius_m) {
  std::vector<ChartObstacle> obstacles;
  const Vector2d reach{radius_m, radius_m};
  const Eigen::AlignedBox2d wide(window.min() - reach, window.max() + reach);
  for (const std::uint64_t index : features.points.in_window(wide, kBlocksPassage)) {
    const MapObject& object = features.objects[index];
    ChartObstacle obstacle;
    obstacle.a = obstacle.b = object.p_W.head<2>();
    obstacle.radius_m = radius_m;
    obstacle.top_m = object.p_W.z();  // depth of its top; 0, at the surface, if the chart does not say
    obstacles.push_back(obstacle);
  }
  for (const std::uint64_t id : features.segments.in_window(wide)) {
    const MapFeatures::Line& line = features.lines[id >> 32];
    if (!line.blocks) continue;
    const std::size_t i = id & 0xffffffffU;
    ChartObstacle obstacle;
    obstacle.a = line.points[i];
    obstacle.b = line.points[i + 1];
    obstacle.radius_m = radius_m;
    obstacles.push_back(obstacle);
  }
  return obstacles;
}

std::vector<ChartedWall> walls_of(const MapFeatures& features) {
  std::vector<ChartedWall> walls;
  for (const MapFeatures::Line& line : features.lines) {
    if (is_wall(line.kind)) add_walls(line.points, walls);
  }
  return walls;
}

std::vector<ChartedWall> walls_of(const std::vector<Prior>& priors) {
  std::vector<ChartedWall> walls;
  for (const Prior& prior : priors) {
    for (const PriorLine& line : prior.lines) {
      if (is_wall(to_text(line.kind))) add_walls(line.points, walls);
    }
    for (const PriorArea& area : prior.areas) {
      if (area.kind != PriorAreaKind::kStructure && area.kind != PriorAreaKind::kObstruction) continue;
      for (Polygon ring : area.rings) {
        ring.push_back(ring.front());
        add_walls(ring, walls);
      }
    }
  }
  return walls;
}

std::vector<ChartObstacle> obstacles_of(const std::vector<Prior>& priors) {
  std::vector<ChartObstacle> obstacles;
  for (const Prior& prior : priors) {
    for (const PriorPoint& point : prior.points) {
      if (blocks(point.kind)) obstacles.push_back({point.north_east, point.north_east, 0, highest_of(point)});
    }
    for (const PriorLine& line : prior.lines) {
      if (!blocks(line.kind)) continue;
      for (std::size_t i = 0; i + 1 < line.points.size(); ++i) {
        obstacles.push_back({line.points[i], line.points[i + 1]});
      }
    }
  }
  return obstacles;
}

}  // namespace isobath
