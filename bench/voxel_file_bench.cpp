// Blocks of voxels to a file and back, and a map into a file for OpenVDB's readers.
#include <bench/voxel_work.hpp>
#include <benchmark/benchmark.h>
#include <filesystem>
#include <isobath/io/exports/voxel_vdb.hpp>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <isobath/map/voxel/voxel_map.hpp>
#include <unistd.h>

namespace isobath {
namespace {

using namespace bench;
namespace fs = std::filesystem;

/// What 40 wide fans say: some 5700 blocks.
void fill(VoxelMap& map) {
  const WideFans& fans = wide_fans();
  FanMapper mapper({}, map.voxel_m(), std::log(0.05 / 0.95));
  for (std::size_t i = 0; i < 200; i += 5) {
    map.advance();
    mapper.update(fans.ping, fans.decisions[i], fans.poses[i], map.layer("flat"));
  }
}

struct Folder {
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  fs::path path = fs::temp_directory_path() / ("isobath_voxel_file_bench_" + std::to_string(getpid()));
};

/// All blocks in one commit; then each touched once, which brings it back.
void VoxelFileWrite(benchmark::State& state) {
  double blocks = 0, megabytes = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const Folder folder;
    VoxelMap map;
    fill(map);
    map.spill_to(folder.path / "voxels.sqlite");
    state.ResumeTiming();
    blocks = static_cast<double>(map.spill_beyond(0));
    state.PauseTiming();
    megabytes = static_cast<double>(fs::file_size(folder.path / "voxels.sqlite")) / 1e6;
    map = VoxelMap();
    state.ResumeTiming();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(blocks) * static_cast<std::int64_t>(state.iterations()));
  state.counters["blocks"] = blocks;
  state.counters["MB"] = megabytes;
}
BENCHMARK(VoxelFileWrite)->Unit(benchmark::kMillisecond)->Iterations(2);

void VoxelFileRead(benchmark::State& state) {
  const Folder folder;
  VoxelMap map;
  fill(map);
  map.spill_to(folder.path / "voxels.sqlite");
  const std::vector<VoxelIndex> corners = map.changed_after(0);
  for (auto _ : state) {
    state.PauseTiming();
    map.spill_beyond(0);
    state.ResumeTiming();
    for (const VoxelIndex& corner : corners) benchmark::DoNotOptimize(map.layer("flat").touch(corner));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(corners.size()) * static_cast<std::int64_t>(state.iterations()));
}
BENCHMARK(VoxelFileRead)->Unit(benchmark::kMillisecond)->Iterations(2);

/// One block a commit: what the disk's flushes cost. Wall time.
void VoxelFileCommit(benchmark::State& state) {
  const Folder folder;
  VoxelMap map;
  map.spill_to(folder.path / "voxels.sqlite");
  for (auto _ : state) {
    map.layer("flat").add({0, 0, 0}, 1);
    map.spill_beyond(0);
  }
}
BENCHMARK(VoxelFileCommit)->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(50);

void VoxelVdbWrite(benchmark::State& state) {
  if (!has_openvdb()) return state.SkipWithError("built without OpenVDB");
  const Folder folder;
  VoxelMap map;
  fill(map);
  double voxels = 0;
  for_each_seen(map, [&](const VoxelIndex&) { ++voxels; });
  for (auto _ : state) write_vdb(map, folder.path / "voxels.vdb");
  state.SetItemsProcessed(static_cast<std::int64_t>(voxels) * static_cast<std::int64_t>(state.iterations()));
  state.counters["MB"] = static_cast<double>(fs::file_size(folder.path / "voxels.vdb")) / 1e6;
}
BENCHMARK(VoxelVdbWrite)->Unit(benchmark::kMillisecond)->Iterations(2);

}  // namespace
}  // namespace isobath
