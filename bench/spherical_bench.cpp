// The spherical grid: echoes into it, questions to it, and all of it filled anew after a step of the vehicle. The room,
// the path and the draws are stated here in full.
#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <isobath/base/random.hpp>
#include <isobath/map/spherical/grid_snapshots.hpp>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <isobath/map/spherical/spherical_passage.hpp>
#include <isobath/perception/scan_shapes.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <isobath/perception/tangential_clusters.hpp>
#include <isobath/sim/plane_section.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector3d;

/// From within a box of 40 x 30 x 12 m, along u.
double wall_ahead(const Vector3d& from, const Vector3d& u) {
  const Vector3d half(20, 15, 6);
  double least = 1e9;
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (u[i] != 0) least = std::min(least, (std::copysign(half[i], u[i]) - from[i]) / u[i]);
  }
  return least;
}

Vector3d random_unit(Random& random) {
  const double z = random.uniform(-0.7, 0.7), a = random.uniform(-std::numbers::pi, std::numbers::pi);
  const double level = std::sqrt(1 - z * z);
  return {level * std::cos(a), level * std::sin(a), z};
}

/// So many cells of the box's walls, floor and ceiling, with the masks of their echoes.
void fill_with(SphericalGrid& grid, std::size_t cells) {
  SphericalMapperConfig config;
  SphericalMapper mapper(config, grid);
  Random random(1);
  while (grid.cells().size() < cells) {
    const Vector3d u = random_unit(random);
    mapper.add({Vector3d::Zero(), u, Angle::degrees(2.5), wall_ahead(Vector3d::Zero(), u), 50, Time{}});
  }
}

// ledger: S4-30 S4-D04: `data_rates` says how many times as fast as 60 beams ten times a second echoes are taken in.
void SphericalEchoes(benchmark::State& state) {
  SphericalGridConfig config;
  SphericalGrid grid(config);
  const SphericalGrid nothing(config);
  SphericalMapper mapper({}, grid);
  Random random(2);
  std::vector<SphericalLook> looks(20'000);
  for (SphericalLook& look : looks) {
    const Vector3d u = random_unit(random);
    look = {
        Vector3d::Zero(), u, Angle::degrees(2.5), wall_ahead(Vector3d::Zero(), u) + 0.05 * random.normal(), 50, Time{}};
  }
  for (auto _ : state) {
    grid.copy_from(nothing);
    for (const SphericalLook& look : looks) mapper.add(look);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * looks.size()));
  constexpr double kBeamsASecond = 600;
  state.counters["data_rates"] = benchmark::Counter(static_cast<double>(looks.size()) / kBeamsASecond,
                                                    benchmark::Counter::kIsIterationInvariantRate);
  state.counters["cells"] = static_cast<double>(grid.cells().size());
  state.counters["bytes_a_cell"] = static_cast<double>(grid.cells().bytes()) / static_cast<double>(grid.cells().size());
}
BENCHMARK(SphericalEchoes)->Unit(benchmark::kMillisecond);

/// There and back in steps of half the finest layer, so that the work of each step is like that of the first. Cells
/// that meet merge, and wide ones are split: `cells` says how many there were.
void SphericalStep(benchmark::State& state) {
  SphericalGridConfig config;
  SphericalGrid grid(config);
  fill_with(grid, static_cast<std::size_t>(state.range(0)));
  const double step = config.rebin_at * config.min_layer_m * 1.0001;
  std::int64_t i = 0;
  double cells = 0;
  for (auto _ : state) {
    const double sign = i++ / 20 % 2 == 0 ? 1 : -1;
    grid.translate({sign * step * 0.8, sign * step * 0.6, 0});
    cells += static_cast<double>(grid.cells().size());
  }
  state.counters["cells"] = cells / static_cast<double>(i);
}
BENCHMARK(SphericalStep)->Arg(5'000)->Arg(18'000)->Unit(benchmark::kMicrosecond);

/// The same where the vehicle goes on, 7.5 m, and hears nothing new: everything ahead has to be split.
void SphericalRun(benchmark::State& state) {
  SphericalGridConfig config;
  double cells = 0, steps = 0;
  for (auto _ : state) {
    state.PauseTiming();
    SphericalGrid grid(config);
    fill_with(grid, 14'000);
    state.ResumeTiming();
    for (int i = 0; i < 100; ++i, ++steps) {
      grid.translate({0.0751, 0, 0});
      cells += static_cast<double>(grid.cells().size());
    }
  }
  state.counters["cells"] = cells / steps;
  state.SetItemsProcessed(static_cast<std::int64_t>(steps));
}
BENCHMARK(SphericalRun)->Unit(benchmark::kMillisecond)->Iterations(3);

void SphericalEmptiness(benchmark::State& state) {
  SphericalGrid grid;
  fill_with(grid, static_cast<std::size_t>(state.range(0)));
  Random random(3);
  std::vector<Vector3d> asked(4096);
  for (Vector3d& u : asked) u = random_unit(random);
  std::size_t i = 0, open = 0;
  for (auto _ : state) open += grid.is_empty(asked[i++ % asked.size()]) ? 1 : 0;
  benchmark::DoNotOptimize(open);
}
BENCHMARK(SphericalEmptiness)->Arg(1'000)->Arg(20'000);

void SphericalWayClear(benchmark::State& state) {
  SphericalGrid grid;
  fill_with(grid, static_cast<std::size_t>(state.range(0)));
  Random random(4);
  std::vector<Vector3d> asked(1024);
  for (Vector3d& u : asked) u = random_unit(random);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(way_ahead(grid, asked[i++ % asked.size()], 15, 1));
}
BENCHMARK(SphericalWayClear)->Arg(1'000)->Arg(20'000)->Unit(benchmark::kMicrosecond);

/// 1000 grids made, filled with ten thousand cells, and destroyed (S4-18).
void SphericalLives(benchmark::State& state) {
  Random random(5);
  std::vector<Vector3d> points(10'000);
  for (Vector3d& p : points) p = random.uniform(2, 45) * random_unit(random);
  for (auto _ : state) {
    SphericalGrid grid;
    for (const Vector3d& p : points) grid.add_echo(p, 0.15, Time{});
    benchmark::DoNotOptimize(grid.cells().size());
  }
}
BENCHMARK(SphericalLives)->Unit(benchmark::kMicrosecond);

/// A copy for readers in other threads, with nobody reading (S4-48).
void SphericalSnapshot(benchmark::State& state) {
  SphericalGrid grid;
  fill_with(grid, static_cast<std::size_t>(state.range(0)));
  GridSnapshots snapshots({});
  for (auto _ : state) snapshots.publish(grid, Time{}, Pose{});
}
BENCHMARK(SphericalSnapshot)->Arg(8'000)->Unit(benchmark::kMicrosecond);

/// A turn of 144 beams in a room with a tank and a body, told as lines, arcs and corners (S4-45).
void SphericalShapesOfScan(benchmark::State& state) {
  PlaneSection room;
  const std::vector<Eigen::Vector2d> walls{{-22, -20}, {20, -20}, {20, 22}, {-22, 22}},
      body{{-6, 2}, {0, 4}, {-2, 10}, {-8, 8}};
  for (const auto& outline : {walls, body}) {
    for (std::size_t i = 0; i < 4; ++i) room.add(SectionLine{outline[i], outline[(i + 1) % 4]});
  }
  room.add(SectionArc{{12, -10}, 3, {}, Angle::degrees(360)});
  Random random(6);
  PlaneScan told;
  told.from = {5, -2};
  for (const SectionReading& reading : scan(room, told.from, {}, random)) {
    if (reading.range_m) told.echoes.emplace_back(reading.bearing, *reading.range_m);
  }
  told.sort();
  for (auto _ : state) benchmark::DoNotOptimize(shapes_of(told));
  state.counters["echoes"] = static_cast<double>(told.echoes.size());
}
BENCHMARK(SphericalShapesOfScan)->Unit(benchmark::kMillisecond);

/// Tangent planes of what a box of cells echoes (S4-44).
void SphericalTangentPlanes(benchmark::State& state) {
  SphericalGrid grid;
  fill_with(grid, static_cast<std::size_t>(state.range(0)));
  const std::vector<Vector3d> echoes = echoes_of(grid, 0);
  for (auto _ : state) benchmark::DoNotOptimize(tangential_clusters(echoes));
  state.counters["echoes"] = static_cast<double>(echoes.size());
}
BENCHMARK(SphericalTangentPlanes)->Arg(20'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isobath
