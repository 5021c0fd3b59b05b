// The depth map at work, beside a plain array (ledger S1-31, S1-70, S1-71; design, section 13): readings through the
// whole mapper, shifts of the window, readings while one runs beside them, and what size costs.
#include <algorithm>
#include <benchmark/benchmark.h>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <isobath/base/random.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/perception/depth_mapper.hpp>
#include <memory>
#include <string>
#include <vector>

namespace isobath {
namespace {

using Clock = std::chrono::steady_clock;

/// Of this thread alone: what it works, not what it waits for a processor that others have.
double worked_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

double microseconds(Clock::duration spent) { return std::chrono::duration<double, std::micro>(spent).count(); }

/// Ground that differs from pixel to pixel by centimetres, as it does.
double ground(double north, double east) {
  const double fine = std::sin(12.9898 * north + 78.233 * east) * 43758.5453;
  return 15 + 4 * std::sin(north / 70) + 3 * std::cos(east / 45) + 0.1 * (fine - std::floor(fine));
}

RangeReading looking(double depression, double azimuth, double width, std::optional<double> range_m) {
  RangeReading reading;
  reading.range_m = range_m;
  reading.max_range_m = 60;
  reading.width = Angle::degrees(width);
  reading.X_BS.rotation =
      Rotation::from_heading_pitch_roll(Angle::degrees(azimuth), Angle::degrees(-depression), Angle());
  return reading;
}

Pose level_at(double north, double east, double depth, double heading) {
  return {Rotation::from_heading(Angle::degrees(heading)), {north, east, depth}};
}

struct Vehicle {
  std::unique_ptr<DepthMap> map;
  std::unique_ptr<DepthMapper> mapper;

  /// Charted `depth_m` all over, 0: not at all.
  Vehicle(double area_m, double depth_m, bool background, const Eigen::Vector2d& start = {0, 0}) {
    DepthMapConfig config;
    config.area_m = area_m;
    const DepthArea area = area_of(config);
    DepthMapperParts parts;
    parts.mapper.prefilter = parts.mapper.quarantine = false;
    parts.mapper.background = background;
    RegionQuadtree prior(area.levels, 0), state(area.levels, 0);
    if (depth_m > 0) {
      prior.fill(prior.square(), DepthPixel::word_of_depth(depth_m));
      state.fill(state.square(), DepthPixel::word_of_state(parts.rules.base_prior, 0, 0));
    }
    map = std::make_unique<DepthMap>(config, area, DepthTrees(std::move(prior), std::move(state)), start);
    mapper = std::make_unique<DepthMapper>(*map, parts, Time{});
  }

  /// A swath of 64 m to each side, every pixel of it once.
  void survey(double north, double east) {
    static Swath swath;
    swath.frame = Swath::Frame::kLevel;
    swath.heading = Angle();
    swath.soundings.clear();
    for (double side = -64; side < 64; side += 0.5) {
      const auto z = static_cast<float>(ground(north, east + side));
      swath.soundings.push_back({{0, static_cast<float>(side), z}, std::hypot(static_cast<float>(side), z), 0.05F});
    }
    mapper->update(swath, level_at(north, east, 2, 0), 0);
  }
};

// The same reading on an array of doubles and bytes: which pixels, by the angle to the axis, and the rule. No trees, no
// window, no exact cone, no prediction.
struct PlainArray {
  static constexpr int kSide = 512;
  std::vector<double> depth = std::vector<double>(std::size_t{kSide} * kSide, 30);
  std::vector<std::uint8_t> confidence = std::vector<std::uint8_t>(std::size_t{kSide} * kSide, 5);

  int take(double north, double east, double z, double heading, double half_angle, double range) {
    const double reach = range + 1;
    const double a = heading - half_angle, b = heading + half_angle;
    const double n1 = north + reach * std::cos(a), e1 = east + reach * std::sin(a);
    const double n2 = north + reach * std::cos(b), e2 = east + reach * std::sin(b);
    const int first_row = static_cast<int>(2 * (128 - std::max({north, n1, n2})));
    const int last_row = static_cast<int>(2 * (128 - std::min({north, n1, n2})));
    const int first_column = static_cast<int>(2 * (128 + std::min({east, e1, e2})));
    const int last_column = static_cast<int>(2 * (128 + std::max({east, e1, e2})));
    const double cos_a = std::cos(half_angle), tan_a = std::tan(half_angle);
    int changed = 0;
    for (int row = std::max(first_row, 0); row <= std::min(last_row, kSide - 1); ++row) {
      for (int column = std::max(first_column, 0); column <= std::min(last_column, kSide - 1); ++column) {
        const double n = 128 - 0.5 * row - 0.25 - north, e = 0.5 * column + 0.25 - 128 - east;
        const double h = std::sqrt(n * n + e * e);
        if (h > reach || n * std::cos(heading) + e * std::sin(heading) < h * cos_a) continue;
        const std::size_t i = static_cast<std::size_t>(row) * kSide + static_cast<std::size_t>(column);
        const bool clear = h < range;
        const double bound = clear ? z + h * tan_a : std::max(0.0, z - h * tan_a);
        if (clear && depth[i] >= bound) continue;
        ++changed;
        if (!clear && depth[i] <= bound) {
          confidence[i] = static_cast<std::uint8_t>(std::min(confidence[i] + 1, 20));
        } else if (--confidence[i] < 2) {
          depth[i] = bound;
          confidence[i] = 6;
        }
      }
    }
    return changed;
  }
};

void PlainObstacleReading(benchmark::State& state) {
  PlainArray array;
  int i = 0;
  for (auto _ : state) {
    const double along = 0.01 * (i++ % 500);
    benchmark::DoNotOptimize(
        array.take(along, -along, 5, static_cast<double>(state.range(0)) * 0.0174532925, 0.0523598776, 50));
  }
}
BENCHMARK(PlainObstacleReading)->Arg(0)->Arg(45)->ArgName("heading");

// 50 m, 6 degrees, through the whole mapper. A bottom 60 m down is out of reach; one at 10 m, 5 m below, is in reach of
// the beam beyond 50 m only, and one at 7 m is what it hears at 38 m.
void ObstacleReading(benchmark::State& state) {
  Vehicle vehicle(8192, static_cast<double>(state.range(1)), false);
  const double heading = static_cast<double>(state.range(0));
  const RangeReading reading = looking(0, 0, 6, 49.9);
  int i = 0;
  for (auto _ : state) {
    const double along = 0.01 * (i++ % 500);
    vehicle.mapper->update(reading, level_at(along, -along, 5, heading), 0);
  }
}
BENCHMARK(ObstacleReading)->ArgsProduct({{0, 45}, {60, 10, 7}})->ArgNames({"heading", "bottom_m"});

void DepthReadingThroughMapper(benchmark::State& state) {
  const auto range = static_cast<double>(state.range(0));
  Vehicle vehicle(8192, 2 + range, false);
  const RangeReading reading = looking(90, 0, static_cast<double>(state.range(1)), range);
  int i = 0;
  for (auto _ : state) {
    const double along = 0.01 * (i++ % 500);
    vehicle.mapper->update(reading, level_at(along, -along, 2, 0), 0);
  }
}
BENCHMARK(DepthReadingThroughMapper)
    ->Args({5, 3})
    ->Args({20, 3})
    ->Args({49, 3})
    ->Args({49, 6})
    ->ArgNames({"range_m", "width"});

// 64 m and back over ground that is sensed everywhere, alike nowhere.
void WindowShift(benchmark::State& state) {
  Vehicle vehicle(2048, 20, false);
  for (double north = -220; north <= 220; north += 0.5) {
    vehicle.mapper->passed(Time{}, level_at(north, 0, 2, 0));
    for (int again = 0; again < 3; ++again) {  // so that the chart yields everywhere
      vehicle.survey(north, -64);
      vehicle.survey(north, 64);
    }
  }
  bool out = false;
  double worst = 0;
  double rows = 0;
  for (auto _ : state) {
    // To and fro, with fresh readings all over what leaves.
    const double north = out ? 60 : -60;
    out = !out;
    for (double at = -128; at < 128; at += 0.5) {
      vehicle.survey(north + at, -64);
      vehicle.survey(north + at, 64);
    }
    const auto target = vehicle.map->wanted({-north, 0});
    if (!target) {
      state.SkipWithError("no shift is due");
      break;
    }
    rows += 32.0 * std::abs(vehicle.map->window().first_tile().row - target->row);
    const auto begin = Clock::now();
    const auto shift = vehicle.map->begin_shift(*target);
    shift->run();
    vehicle.map->finish_shift(*shift);
    const double spent = microseconds(Clock::now() - begin);
    state.SetIterationTime(1e-6 * spent);
    worst = std::max(worst, spent);
  }
  state.counters["worst_us"] = worst;
  state.counters["rows"] = rows / static_cast<double>(state.iterations());
  state.counters["leaves"] = static_cast<double>(vehicle.map->trees().sensed().statistics().leaves);
}
BENCHMARK(WindowShift)->Iterations(20)->UseManualTime()->Unit(benchmark::kMicrosecond);

void quantiles(benchmark::State& state, const std::string& name, std::vector<double>& took) {
  std::sort(took.begin(), took.end());
  const auto at = [&](double q) { return took[static_cast<std::size_t>(q * static_cast<double>(took.size() - 1))]; };
  state.counters[name + "_median_us"] = at(0.5);
  state.counters[name + "_p999_us"] = at(0.999);
  state.counters[name + "_worst_us"] = took.back();
}

// A run of 20 km at speed, with a shift in a thread of its own each 64 m: how long the caller is held by each reading
// and each fix that comes from when a shift begins until it is over, and by all others.
void ReadingBesideShifts(benchmark::State& state) {
  for (auto _ : state) {
    Vehicle vehicle(32768, 20, true, {-10000, 0});
    std::vector<double> beside, alone, beside_wall, alone_wall, fixes;
    const RangeReading ahead = looking(0, 0, 6, 49.9), down = looking(90, 0, 6, 15);
    std::uint64_t queued = 0, shifts = 0;
    for (double north = -10000; north < 10000; north += 0.45) {
      const Pose X_WB = level_at(north, 0.2 * std::sin(north), 5, 10 * std::sin(0.1 * north));
      const auto begin = Clock::now();
      for (const RangeReading& reading : {ahead, down}) {
        const auto wall = Clock::now();
        const double before = worked_us();
        vehicle.mapper->update(reading, X_WB, 0);
        const double spent = worked_us() - before;
        const bool during = vehicle.mapper->counts().queued > queued;
        queued = vehicle.mapper->counts().queued;
        (during ? beside : alone).push_back(spent);
        (during ? beside_wall : alone_wall).push_back(microseconds(Clock::now() - wall));
      }
      const double before = worked_us();
      vehicle.mapper->passed(Time{}, X_WB);
      if (vehicle.mapper->counts().shifts > shifts) fixes.push_back(worked_us() - before);
      shifts = vehicle.mapper->counts().shifts;
      queued = vehicle.mapper->counts().queued;
      while (Clock::now() - begin < std::chrono::microseconds(state.range(0))) {
      }
    }
    quantiles(state, "alone", alone);
    quantiles(state, "beside", beside);
    std::vector<double> all_wall = alone_wall;
    all_wall.insert(all_wall.end(), beside_wall.begin(), beside_wall.end());
    quantiles(state, "all_wall", all_wall);
    quantiles(state, "beside_wall", beside_wall);
    quantiles(state, "begin_shift", fixes);
    state.counters["shifts"] = static_cast<double>(shifts);
    state.counters["queued"] = static_cast<double>(queued);
  }
}
BENCHMARK(ReadingBesideShifts)->Arg(100)->Iterations(1)->Unit(benchmark::kSecond)->ArgName("pause_us");

// Areas of 1, 10 and 100 km with tracks through all of them: readings, shifts, snapshots, and the commit to disk.
void Growth(benchmark::State& state) {
  const double area = 1000.0 * static_cast<double>(state.range(0));
  for (auto _ : state) {
    Vehicle vehicle(area, 20, false);
    const double half = std::min(area, 60000.0) / 2 - 300;
    const RangeReading ahead = looking(0, 0, 6, 49.9);
    double readings = 0, shifts = 0, worst_shift = 0;
    std::uint64_t count = 0;
    for (double north = -half; north < half; north += 1.5) {
      const double depth = ground(north, 0);
      const Pose X_WB = level_at(north, 0, 2, 0);
      const auto begin = Clock::now();
      vehicle.mapper->update(ahead, X_WB, 0);
      vehicle.mapper->update(looking(90, 0, 6, depth - 2), X_WB, 0);
      const auto middle = Clock::now();
      vehicle.mapper->passed(Time{}, X_WB);
      readings += microseconds(middle - begin);
      if (vehicle.mapper->counts().shifts > count) {
        shifts += microseconds(Clock::now() - middle);
        worst_shift = std::max(worst_shift, microseconds(Clock::now() - middle));
      }
      count = vehicle.mapper->counts().shifts;
    }
    state.counters["reading_us"] = readings / (2 * half / 1.5) / 2;
    state.counters["shift_us"] = shifts / static_cast<double>(count);
    state.counters["worst_shift_us"] = worst_shift;
    state.counters["shifts"] = static_cast<double>(count);
    vehicle.mapper->finish();
    auto begin = Clock::now();
    benchmark::DoNotOptimize(vehicle.map->snapshot());
    state.counters["snapshot_us"] = microseconds(Clock::now() - begin);
    begin = Clock::now();
    vehicle.map->flush();
    state.counters["flush_us"] = microseconds(Clock::now() - begin);
    const RegionQuadtree::Statistics sensed = vehicle.map->trees().sensed().statistics();
    state.counters["MB"] = static_cast<double>(sensed.bytes + vehicle.map->trees().state().statistics().bytes) / 1e6;
    const auto folder = std::filesystem::temp_directory_path() / "isobath_depth_map_bench";
    std::filesystem::remove_all(folder);
    {
      MapFolder store(folder);
      MapFacts facts;
      facts.area = vehicle.map->area();
      begin = Clock::now();
      store.commit(facts, vehicle.map->trees());
      state.counters["commit_ms"] = microseconds(Clock::now() - begin) / 1000;
    }
    std::filesystem::remove_all(folder);
  }
}
BENCHMARK(Growth)->Arg(1)->Arg(10)->Arg(100)->Iterations(1)->Unit(benchmark::kSecond)->ArgName("area_km");

}  // namespace
}  // namespace isobath
