// Triangulations of points that move, and paths among obstacles that move: operations a second, what a cycle of the
// path finder costs with 50 bodies of six corners, and how costs grow with the number of obstacles (ledger S3-31).
#include <benchmark/benchmark.h>
#include <cmath>
#include <ctime>
#include <isobath/base/random.hpp>
#include <isobath/geometry/dynamic_delaunay.hpp>
#include <isobath/geometry/kinetic_delaunay.hpp>
#include <isobath/geometry/triangulation.hpp>
#include <isobath/planning/roadmap/path_finder.hpp>
#include <isobath/planning/roadmap/visibility_graph.hpp>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace isobath {
namespace {

using Eigen::Vector2d;

/// CPU time of this thread: neighbours on the machine do not count.
double now_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Vector2d anywhere(Random& random, double half) { return {random.uniform(-half, half), random.uniform(-half, half)}; }

/// The exponent of a power law through times: least squares of the logarithms.
double exponent(const std::vector<std::pair<double, double>>& size_and_time) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const auto n = static_cast<double>(size_and_time.size());
  for (const auto& [size, time] : size_and_time) {
    x += std::log(size) / n;
    y += std::log(time) / n;
  }
  for (const auto& [size, time] : size_and_time) {
    xx += (std::log(size) - x) * (std::log(size) - x);
    xy += (std::log(size) - x) * (std::log(time) - y);
  }
  return xy / xx;
}

DynamicDelaunay filled(int count, Random& random) {
  DynamicDelaunay d(count);
  for (int i = 0; i < count; ++i) d.insert(anywhere(random, 1), i);
  return d;
}

/// Points at random, each located from the sample.
void DelaunayInsertion(benchmark::State& state) {
  Random random(1);
  for (auto _ : state) benchmark::DoNotOptimize(filled(static_cast<int>(state.range(0)), random));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(DelaunayInsertion)->RangeMultiplier(10)->Range(100, 100'000)->Unit(benchmark::kMillisecond);

/// Along a Hilbert curve, as Triangulation does.
void DelaunayOfAll(benchmark::State& state) {
  Random random(1);
  std::vector<Vector2d> points;
  for (int i = 0; i < 100'000; ++i) points.push_back(anywhere(random, 1));
  for (auto _ : state) benchmark::DoNotOptimize(Triangulation(points));
  state.SetItemsProcessed(state.iterations() * 100'000);
}
BENCHMARK(DelaunayOfAll)->Unit(benchmark::kMillisecond);

void DelaunayDeletionAndInsertion(benchmark::State& state) {
  Random random(2);
  DynamicDelaunay d = filled(10'000, random);
  for (auto _ : state) {
    const int id = static_cast<int>(random.index(10'000));
    d.remove(id);
    d.insert(anywhere(random, 1), id);
  }
}
BENCHMARK(DelaunayDeletionAndInsertion);

/// A hundredth of the distance to the neighbours each time.
void DelaunayMovement(benchmark::State& state) {
  Random random(3);
  DynamicDelaunay d = filled(10'000, random);
  for (auto _ : state) {
    const int id = static_cast<int>(random.index(10'000));
    d.move(id, d.at(id) + 2e-4 * anywhere(random, 1));
  }
}
BENCHMARK(DelaunayMovement);

/// Points in linear motion in a square, which turn back at its sides once a second.
void DelaunayFlips(benchmark::State& state) {
  Random random(4);
  const int count = static_cast<int>(state.range(0));
  KineticDelaunay kinetic(count);
  for (int i = 0; i < count; ++i) kinetic.insert(anywhere(random, 100), anywhere(random, 2), i);
  std::size_t flips = 0;
  for (auto _ : state) {
    kinetic.advance(kinetic.now_s() + 1);
    flips += kinetic.flips().size();
    for (int i = 0; i < count; ++i) {
      const Vector2d p = kinetic.triangulation().at(i);
      if (p.cwiseAbs().maxCoeff() > 100) kinetic.set_motion(i, p, 0.02 * (anywhere(random, 50) - p));
    }
  }
  state.counters["flips"] = benchmark::Counter(static_cast<double>(flips), benchmark::Counter::kIsRate);
  state.counters["repairs"] = static_cast<double>(kinetic.repairs());
}
BENCHMARK(DelaunayFlips)->Arg(300)->Arg(3000)->Unit(benchmark::kMillisecond);

struct Body {
  Vector2d at, velocity;
  double size, turned;
};

Polygon outline_of(const Body& body, int corners) {
  Polygon outline;
  for (int i = 0; i < corners; ++i) {
    const double angle = body.turned + 2 * std::numbers::pi * i / corners;
    outline.emplace_back(body.at + body.size * Vector2d(2 * std::cos(angle), std::sin(angle)));
  }
  return outline;
}

std::vector<Body> bodies_in(Random& random, int count, double half) {
  std::vector<Body> bodies;
  for (int i = 0; i < count; ++i) {
    bodies.push_back({anywhere(random, half), anywhere(random, 2), random.uniform(1, 3), random.uniform(0, 6)});
  }
  return bodies;
}

/// A cycle: 50 bodies of six corners move by half a second, then candidates across 200 m.
void PathFinderCycle(benchmark::State& state) {
  Random random(5);
  std::vector<Body> bodies = bodies_in(random, 50, 85);
  PathFinderConfig config;
  config.spacing_m = 0.1 * static_cast<double>(state.range(0));
  PathFinder finder(config);
  double updating = 0, finding = 0, paths = 0, refused = 0;
  for (auto _ : state) {
    for (Body& body : bodies) {
      body.at += 0.5 * body.velocity;
      for (int k = 0; k < 2; ++k) {
        if (std::abs(body.at[k]) > 85) body.velocity[k] = -std::copysign(body.velocity[k], body.at[k]);
      }
    }
    const double start = now_s();
    for (std::size_t i = 0; i < bodies.size(); ++i) finder.set_obstacle(static_cast<int>(i), outline_of(bodies[i], 6));
    const double middle = now_s();
    const auto found = finder.candidates({-98, 0}, {98, 0});
    finding += now_s() - middle;
    updating += middle - start;
    paths += found ? static_cast<double>(found->paths.size()) : 0;
    refused += found ? 0 : 1;
  }
  const auto n = static_cast<double>(state.iterations());
  state.counters["update_ms"] = 1e3 * updating / n;
  state.counters["candidates_ms"] = 1e3 * finding / n;
  state.counters["paths"] = paths / n;
  state.counters["refused"] = refused / n;
}
BENCHMARK(PathFinderCycle)->ArgName("spacing_dm")->Arg(10)->Arg(20)->Arg(40)->Unit(benchmark::kMillisecond);

/// Obstacles at the same density, whatever their number.
struct Field {
  Field(int count, int corners, bool enclosed) {
    Random random(6);
    const double half = 8 * std::sqrt(count);
    std::vector<GrownPart> parts;
    points.emplace(80 * count);
    for (const Vector2d& p : {Vector2d(-1, -1), Vector2d(1, -1), Vector2d(1, 1), Vector2d(-1, 1)}) {
      points->insert(1.5 * half * p, -1);
    }
    for (const Body& body : bodies_in(random, count, half)) {
      const Polygon outline = outline_of(body, corners);
      const Polygon shape = enclosed ? convex_enclosure(outline) : outline;
      const int label = static_cast<int>(parts.size());
      parts.push_back({label, label, shape, grown_polygon(shape, 2, 12)});
      for (std::size_t i = 0; i < shape.size(); ++i) {
        const Vector2d side = shape[(i + 1) % shape.size()] - shape[i];
        const double pieces = std::ceil(side.norm());
        for (double k = 0; k < pieces; ++k) points->insert(shape[i] + k / pieces * side, label);
      }
    }
    obstacles.emplace(std::move(parts));
    border = {Vector2d::Constant(-1.5 * half), Vector2d::Constant(1.5 * half)};
  }
  std::optional<DynamicDelaunay> points;
  std::optional<GrownObstacles> obstacles;
  Eigen::AlignedBox2d border;
};

/// Time of one call, the least of three.
template <class Work>
double time_of(const Work& work) {
  double least = INFINITY;
  for (int i = 0; i < 3; ++i) {
    const double start = now_s();
    work();
    least = std::min(least, now_s() - start);
  }
  return least;
}

/// Exponents of growth: time of one insertion among n points, of a road map and of a whole visibility graph of n
/// obstacles; and how much longer a road map takes with hulls of 24 corners than with their enclosures.
void RoadMapGrowth(benchmark::State& state) {
  for (auto _ : state) {
    std::vector<std::pair<double, double>> insertion, road_map, visibility;
    for (const int n : {1'000, 4'000, 16'000, 64'000}) {
      Random random(7);
      insertion.emplace_back(n, time_of([&] { benchmark::DoNotOptimize(filled(n, random)); }) / n);
    }
    for (const int n : {50, 100, 200, 400, 800}) {
      const Field field(n, 6, true);
      road_map.emplace_back(
          n, time_of([&] { benchmark::DoNotOptimize(RoadMap(*field.points, *field.obstacles, field.border)); }));
    }
    for (const int n : {50, 100, 200}) {
      const Field field(n, 6, true);
      visibility.emplace_back(n, time_of([&] {
                                const VisibilityGraph graph(*field.obstacles);
                                for (int i = 0; i < static_cast<int>(graph.nodes().size()); ++i) {
                                  benchmark::DoNotOptimize(graph.arcs_from(i));
                                }
                              }));
    }
    const auto with = [](bool enclosed) {
      return time_of([&] {
        const Field field(200, 24, enclosed);
        benchmark::DoNotOptimize(RoadMap(*field.points, *field.obstacles, field.border));
      });
    };
    state.counters["insertion"] = exponent(insertion);
    state.counters["road_map"] = exponent(road_map);
    state.counters["visibility"] = exponent(visibility);
    state.counters["road_map_800_ms"] = 1e3 * road_map.back().second;
    state.counters["visibility_200_ms"] = 1e3 * visibility.back().second;
    state.counters["hulls_to_enclosures"] = with(false) / with(true);
  }
}
BENCHMARK(RoadMapGrowth)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isobath
