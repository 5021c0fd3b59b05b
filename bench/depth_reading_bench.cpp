// What one reading costs (ledger S1-71): time against range and pixels, and the affine law through it. The paper's two
// points, 30 ms at 10 m and 100 ms at 50 m on a Sun-3, fit 26.6 ms and 0.135 ms a pixel.
#include <benchmark/benchmark.h>
#include <ctime>
#include <isobath/perception/reading_evidence.hpp>
#include <vector>

namespace isobath {
namespace {

RangeReading ahead(double range_m, double width_deg = 6, double depression_deg = 0) {
  RangeReading r;
  r.range_m = range_m;
  r.max_range_m = 60;
  r.width = Angle::degrees(width_deg);
  r.X_BS.rotation = Rotation::from_heading_pitch_roll({}, Angle::degrees(-depression_deg), {});
  return r;
}

/// A vehicle that turns a little from reading to reading.
std::vector<Pose> poses() {
  std::vector<Pose> out;
  for (int i = 0; i < 64; ++i) {
    out.push_back({Rotation::from_heading_pitch_roll(Angle::degrees(5.625 * i), Angle::degrees(1), Angle::degrees(-2)),
                   {0.37 * i, -0.23 * i, 8}});
  }
  return out;
}

void measure(benchmark::State& state, const RangeReading& reading, ReadingEvidenceConfig config = {}) {
  config.range_cap_m = 60;
  ReadingEvidence evidence(config, {});
  const std::vector<Pose> at = poses();
  std::size_t i = 0;
  std::size_t pixels = 0;
  for (auto _ : state) {
    const Evidence e = evidence.add_reading(reading, at[i++ % at.size()]);
    pixels += e.pixels.size();
    benchmark::DoNotOptimize(e.pixels.data());
    benchmark::ClobberMemory();
  }
  const auto n = static_cast<double>(state.iterations());
  state.counters["pixels"] = static_cast<double>(pixels) / n;
  state.SetItemsProcessed(static_cast<std::int64_t>(pixels));
}

void ObstacleReading(benchmark::State& state) { measure(state, ahead(static_cast<double>(state.range(0)))); }
BENCHMARK(ObstacleReading)->Arg(10)->Arg(20)->Arg(30)->Arg(40)->Arg(50);

void ObstacleReadingPlanes(benchmark::State& state) {
  ReadingEvidenceConfig config;
  config.geometry = ReadingEvidenceConfig::Geometry::kPlanes;
  measure(state, ahead(50), config);
}
BENCHMARK(ObstacleReadingPlanes);

void ObstacleReadingTouched(benchmark::State& state) {
  ReadingEvidenceConfig config;
  config.coverage = ReadingEvidenceConfig::Coverage::kTouched;
  measure(state, ahead(50), config);
}
BENCHMARK(ObstacleReadingTouched);

// A cone about the vertical takes the way of one column at a time.
void ObstacleReadingColumns(benchmark::State& state) { measure(state, ahead(20, 100, 44)); }
BENCHMARK(ObstacleReadingColumns);

void DepthReading(benchmark::State& state) {
  ReadingEvidenceConfig config;
  config.footprint = static_cast<ReadingEvidenceConfig::Footprint>(state.range(1));
  measure(state, ahead(static_cast<double>(state.range(0)), 6, 90), config);
}
BENCHMARK(DepthReading)->Args({10, 0})->Args({50, 0})->Args({50, 1})->Args({50, 2});

void Sounding(benchmark::State& state) {
  ReadingEvidence evidence({}, {});
  double north = 0;
  for (auto _ : state) {
    north += 0.01;
    const Evidence e = evidence.add_sounding({north, 3, 20}, {0, 0.5, 0.866}, 23, Angle::degrees(0.5), 0.05);
    benchmark::DoNotOptimize(e.pixels.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(Sounding);

void Prediction(benchmark::State& state) {
  const PixelGrid grid;
  RangePredictor predictor({}, grid);
  const Pose X_WB{Rotation::from_heading(Angle::degrees(33)), {0, 0, 5}};
  const BeamCone cone(ahead(50), X_WB);
  const PixelWindow window = predictor.window(cone, 50);
  const std::vector<float> depth(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height),
                                 static_cast<float>(state.range(0)));
  for (auto _ : state) {
    predictor.pixels(cone, 50, window);
    RangePrediction p = predictor.predict_listed(cone, 50, {window, depth});
    benchmark::DoNotOptimize(p);
  }
}
BENCHMARK(Prediction)->Arg(6)->Arg(15);

// Least squares of time over pixels, from readings of 5 to 50 m.
void ReadingCostLaw(benchmark::State& state) {
  ReadingEvidence evidence({}, {});
  const std::vector<Pose> at = poses();
  double n = 0;
  double sx = 0;
  double sy = 0;
  double sxx = 0;
  double sxy = 0;
  for (auto _ : state) {
    for (int range = 5; range < 50; range += 5) {
      const RangeReading reading = ahead(range);
      std::size_t pixels = 0;
      const std::clock_t begin = std::clock();  // of the processor: neighbours do not count
      for (const Pose& X_WB : at) pixels += evidence.add_reading(reading, X_WB).pixels.size();
      const double spent = 1e9 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      const double x = static_cast<double>(pixels) / static_cast<double>(at.size());
      const double y = spent / static_cast<double>(at.size());
      n += 1;
      sx += x;
      sy += y;
      sxx += x * x;
      sxy += x * y;
    }
  }
  const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  state.counters["ns_a_pixel"] = slope;
  state.counters["ns_fixed"] = (sy - slope * sx) / n;
}
BENCHMARK(ReadingCostLaw);

}  // namespace
}  // namespace isobath
