// A map and its mapper over charted or uncharted water, for tests.
#pragma once

#include <isobath/perception/depth_mapper.hpp>
#include <memory>
#include <tests/perception/first_echo.hpp>
#include <vector>

namespace isobath::test {

struct Rig {
  DepthMapConfig map_config;
  DepthMapperParts parts;
  double charted_m = 0;  ///< everywhere; 0: uncharted
  struct Patch {
    double north, east, side, depth_m;
  };
  std::vector<Patch> patches;  ///< charted otherwise; north-west corner and side, m
  Eigen::Vector2d start{0, 0};
  std::unique_ptr<DepthMap> map;
  std::unique_ptr<DepthMapper> mapper;

  Rig() {
    // One reading is one reading, unless a test asks for more.
    parts.mapper.prefilter = parts.mapper.quarantine = false;
    map_config.area_m = 256;
  }

  void build() {
    const DepthArea area = area_of(map_config);
    RegionQuadtree prior(area.levels, 0), state(area.levels, 0);
    const std::uint32_t base = DepthPixel::word_of_state(parts.rules.base_prior, 0, 0);
    if (charted_m > 0) {
      prior.fill(prior.square(), DepthPixel::word_of_depth(charted_m));
      state.fill(state.square(), base);
    }
    for (const Patch& p : patches) {
      const Pixel corner = area.grid.at({p.north, p.east});
      const int side = static_cast<int>(std::lround(p.side / area.grid.pixel_m));
      prior.fill({corner.column, corner.row, side, side}, DepthPixel::word_of_depth(p.depth_m));
      state.fill({corner.column, corner.row, side, side}, base);
    }
    map = std::make_unique<DepthMap>(map_config, area, DepthTrees(std::move(prior), std::move(state)), start);
    mapper = std::make_unique<DepthMapper>(*map, parts, Time{});
  }

  [[nodiscard]] DepthPixel at(double north, double east) const {
    return map->snapshot()->at(map->grid().at({north, east}));
  }
  [[nodiscard]] double depth(double north, double east) const { return at(north, east).depth_m(); }
};

inline Pose at(double north, double east, double depth, double heading = 0, double pitch = 0, double roll = 0) {
  return {Rotation::from_heading_pitch_roll(Angle::degrees(heading), Angle::degrees(pitch), Angle::degrees(roll)),
          {north, east, depth}};
}

/// A sonar that looks `depression` degrees down and `azimuth` degrees to starboard; 90: straight down.
inline RangeReading looking(double depression, double width, double azimuth = 0) {
  RangeReading reading;
  reading.max_range_m = 50;
  reading.width = Angle::degrees(width);
  reading.X_BS.rotation =
      Rotation::from_heading_pitch_roll(Angle::degrees(azimuth), Angle::degrees(-depression), Angle());
  return reading;
}

inline RangeReading with_range(RangeReading reading, std::optional<double> range_m, double time_s = 0) {
  reading.range_m = range_m;
  reading.time = Time{} + seconds(time_s);
  return reading;
}

/// What this sonar hears of this world.
template <class World>
RangeReading heard(const World& world, RangeReading sonar, const Pose& X_WB, double time_s = 0) {
  return with_range(sonar, first_echo(world, X_WB * sonar.X_BS, sonar.width / 2, sonar.max_range_m), time_s);
}

}  // namespace isobath::test
