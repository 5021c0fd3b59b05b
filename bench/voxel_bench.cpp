// Voxels: rays into the map and questions to it, beside OctoMap on the same work (voxel_work.hpp).
#include <algorithm>
#include <bench/voxel_work.hpp>
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdint>
#include <isobath/map/voxel_map.hpp>
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
    VoxelBlocks blocks({to_evidence(kLeast), to_evidence(kMost)});
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

void FanBins(benchmark::State& state, FanMapperConfig::Rule rule) {
  const WideFans& fans = wide_fans();
  FanMapperConfig config;
  config.rule = rule;
  config.hit = 0.5;
  config.miss = -0.1;
  config.shadow_bins = 0;
  double megabytes = 0;
  for (auto _ : state) {
    VoxelBlocks blocks;
    FanMapper mapper(config, kVoxel, std::log(0.05 / 0.95));
    for (std::size_t i = 0; i < 200; ++i) {
      mapper.update(fans.ping, fans.decisions[i], fans.poses[i], blocks, static_cast<int>(state.range(0)));
    }
    megabytes = static_cast<double>(blocks.bytes()) / 1e6;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * 200 * 512 * 500);
  state.counters["MB"] = megabytes;
}
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
