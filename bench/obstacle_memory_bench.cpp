// What a sweep costs the memory of obstacles, one core: three hundred obstacles, sweeps of 100 x 100 cells that show
// forty of them again; and the same obstacles all in view and none seen any more, which is the dearest that can be.
#include <benchmark/benchmark.h>
#include <cmath>
#include <isobath/base/random.hpp>
#include <isobath/map/occupancy/obstacle_memory.hpp>
#include <vector>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr CartesianGrid kCells{100, 100, 1};

Polygon rock(const Vector2d& p) {
  return {p + Vector2d(-1, -1), p + Vector2d(1, -1), p + Vector2d(1, 1), p + Vector2d(-1, 1)};
}

struct Sea {
  explicit Sea(double spacing) : free(kCells.size()) {
    for (std::size_t i = 0; i < free.size(); ++i)
      free[i] = (kCells.centre(kCells.cell(i)) - Vector2d(50, 50)).norm() < 38;
    for (int row = 0; row < 15; ++row) {
      for (int column = 0; column < 20; ++column) rocks.emplace_back(spacing * (column - 9.5), spacing * (row - 7));
    }
  }
  // Those within 40 m, as seen from p.
  MemorySweep look(const Vector2d& p, double now, double sigma) {
    seen.clear();
    for (const Vector2d& r : rocks) {
      if ((r - p).norm() > 40) continue;
      Obstacle o;
      o.outline = rock(r - p);
      o.nearest = o.centre = r - p;
      o.covariance.setZero();
      o.existence = 0.95;
      seen.push_back(o);
    }
    return {Time(seconds(now)), {{}, {p.x(), p.y(), 0}}, sigma, seen, {kCells, {50, 50}, {}, free}};
  }
  std::vector<Vector2d> rocks;
  std::vector<Obstacle> seen;
  std::vector<std::uint8_t> free;
};

void ObstacleMemorySweep(benchmark::State& state) {
  Sea sea(11);
  ObstacleMemory memory;
  constexpr int kWay = 3000;
  std::vector<std::vector<Obstacle>> seen;
  std::vector<MemorySweep> sweeps;
  for (int i = 0; i < kWay; ++i) {
    const double along = 200.0 * i / kWay - 100, across = 80 * std::sin(0.02 * i);
    sweeps.push_back(sea.look({along, across}, 0, 0.0));
    seen.push_back(sea.seen);
  }
  double now = 0, sigma = 0;
  std::size_t i = 0;
  const auto step = [&] {
    const std::size_t back = i++ / kWay % 2 == 0 ? i % kWay : kWay - 1 - i % kWay;
    sweeps[back].obstacles = seen[back];
    sweeps[back].time = Time(seconds(now += 0.1));
    sweeps[back].sigma_m = sigma = std::min(2.0, sigma + 1e-4);
    benchmark::DoNotOptimize(memory.add(sweeps[back]));
  };
  for (int n = 0; n < 2 * kWay; ++n) step();
  for (auto _ : state) {
    step();
    benchmark::DoNotOptimize(memory.known({0, 0}, 60));
  }
  state.counters["obstacles"] = static_cast<double>(memory.size());
}
BENCHMARK(ObstacleMemorySweep)->Unit(benchmark::kMicrosecond);

void ObstacleMemoryAllMissing(benchmark::State& state) {
  Sea sea(2.5);
  ObstacleMemoryConfig config;
  config.miss = 0.99;
  config.min_existence = 0;
  ObstacleMemory memory(config);
  for (int i = 0; i < 20; ++i) memory.add(sea.look({0, 0}, i, 0));
  double now = 20;
  for (auto _ : state) {
    MemorySweep sweep = sea.look({0, 0}, now, 2);
    sweep.obstacles = {};
    benchmark::DoNotOptimize(memory.add(sweep));
    now += 1e-3;
  }
  state.counters["obstacles"] = static_cast<double>(memory.size());
}
BENCHMARK(ObstacleMemoryAllMissing)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isobath
