// Builds the voxel map, occupied, free or unknown water in three dimensions, from a horizontal and a vertical fan.
//
// The scene: a wall that rises from the bottom, 6 m high in 9 m of water, ahead of a vehicle with two P450 staves.
#include <cstdio>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/world/voxel_model.hpp>

using namespace isobath;

/// Gets the pings of the pipeline, each with its pose and its echo decisions.
class Voxels : public ResultSink {
 public:
  explicit Voxels(const VoxelModelConfig& config) : model(config) {}
  void on_ping(const PosedPing& ping) override { model.update(ping); }
  void on_vertical_ping(const PosedPing& ping) override { model.update(ping); }
  void on_scan(const ScanResult&) override {}
  VoxelModel model;
};

Scene scene_with_a_wall() {
  Scene scene;
  scene.about.duration_s = 16;
  scene.bottom = {.kind = BottomKind::kFlat, .depth = 9};
  scene.vehicle = {.start = {0, 0, 3}, .speed = 1};
  scene.waypoints = {{.north = 40, .east = 0, .depth = 3}};
  scene.bodies = {{.name = "wall", .shape = Box{.centre = {30, 0, 6}, .size = {1, 30, 6}}}};
  scene.sonars = {sonar_preset("p450_horizontal"), sonar_preset("p450_vertical")};
  for (SonarConfig& sonar : scene.sonars) sonar.range_m = 40, sonar.bins = 400;
  return scene;
}

int main() {
  SimulatedSource vehicle(scene_with_a_wall());
  VoxelModelConfig config;
  config.fans.shadow_bins = 1;  // the echo of a wall across the beam fills one bin, and hides what is behind
  Voxels voxels(config);
  Pipeline pipeline(OnboardConfiguration{}, voxels);
  while (auto event = vehicle.next()) pipeline.on_event(std::move(*event));
  pipeline.finish();

  const VoxelMap& map = *voxels.model.map();
  const auto space_at = [&map](double north, double east, double depth) {
    return map.space(map.voxel_at({north, east, depth}));
  };
  std::printf("%zu layers of evidence, voxels of %.2f m; a slice ahead: # occupied, . free, blank unknown\n",
              map.sensors().size(), map.voxel_m());
  for (double depth = 0.25; depth < 10; depth += 0.5) {
    std::printf("%4.1f m |", depth);
    for (double north = 15; north < 40; north += 0.5) std::putchar(" .#"[static_cast<int>(space_at(north, 0, depth))]);
    std::printf("|\n");
  }
  if (space_at(29.6, 0, 4) != Space::kOccupied && space_at(29.9, 0, 4) != Space::kOccupied)
    return std::printf("the wall is not in the map\n"), 1;
  if (space_at(22, 0, 3) != Space::kFree) return std::printf("the water before the wall is not free\n"), 1;
  if (space_at(33, 0, 6) != Space::kUnknown) return std::printf("no sonar has seen behind the wall\n"), 1;
  return 0;
}
