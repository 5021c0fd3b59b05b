#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/mission/plan/mission_file.hpp>
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

PathOutcome check_path(const PathRequest& request) {
  const StoredMap map = open_map(request.map);
  std::vector<Eigen::Vector3d> path;
  if (!request.points.empty()) {
    if (!map.facts.origin) {
      throw Error("the map has no geographic origin", {request.map.string()}, {},
                  "give the path in metres north and east");
    }
    const LocalPlane plane(*map.facts.origin);
    for (const GeoPoint& point : request.points) {
      refuse_far(point, *map.facts.origin, request.map);
      const Eigen::Vector2d p = plane.to_plane(point);
      path.emplace_back(p.x(), p.y(), request.draught_m);
    }
  }
  for (const Eigen::Vector2d& p : request.local_m) {
    if (!(p.norm() < kFarthest)) throw Error("a way-point lies more than 900 km from the map", {request.map.string()});
    path.emplace_back(p.x(), p.y(), request.draught_m);
  }
  std::vector<ChartObstacle> obstacles;
  const std::filesystem::path objects = request.map / "objects.sqlite";
  if (std::filesystem::exists(objects)) {
    Eigen::AlignedBox2d window;
    const double aside = request.find ? request.search.margin_m : 0;
    for (const Eigen::Vector3d& p : path) {
      window.extend(Eigen::Vector2d(p.head<2>() - Eigen::Vector2d::Constant(aside)));
      window.extend(Eigen::Vector2d(p.head<2>() + Eigen::Vector2d::Constant(aside)));
    }
    obstacles = obstacles_near(load_features(ObjectStore(objects), map.facts.area), window,
                               request.obstacle_radius_m + request.search.passage.half_width_m);
    for (ChartObstacle& obstacle : obstacles) obstacle.radius_m = request.obstacle_radius_m;
  }
  PathOutcome outcome;
  outcome.origin = map.facts.origin;
  const auto field = snapshot_of(map);
  std::string no_way;
  if (request.find) {
    if (path.size() < 2) throw Error("a way needs a start and a goal", {}, "at least two way-points");
    std::vector<Eigen::Vector3d> way{path.front()};
    for (std::size_t i = 1; i < path.size() && no_way.empty(); ++i) {
      const auto leg = search_path(*field, path[i - 1], path[i], request.search, obstacles);
      if (!leg) {
        no_way = fmt::format("leg {}: {}", i, to_text(leg.error()));
        continue;
      }
      outcome.queries += leg->queries;
      way.insert(way.end(), leg->points.begin() + 1, leg->points.end());
    }
    if (no_way.empty()) {
      path = std::move(way);
      for (const Eigen::Vector3d& p : path) outcome.way.emplace_back(p.head<2>());
    }
  }
  const auto verdict = traversability(*field, path, request.search.passage, obstacles);
  if (!verdict) throw Error(std::string("the path cannot be checked: ") + to_text(verdict.error()));
  outcome.verdict = *verdict;
  outcome.reason = verdict->strict() == 1 ? "" : verdict->reason();
  if (!no_way.empty()) outcome.reason = no_way + "; the straight way: " + outcome.reason;
  const auto text = [&](Pixel pixel) { return place_text(outcome.origin, verdict->grid.centre(pixel)); };
  if (!outcome.reason.empty() && verdict->blocking) outcome.reason += text(verdict->blocking->pixel);
  if (verdict->worst && verdict->worst->depth_m) {
    outcome.least =
        fmt::format("least depth on the path: {:.2f} m{}", *verdict->worst->depth_m, text(verdict->worst->pixel));
  }
  for (std::size_t i = 1; i < path.size(); ++i) outcome.length_m += (path[i] - path[i - 1]).norm();
  return outcome;
}

std::string mission_along(const PathRequest& request, const PathOutcome& outcome) {
  MissionPlan plan;
  plan.title = "way over " + request.map.filename().string();
  plan.origin = outcome.origin;
  for (std::size_t i = 1; i < outcome.way.size(); ++i) {
    MissionPoint& point = plan.points.emplace_back();
    point.north_east = outcome.way[i];
    point.depth_m = request.draught_m;
  }
  return write_mission(plan);
}

}  // namespace isobath
