// Workload D: one fan of 512 beams x 500 bins (130 degrees, 50 m) into 400 x 400 cells of 0.25 m, in bins a second;
// beside a plain log-odds scatter of the same fan, one cell a bin by its centre. And a scanning sonar's ping (S6-31).
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdint>
#include <isobath/base/random.hpp>
#include <isobath/perception/grid_mapper.hpp>
#include <vector>

namespace isobath {
namespace {

constexpr int kBeams = 512;
constexpr int kBins = 500;
constexpr double kBin = 0.1;
constexpr double kSpread = 130;
constexpr std::uint8_t kThreshold = 200;

BodyGridConfig plane() {
  BodyGridConfig c;
  c.cell_m = 0.25;
  c.cells_x = c.cells_y = 400;
  return c;
}

std::shared_ptr<const BeamFan> fan_of(int beams, double spread_deg, double width_deg) {
  auto fan = std::make_shared<BeamFan>();
  for (int b = 0; b < beams; ++b) {
    const double share = beams > 1 ? b / (beams - 1.0) - 0.5 : 0;
    fan->azimuth.push_back(Angle::degrees(spread_deg * share));
    fan->width.push_back(Angle::degrees(width_deg));
  }
  fan->height = Angle::degrees(15);
  return fan;
}

// Intensities of ping i: the wave-shaped wall of workload B, and one false alarm in fifty bins.
std::vector<std::uint8_t> wall(int ping, int beams, int bins) {
  std::vector<std::uint8_t> image(static_cast<std::size_t>(beams) * bins);
  Random random(static_cast<std::uint64_t>(ping) + 1);
  for (int b = 0; b < beams; ++b) {
    const int first = static_cast<int>((20 + 15 * std::sin(0.05 * b + 0.1 * ping)) / kBin);
    for (int k = 0; k < bins; ++k) {
      const bool echo = (k >= first && k < first + 10) || random.uniform() < 0.02;
      image[static_cast<std::size_t>(b) * bins + k] = static_cast<std::uint8_t>(echo ? 220 : 100);
    }
  }
  return image;
}

// The threshold decisions of one ping, S = 1 at or above.
void decide(const std::vector<std::uint8_t>& image, EchoDecisions& decisions) {
  for (int b = 0; b < decisions.beams(); ++b) {
    const std::uint8_t* row = image.data() + static_cast<std::size_t>(b) * decisions.bins();
    std::uint64_t* hits = decisions.hits(b);
    for (int w = 0; w < decisions.words(); ++w) {
      const int n = std::min(64, decisions.bins() - 64 * w);
      std::uint64_t word = 0;
      for (int i = 0; i < n; ++i) word |= static_cast<std::uint64_t>(row[64 * w + i] >= kThreshold) << i;
      hits[w] = word;
    }
  }
}

struct Workload {
  explicit Workload(int beams = kBeams, int bins = kBins, double spread = kSpread,
                    double width = kSpread / (kBeams - 1), double bin_m = kBin) {
    ping.fan = fan_of(beams, spread, width);
    ping.window = {0, bin_m, bins};
    for (int i = 0; i < 8; ++i) images.push_back(wall(i, beams, bins));
    decisions.reset(beams, bins);
    decisions.p_detect.assign(static_cast<std::size_t>(bins), 0.8f);
  }
  Ping ping;
  EchoDecisions decisions;
  std::vector<std::vector<std::uint8_t>> images;
};

Pose at(double x, double y, double heading_deg) {
  return {Rotation::from_heading(Angle::degrees(heading_deg)), {x, y, 0}};
}

void count(benchmark::State& state, const Workload& w) {
  state.SetItemsProcessed(state.iterations() * w.decisions.beams() * w.decisions.bins());
}

void BodyGridPlainScatter(benchmark::State& state) {
  const Workload w;
  std::vector<double> grid(400 * 400, -4.6);
  std::vector<Eigen::Vector2f> direction;
  for (Angle a : w.ping.fan->azimuth) direction.emplace_back(std::cos(a.radians()), std::sin(a.radians()));
  std::size_t i = 0;
  for (auto _ : state) {
    const auto& image = w.images[i++ % w.images.size()];
    for (int b = 0; b < kBeams; ++b) {
      for (int k = 0; k < kBins; ++k) {
        const float r = static_cast<float>((k + 0.5) * kBin / 0.25);
        const auto x = static_cast<std::size_t>(200 + r * direction[b].x());
        const auto y = static_cast<std::size_t>(200 + r * direction[b].y());
        double& l = grid[x * 400 + y];
        l = std::clamp(
            l + (image[static_cast<std::size_t>(b) * kBins + static_cast<std::size_t>(k)] >= kThreshold ? 0.5 : -0.1),
            -9.2, 9.2);
      }
    }
    benchmark::ClobberMemory();
  }
  count(state, w);
}
BENCHMARK(BodyGridPlainScatter)->Unit(benchmark::kMillisecond);

void BodyGridStatic(benchmark::State& state) {
  Workload w;
  GridMapper mapper(plane(), {});
  std::size_t i = 0;
  mapper.update(w.ping, w.decisions, {});
  for (auto _ : state) {
    decide(w.images[i++ % w.images.size()], w.decisions);
    mapper.update(w.ping, w.decisions, {});
  }
  count(state, w);
}
BENCHMARK(BodyGridStatic)->Unit(benchmark::kMillisecond);

// 1.5 m/s and 5 degrees a second at ten pings a second, back and forth. Arguments: table in MB, pings before the clock
// starts.
void BodyGridMoving(benchmark::State& state) {
  Workload w;
  GridMapperConfig config;
  config.table.table_mb = static_cast<int>(state.range(0));
  GridMapper mapper(plane(), config);
  double heading = 0;
  double x = 0;
  double y = 0;
  std::size_t i = 0;
  const auto step = [&] {
    heading += i / 300 % 2 == 0 ? 0.5 : -0.5;
    x += 0.15 * std::cos(heading * std::numbers::pi / 180);
    y += 0.15 * std::sin(heading * std::numbers::pi / 180);
    decide(w.images[i++ % w.images.size()], w.decisions);
    mapper.update(w.ping, w.decisions, at(x, y, heading));
  };
  for (int n = 0; n < state.range(1); ++n) step();
  const std::uint64_t built = mapper.table().rows_built();
  for (auto _ : state) step();
  count(state, w);
  state.counters["rows_built_share"] =
      double(mapper.table().rows_built() - built) / (double(state.iterations()) * kBeams);
}
BENCHMARK(BodyGridMoving)->Args({64, 0})->Args({64, 1000})->Args({256, 1000})->Unit(benchmark::kMillisecond);

// A scanning sonar of 44 bins to 50 m, 3.5 degrees wide, stepping 1.8 degrees, into 100 x 100 cells of 1 m; moving.
void BodyGridScanningPing(benchmark::State& state) {
  Workload w(1, 44, 0, 3.5, 50.0 / 44);
  GridMapper mapper({}, {});
  std::size_t i = 0;
  const auto step = [&] {
    w.ping.X_BS.rotation = Rotation::from_heading(Angle::degrees(1.8 * static_cast<double>(i)));
    decide(w.images[i % w.images.size()], w.decisions);
    mapper.update(w.ping, w.decisions, at(0.05 * static_cast<double>(i), 0, 0));
    ++i;
  };
  for (int n = 0; n < 2000; ++n) step();
  for (auto _ : state) step();
  count(state, w);
}
BENCHMARK(BodyGridScanningPing)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isobath
