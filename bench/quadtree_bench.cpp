// Quadtrees of the depth map (S1-11 to S1-23), beside plain arrays and beside looking at everything.
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <isobath/base/random.hpp>
#include <isobath/map/depth/region_quadtree.hpp>
#include <isobath/map/depth/tree_file.hpp>
#include <isobath/map/features/pmr_quadtree.hpp>
#include <limits>
#include <numbers>
#include <unistd.h>
#include <vector>

namespace isobath {
namespace {

constexpr int kLevels = 11;
constexpr int kSide = 1 << kLevels;
constexpr int kWindow = 512;
constexpr PixelWindow kPlace{301, 407, kWindow, kWindow};  // aligned to nothing

enum Bottom : std::int64_t { kRough, kSlopes, kTerraces, kFlat };

// Depth words in centimetres: noise, slopes of 2 m, the same in steps of 10 cm, nothing.
std::vector<std::uint32_t> bottom(std::int64_t kind) {
  Random random(1);
  std::vector<std::uint32_t> values;
  values.reserve(std::size_t{kSide} * kSide);
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const double depth_m = 30 + std::sin(0.01 * column) + std::cos(0.013 * row);
      switch (kind) {
        case kRough: values.push_back(static_cast<std::uint32_t>(3000 + random.index(1000))); break;
        case kSlopes: values.push_back(static_cast<std::uint32_t>(std::lround(100 * depth_m))); break;
        case kTerraces: values.push_back(static_cast<std::uint32_t>(10 * std::lround(10 * depth_m))); break;
        default: values.push_back(3000); break;
      }
    }
  }
  return values;
}

RegionQuadtree tree_of(const std::vector<std::uint32_t>& values) {
  return RegionQuadtree::from_raster(kLevels, values, kSide, kSide, 0);
}

void all_bottoms(benchmark::internal::Benchmark* b) { b->Arg(kRough)->Arg(kSlopes)->Arg(kTerraces)->Arg(kFlat); }

// Bar: 50 M pixels/s.
void QuadtreeFromRaster(benchmark::State& state) {
  const auto values = bottom(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(tree_of(values).root());
  state.SetItemsProcessed(state.iterations() * kSide * kSide);
  const auto s = tree_of(values).statistics();
  state.counters["leaves"] = double(s.leaves);
  state.counters["bytes_per_leaf"] = 4 * double(s.words) / double(s.leaves);
  state.counters["bytes_per_pixel"] = 4 * double(s.words) / kSide / kSide;
}
BENCHMARK(QuadtreeFromRaster)->Apply(all_bottoms)->Unit(benchmark::kMillisecond);

void QuadtreeReadWindow(benchmark::State& state) {
  const RegionQuadtree tree = tree_of(bottom(state.range(0)));
  std::vector<std::uint32_t> window(std::size_t{kWindow} * kWindow);
  for (auto _ : state) benchmark::DoNotOptimize(tree.read(kPlace, window.data(), kWindow));
  state.SetItemsProcessed(state.iterations() * kWindow * kWindow);
}
BENCHMARK(QuadtreeReadWindow)->Apply(all_bottoms)->Unit(benchmark::kMicrosecond);

void QuadtreeReadWindowPlainArray(benchmark::State& state) {
  const auto values = bottom(kRough);
  std::vector<std::uint32_t> window(std::size_t{kWindow} * kWindow);
  for (auto _ : state) {
    for (int row = 0; row < kWindow; ++row) {
      std::memcpy(&window[std::size_t{kWindow} * row], &values[std::size_t{kSide} * (kPlace.row + row) + kPlace.column],
                  sizeof(std::uint32_t) * kWindow);
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kWindow * kWindow);
}
BENCHMARK(QuadtreeReadWindowPlainArray)->Unit(benchmark::kMicrosecond);

// Every pixel by itself, as a map without windows would do it.
void QuadtreeReadPixels(benchmark::State& state) {
  const RegionQuadtree tree = tree_of(bottom(kRough));
  Random random(2);
  std::vector<Pixel> pixels;
  for (int i = 0; i < 100000; ++i) {
    pixels.push_back({static_cast<std::int32_t>(random.index(kSide)), static_cast<std::int32_t>(random.index(kSide))});
  }
  std::uint32_t sum = 0;
  for (auto _ : state) {
    for (Pixel p : pixels) sum += tree.at(p);
  }
  benchmark::DoNotOptimize(sum);
  state.SetItemsProcessed(state.iterations() * std::int64_t(pixels.size()));
}
BENCHMARK(QuadtreeReadPixels)->Unit(benchmark::kMillisecond);

// All pixels of the window change; while a snapshot holds the pages (argument 1) each page is cloned.
void QuadtreeWriteWindow(benchmark::State& state) {
  RegionQuadtree tree = tree_of(bottom(kRough));
  std::vector<std::uint32_t> window(std::size_t{kWindow} * kWindow);
  tree.read(kPlace, window.data(), kWindow);
  for (auto _ : state) {
    state.PauseTiming();
    for (auto& v : window) ++v;
    const RegionQuadtree snapshot = state.range(0) != 0 ? tree : RegionQuadtree(0);
    state.ResumeTiming();
    benchmark::DoNotOptimize(tree.write(kPlace, {window.data(), kWindow}));
  }
  state.SetItemsProcessed(state.iterations() * kWindow * kWindow);
}
BENCHMARK(QuadtreeWriteWindow)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

// One pixel in a hundred has changed, in strips as beams leave them.
void QuadtreeWriteChanged(benchmark::State& state) {
  RegionQuadtree tree = tree_of(bottom(kRough));
  std::vector<std::uint32_t> window(std::size_t{kWindow} * kWindow);
  tree.read(kPlace, window.data(), kWindow);
  std::vector<std::uint8_t> changed(window.size(), 0);
  for (int i = 0; i < kWindow; ++i) {
    for (int k = 0; k < 5; ++k) changed[std::size_t{kWindow} * i + (i / 2 + k)] = 1;
  }
  for (auto _ : state) {
    state.PauseTiming();
    for (auto& v : window) ++v;
    state.ResumeTiming();
    benchmark::DoNotOptimize(tree.write(kPlace, {window.data(), kWindow, changed.data(), kWindow}));
  }
  state.SetItemsProcessed(state.iterations() * kWindow * kWindow);
}
BENCHMARK(QuadtreeWriteChanged)->Unit(benchmark::kMicrosecond);

void QuadtreeWriteWindowPlainArray(benchmark::State& state) {
  auto values = bottom(kRough);
  const std::vector<std::uint32_t> window(std::size_t{kWindow} * kWindow, 7);
  for (auto _ : state) {
    for (int row = 0; row < kWindow; ++row) {
      std::memcpy(&values[std::size_t{kSide} * (kPlace.row + row) + kPlace.column], &window[std::size_t{kWindow} * row],
                  sizeof(std::uint32_t) * kWindow);
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kWindow * kWindow);
}
BENCHMARK(QuadtreeWriteWindowPlainArray)->Unit(benchmark::kMicrosecond);

void QuadtreeSnapshot(benchmark::State& state) {
  const RegionQuadtree tree = tree_of(bottom(kRough));
  for (auto _ : state) {
    const RegionQuadtree snapshot(tree);  // NOLINT(performance-unnecessary-copy-initialization): this is measured
    benchmark::DoNotOptimize(snapshot.root());
  }
  state.counters["pages"] = double(tree.statistics().pages);
}
BENCHMARK(QuadtreeSnapshot)->Unit(benchmark::kMicrosecond);

// Checksums and every link.
void QuadtreeOpenFile(benchmark::State& state) {
  const auto file = std::filesystem::temp_directory_path() / ("quadtree_bench." + std::to_string(::getpid()));
  const RegionQuadtree tree = tree_of(bottom(kRough));
  write_tree_file(file, tree, 1, "");
  for (auto _ : state) benchmark::DoNotOptimize(open_tree_file(file, 0).tree.root());
  state.SetBytesProcessed(state.iterations() * std::int64_t(tree.statistics().bytes));
  std::filesystem::remove(file);
}
BENCHMARK(QuadtreeOpenFile)->Unit(benchmark::kMillisecond);

constexpr int kObjects = 100000;
constexpr double kArea = 10000;

std::vector<Eigen::Vector2d> points(std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector2d> all;
  for (int i = 0; i < kObjects; ++i) {
    const double north = random.uniform(0, kArea);
    all.emplace_back(north, random.uniform(0, kArea));
  }
  return all;
}

struct Pieces {
  std::vector<Eigen::Vector2d> a = points(1);
  std::vector<Eigen::Vector2d> b;
  Pieces() {
    Random random(3);
    for (const auto& p : a) {
      const double heading = random.uniform(0, 2 * std::numbers::pi);
      b.emplace_back(p + 20 * Eigen::Vector2d(std::cos(heading), std::sin(heading)));
    }
  }
};

void NearestSegment(benchmark::State& state) {
  PmrQuadtree tree({0, 0}, kArea);
  const Pieces pieces;
  for (std::size_t i = 0; i < pieces.a.size(); ++i) tree.insert({i, pieces.a[i], pieces.b[i]});
  const auto queries = points(2);
  std::size_t i = 0;
  SearchEffort all;
  for (auto _ : state) {
    SearchEffort effort;
    benchmark::DoNotOptimize(tree.nearest(queries[i++ % queries.size()], &effort));
    all.nodes += effort.nodes;
    all.objects += effort.objects;
  }
  state.counters["nodes"] = double(all.nodes) / double(state.iterations());
  state.counters["segments"] = double(all.objects) / double(state.iterations());
}
BENCHMARK(NearestSegment)->Unit(benchmark::kMicrosecond);

void NearestSegmentBruteForce(benchmark::State& state) {
  const Pieces pieces;
  const auto queries = points(2);
  std::size_t i = 0;
  for (auto _ : state) {
    const Eigen::Vector2d& p = queries[i++ % queries.size()];
    double best = std::numeric_limits<double>::infinity();
    std::size_t nearest = 0;
    for (std::size_t k = 0; k < pieces.a.size(); ++k) {
      const Eigen::Vector2d d = pieces.b[k] - pieces.a[k];
      const double t = std::clamp((p - pieces.a[k]).dot(d) / d.squaredNorm(), 0.0, 1.0);
      const double squared = (pieces.a[k] + t * d - p).squaredNorm();
      if (squared < best) best = squared, nearest = k;
    }
    benchmark::DoNotOptimize(nearest);
  }
}
BENCHMARK(NearestSegmentBruteForce)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isobath
