// Pings of simulated sonars, with all effects of their presets on: a fan before a bridge, a scanning head over a flat
// bottom; and rays alone.
#include <benchmark/benchmark.h>
#include <isobath/base/random.hpp>
#include <isobath/sim/simulated_sonar.hpp>
#include <memory>
#include <string>
#include <vector>

namespace isobath {
namespace {

struct Site {
  Scene scene;
  World world;
  Water water;
  explicit Site(const std::string& toml) : scene(parse_scene(toml, "bench.toml")), world(scene), water(scene.water) {}
};

// A river of 8 m: its bed, a berm 30 m to starboard, eight pylons of a bridge 45 m ahead, the surface above.
const Site& bridge() {
  static const Site site(R"([scene]
title = "bridge"
[bottom]
kind = "terrain"
depth = 8
relief_m = 0.3
wavelength_m = 25
extent_m = 150
cell_m = 0.5
material = "gravel"
[[wall]]
name = "berm"
line = [[-100, 30], [100, 30]]
top = 0
bottom = 8
batter_deg = -30
material = "rock"
[[pylons]]
name = "bridge"
first = [45, -28]
step = [0, 8]
count = 8
radius = 1
top = -1
bottom = 9
)");
  return site;
}

Pose under_way(double t) { return {Rotation::from_heading_pitch_roll(Angle::degrees(3 * t), {}, {}), {0.1 * t, 0, 3}}; }

/// 512 beams x 500 bins to 60 m, 16 rays a beam. Argument: threads. Items are pings.
void fan_ping(benchmark::State& bench) {
  SonarConfig sonar = sonar_preset("oculus_m1200d");
  sonar.range_m = 60;
  SimulatedSonar device(sonar, bridge().world, bridge().water, 1, static_cast<int>(bench.range(0)));
  std::uint64_t n = 0;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(device.ping(Time{}, under_way(0.1 * static_cast<double>(n % 100)), n));
    ++n;
  }
  bench.SetItemsProcessed(bench.iterations());
}
BENCHMARK(fan_ping)->Arg(1)->Arg(2)->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);

/// The same, echoes alone: without speckle, noise, quantisation and labels of the samples.
void fan_echoes(benchmark::State& bench) {
  SonarConfig sonar = sonar_preset("oculus_m1200d");
  sonar.range_m = 60;
  EchoSynthesizer former(sonar, bridge().world, bridge().water, 1);
  EchoImage image;
  std::uint64_t n = 0;
  for (auto _ : bench) {
    former.form(under_way(0.1 * static_cast<double>(n++ % 100)), image);
    benchmark::DoNotOptimize(image.rough.data());
  }
  bench.SetItemsProcessed(bench.iterations());
}
BENCHMARK(fan_echoes)->Unit(benchmark::kMillisecond);

/// A line of 44 bins of a Micron over a flat bottom with one buoy. Items are lines.
void scanned_line(benchmark::State& bench) {
  static const Site site(R"([scene]
[bottom]
kind = "flat"
depth = 15
[[sphere]]
name = "buoy"
centre = [25, 3, 4]
radius = 0.5
material = "steel"
)");
  SimulatedSonar device(sonar_preset("micron"), site.world, site.water, 1, 1);
  std::uint64_t n = 0;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(device.ping(Time{}, under_way(0), n));
    ++n;
  }
  bench.SetItemsProcessed(bench.iterations());
}
BENCHMARK(scanned_line);

/// Rays in the order of a fan (0) or of no order (1). Items are rays.
void cast(benchmark::State& bench) {
  std::vector<Eigen::Vector3d> rays;
  Random random(1);
  for (int b = 0; b < 512; ++b) {
    for (int i = 0; i < 16; ++i) {
      const double azimuth = bench.range(0) == 0 ? (b - 256) * 0.0044 : random.uniform(-1.1, 1.1);
      const double elevation = bench.range(0) == 0 ? (i - 8) * 0.03 : random.uniform(-0.25, 0.25);
      rays.emplace_back(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                        -std::sin(elevation));
    }
  }
  const World& world = bridge().world;
  for (auto _ : bench) {
    for (const Eigen::Vector3d& u : rays) benchmark::DoNotOptimize(world.cast({0, 0, 3}, u, 80));
  }
  bench.SetItemsProcessed(bench.iterations() * static_cast<std::int64_t>(rays.size()));
}
BENCHMARK(cast)->Arg(0)->Arg(1);

}  // namespace
}  // namespace isobath
