// OpenVDB beside this project's voxels on the same work (voxel_work.hpp), one after the other in the same run: each
// line gives both speeds and how many times as fast this project is. Alone in its file, since its headers take long.
#include <algorithm>
#include <bench/voxel_work.hpp>
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <isobath/perception/fan_mapper.hpp>
#include <vector>
#ifdef ISOBATH_HAS_OPENVDB
#include <openvdb/math/DDA.h>
#include <openvdb/math/Ray.h>
#include <openvdb/openvdb.h>

namespace isobath {
namespace {

using namespace bench;

template <class Work>
double seconds_of(const Work& work) {
  const std::clock_t begin = std::clock();  // of the processor: one thread
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

void report(benchmark::State& state, double items, double own_s, double peer_s) {
  state.counters["isobath_per_s"] = items / own_s;
  state.counters["openvdb_per_s"] = items / peer_s;
  state.counters["times_as_fast"] = peer_s / own_s;
}

using Accessor = openvdb::FloatGrid::Accessor;

void add(Accessor& map, const openvdb::Coord& at, float more) {
  map.modifyValue(at,
                  [more](float& e) { e = std::clamp(e + more, static_cast<float>(kMin), static_cast<float>(kMax)); });
}

/// OpenVDB's own walk from voxel to voxel, the last one apart.
void insert(Accessor& map, const Ray& ray) {
  using VdbRay = openvdb::math::Ray<double>;
  const Vector3d from = ray.from / kVoxel, way = ray.to / kVoxel - from;
  const double length = way.norm();
  const Vector3d u = way / length;
  const VoxelIndex end = floor_of(ray.to / kVoxel);
  const openvdb::Coord last(end.x(), end.y(), end.z());
  openvdb::math::DDA<VdbRay> walk(VdbRay({from.x(), from.y(), from.z()}, {u.x(), u.y(), u.z()}, 0, length));
  do {
    if (walk.voxel() == last) break;
    add(map, walk.voxel(), static_cast<float>(kMiss));
  } while (walk.step());
  add(map, last, static_cast<float>(ray.hit ? kHit : kMiss));
}

openvdb::FloatGrid::Ptr vdb_mapped(std::size_t count) {
  const auto grid = openvdb::FloatGrid::create(0);
  Accessor map = grid->getAccessor();
  for (std::size_t i = 0; i < count; ++i) insert(map, rays()[i]);
  return grid;
}

/// A quarter of the rays.
void OpenVdbRays(benchmark::State& state) {
  const std::size_t count = rays().size() / 4;
  for (auto _ : state) {
    VoxelBlocks blocks({to_evidence(kMin), to_evidence(kMax)});
    const LogOdds16 hit = to_evidence(kHit), miss = to_evidence(kMiss);
    const double own = seconds_of([&] {
      for (std::size_t i = 0; i < count; ++i) {
        const Ray& r = rays()[i];
        blocks.insert_ray(r.from / kVoxel, r.to / kVoxel, miss, r.hit ? hit : miss);
      }
    });
    openvdb::FloatGrid::Ptr grid;
    const double peer = seconds_of([&] { grid = vdb_mapped(count); });
    report(state, static_cast<double>(count), own, peer);
    state.counters["isobath_MB"] = static_cast<double>(blocks.bytes()) / 1e6;
    state.counters["openvdb_MB"] = static_cast<double>(grid->memUsage()) / 1e6;
    // The two walk alike but for ties on edges: what they hold of a voxel is to agree nearly everywhere.
    std::int64_t same = 0, seen = 0;
    for (auto v = grid->cbeginValueOn(); v; ++v) {
      const openvdb::Coord c = v.getCoord();
      const LogOdds16 e = blocks.at({c.x(), c.y(), c.z()});
      ++seen;
      same += e != kUnseen && std::abs(to_log_odds(e) - *v) < 0.05 ? 1 : 0;
    }
    state.counters["agree"] = static_cast<double>(same) / static_cast<double>(seen);
  }
}
BENCHMARK(OpenVdbRays)->Unit(benchmark::kMillisecond)->Iterations(1);

/// A place on the arc of a bin, m.
struct ArcSample {
  double ahead, down;
};
std::vector<std::vector<ArcSample>> arcs_of(double height) {
  std::vector<std::vector<ArcSample>> arcs(500);
  for (int bin = 0; bin < 500; ++bin) {
    const double range = (bin + 0.5) * 0.1;
    const int samples = static_cast<int>(std::ceil(range * height / kVoxel));
    for (int s = 0; s < samples; ++s) {
      const double elevation = height * ((s + 0.5) / samples - 0.5);
      arcs[static_cast<std::size_t>(bin)].push_back({range * std::cos(elevation), -range * std::sin(elevation)});
    }
  }
  return arcs;
}

/// Ten of the pings; OpenVDB a sample each quarter of a metre along the arc of each bin.
void OpenVdbFans(benchmark::State& state) {
  const WideFans& fans = wide_fans();
  constexpr std::size_t kPings = 10;
  const auto arcs = arcs_of(fans.ping.fan->height.radians());
  FanMapperConfig config;
  config.rule = FanMapperConfig::Rule::kHitAndMiss;
  config.hit = 0.5;
  config.miss = -0.1;
  config.shadow_bins = 0;
  for (auto _ : state) {
    VoxelBlocks blocks;
    FanMapper mapper(config, kVoxel, std::log(0.05 / 0.95));
    const double own = seconds_of([&] {
      for (std::size_t i = 0; i < kPings; ++i) {
        mapper.update(fans.ping, fans.decisions[i], fans.poses[i], blocks);
      }
    });
    const auto grid = openvdb::FloatGrid::create(0);
    const double peer = seconds_of([&] {
      Accessor map = grid->getAccessor();
      for (std::size_t i = 0; i < kPings; ++i) {
        const Eigen::Matrix3d R = fans.poses[i].rotation.matrix() / kVoxel;
        const Vector3d at = fans.poses[i].translation / kVoxel;
        for (int beam = 0; beam < 512; ++beam) {
          const double azimuth = fans.ping.fan->azimuth[static_cast<std::size_t>(beam)].radians();
          const Vector3d ahead = R * Vector3d(std::cos(azimuth), std::sin(azimuth), 0), down = R.col(2);
          const std::uint64_t* hits = fans.decisions[i].hits(beam);
          for (int bin = 0; bin < 500; ++bin) {
            const float more = (hits[bin / 64] >> (bin % 64) & 1) != 0 ? 0.5f : -0.1f;
            for (const ArcSample& s : arcs[static_cast<std::size_t>(bin)]) {
              const VoxelIndex v = floor_of(at + s.ahead * ahead + s.down * down);
              add(map, {v.x(), v.y(), v.z()}, more);
            }
          }
        }
      }
    });
    report(state, kPings * 512.0 * 500, own, peer);
  }
}
BENCHMARK(OpenVdbFans)->Unit(benchmark::kMillisecond)->Iterations(1);

void OpenVdbQueries(benchmark::State& state) {
  const std::vector<Vector3d> asked = questions();
  const VoxelBlocks blocks = mapped();
  const auto grid = vdb_mapped(rays().size());
  for (auto _ : state) {
    std::int64_t own_occupied = 0, peer_occupied = 0;
    const double own = seconds_of([&] {
      for (const Vector3d& p : asked) own_occupied += blocks.at(floor_of(p * (1 / kVoxel))) > 0;
    });
    const openvdb::FloatGrid::ConstAccessor map = grid->getConstAccessor();
    const double peer = seconds_of([&] {
      for (const Vector3d& p : asked) {
        const VoxelIndex v = floor_of(p * (1 / kVoxel));
        peer_occupied += map.getValue({v.x(), v.y(), v.z()}) > 0;
      }
    });
    report(state, static_cast<double>(asked.size()), own, peer);
    state.counters["isobath_occupied"] = static_cast<double>(own_occupied);
    state.counters["openvdb_occupied"] = static_cast<double>(peer_occupied);
  }
}
BENCHMARK(OpenVdbQueries)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace isobath
#endif
