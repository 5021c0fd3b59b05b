// Ways past hazards: A* on 400 x 400 cells beside a plain Dijkstra of the same run and OMPL's RRT* (where it is
// installed), checks of a way against 500 hazards, and a whole plan on a map of 100 m at 0.5 m.
#include <algorithm>
#include <benchmark/benchmark.h>
#include <ctime>
#include <isobath/base/random.hpp>
#include <isobath/planning/route_grid.hpp>
#include <isobath/planning/route_planner.hpp>
#include <numbers>
#include <queue>
#ifdef ISOBATH_HAS_OMPL
#include <ompl/base/MotionValidator.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/util/RandomNumbers.h>
#endif

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr int kMaps = 21;
constexpr double kReach = 0.5;
const RouteWindow kWindow{{0, 0}, 1, 400, 400};

/// CPU time of this thread: neighbours on the machine do not count.
double now_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}
double ms_since(double start) { return now_ms() - start; }
double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

/// Discs of 2 to 8 m until a fifth of 400 m x 400 m is covered; the corners stay free.
std::vector<Hazard> discs(Random& random) {
  std::vector<Hazard> hazards;
  for (double uncovered = 1; uncovered > 0.8;) {
    const double x = random.uniform(0, 400);
    const double y = random.uniform(0, 400);
    const double radius = random.uniform(2, 8);
    if (std::min(std::hypot(x, y), std::hypot(x - 399, y - 399)) < radius + 3) continue;
    hazards.push_back({{{x, y}}, radius, HazardKind::kSeen, 0});
    uncovered *= 1 - std::numbers::pi * radius * radius / 160000;
  }
  return hazards;
}

std::vector<Hazard> outlines(Random& random, int count, double extent) {
  std::vector<Hazard> hazards;
  while (static_cast<int>(hazards.size()) < count) {
    const double x = random.uniform(-extent, extent);
    const double y = random.uniform(-extent, extent);
    if (std::hypot(x, y) < 6 || std::hypot(x - extent, y) < 6) continue;
    Polygon corners;
    for (int i = 0; i < 8; ++i) {
      const double angle = random.uniform(0, 2 * std::numbers::pi);
      const double radius = random.uniform(0.2, 1);
      corners.emplace_back(x + radius * std::cos(angle), y + radius * std::sin(angle));
    }
    hazards.push_back({convex_hull(corners), random.uniform(0, 0.5), HazardKind::kSeen, 0});
  }
  return hazards;
}

/// All cells in the order of their cost, until the goal; no heuristic.
double dijkstra(const RouteGrid& grid, std::size_t start, std::size_t goal) {
  using Entry = std::pair<double, std::size_t>;
  std::vector<double> cost(kWindow.size(), INFINITY);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost[start] = 0;
  open.push({0, start});
  while (!open.empty()) {
    const auto [here, cell] = open.top();
    open.pop();
    if (here > cost[cell]) continue;
    if (cell == goal) break;
    const auto column = static_cast<std::int32_t>(cell % 400), row = static_cast<std::int32_t>(cell / 400);
    for (std::size_t step = 0; step < 8; ++step) {
      const std::int32_t c = column + kGridSteps[step].column, r = row + kGridSteps[step].row;
      if (c < 0 || c >= 400 || r < 0 || r >= 400 || !grid.open(cell, step)) continue;
      const std::size_t to = static_cast<std::size_t>(r) * 400 + static_cast<std::size_t>(c);
      const double total = here + grid.step_cost(cell, to, step);
      if (total >= cost[to]) continue;
      cost[to] = total;
      open.push({total, to});
    }
  }
  return cost[goal];
}

/// `standing_off`: with the preference for room, 5 m at a weight of 0.3.
void route_astar(benchmark::State& bench) {
  const bool standing_off = bench.range(0) != 0;
  Random random(1);
  std::vector<RouteGrid> grids;
  for (int i = 0; i < kMaps; ++i) {
    grids.push_back(RouteGrid::exact(HazardMap(discs(random)), kWindow, kReach));
    if (standing_off) grids.back().prefer_room(5, 0.3);
  }
  const std::size_t goal = kWindow.size() - 1;
  std::vector<double> times, expanded, costs;
  std::size_t next = 0;
  for (auto _ : bench) {
    const double start = now_ms();
    const RouteGrid& grid = grids[next++ % grids.size()];
    GridSearch<RouteGrid> search(grid, 400, 400, 1);
    benchmark::DoNotOptimize(search.run(0, goal, 1'000'000));
    times.push_back(ms_since(start));
    expanded.push_back(static_cast<double>(search.expanded()));
    costs.push_back(search.cost(goal));
  }
  std::vector<double> plain;
  bool same = true;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const double start = now_ms();
    const double cost = dijkstra(grids[i], 0, goal);
    plain.push_back(ms_since(start));
    if (i < costs.size() && std::isfinite(cost)) same = same && std::abs(cost - costs[i]) < 1e-6;
  }
  bench.counters["median_ms"] = median(times);
  bench.counters["expanded"] = median(expanded);
  bench.counters["dijkstra_ms"] = median(plain);
  bench.counters["dijkstra_ratio"] = median(plain) / median(times);
  bench.counters["same_cost"] = same ? 1 : 0;
}
BENCHMARK(route_astar)->ArgName("room")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void route_grid_of_discs(benchmark::State& bench) {
  Random random(1);
  const HazardMap map(discs(random));
  for (auto _ : bench) benchmark::DoNotOptimize(RouteGrid::exact(map, kWindow, kReach));
  bench.counters["hazards"] = static_cast<double>(map.hazards().size());
}
BENCHMARK(route_grid_of_discs)->Unit(benchmark::kMillisecond);

RouteTask across() {
  RouteTask task;
  task.goal = {399, 399};
  task.half_width_m = kReach;
  return task;
}
RouteConfig shortest() {
  RouteConfig config;
  config.clearance_m = 0;
  config.room_weight = 0;
  return config;
}

#ifdef ISOBATH_HAS_OMPL
namespace ob = ompl::base;
namespace og = ompl::geometric;

Vector2d place_of(const ob::State* state) {
  const auto* values = state->as<ob::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1]};
}

/// Motions are checked exactly, as ours are.
class ExactMotions : public ob::MotionValidator {
 public:
  ExactMotions(const ob::SpaceInformationPtr& space, const HazardMap& map) : MotionValidator(space), map_(map) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return map_.leg_is_clear(place_of(a), place_of(b), kReach);
  }
  bool checkMotion(const ob::State* a, const ob::State* b, std::pair<ob::State*, double>& /*last*/) const override {
    return checkMotion(a, b);
  }

 private:
  const HazardMap& map_;
};

/// Seconds until RRT* has a way no longer than `length`, and the length that it has then.
std::pair<double, double> rrt_star(const HazardMap& map, double length, double limit_s) {
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ompl::RNG::setSeed(1);
  const auto space = std::make_shared<ob::RealVectorStateSpace>(2);
  space->setBounds(0, 400);
  og::SimpleSetup setup(space);
  setup.setStateValidityChecker([&](const ob::State* s) { return map.distance(place_of(s)) >= kReach; });
  setup.getSpaceInformation()->setMotionValidator(std::make_shared<ExactMotions>(setup.getSpaceInformation(), map));
  ob::ScopedState<> from(space), to(space);
  from[0] = from[1] = 0;
  to[0] = to[1] = 399;
  setup.setStartAndGoalStates(from, to);
  const auto objective = std::make_shared<ob::PathLengthOptimizationObjective>(setup.getSpaceInformation());
  objective->setCostThreshold(ob::Cost(length));
  setup.setOptimizationObjective(objective);
  setup.setPlanner(std::make_shared<og::RRTstar>(setup.getSpaceInformation()));
  setup.setup();
  const double start = now_ms();
  setup.solve(limit_s);
  const double seconds = ms_since(start) / 1000;
  return {seconds, setup.haveExactSolutionPath() ? setup.getSolutionPath().length() : INFINITY};
}
#endif

/// Cells, search and smoothing; then RRT* on the first three maps until it has a way as short, 3 s at most each.
void route_plan_among_discs(benchmark::State& bench) {
  Random random(1);
  std::vector<HazardMap> maps;
  for (int i = 0; i < kMaps; ++i) maps.emplace_back(discs(random));
  std::vector<double> times, lengths(maps.size(), 0);
  std::size_t next = 0;
  for (auto _ : bench) {
    const double start = now_ms();
    const std::size_t i = next++ % maps.size();
    const auto path = plan_route(maps[i], across(), shortest());
    times.push_back(ms_since(start));
    lengths[i] = path ? path->length_m : 0;
  }
  bench.counters["median_ms"] = median(times);
#ifdef ISOBATH_HAS_OMPL
  std::vector<double> seconds, longer;
  int as_short = 0;
  for (std::size_t i = 0; i < 3 && lengths[i] > 0; ++i) {
    const auto [s, length] = rrt_star(maps[i], lengths[i], 3);
    seconds.push_back(s);
    longer.push_back(length / lengths[i]);
    as_short += length <= lengths[i];
  }
  bench.counters["rrtstar_s"] = median(seconds);
  bench.counters["rrtstar_as_short_of_3"] = as_short;
  bench.counters["rrtstar_length_ratio"] = median(longer);
  bench.counters["rrtstar_time_ratio"] = 1000 * median(seconds) / median(times);
#endif
}
BENCHMARK(route_plan_among_discs)->Unit(benchmark::kMillisecond)->Iterations(2 * kMaps);

void route_conflict(benchmark::State& bench) {
  Random random(2);
  const HazardMap map(outlines(random, 500, 100));
  std::vector<std::vector<Vector2d>> ways;
  for (int i = 0; i < 64; ++i) {
    std::vector<Vector2d> way;
    for (int k = 0; k < 11; ++k) {
      const double y = random.uniform(-3, 3);
      way.emplace_back(-100 + 20.0 * k, 300 * (i % 2) + y);  // every second one passes all at a distance
    }
    ways.push_back(way);
  }
  std::size_t next = 0;
  for (auto _ : bench) benchmark::DoNotOptimize(map.conflict(ways[next++ % ways.size()], 3.5));
}
BENCHMARK(route_conflict)->Unit(benchmark::kMicrosecond);

/// Every leg is looked at to its end.
void route_clear_way(benchmark::State& bench) {
  Random random(2);
  const HazardMap map(outlines(random, 500, 100));
  std::vector<Vector2d> way;
  for (int k = 0; k < 11; ++k) way.emplace_back(-100 + 20.0 * k, 7 * (k % 2));
  for (auto _ : bench) {
    double least = INFINITY;
    for (std::size_t i = 1; i < way.size(); ++i) least = std::min(least, map.leg_distance(way[i - 1], way[i]));
    benchmark::DoNotOptimize(least);
  }
}
BENCHMARK(route_clear_way)->Unit(benchmark::kMicrosecond);

/// From 500 outlines to a way over 100 m at 0.5 m, with a turning radius: what a scan costs that asks for another way.
void route_replan(benchmark::State& bench) {
  Random random(3);
  std::vector<std::vector<Hazard>> scans;
  for (int i = 0; i < kMaps; ++i) scans.push_back(outlines(random, 500, 100));
  RouteConfig config;
  config.cell_m = 0.5;
  config.clearance_m = 1;
  config.wished_clearance_m = 3;
  RouteTask task;
  task.goal = {100, 0};
  task.heading = 0;
  task.turning_radius_m = static_cast<double>(bench.range(0));
  std::vector<double> times;
  double ways = 0;
  std::size_t next = 0;
  for (auto _ : bench) {
    const double start = now_ms();
    const HazardMap map(scans[next++ % scans.size()]);
    ways += plan_route(map, task, config).has_value();
    times.push_back(ms_since(start));
  }
  bench.counters["median_ms"] = median(times);
  bench.counters["worst_ms"] = *std::max_element(times.begin(), times.end());
  bench.counters["ways_share"] = ways / static_cast<double>(times.size());
}
BENCHMARK(route_replan)->ArgName("radius")->Arg(0)->Arg(3)->Arg(8)->Unit(benchmark::kMillisecond);

void hazard_map_of_500(benchmark::State& bench) {
  Random random(3);
  const std::vector<Hazard> hazards = outlines(random, 500, 100);
  for (auto _ : bench) benchmark::DoNotOptimize(HazardMap(hazards));
}
BENCHMARK(hazard_map_of_500)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isobath
