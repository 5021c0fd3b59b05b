// An approach planned anew: what an image of the pair of fans costs, to be held against its 200 ms at five images a
// second (ledger S5-47).
#include <benchmark/benchmark.h>
#include <isobath/planning/opening_approach.hpp>
#include <isobath/planning/opening_view.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr double kWay = 0.3;  // m between images at 1.5 m/s

VehicleParameters slender() {
  VehicleParameters parameters;
  parameters.half_width_m = 0.15;
  parameters.limits = {2.5, 0.1, 4.5, Angle::degrees(15), 0.5, 100};
  return parameters;
}

Opening opening_at_60_m() { return {{Rotation(), {60, 0, 4}}, 25, 8}; }

/// `range(0)`: with a map of half-metre voxels to look for obstacles in.
void plan_an_image(benchmark::State& state) {
  VoxelMap map({0.5, 0.5, 0.98, 0.2, 6.9});
  for (int i = 0; i < 200; ++i) map.layer("any").add({i, 30, 8}, to_evidence(6));
  const Opening opening = opening_at_60_m();
  OpeningApproach approach({}, slender(), 1.5, {0, 0, 4}, opening);
  double along = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(approach.step({along, 0, 4}, opening, 0.5, state.range(0) != 0 ? &map : nullptr));
    along += kWay;
    if (along > 30) {
      state.PauseTiming();
      approach = OpeningApproach({}, slender(), 1.5, {0, 0, 4}, opening);
      along = 0;
      state.ResumeTiming();
    }
  }
}
BENCHMARK(plan_an_image)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void look_at_the_opening(benchmark::State& state) {
  OpeningView view(opening_at_60_m());
  for (auto _ : state) view.look({Rotation::from_heading(Angle::degrees(90)), {0, 0, 4}});  // nothing becomes known
}
BENCHMARK(look_at_the_opening)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isobath
