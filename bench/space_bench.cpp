// Ways in three dimensions: what the planner is given, and a plan through 100 x 100 x 20 m (ledger S5-36).
#include <algorithm>
#include <benchmark/benchmark.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/space_route.hpp>
#include <isobath/planning/world_snapshot.hpp>

namespace isobath {
namespace {

/// A river of 100 x 100 x 20 m that was measured, voxels of 0.5 m: 30 columns stand in it, and three walls across, each
/// with one gap, which the plan view takes for closed.
struct MeasuredRiver {
  MeasuredRiver() : map({.voxel_m = 0.5, .prior = 0.05, .occupied = 0.7, .free = 0.04, .max_log_odds = 6.9}) {
    VoxelBlocks &vertical = map.layer("upright"), &flat = map.layer("flat");
    put(vertical, {0, -100, 0}, {200, 100, 40}, -3);
    put(flat, {0, -100, 0}, {200, 100, 40}, -1);
    Random random(4);
    for (int i = 0; i < 30; ++i) {
      const int north = 10 + static_cast<int>(random.index(180));
      const int east = static_cast<int>(random.index(190)) - 95;
      put(vertical, {north, east, 0}, {north + 3, east + 3, 40}, 13);
    }
    for (int wall = 0; wall < 3; ++wall) {
      const int north = 50 + 50 * wall, gap = static_cast<int>(random.index(160)) - 80;
      put(vertical, {north, -100, 0}, {north + 2, gap, 40}, 13);
      put(vertical, {north, gap + 12, 0}, {north + 2, 100, 40}, 13);
      put(vertical, {north, gap, 14}, {north + 2, gap + 12, 40}, 13);
      hazards.push_back({{{0.5 * north, -50}, {0.5 * north + 1, -50}, {0.5 * north + 1, 50}, {0.5 * north, 50}},
                         0,
                         HazardKind::kSeen,
                         0});
    }
    task.start = {2, 0, 8};
    task.goal = {98, 0, 8};
    task.half_width_m = 0.15;
    task.hazards = hazards;
    config.reach_m = 100;
    config.margin_m = 50;
  }
  static void put(VoxelBlocks& layer, const VoxelIndex& from, const VoxelIndex& to, double log_odds) {
    for (int x = from.x(); x < to.x(); ++x) {
      for (int y = from.y(); y < to.y(); ++y) {
        for (int z = from.z(); z < to.z(); ++z) layer.add({x, y, z}, to_evidence(log_odds));
      }
    }
  }

  VoxelMap map;
  std::vector<Hazard> hazards;
  SpaceRouteTask task;
  SpaceRouteConfig config;
  std::vector<std::string> heights = {"upright"};
};

void SpaceOfAScan(benchmark::State& bench) {
  const MeasuredRiver river;
  double voxels = 0;
  for (auto _ : bench) {
    const OccupancySnapshot grid(river.map, river.heights, {50, 0, 5}, 80);
    voxels = grid.size().cast<double>().prod();
    benchmark::DoNotOptimize(grid);
  }
  bench.counters["voxels"] = voxels;
}
BENCHMARK(SpaceOfAScan)->Unit(benchmark::kMillisecond);

void SpaceRoute(benchmark::State& bench) {
  MeasuredRiver river;
  const OccupancySnapshot grid(river.map, river.heights, {50, 0, 5}, 80);
  river.task.turning_radius_m = static_cast<double>(bench.range(0));
  if (bench.range(0) > 0) river.task.heading = Angle::degrees(20);
  Result<SpaceRoutePath, RouteRefusal> path = tl::unexpected(RouteRefusal::kNoPath);
  for (auto _ : bench) path = plan_space_route(grid, river.task, river.config);
  bench.counters["found"] = path.has_value();
  bench.counters["length_m"] = path ? path->length_m : 0;
  bench.counters["expanded"] = path ? path->expanded : 0;
}
BENCHMARK(SpaceRoute)->ArgName("radius")->Arg(0)->Arg(4)->Unit(benchmark::kMillisecond);

void SpaceKept(benchmark::State& bench) {
  const MeasuredRiver river;
  const OccupancySnapshot grid(river.map, river.heights, {50, 0, 5}, 80);
  const std::vector<Eigen::Vector3d> way = plan_space_route(grid, river.task, river.config)->points;
  bool clear = false;
  for (auto _ : bench) clear = is_clear(room_for(grid, river.task, river.config, true), way, 1);
  bench.counters["clear"] = clear;
}
BENCHMARK(SpaceKept)->Unit(benchmark::kMillisecond);

/// The voxels of a scan as a depth field, for a vehicle with a metre of water above and below it.
void WorldFieldMade(benchmark::State& bench) {
  const MeasuredRiver river;
  const WorldSnapshot world{
      .voxels = std::make_shared<const OccupancySnapshot>(river.map, river.heights, Eigen::Vector3d(50, 0, 5), 80)};
  for (auto _ : bench) benchmark::DoNotOptimize(WorldField(world, {7, 9}).has_solid());
  bench.counters["columns"] = world.voxels->size().head<2>().cast<double>().prod();
}
BENCHMARK(WorldFieldMade)->Unit(benchmark::kMicrosecond);

/// 200 x 200 pixels of half a metre.
void WorldFieldRead(benchmark::State& bench) {
  const MeasuredRiver river;
  const WorldSnapshot world{
      .voxels = std::make_shared<const OccupancySnapshot>(river.map, river.heights, Eigen::Vector3d(50, 0, 5), 80)};
  const WorldField field(world, {7, 9});
  const PixelWindow window{-100, -200, 200, 200};
  std::vector<DepthPixel> pixels(200UL * 200);
  for (auto _ : bench) {
    field.read(window, pixels);
    benchmark::DoNotOptimize(pixels.data());
  }
  bench.counters["known"] =
      static_cast<double>(std::count_if(pixels.begin(), pixels.end(), [](const DepthPixel& p) { return p.known(); }));
}
BENCHMARK(WorldFieldRead)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isobath
