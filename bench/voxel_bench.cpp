// Voxels: rays into the map and questions to it, beside OctoMap on the same work (voxel_work.hpp).
#include <algorithm>
#include <bench/voxel_work.hpp>
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdint>
#include <isobath/map/voxel/voxel_map.hpp>
#include <isobath/perception/fan_mapper.hpp>
#include <vector>
#ifdef ISOBATH_HAS_OCTOMAP
#include <octomap/octomap.h>
#endif

namespace isobath {
namespace {

using namespace bench;

void VoxelRays(benchmark::State& state) {
  rays();
  std::int64_t voxels = 0;
  double megabytes = 0;
  for (auto _ : state) {
    VoxelBlocks blocks({to_evidence(kMin), to_evidence(kMax)});
    const LogOdds16 hit = to_evidence(kHit), miss = to_evidence(kMiss);
    voxels = 0;
    for (const Ray& r : rays()) {
      voxels += blocks.insert_ray(r.from / kVoxel, r.to / kVoxel, miss, r.hit ? hit : miss) + 1;
    }
    megabytes = static_cast<double>(blocks.bytes()) / 1e6;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * rays().size()));
  state.counters["MB"] = megabytes;
  state.counters["hits"] =
      static_cast<double>(std::count_if(rays().begin(), rays().end(), [](const Ray& r) { return r.hit; }));
  state.counters["voxels"] = static_cast<double>(voxels);
}
BENCHMARK(VoxelRays)->Unit(benchmark::kMillisecond)->Iterations(1)->Repetitions(3);

void VoxelQueries(benchmark::State& state) {
  static const VoxelBlocks kBlocks = mapped();
  static const std::vector<Vector3d> kQuestions = questions();
  std::int64_t occupied = 0;
  for (auto _ : state) {
    occupied = 0;
    for (const Vector3d& p : kQuestions) {
      occupied += kBlocks.at(floor_of(p * (1 / kVoxel))) > 0;
    }
    benchmark::DoNotOptimize(occupied);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * kQuestions.size()));
  state.counters["occupied"] = static_cast<double>(occupied);
}
BENCHMARK(VoxelQueries)->Unit(benchmark::kMillisecond);

void FanBins(benchmark::State& state, FanMapperConfig::Rule rule, double voxel_m = kVoxel) {
  const WideFans& fans = wide_fans();
  FanMapperConfig config;
  config.rule = rule;
  config.hit = 0.5;
  config.miss = -0.1;
  config.shadow_bins = 0;
  double megabytes = 0;
  for (auto _ : state) {
    VoxelBlocks blocks;
    FanMapper mapper(config, voxel_m, std::log(0.05 / 0.95));
    for (std::size_t i = 0; i < 200; ++i) {
      mapper.update(fans.ping, fans.decisions[i], fans.poses[i], blocks, static_cast<int>(state.range(0)));
    }
    megabytes = static_cast<double>(blocks.bytes()) / 1e6;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * 200 * 512 * 500);
  state.counters["MB"] = megabytes;
  state.counters["images/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * 200, benchmark::Counter::kIsRate);
}
/// The same bins scattered forwards, in double: each bin to the voxels of the midpoints of its arc, a voxel apart. A
/// voxel in which any bin with an echo falls is hit.
VoxelBlocks scattered(const WideFans& fans, std::size_t number) {
  const Ping& ping = fans.ping;
  const BeamFan& fan = *ping.fan;
  const Pose X_WS = fans.poses[number] * ping.X_BS;
  VoxelBlocks marks;
  for (int beam = 0; beam < fan.beams(); ++beam) {
    const double azimuth = fan.azimuth[static_cast<std::size_t>(beam)].radians();
    for (int bin = 0; bin < ping.window.bins; ++bin) {
      const double range = ping.window.centre(bin);
      const double height = fan.height.radians();
      const int pieces = static_cast<int>(std::ceil(range * height / kVoxel));
      const bool hit = fans.decisions[number].hit(beam, bin);
      for (int k = 0; k < pieces; ++k) {
        const double elevation = ((k + 0.5) / pieces - 0.5) * height;
        const Vector3d u(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                         -std::sin(elevation));
        const VoxelIndex v = floor_of(X_WS * (range * u) * (1 / kVoxel));
        LogOdds16& mark = marks.touch(v)[VoxelBlocks::offset(v)];
        mark = hit ? LogOdds16{1} : std::max(mark, LogOdds16{-1});
      }
    }
  }
  return marks;
}

void FanAccuracy(benchmark::State& state) {
  const WideFans& fans = wide_fans();
  FanMapperConfig config;
  config.rule = FanMapperConfig::Rule::kHitAndMiss;
  config.hit = 0.5;
  config.miss = -0.1;
  config.shadow_bins = 0;
  double voxels = 0, same = 0, hits = 0, hits_met = 0, mapped = 0, beside = 0;
  for (auto _ : state) {
    for (std::size_t number = 0; number < 200; number += 40) {
      const VoxelBlocks reference = scattered(fans, number);
      VoxelBlocks blocks;
      FanMapper(config, kVoxel, std::log(0.05 / 0.95))
          .update(fans.ping, fans.decisions[number], fans.poses[number], blocks);
      reference.for_each(0, [&](const VoxelBlocks::Block& block) {
        for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
          if (block.evidence[i] == kUnseen) continue;
          const VoxelIndex v = block.corner + VoxelBlocks::place_of(i);
          const LogOdds16 e = blocks.at(v);
          ++voxels;
          const bool hit = block.evidence[i] > 0;
          same += e != kUnseen && (e > 0) == hit;
          hits += hit;
          hits_met += hit && e != kUnseen && e > 0;
        }
      });
      blocks.for_each(0, [&](const VoxelBlocks::Block& block) {
        for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
          if (block.evidence[i] == kUnseen) continue;
          ++mapped;
          beside += reference.at(block.corner + VoxelBlocks::place_of(i)) == kUnseen;
        }
      });
    }
  }
  state.counters["same"] = same / voxels;
  state.counters["hits_met"] = hits_met / hits;
  state.counters["beside"] = beside / mapped;
}
BENCHMARK(FanAccuracy)->Unit(benchmark::kMillisecond)->Iterations(1);

BENCHMARK_CAPTURE(FanBins, hit_and_miss, FanMapperConfig::Rule::kHitAndMiss)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(FanBins, marginal, FanMapperConfig::Rule::kMarginal)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

BENCHMARK_CAPTURE(FanBins, aspects, FanMapperConfig::Rule::kAspects)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
// Voxels of half a metre on one core; five images a second of each of two planes are wanted (S5-60).
BENCHMARK_CAPTURE(FanBins, aspects_half_metre, FanMapperConfig::Rule::kAspects, 0.5)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

#ifdef ISOBATH_HAS_OCTOMAP
/// A tenth of the rays: the whole takes minutes.
void OctoMapRays(benchmark::State& state) {
  const std::size_t count = rays().size() / 10;
  double megabytes = 0;
  for (auto _ : state) {
    octomap::OcTree tree(kVoxel);
    const auto point = [](const Vector3d& p) {
      return octomap::point3d(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
    };
    octomap::KeyRay passed;
    for (std::size_t i = 0; i < count; ++i) {
      const Ray& r = rays()[i];
      if (tree.computeRayKeys(point(r.from), point(r.to), passed)) {
        for (const octomap::OcTreeKey& k : passed) tree.updateNode(k, static_cast<float>(kMiss), true);
      }
      tree.updateNode(point(r.to), static_cast<float>(r.hit ? kHit : kMiss), true);
    }
    megabytes = static_cast<double>(tree.memoryUsage()) / 1e6;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * count));
  state.counters["MB"] = megabytes;
}
BENCHMARK(OctoMapRays)->Unit(benchmark::kMillisecond)->Iterations(1);
#endif

}  // namespace
}  // namespace isobath
