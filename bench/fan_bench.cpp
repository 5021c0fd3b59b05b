// What the decision of a fan's ping costs (docs/imaging-sonar.md: at most 5 ms of one core for 512 beams x 500 bins).
#include <benchmark/benchmark.h>

#include <isobath/sonar/fan_detector.hpp>
#include <tests/support/fan_pings.hpp>

namespace isobath {
namespace {

constexpr double kPingInterval_s = 0.1;

/// Over bottom and surface, with a wall, a pole and points ahead.
test::FanSettings fan_settings(int beams, int bins) {
  test::FanSettings s;
  s.beams = beams;
  s.bins = bins;
  s.sector = 130 * std::numbers::pi / 180;
  s.width = 2 * s.sector / beams;
  s.bin_m = 60.0 / bins;
  s.memory = 0.5;
  s.bottom = {12, 30};
  s.surface = {15, 25};
  s.targets = {{30, 0.1, 80, 0.2}, {22, -0.4, 90, 0}, {41, 0.5, 60, 0}, {50, -0.7, 70, 0.05}};
  return s;
}

void FanDecision(benchmark::State& state) {
  test::FanPings pings(fan_settings(static_cast<int>(state.range(0)), static_cast<int>(state.range(1))));
  std::vector<Ping> recorded;
  for (int i = 0; i < 16; ++i) recorded.push_back(pings.next().ping);
  FanDetector detector;
  EchoDecisions samples;
  FanLooks looks;
  const WaterColumn water{{}, 12, 15};
  int heard = 0;
  for (auto _ : state) {
    Ping& ping = recorded[static_cast<std::size_t>(heard % 16)];
    ping.time = Time{} + seconds(kPingInterval_s * heard++);
    detector.detect(ping, water, samples, looks);
    benchmark::DoNotOptimize(samples);
  }
  state.counters["pings/s"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(FanDecision)->Args({512, 500})->Args({256, 500})->Args({128, 300})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isobath
