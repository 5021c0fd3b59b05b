// From scan to decision: an ObstacleScan of 60 obstacles within a 100 m map in, the Navigator's RoutePlanned (or its
// silence, where the way is kept) out; cells of 0.5 m. The 99th percentile over 1000 different scans, one scan to a way
// of its own, and the same in passing, scan after scan on the way (S6-31, S6-55). Processor time of the one thread.
#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <ctime>
#include <isobath/base/random.hpp>
#include <isobath/mission/agents/navigator.hpp>
#include <vector>

namespace isobath {
namespace {

constexpr int kScans = 1000;
constexpr int kObstacles = 60;

Navigation here() {
  Navigation n;
  n.X_WB.translation = {0, 0, 2};
  return n;
}

// Obstacles of 1 to 4 m across, anywhere 100 m ahead but at the vehicle and at the point.
ObstacleScan scan_of(std::uint64_t seed) {
  Random random(seed);
  ObstacleScan scan;
  scan.number = static_cast<int>(seed);
  while (scan.hazards.size() < kObstacles) {
    const double x = random.uniform(0, 100);
    const double y = random.uniform(-50, 50);
    const Eigen::Vector2d middle(x, y);
    if (middle.norm() < 8 || (middle - Eigen::Vector2d(95, 0)).norm() < 15) continue;
    std::vector<Eigen::Vector2d> corners;
    for (int i = 0; i < 6; ++i) {
      const double bearing = random.uniform(0, 6.28);
      const double radius = random.uniform(0.5, 2);
      corners.emplace_back(middle + radius * Eigen::Vector2d(std::cos(bearing), std::sin(bearing)));
    }
    scan.hazards.push_back({convex_hull(std::move(corners)), 0.25, HazardKind::kSeen, 0});
  }
  return scan;
}

void report(benchmark::State& state, std::vector<double> ms, double planned) {
  std::sort(ms.begin(), ms.end());
  state.counters["median_ms"] = ms[ms.size() / 2];
  state.counters["p99_ms"] = ms[ms.size() * 99 / 100];
  state.counters["worst_ms"] = ms.back();
  state.counters["replanned"] = planned / static_cast<double>(ms.size());
}

RouteConfig fine() {
  RouteConfig route;
  route.cell_m = 0.5;
  return route;
}

void scan_to_decision(benchmark::State& state, bool keeps_its_way) {
  std::vector<ObstacleScan> scans;
  for (int i = 0; i < kScans; ++i) scans.push_back(scan_of(static_cast<std::uint64_t>(i) + 1));
  std::vector<double> ms;
  double planned = 0;
  for (auto _ : state) {
    Navigator navigator(NavigatorConfig{}, fine(), VehicleParameters{});
    Outbox out;
    navigator.on_message(here(), Time{}, out);
    RouteRequest request;
    request.target.north_east = {95, 0};
    navigator.on_message(ObstacleScan{}, Time{}, out);
    navigator.on_message(request, Time{}, out);
    for (const ObstacleScan& scan : scans) {
      if (!keeps_its_way) {  // a straight way again
        navigator.on_message(ObstacleScan{}, Time{}, out);
        navigator.on_message(request, Time{}, out);
      }
      out.said().clear();
      const std::clock_t from = std::clock();
      navigator.on_message(scan, Time{}, out);
      ms.push_back(1e3 * static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC);
      planned += static_cast<double>(!out.said().empty());
    }
  }
  report(state, std::move(ms), planned);
}

BENCHMARK_CAPTURE(scan_to_decision, straight_way_then_clutter, false)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(scan_to_decision, clutter_after_clutter, true)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace isobath
