#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/studies/check_path.hpp>
#include <isobath/world/map_features.hpp>
#include <isobath/world/map_raster.hpp>

namespace isobath {
namespace {

constexpr double kFarthest = 9e5;  // m, on the globe and on the plane: the radius of a local plane

/// " (41.79300, -82.68881)"; empty if the map has no geographic origin.
std::string place_of(const MapFacts& facts, Pixel pixel) {
  if (!facts.origin) return {};
  const GeoPoint p = LocalPlane(*facts.origin).to_geo(facts.area.grid.centre(pixel));
  return fmt::format(" ({:.6f}, {:.6f})", p.latitude_deg, p.longitude_deg);
}

void refuse_far(const GeoPoint& point, const GeoOrigin& origin, const std::filesystem::path& map) {
  const double apart = distance_m(point, origin);
  if (apart < kFarthest) return;
  throw Error(
      fmt::format("the way-point {:.4f}, {:.4f} lies {:.0f} km from the map, which is at {:.4f}, {:.4f}",
                  point.latitude_deg, point.longitude_deg, apart / 1000, origin.latitude_deg, origin.longitude_deg),
      {map.string()});
}

}  // namespace

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
    for (const Eigen::Vector3d& p : path) window.extend(Eigen::Vector2d(p.head<2>()));
    obstacles = obstacles_near(load_features(ObjectStore(objects), map.facts.area), window,
                               request.obstacle_radius_m + request.passage.half_width_m);
    for (ChartObstacle& obstacle : obstacles) obstacle.radius_m = request.obstacle_radius_m;
  }
  const auto verdict = traversability(*snapshot_of(map), path, request.passage, obstacles);
  if (!verdict) throw Error(std::string("the path cannot be checked: ") + to_text(verdict.error()));
  PathOutcome outcome{*verdict, verdict->strict() == 1 ? "" : verdict->reason(), {}, map.facts.origin, 0};
  if (!outcome.reason.empty() && verdict->blocking) outcome.reason += place_of(map.facts, verdict->blocking->pixel);
  if (verdict->worst && verdict->worst->depth_m) {
    outcome.least = fmt::format("least depth on the path: {:.2f} m{}", *verdict->worst->depth_m,
                                place_of(map.facts, verdict->worst->pixel));
  }
  for (std::size_t i = 1; i < path.size(); ++i) outcome.length_m += (path[i] - path[i - 1]).norm();
  return outcome;
}

}  // namespace isobath
