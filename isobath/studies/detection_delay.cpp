#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/depth_mapper.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/detection_delay.hpp>
#include <memory>

namespace isobath {
namespace {

constexpr double kCharted_m = 30, kVehicle_m = 5, kSonarRange_m = 50, kBeam_deg = 6;
constexpr double kAxisFloor = 0.1;  // nothing below has a place on the logarithmic axis

/// Charted water and the mapper over it.
struct ChartedWater {
  std::unique_ptr<DepthMap> map;
  std::unique_ptr<DepthMapper> mapper;

  ChartedWater(int base, double area_m, double start_north, bool prefilter) {
    DepthMapConfig config;
    config.area_m = area_m;
    config.window_pixels = 256;
    DepthMapperParts parts;
    parts.mapper.prefilter = prefilter;
    parts.mapper.quarantine = false;
    parts.rules.base_prior = base;
    parts.rules.base_sensor = base + 1;
    const DepthArea area = area_of(config);
    RegionQuadtree prior(area.levels, 0), state(area.levels, 0);
    prior.fill(prior.square(), DepthPixel::word_of_depth(kCharted_m));
    state.fill(state.square(), DepthPixel::word_of_state(base, 0, 0));
    map = std::make_unique<DepthMap>(config, area, DepthTrees(std::move(prior), std::move(state)),
                                     Eigen::Vector2d(start_north, 0));
    mapper = std::make_unique<DepthMapper>(*map, parts, Time{});
  }
};

Pose level_at(double north) { return {Rotation(), {north, 0, kVehicle_m}}; }

RangeReading ahead(std::optional<double> range_m, double time_s) {
  RangeReading reading;
  reading.max_range_m = kSonarRange_m;
  reading.width = Angle::degrees(kBeam_deg);
  reading.range_m = range_m;
  reading.time = Time{} + seconds(time_s);
  return reading;
}

int readings_until_seen(int base, const DelayRequest& request, bool prefilter, double speed) {
  ChartedWater water(base, 128, 0, prefilter);
  const Pixel wall = water.map->grid().at({request.wall_m + 0.25, 0.1});
  int readings = 0;
  while (water.map->window().at(wall).depth_m() > 10 && readings < 1000) {
    const double time_s = DelayRequest::kCycle_s * readings++;
    const double left_m = request.wall_m - speed * time_s;
    water.mapper->update(ahead(left_m, time_s), level_at(speed * time_s), 0);
  }
  return readings;
}

/// Readings that put an obstacle into empty water, for 1000 readings.
double false_obstacles(int base, const DelayRequest& request, bool under_way, int seed) {
  const double reach_m = request.speed * DelayRequest::kCycle_s * request.readings;
  const double area_m = under_way ? std::exp2(std::ceil(std::log2(2 * reach_m))) : 128;
  const double start = under_way ? -0.5 * reach_m : 0;
  ChartedWater water(base, area_m, start, false);
  bool raised = false;
  water.mapper->on_change([&](const PixelChange& c) { raised |= c.after.depth_cm() < c.before.depth_cm(); });
  Random random(static_cast<std::uint64_t>(seed));
  int bad = 0;
  for (int i = 0; i < request.readings; ++i) {
    const double time_s = DelayRequest::kCycle_s * i;
    const Pose X_WB = level_at(start + (under_way ? request.speed * time_s : 0));
    if (under_way) water.mapper->passed(Time{} + seconds(time_s), X_WB);
    std::optional<double> echo;
    if (random.uniform() < request.spurious_share) {
      echo = random.uniform(request.nearest_false_m, request.farthest_false_m);
    }
    raised = false;
    water.mapper->update(ahead(echo, time_s), X_WB, 0);
    bad += raised;
  }
  return 1000.0 * bad / request.readings;
}

FalseObstacles over_seeds(int base, const DelayRequest& request, bool under_way) {
  FalseObstacles all{0, 1e9, 0};
  for (int seed = 1; seed <= request.seeds; ++seed) {
    const double one = false_obstacles(base, request, under_way, seed);
    all.mean += one / request.seeds;
    all.least = std::min(all.least, one);
    all.most = std::max(all.most, one);
  }
  return all;
}

}  // namespace

DetectionDelay measure_delay(int base, const DelayRequest& request) {
  return {base,
          readings_until_seen(base, request, false, 0),
          readings_until_seen(base, request, true, 0),
          readings_until_seen(base, request, true, request.speed),
          over_seeds(base, request, false),
          over_seeds(base, request, true)};
}

std::vector<DetectionDelay> measure_delays(const DelayRequest& request) {
  std::vector<DetectionDelay> rows;
  for (int base = request.from_base; base <= request.to_base; ++base) rows.push_back(measure_delay(base, request));
  return rows;
}

std::string delay_picture(const std::vector<DetectionDelay>& rows) {
  ChartPicture picture(720, 440, "Each reading of delay saves false obstacles",
                       {"delay until a wall stands in the map (s)", 0, 5, false},
                       {"false obstacles per 1000 readings", kAxisFloor, 100, true});
  const auto curve = [&](FalseObstacles DetectionDelay::*of, Colour colour, const std::string& name) {
    std::vector<double> x, y, low, high;
    for (const DetectionDelay& row : rows) {
      if ((row.*of).mean < kAxisFloor) continue;
      x.push_back(DelayRequest::kCycle_s * row.readings);
      y.push_back((row.*of).mean);
      low.push_back(std::max(kAxisFloor, (row.*of).least));
      high.push_back(std::max(kAxisFloor, (row.*of).most));
    }
    picture.band(x, low, high, {colour.red, colour.green, colour.blue, 0.15});
    picture.curve(x, y, {colour, 2, false}, name);
    picture.points(x, y, colour, "");
  };
  curve(&DetectionDelay::false_standing, palette::kObstacle, "standing still");
  curve(&DetectionDelay::false_under_way, palette::kTrack, "at 1.5 m/s");
  picture.finish();
  return picture.png();
}

}  // namespace isobath
