// What a page costs whoever maps: the picture of a fan of 512 x 500, ten of which come a second, and that of the grid
// around the vehicle, twice a second.
#include <benchmark/benchmark.h>
#include <cmath>
#include <isobath/base/random.hpp>
#include <isobath/display/map_display.hpp>
#include <isobath/display/sonar_display.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <tests/support/echoes.hpp>
#include <vector>

namespace isobath {
namespace {

constexpr int kFanBeams = 512, kFanBins = 500, kFanPings = 8;

/// Background all over, and an echo in one bin of fifty.
template <class Sample>
void DisplayOfAFan(benchmark::State& state) {
  const double full = sizeof(Sample) == 1 ? 255 : sizeof(Sample) == 2 ? 65535 : 1;
  const auto fan = test::fan_of(kFanBeams, Angle::degrees(-65), Angle::degrees(130.0 / (kFanBeams - 1)));
  Random random(5);
  EchoDecisions decisions;
  decisions.reset(kFanBeams, kFanBins);
  std::vector<Ping> pings;
  for (int i = 0; i < kFanPings; ++i) {
    const auto value = [&](int beam, int bin) {
      const bool echo = random.uniform() < 0.02;
      if (echo) decisions.set_hit(beam, bin);
      return full * std::min(1.0, 0.02 * std::hypot(random.normal(), random.normal()) + (echo ? 0.5 : 0));
    };
    pings.push_back(test::ping_of<Sample>(fan, {0.1, 0.1, kFanBins}, value, static_cast<float>(full)));
  }
  DisplayState items;
  SonarDisplay display(items);
  std::int64_t shown = 0;
  for (auto _ : state) {
    Ping& ping = pings[static_cast<std::size_t>(shown % kFanPings)];
    ping.time = Time(std::chrono::milliseconds(100 * ++shown));
    display.on_ping({ping, Pose{}, decisions});
  }
  state.counters["KB_a_ping"] = static_cast<double>(items.bytes()) / 1e3;
}
BENCHMARK(DisplayOfAFan<std::uint8_t>)->Unit(benchmark::kMillisecond);
BENCHMARK(DisplayOfAFan<std::uint16_t>)->Unit(benchmark::kMillisecond);
BENCHMARK(DisplayOfAFan<float>)->Unit(benchmark::kMillisecond);

/// A third of the cells heard of, each of them otherwise.
void DisplayOfTheGrid(benchmark::State& state) {
  BodyGridConfig config;
  config.cells_x = config.cells_y = 400;
  BodyGrid grid(config);
  Random random(6);
  for (double& log_odds : grid.log_odds()) {
    if (random.uniform() < 1.0 / 3) log_odds = random.uniform(grid.log_odds_min(), grid.log_odds_max());
  }
  DisplayState items;
  MapDisplay display(items);
  std::int64_t shown = 0;
  for (auto _ : state) display.show(Time(seconds(static_cast<double>(++shown))), grid, Pose{});
  state.counters["KB"] = static_cast<double>(items.bytes()) / 1e3;
}
BENCHMARK(DisplayOfTheGrid)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isobath
