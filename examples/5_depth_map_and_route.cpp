// Surveys a bottom with a multibeam echo sounder, and asks the depth map for a way past its shoals.
#include <cstdio>
#include <isobath/mission/agents/shoal_outlines.hpp>
#include <isobath/onboard/onboard.hpp>
#include <isobath/planning/route_planner.hpp>
#include <isobath/planning/traversability.hpp>
#include <isobath/report/depth_pages.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/world/map_raster.hpp>

using namespace isobath;

/// Five lanes of 40 m over a bottom that is 6 m deep on average.
Scene survey() {
  Scene scene;
  scene.about.duration_s = 120;
  scene.bottom = {.kind = BottomKind::kTerrain, .depth = 6, .relief_m = 1, .wavelength_m = 40, .seed = 3};
  scene.vehicle.speed = 2;
  for (int lane = 0; lane < 5; ++lane) {
    const double begin = lane % 2 == 0 ? 0 : 40, east = 8 * lane;
    scene.waypoints.push_back({.north = begin, .east = east});
    scene.waypoints.push_back({.north = 40 - begin, .east = east});
  }
  scene.sonars = {sonar_preset("multibeam_echo_sounder")};
  scene.sonars[0].beams = 32;
  return scene;
}

int main() {
  OnboardConfiguration configuration;
  configuration.depth_map.pixel_m = 1;
  configuration.depth.mapper.prefilter = false;  // merges readings less than a metre apart: here each counts
  DepthModel depths(configuration);
  Onboard onboard(configuration, depths, {});  // every map that there is a sensor for; no helm
  SimulatedSource boat(survey());
  while (auto event = boat.next()) onboard.on_event(std::move(*event));
  onboard.finish();
  std::vector<std::filesystem::path> files;
  write_depth_files(depths, {.survey = "simulated"}, ".", files);  // depth.tif, chart.png, confidence.png

  const std::shared_ptr<const DepthSnapshot> map = depths.snapshot();
  const double draught = 4;
  const PassageConfig passage{.half_width_m = 1, .clearance_m = 0.5};
  const std::vector<Eigen::Vector3d> straight{{8, 28, draught}, {38, 24, draught}};  // north, east, depth
  const auto first = traversability(*map, straight, passage);
  std::printf("straight: %.0f %% of the corridor is clear; %s\n", 100 * first->fraction, first->reason().c_str());

  std::vector<Hazard> hazards;  // water that is too shallow, or not known
  const ShoalRule shallow{.depth_m = draught + passage.clearance_m, .unknown_blocks = true};
  const ShoalOutlines shoals = shoal_outlines(*map, known_extent(map->trees()), shallow);
  for (const Polygon& shoal : shoals.charted) hazards.push_back({shoal, 0, HazardKind::kCharted});
  for (const Polygon& shoal : shoals.sensed) hazards.push_back({shoal, 0, HazardKind::kMapped});
  const RouteTask task{.start = {8, 28}, .goal = {38, 24}, .half_width_m = passage.half_width_m};
  const auto route = plan_route(HazardMap(hazards), task, {.clearance_m = 0.5, .wished_clearance_m = 2});
  if (!route) return std::printf("no route: %s\n", to_text(route.error())), 1;

  std::vector<Eigen::Vector3d> path;
  for (const Eigen::Vector2d& p : route->points) path.emplace_back(p.x(), p.y(), draught);
  const auto second = traversability(*map, path, passage);
  std::printf("round the shoals: %.0f %% of the corridor is clear, %.1f m long\n", 100 * second->fraction,
              route->length_m);
  for (const auto& p : path) std::printf("  north %.1f, east %.1f m\n", p.x(), p.y());
  return first->strict() == 0 && second->strict() == 1 ? 0 : 1;
}
