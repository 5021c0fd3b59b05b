// A lake with a chart, a vehicle with five forward sonars and one depth sonar (ledger S1-56), and a depth model that
// hears them: for tests of missions.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <isobath/io/gdal/geotiff.hpp>
#include <isobath/world/depth_model.hpp>
#include <tests/perception/mapper_rig.hpp>
#include <vector>

namespace isobath::test {

struct ChartedLake {
  static constexpr double kSide = 256;  ///< m, of the operational area
  static constexpr GeoOrigin kOrigin{47.5, 8.5};
  using World = std::function<double(double north, double east)>;

  std::filesystem::path chart;
  Configuration configuration;

  /// NaN: not charted.
  ChartedLake(const std::filesystem::path& folder, const World& charted) : chart(folder / "chart.tif") {
    configuration.depth_map.area_m = kSide;
    configuration.prior.reading.sign = PriorSign::kDown;
    configuration.prior.reading.datum_offset_m = {0};
    configuration.prior.reading.sigma_m = 0.1;
    configuration.prior.reading.sigma_share = 0;
    const PixelGrid grid = area_of(configuration.depth_map).grid;
    const int side = static_cast<int>(kSide / grid.pixel_m);
    std::vector<float> depths;
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < side; ++column) {
        const Eigen::Vector2d p = grid.centre({column, row});
        depths.push_back(static_cast<float>(charted(p.x(), p.y())));
      }
    }
    write_geotiff(chart, {side, side, grid.pixel_m, grid.corner_m, {}, {}}, {"depth", "m"}, depths);
  }

  void prepare(DepthModel& model) const {
    model.set_prior_files({chart.string()});
    model.locate(kOrigin);
  }

  static std::vector<RangeReading> sonars() {
    std::vector<RangeReading> all;
    for (const double azimuth : {-30.0, -15.0, 0.0, 15.0, 30.0}) all.push_back(looking(0, 6, azimuth));
    all.push_back(looking(90, 6));
    return all;
  }

  static std::vector<RangeReading> hear(const World& world, const Pose& X_WB) {
    std::vector<RangeReading> all = sonars();
    for (RangeReading& sonar : all) {
      sonar.range_m = first_echo(world, X_WB * sonar.X_BS, sonar.width / 2, sonar.max_range_m, 4, 12, 0.25);
    }
    return all;
  }

  static void give(DepthModel& model, std::vector<RangeReading> cycle, const Pose& X_WB, double time_s) {
    model.on_passage(Time{} + seconds(time_s), X_WB);
    for (RangeReading& reading : cycle) {
      reading.time = Time{} + seconds(time_s);
      model.on_range(reading, {X_WB, 0});
    }
  }

  /// Ahead at 1.5 m/s from `from` on, a cycle every 0.6 s. Returns how many cycles.
  static int swim(DepthModel& model, const World& world, const Pose& from, double metres, double start_s = 0) {
    int cycle = 0;
    for (; 0.9 * cycle <= metres + 1e-9; ++cycle) {
      const Pose X_WB = from * Pose{Rotation{}, {0.9 * cycle, 0, 0}};
      give(model, hear(world, X_WB), X_WB, start_s + 0.6 * cycle);
    }
    return cycle;
  }
};

/// Ground of one depth with square piles on it.
struct Pile {
  double north, east, half_m, top_m;
};
inline ChartedLake::World with_piles(double depth_m, const std::vector<Pile>& piles) {
  return [=](double north, double east) {
    for (const Pile& p : piles) {
      if (std::abs(north - p.north) <= p.half_m && std::abs(east - p.east) <= p.half_m) return p.top_m;
    }
    return depth_m;
  };
}

}  // namespace isobath::test
