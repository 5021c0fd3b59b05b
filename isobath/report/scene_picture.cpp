#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/report/plot/picture.hpp>
#include <isobath/report/scene_picture.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr int kPixels = 640;
constexpr int kDepths = 200;  // depth samples along each side

std::size_t at(int row, int column) {
  return static_cast<std::size_t>(row) * kDepths + static_cast<std::size_t>(column);
}

PlanExtent around(const Simulator& simulator, std::span<const Vector2d> track) {
  Eigen::AlignedBox2d box;
  const Scene& scene = simulator.scene();
  const Vector2d start = scene.vehicle.start.head<2>();
  box.extend(Vector2d(start.array() - 5)).extend(Vector2d(start.array() + 5));
  for (const Vector2d& p : track) box.extend(p);
  for (const WaypointConfig& w : scene.waypoints) box.extend(Vector2d(w.north, w.east));
  for (const WorldBody& b : simulator.world().bodies()) {
    for (const Polygon& part : b.plan) {
      for (const Vector2d& p : part) box.extend(p);
    }
    for (std::size_t i = 0; i + 3 < b.body->path.size(); i += 4)
      box.extend(Vector2d(b.body->path[i + 1], b.body->path[i + 2]));
  }
  return frame_around(box);
}

/// Deep water is dark, shallow water light.
Colour bottom_colour(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  return {0.91 - 0.62 * s, 0.95 - 0.47 * s, 0.98 - 0.28 * s, 1};
}

/// The sector that a sonar covers at the start, out to its range.
Polygon field_of_view(const SonarConfig& sonar, const Pose& X_WB) {
  const Pose X_WS = X_WB * sensor_pose(sonar);
  Polygon points{X_WS.translation.head<2>()};
  const double half = sonar.kind == SonarKind::kRanges && sonar.beams == 1
                          ? 0.5 * sonar.width.radians()
                          : std::max(0.5 * sonar.sector.radians(), 0.5 * sonar.width.radians());
  for (int i = -16; i <= 16; ++i) {
    const double a = half * i / 16;
    points.push_back((X_WS * (sonar.range_m * Eigen::Vector3d(std::cos(a), std::sin(a), 0))).head<2>());
  }
  return points;
}

}  // namespace

std::string scene_picture(const Simulator& simulator, std::span<const Vector2d> track) {
  const Scene& scene = simulator.scene();
  const PlanExtent extent = around(simulator, track);
  PlanPicture picture(extent, kPixels, {scene.about.title, "north (m)", "east (m)"});
  const double cell_x = (extent.x_max - extent.x_min) / kDepths, cell_y = (extent.y_max - extent.y_min) / kDepths;
  std::vector<double> depths(at(kDepths, 0), std::nan(""));
  double shallow = 1e9, deep = -1e9;
  for (int i = 0; i < kDepths; ++i) {
    for (int j = 0; j < kDepths; ++j) {
      const auto depth =
          simulator.world().bottom_depth(extent.x_min + (i + 0.5) * cell_x, extent.y_min + (j + 0.5) * cell_y);
      if (!depth) continue;
      depths[at(i, j)] = *depth;
      shallow = std::min(shallow, *depth);
      deep = std::max(deep, *depth);
    }
  }
  picture.raster([&](double x, double y) {
    const int i = std::clamp(static_cast<int>((x - extent.x_min) / cell_x), 0, kDepths - 1);
    const int j = std::clamp(static_cast<int>((y - extent.y_min) / cell_y), 0, kDepths - 1);
    const double depth = depths[at(i, j)];
    if (std::isnan(depth)) return Colour{0.96, 0.96, 0.96, 1};
    return bottom_colour(deep - shallow < 0.01 ? 0.5 : (depth - shallow) / (deep - shallow));
  });
  const Pose X_WB{Rotation::from_heading(scene.vehicle.heading), scene.vehicle.start};
  for (const SonarConfig& sonar : scene.sonars) {
    const bool level = std::abs(sonar.pitch.degrees()) < 60 && std::abs(sonar.roll.degrees()) < 60;
    if (level) picture.polygon(field_of_view(sonar, X_WB), {{0.8, 0.5, 0.1, 0.8}, 1, true}, {0.9, 0.6, 0.1, 0.08});
  }
  for (const WorldBody& body : simulator.world().bodies()) {
    for (const Polygon& part : body.plan) picture.polygon(part, {palette::kInk, 1.5, false}, {0.3, 0.25, 0.2, 0.6});
    std::vector<Vector2d> way;
    for (std::size_t i = 0; i + 3 < body.body->path.size(); i += 4)
      way.emplace_back(body.body->path[i + 1], body.body->path[i + 2]);
    if (way.size() > 1) picture.polyline(way, {palette::kObstacle, 1.2, true});
  }
  std::vector<Vector2d> legs{scene.vehicle.start.head<2>()};
  for (const WaypointConfig& w : scene.waypoints) legs.emplace_back(w.north, w.east);
  if (legs.size() > 1) picture.polyline(legs, {palette::kFaint, 1, true});
  for (std::size_t i = 1; i < legs.size(); ++i) picture.dot(legs[i], 2.5, palette::kInk);
  if (track.size() > 1) picture.polyline(track, {palette::kTrack, 2, false});
  picture.vehicle(legs[0], scene.vehicle.heading.radians());
  std::vector<PlanPicture::LegendEntry> legend;
  if (deep >= shallow) {
    legend.push_back({bottom_colour(0), fmt::format("{:.1f} m deep", shallow)});
    if (deep - shallow > 0.01) legend.push_back({bottom_colour(1), fmt::format("{:.1f} m", deep)});
  }
  legend.push_back({palette::kInk, "bodies"});
  if (track.size() > 1) legend.push_back({palette::kTrack, "track"});
  legend.push_back({{0.9, 0.6, 0.1, 1}, "sonar field of view at the start"});
  picture.finish(legend);
  return picture.png();
}

}  // namespace isobath
