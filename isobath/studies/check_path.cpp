#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/charts/threat_areas.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/map/depth/mission_map.hpp>
#include <isobath/mission/plan/mission_file.hpp>
#include <isobath/planning/world_snapshot.hpp>
#include <isobath/studies/check_path.hpp>
#include <isobath/world/map_features.hpp>
#include <isobath/world/map_raster.hpp>

namespace isobath {
namespace {

constexpr double kFarthest = 9e5;  // m, on the globe and on the plane: the radius of a local plane

void refuse_far(const GeoPoint& point, const GeoOrigin& origin, const std::filesystem::path& map) {
  const double apart = distance_m(point, origin);
  if (apart < kFarthest) return;
  throw Error(
      fmt::format("the way-point {:.4f}, {:.4f} lies {:.0f} km from the map, which is at {:.4f}, {:.4f}",
                  point.latitude_deg, point.longitude_deg, apart / 1000, origin.latitude_deg, origin.longitude_deg),
      {map.string()});
}

}  // namespace

std::string place_text(const std::optional<GeoOrigin>& origin, const Eigen::Vector2d& place) {
  if (!origin) return {};
  const GeoPoint p = LocalPlane(*origin).to_geo(place);
  return fmt::format(" ({:.6f}, {:.6f})", p.latitude_deg, p.longitude_deg);
}

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Path = std::vector<Vector3d>;

Path points_of(const PathRequest& request, const StoredMap& map) {
  Path path;
  if (!request.points.empty()) {
    if (!map.facts.origin) {
      throw Error("the map has no geographic origin", {request.map.string()}, {},
                  "give the path in metres north and east");
    }
    const LocalPlane plane(*map.facts.origin);
    for (const GeoPoint& point : request.points) {
      refuse_far(point, *map.facts.origin, request.map);
      const Vector2d p = plane.to_plane(point);
      path.emplace_back(p.x(), p.y(), request.draught_m);
    }
  }
  for (const Vector2d& p : request.local_m) {
    if (!(p.norm() < kFarthest)) throw Error("a way-point lies more than 900 km from the map", {request.map.string()});
    path.emplace_back(p.x(), p.y(), request.draught_m);
  }
  return path;
}

Eigen::AlignedBox2d box_round(const Path& path, double aside_m) {
  Eigen::AlignedBox2d box;
  for (const Vector3d& p : path) {
    box.extend(Vector2d(p.head<2>() - Vector2d::Constant(aside_m)));
    box.extend(Vector2d(p.head<2>() + Vector2d::Constant(aside_m)));
  }
  return box;
}

/// A path over a map: what is known of the map where the path is, and how the path is judged.
class PathOverMap {
 public:
  explicit PathOverMap(const PathRequest& request)
      : request_(request),
        map_(open_map(request.map)),
        depths_(snapshot_of(map_)),
        world_{.depths = depths_},
        points_(points_of(request, map_)),
        passage_(request.search.passage),
        features_(map_.facts.area) {
    passage_.half_width_m = request.formation.half_width_m(passage_.half_width_m);
    const std::filesystem::path objects = request.map / "objects.sqlite";
    if (!std::filesystem::exists(objects)) return;
    store_.emplace(objects);
    features_ = load_features(*store_, map_.facts.area);
  }

  PathOutcome judge() {
    PathOutcome outcome;
    outcome.origin = map_.facts.origin;
    Path path = points_;
    std::string no_way;
    if (request_.line.any()) outcome.way = path = course_along_line();
    load_obstacles(path);
    outcome.obstacles = world_.all_objects().size();
    find_objects(outcome);
    load_threats(path);
    if (request_.find) {
      no_way = find_way(outcome);
      if (no_way.empty()) path = outcome.way;
    }
    decide(path, no_way, outcome);
    if (request_.formation.vehicles > 1) outcome.abreast = abreast(path);
    if (threats_) outcome.threats = risk_of_path(path);
    for (std::size_t i = 1; i < path.size(); ++i) outcome.length_m += (path[i] - path[i - 1]).norm();
    return outcome;
  }

 private:
  [[nodiscard]] Path course_along_line() const {
    if (points_.size() > 2) throw Error("a line is followed from one point, or from one to another");
    std::optional<Vector2d> end;
    if (points_.size() == 2) end = points_[1].head<2>();
    const auto line =
        line_to_follow(*depths_, features_, request_.line, map_.facts.origin, points_.front().head<2>(), end);
    FeatureCourseConfig config;
    config.offset_m = request_.offset_m;
    config.depth_m = config.unknown_depth_m = request_.draught_m;
    config.half_width_m = passage_.half_width_m;
    if (request_.altitude_m) {
      config.rule = DepthRule::kAltitude;
      config.altitude_m = *request_.altitude_m;
    }
    const auto course = feature_course(line, config, depths_.get());
    if (!course) throw Error(std::string("the line cannot be followed: ") + to_text(course.error()));
    Path path;
    for (const Waypoint& w : *course) path.emplace_back(w.north, w.east, std::max(w.depth, request_.draught_m));
    return path;
  }

  void load_obstacles(const Path& path) {
    auto obstacles = obstacles_near(features_, box_round(path, request_.find ? request_.search.margin_m : 0),
                                    request_.obstacle_radius_m + passage_.half_width_m);
    for (ChartObstacle& obstacle : obstacles) obstacle.radius_m = request_.obstacle_radius_m;
    world_.objects = std::make_shared<const std::vector<ChartObstacle>>(std::move(obstacles));
  }

  void find_objects(PathOutcome& outcome) const {
    const Vector2d start = points_.front().head<2>();
    const auto described = [&](const PrQuadtree::Found& found) {
      const MapObject& object = features_.objects[found.id];
      return ObjectNear{object.kind,    object.name,    object.p_W.head<2>(),
                        object.p_W.z(), found.distance, shapes_of(object.id)};
    };
    if (const auto found = features_.points.nearest(start)) outcome.nearest_object = described(*found);
    if (!request_.objects_within_m) return;
    for (const PrQuadtree::Found& found : features_.points.within(start, *request_.objects_within_m)) {
      outcome.objects.push_back(described(found));
    }
  }

  [[nodiscard]] std::vector<ShapeReference> shapes_of(ObjectId id) const {
    std::vector<ShapeReference> shapes;
    for (const std::string& attribute : store_->attributes(id)) {
      const auto entry = store_->latest(id, attribute);
      if (!entry) continue;
      if (const auto* shape = std::get_if<ShapeReference>(&entry->value)) shapes.push_back(*shape);
    }
    return shapes;
  }

  /// The mission map over the path, with the threats.
  void load_threats(const Path& path) {
    if (request_.threats.empty()) return;
    if (!map_.facts.origin) {
      throw Error("the map has no geographic origin, so no areas can be placed on it", {request_.map.string()});
    }
    const auto areas = read_threat_areas(request_.threats, LocalPlane(*map_.facts.origin));
    const Eigen::AlignedBox2d box = box_round(path, request_.search.margin_m).intersection(box_of(map_.facts.area));
    if (box.isEmpty()) throw Error("the path lies outside the map", {request_.map.string()});
    const PixelGrid cells{depths_->grid().corner_m, depths_->grid().pixel_m * MissionCell::kPixels};
    const Pixel first = cells.at({box.max().x(), box.min().y()}), last = cells.at({box.min().x(), box.max().y()});
    const PixelWindow window{first.column, first.row, last.column - first.column + 1, last.row - first.row + 1};
    if (std::int64_t{window.width} * window.height > MissionMap::kMaxCells) {
      throw Error("the path is too long for a mission map", {request_.map.string()});
    }
    MissionMap mission(*depths_, window);
    for (const ThreatArea& area : areas) {
      mission.add_threat(area.rings, rate_of_probability(area.detection, area.over_m),
                         rate_of_probability(area.destruction, area.over_m));
    }
    threats_ = Threats{areas.size(), risk_of(mission, Threat::kDetection), risk_of(mission, Threat::kDestruction),
                       risk_of(mission, Threat::kAny)};
  }

  /// Sets the way; returns why there is none.
  std::string find_way(PathOutcome& outcome) const {
    if (points_.size() < 2) throw Error("a way needs a start and a goal", {}, "at least two way-points");
    PilotSearchConfig search = request_.search;
    search.passage = passage_;
    Path way{points_.front()};
    for (std::size_t i = 1; i < points_.size(); ++i) {
      const auto leg = search_path(*depths_, at_deepest(points_[i - 1]), at_deepest(points_[i]), search,
                                   world_.all_objects(), threats_ ? &threats_->any : nullptr);
      if (!leg) return fmt::format("leg {}: {}", i, to_text(leg.error()));
      outcome.queries += leg->queries;
      for (std::size_t k = 1; k < leg->points.size(); ++k) {
        way.emplace_back(leg->points[k].x(), leg->points[k].y(), request_.draught_m);
      }
    }
    outcome.way = std::move(way);
    return {};
  }

  void decide(const Path& path, const std::string& no_way, PathOutcome& outcome) const {
    const auto verdict = check_passage(world_, at_deepest(path), passage_);
    if (!verdict) throw Error(std::string("the path cannot be checked: ") + to_text(verdict.error()));
    outcome.verdict = *verdict;
    outcome.reason = verdict->strict() == 1 ? "" : verdict->reason();
    if (!no_way.empty()) outcome.reason = no_way + "; the straight way: " + outcome.reason;
    const auto text = [&](Pixel pixel) { return place_text(outcome.origin, verdict->grid.centre(pixel)); };
    if (!outcome.reason.empty() && verdict->blocking) outcome.reason += text(verdict->blocking->pixel);
    if (!verdict->worst || !verdict->worst->depth_m) return;
    outcome.least =
        fmt::format("least depth on the path: {:.2f} m{}", *verdict->worst->depth_m, text(verdict->worst->pixel));
  }

  /// The blocks say at once how many there can be at most; of these, the pixels decide.
  [[nodiscard]] AbreastOutcome abreast(const Path& path) const {
    const PassageConfig& one = request_.search.passage;
    const auto blocks = vehicles_abreast(*depths_, path, one, request_.formation);
    const auto all = corridor_traversability(*depths_, path, one, request_.formation);
    if (!blocks || !all) throw Error("the path of the formation cannot be checked");
    AbreastOutcome outcome{0, *blocks, all->mixed_share()};
    Formation formation = request_.formation;
    for (int vehicles = blocks->possible; vehicles > 0 && outcome.vehicles == 0; --vehicles) {
      formation.vehicles = vehicles;
      PassageConfig passage = one;
      passage.half_width_m = formation.half_width_m(one.half_width_m);
      const auto verdict = check_passage(world_, at_deepest(path), passage);
      if (verdict && verdict->strict() == 1) outcome.vehicles = vehicles;
    }
    return outcome;
  }

  [[nodiscard]] ThreatOutcome risk_of_path(const Path& path) const {
    const auto flat = [](const Path& points) {
      std::vector<Vector2d> plane;
      for (const Vector3d& p : points) plane.emplace_back(p.head<2>());
      return plane;
    };
    const auto along = flat(path), straight = flat(points_);
    return {threats_->areas, path_risk(threats_->detection, along), path_risk(threats_->destruction, along),
            path_risk(threats_->detection, straight), path_risk(threats_->destruction, straight)};
  }

  [[nodiscard]] Vector3d at_deepest(const Vector3d& p) const {
    const double deeper = request_.formation.vehicles > 1 ? request_.formation.depth_spread_m : 0;
    return {p.x(), p.y(), p.z() + deeper};
  }
  [[nodiscard]] Path at_deepest(Path path) const {
    for (Vector3d& p : path) p = at_deepest(p);
    return path;
  }

  struct Threats {
    std::size_t areas = 0;
    RiskGrid detection, destruction, any;
  };

  const PathRequest& request_;
  StoredMap map_;
  std::shared_ptr<const DepthSnapshot> depths_;
  WorldSnapshot world_;  ///< with the objects near the path
  Path points_;
  PassageConfig passage_;             ///< of the whole formation
  std::optional<ObjectStore> store_;  ///< empty: the map has no objects
  MapFeatures features_;
  std::optional<Threats> threats_;
};

}  // namespace

PathOutcome check_path(const PathRequest& request) { return PathOverMap(request).judge(); }

std::string mission_along(const PathRequest& request, const PathOutcome& outcome) {
  MissionPlan plan;
  plan.title = "way over " + request.map.filename().string();
  plan.origin = outcome.origin;
  for (std::size_t i = request.line.any() ? 0 : 1; i < outcome.way.size(); ++i) {
    MissionPoint& point = plan.points.emplace_back();
    point.north_east = outcome.way[i].head<2>();
    point.depth_m = outcome.way[i].z();
  }
  return write_mission(plan);
}

}  // namespace isobath
