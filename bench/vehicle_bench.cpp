// Steps of the vehicles, one core: Runge-Kutta steps of the torpedo alone, of both plants with their autopilots, and of
// what steers them.
#include <benchmark/benchmark.h>
#include <cmath>
#include <isobath/vehicle/depth_keeper.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/plant.hpp>
#include <string>

namespace isobath {
namespace {

// From the root of the project, or from build/<preset>.
VehicleModel model_of(const std::string& name) {
  try {
    return load_vehicle("vehicles/" + name + ".toml");
  } catch (const Error&) {
    return load_vehicle("../../vehicles/" + name + ".toml");
  }
}

VehicleState under_way() {
  VehicleState s;
  s.X_WB.translation.z() = 10;
  s.v_B.x() = 1.5;
  return s;
}

void torpedo_step(benchmark::State& bench) {
  VehicleDynamics dynamics(model_of("remus100"), under_way());
  ActuatorVector commands(5);
  commands << 3.86, 0.05, 0.05, 0.02, 0.02;
  const WaterConditions water{1025, {0.2, 0.1, 0}};
  for (auto _ : bench) {
    dynamics.step(commands, water, 0.02);
    benchmark::DoNotOptimize(dynamics.state());
  }
  bench.SetItemsProcessed(bench.iterations());
}
BENCHMARK(torpedo_step);

void plant_step(benchmark::State& bench, const std::string& name, PlantKind kind) {
  const auto plant = make_plant(model_of(name), kind, under_way());
  const WaterConditions water{1025, {0.2, 0.1, 0}};
  for (auto _ : bench) {
    plant->step({Angle::degrees(30), 12, 1.0, 0}, water, 0.02);
    benchmark::DoNotOptimize(plant->state());
  }
  bench.SetItemsProcessed(bench.iterations());
}
BENCHMARK_CAPTURE(plant_step, torpedo_dynamic, "remus100", PlantKind::kDynamic);
BENCHMARK_CAPTURE(plant_step, rov_dynamic, "hovering_rov", PlantKind::kDynamic);
BENCHMARK_CAPTURE(plant_step, torpedo_kinematic, "remus100", PlantKind::kKinematic);

void guidance_step(benchmark::State& bench) {
  const VehicleState state = under_way();
  LineOfSight guidance({}, {{1e6, 0, 10, 1.5}, {1e6, 50, 10, 1.5}}, parameters_of(model_of("remus100")));
  for (auto _ : bench) benchmark::DoNotOptimize(guidance.step(state, 0.1));
  bench.SetItemsProcessed(bench.iterations());
}
BENCHMARK(guidance_step);

// An echo and an order.
void depth_keeper_step(benchmark::State& bench) {
  DepthKeeper keeper({}, parameters_of(model_of("remus100")));
  VehicleState state = under_way();
  AltimeterReading reading;
  reading.max_range_m = 50;
  reading.X_BS.rotation = Rotation::from_heading_pitch_roll({}, Angle::degrees(-90), {});
  for (auto _ : bench) {
    state.X_WB.translation.x() += 0.15;
    reading.range_m = 8 + std::sin(0.02 * state.X_WB.translation.x());
    keeper.on_altimeter(reading, state.X_WB);
    benchmark::DoNotOptimize(keeper.step({0, 5.0}, state.X_WB, {1.5, 0, 0}, reading.time));
  }
  bench.SetItemsProcessed(bench.iterations());
}
BENCHMARK(depth_keeper_step);

}  // namespace
}  // namespace isobath
