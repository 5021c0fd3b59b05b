// Readings into the spherical grid: densities by numerical integrals, states by hand, and grids of two resolutions.
#include <algorithm>
#include <cmath>
#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <map>
#include <numbers>
#include <tests/support/directions.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using test::kRadiansADegree, test::towards;

SphericalLook beam_look(const Vector3d& u, std::optional<double> range, double t = 0) {
  return {Vector3d::Zero(), u, Angle::degrees(2.5), range, 50, Time{} + seconds(t)};
}
double occupancy_at(const SphericalGrid& grid, const Vector3d& p) {
  return 1 / (1 + std::exp(-grid.log_odds(*grid.place_at(grid.to_table(p)))));
}

// Across north, and at 60 degrees of elevation, where the beam is as round. ledger: S4-25 S4-26 S4-E06
TEST(ReadingGaussian, FallsWithRangeAndTheGreatCircleToTheMiddleOfACell) {
  SphericalGrid grid;
  for (const Vector3d& axis : {towards(0.3, 1), towards(40, 60)}) {
    const ReadingGaussian reading{axis, 20, 1, 5 * kRadiansADegree};
    std::vector<TouchedCell> touched;
    touched_cells(grid, reading, 2, 100'000, touched);
    EXPECT_GT(touched.size(), 200u);
    for (const TouchedCell& cell : touched) {
      const Vector3d p = grid.middle_in_table(cell.place);
      const double off = std::atan2(axis.cross(p).norm(), axis.dot(p)) / reading.sigma_rad;
      EXPECT_NEAR(cell.response, std::exp(-0.5 * (std::pow(p.norm() - 20, 2) + off * off)), 0.01);
    }
  }
}

// ledger: S4-28
TEST(ReadingGaussian, TouchesCellsUpToItsFactorAndNoFurther) {
  SphericalGrid grid;
  std::vector<TouchedCell> touched;
  const Vector3d axis = towards(31.25, 1.25);  // the middle of a bucket
  for (const double sigmas : {1.9, 2.1}) {
    // the side of the next bucket stands off by 1.25 degrees, the next layer's by so many deviations
    const ReadingGaussian in_angle{axis, 2.025, 1e-3, 1.25 * kRadiansADegree / sigmas};
    touched_cells(grid, in_angle, 2, 1000, touched);
    EXPECT_EQ(touched.size(), sigmas < 2 ? 9u : 1u) << sigmas;
    const ReadingGaussian in_range{axis, 2.025, 0.075 / sigmas, 0.1 * kRadiansADegree};
    touched_cells(grid, in_range, 2, 1000, touched);
    EXPECT_EQ(touched.size(), sigmas < 2 ? 3u : 1u) << sigmas;
  }
  const ReadingGaussian wide{axis, 20, 1, 5 * kRadiansADegree};
  touched_cells(grid, wide, 2, 40, touched);
  EXPECT_EQ(touched.size(), 40u);
  double least = 1;
  for (const TouchedCell& cell : touched) least = std::min(least, cell.mass);
  std::vector<TouchedCell> all;
  touched_cells(grid, wide, 2, 10'000, all);
  EXPECT_EQ(std::count_if(all.begin(), all.end(), [&](const auto& c) { return c.mass > least; }), 39)
      << "those of the greatest mass";
}

// ledger: S4-28 S4-50
TEST(ReadingGaussian, MassesOfCellsAreWhatSamplingGivesThem) {
  SphericalGrid grid;
  Random random(3);
  for (const double elevation : {0.0, 33.0, -60.0, 84.0}) {
    const Vector3d axis = towards(77.7, elevation);
    const ReadingGaussian reading{axis, 30, 0.3, 1.06 * kRadiansADegree};
    std::vector<TouchedCell> touched;
    touched_cells(grid, reading, 5, 100'000, touched);
    std::map<SphericalPlace, int> drawn;
    constexpr int kDraws = 40'000;
    const Vector3d east = Vector3d::UnitZ().cross(axis).normalized(), up = axis.cross(east);
    for (int i = 0; i < kDraws; ++i) {
      const double x = reading.sigma_rad * random.normal();
      const double y = reading.sigma_rad * random.normal();
      const double r = 30 + 0.3 * random.normal();
      const Vector3d u = (axis + x * east + y * up).normalized();
      ++drawn[*grid.place_at(r * u)];
    }
    double sum = 0;
    for (const TouchedCell& cell : touched) {
      sum += cell.mass;
      const double share = drawn[cell.place] / static_cast<double>(kDraws);
      EXPECT_NEAR(cell.mass, share, 0.012) << elevation;
    }
    EXPECT_NEAR(sum, 1, 0.01) << elevation;
  }
}

// ledger: S4-27 S4-E04 S4-E08
TEST(SphericalMapper, ByTheLargestResponseStatesNeverFallNorRiseByRepetition) {
  SphericalMapperConfig config;
  config.rule = SphericalMapperConfig::Rule::kMaximumResponse;
  SphericalGridConfig no_locks;
  no_locks.lock_echoes = 0;
  SphericalGrid grid(no_locks);
  SphericalMapper mapper(config, grid);
  const Vector3d u = towards(31.25, 1.25);
  mapper.add(beam_look(u, 10));
  const auto states = [&] {
    std::vector<float> all;
    grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
      for (const SphericalCell& cell : beam) all.push_back(cell.log_odds);
    });
    return all;
  };
  const auto before = states();
  const SphericalPlace place = *grid.place_at(10 * u);
  const double middle = grid.layers().middle(place.layer);
  EXPECT_NEAR(occupancy_at(grid, 10 * u), std::exp(-0.5 * std::pow((middle - 10) / 0.15, 2)), 1e-4)
      << "at the cell's middle, relative to the peak";
  mapper.add(beam_look(u, 10));
  EXPECT_EQ(states(), before);
  mapper.add(beam_look(u, 25));  // through it
  mapper.add(beam_look(u, std::nullopt));
  EXPECT_GE(occupancy_at(grid, 10 * u), std::exp(-0.5 * std::pow((middle - 10) / 0.15, 2)) - 1e-4)
      << "it can never clear a cell";
}

// ledger: S4-27
TEST(SphericalMapper, ByTheLargestResponseNoStateOfAnyCellEverFalls) {
  SphericalMapperConfig config;
  config.rule = SphericalMapperConfig::Rule::kMaximumResponse;
  SphericalGrid grid;  // with locks: they raise nothing
  SphericalMapper mapper(config, grid);
  Random random(8);
  std::map<SphericalPlace, float> states;
  const auto look_again = [&](bool repeated) {
    std::size_t seen = 0;
    grid.cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
      for (const SphericalCell& cell : beam) {
        const auto [known, is_new] = states.try_emplace({d, cell.layer}, cell.log_odds);
        ASSERT_FALSE(repeated && is_new);
        ASSERT_TRUE(!repeated || cell.log_odds == known->second);
        ASSERT_GE(cell.log_odds, known->second);
        known->second = cell.log_odds;
        ++seen;
      }
    });
    ASSERT_EQ(seen, states.size()) << "none is gone";
  };
  for (int i = 0; i < 200; ++i) {
    const double azimuth = random.uniform(-20, 20);
    const double elevation = random.uniform(-10, 10);
    const double range = random.uniform(5, 20);
    const bool silent = random.uniform() < 0.2;
    const SphericalLook look = beam_look(towards(azimuth, elevation), silent ? std::nullopt : std::optional(range));
    mapper.begin_scan();
    mapper.add(look);
    look_again(false);
    mapper.add(look);
    look_again(true);
  }
  EXPECT_GT(states.size(), 1000u);
}

// ledger: S4-50 S4-E08
TEST(SphericalMapper, ByLogOddsEchoesRaiseAndClearWaterLowers) {
  SphericalGrid grid;
  SphericalMapper mapper({}, grid);
  const Vector3d u = towards(31.25, 1.25);
  mapper.add(beam_look(u, 10));
  const double once = occupancy_at(grid, 10 * u);
  mapper.add(beam_look(u, 10));
  const double twice = occupancy_at(grid, 10 * u);
  EXPECT_GT(once, 0.05);
  EXPECT_GT(twice, once);
  // Lambda = Lambda_0 + kappa m, twice; m by a plain integral of the cell
  const SphericalPlace place = *grid.place_at(10 * u);
  const auto phi = [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); };
  const double s = 2.5 * kRadiansADegree / 2.355, w = 1.25 * kRadiansADegree;
  const double mass =
      (phi((grid.layers().outer(place.layer) - 10) / 0.15) - phi((grid.layers().inner(place.layer) - 10) / 0.15)) *
      std::pow(phi(w / s) - phi(-w / s), 2);
  EXPECT_NEAR(twice, 1 - 0.99 * std::exp(2 * std::log(0.1) * mass), 2e-3);
  for (int i = 0; i < 20; ++i) mapper.add(beam_look(u, 25));
  EXPECT_LT(occupancy_at(grid, 10 * u), 0.01);
  EXPECT_TRUE(grid.was_clear(20 * u));
  EXPECT_FALSE(grid.was_clear(26 * u));
}

// ledger: S4-50
TEST(SphericalMapper, SaysTheSameAtAnyResolution) {
  SphericalMapperConfig config;
  config.max_cells = 10'000;
  config.mask = 4;
  std::vector<double> numbers;
  for (const double bucket : {5.0, 2.5, 1.0}) {
    SphericalGridConfig grid_config;
    grid_config.bucket = Angle::degrees(bucket);
    grid_config.prior = 1e-6;
    SphericalGrid grid(grid_config);
    SphericalMapper mapper(config, grid);
    for (int i = 0; i < 3; ++i) mapper.add(beam_look(towards(33, 2), 18 + 0.1 * i));
    mapper.add(beam_look(towards(33, 2), 30));  // past it: mostly a pass
    double number = 0;
    grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
      for (const SphericalCell& cell : beam) {
        const double r = grid.point_of(cell).norm();
        if (r < 22) number -= std::log1p(-SphericalGrid::probability(cell));
      }
    });
    numbers.push_back(number);
  }
  EXPECT_NEAR(numbers[1], numbers[2], 0.05 * numbers[2]);
  const double merged_fine = 1 - std::exp(-numbers[2]), merged_coarse = 1 - std::exp(-numbers[0]);
  EXPECT_NEAR(merged_coarse, merged_fine, 0.05 * merged_fine);
}

// ledger: S4-50 S4-F05
TEST(SphericalMapper, WhatMovedAwayFadesToThePriorWithItsTime) {
  SphericalMapperConfig config;
  config.tau_s = 20;
  SphericalGrid grid;
  SphericalMapper mapper(config, grid);
  const Pose still;
  const auto reading = [&](double t, const Angle& heading) {
    RangeReading r;
    r.time = Time{} + seconds(t);
    r.range_m = 15;
    r.max_range_m = 40;
    r.width = Angle::degrees(2.5);
    r.X_BS.rotation = Rotation::from_heading(heading);
    mapper.update(r, still);
  };
  for (int i = 0; i < 5; ++i) reading(0, Angle::degrees(10));
  const Vector3d p = 15 * towards(80, 0.01);
  const double l0 = grid.prior_log_odds(), before = grid.log_odds(*grid.place_at(p)) - l0;
  for (double t = 0.5; t <= 20; t += 0.5) reading(t, Angle::degrees(100));  // it is elsewhere
  EXPECT_NEAR((grid.log_odds(*grid.place_at(p)) - l0) / before, std::exp(-1), 0.02);
  for (double t = 20; t <= 200; t += 1) reading(t, Angle::degrees(100));
  EXPECT_TRUE(grid.is_empty(p)) << "and is forgotten";
}

// ledger: S4-19 S4-20 S4-02
TEST(SphericalMapper, PutsAnEchoDueNorthAt90DegreesAndATargetAheadTooIfTheCourseIsUp) {
  using Axes = SphericalMapperConfig::Axes;
  for (const double heading : {0.0, 77.0, 260.0}) {
    for (const Axes axes : {Axes::kNorthUp, Axes::kCourseUp}) {
      SphericalMapperConfig config;
      config.axes = axes;
      SphericalGrid grid;
      SphericalMapper mapper(config, grid);
      RangeReading reading;
      reading.range_m = 12;
      reading.max_range_m = 40;
      reading.width = Angle::degrees(2.5);
      const Angle bearing = axes == Axes::kNorthUp ? Angle::degrees(-heading) : Angle{};
      reading.X_BS.rotation = Rotation::from_heading(bearing);
      mapper.update(reading, {Rotation::from_heading(Angle::degrees(heading)), {5, 6, 7}});
      EXPECT_FALSE(grid.is_empty({0.01, 1, 0.01})) << heading;
      EXPECT_TRUE(grid.is_empty({1, 0, 0}));
    }
  }
}

// ledger: S4-01
TEST(SphericalMapper, AWallPassedEarlierIsStillThereAtTheRightPlace) {
  SphericalGrid grid;
  SphericalMapper mapper({}, grid);
  Pose X_WB;
  X_WB.translation = {0, 0, 10};
  for (int i = 0; i < 300; ++i) {  // 30 m to the north, a wall 8 m to starboard over the first 10
    X_WB.translation.x() = 0.1 * i;
    RangeReading reading;
    reading.time = Time{} + seconds(0.1 * i);
    if (X_WB.translation.x() < 10) reading.range_m = 8;
    reading.max_range_m = 30;
    reading.width = Angle::degrees(2.5);
    reading.X_BS.rotation = Rotation::from_heading(Angle::degrees(90));
    mapper.update(reading, X_WB);
  }
  std::uint32_t echoes = 0;
  std::vector<std::pair<Vector3d, double>> occupied;
  grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      echoes += cell.echoes;
      if (cell.echoes == 0 || SphericalGrid::probability(cell) < grid.config().occupied) continue;
      const Vector3d p = world_from_grid_axes(grid.point_of(cell)) + X_WB.translation;
      const double cell_m = grid.layers().thickness(cell.layer);
      EXPECT_NEAR(p.y(), 8, cell_m);
      EXPECT_GT(p.x(), -cell_m);
      EXPECT_LT(p.x(), 10 + cell_m);
      EXPECT_NEAR(p.z(), 10, cell_m);
      occupied.emplace_back(p, cell_m);
    }
  });
  EXPECT_EQ(echoes, 100u) << "all that it was heard by";
  // 10 m of wall, 21 to 30 m astern by now, in cells of 0.9 to 1.3 m: all of it, and no more than one row of them
  for (double x = 0; x < 10; x += 0.25) {
    EXPECT_TRUE(std::any_of(occupied.begin(), occupied.end(),
                            [&](const auto& cell) { return (cell.first - Vector3d(x, 8, 10)).norm() < cell.second; }))
        << "a hole at " << x;
  }
  EXPECT_LE(occupied.size(), 2u * 12u) << "ten metres of cells, in the rows above and below the level";
}

// ledger: S4-06
TEST(SphericalMapper, AScanStoresNoMoreThanItsMasks) {
  SphericalMapperConfig config;
  config.max_cells = 27;
  SphericalGrid grid;
  SphericalMapper mapper(config, grid);
  const std::size_t empty = grid.bytes();
  EXPECT_LT(empty, 10'000u) << "nothing is stored before there is something";
  for (int i = 0; i < 144; ++i) mapper.add(beam_look(towards(2.5 * i + 1.25, 1.25), 20 + 5 * std::sin(0.3 * i)));
  EXPECT_LE(grid.cells().size(), 144u * 27u);
  EXPECT_GT(grid.cells().size(), 144u);
  EXPECT_LT(static_cast<double>(grid.cells().bytes()), 200.0 * static_cast<double>(grid.cells().size()) + 2e5);
}

// ledger: S4-05 S4-36 S4-E01
TEST(SphericalMapper, AGridFollowsFromItsSonar) {
  const SphericalGridConfig fine = grid_for(listed_resolution("em_1000_shallow"));
  const SphericalGridConfig coarse = grid_for(listed_resolution("wesmar_ss150"));
  EXPECT_NEAR(fine.bucket.degrees(), 2.5, 1e-12);
  EXPECT_LE(coarse.bucket.degrees(), 6.5);
  EXPECT_GT(coarse.bucket.degrees(), 6);
  EXPECT_EQ(coarse.min_layer_m, 0.5);
  EXPECT_EQ(SphericalGrid(coarse).buckets().azimuths() % 2, 0);
  const SonarResolution em = listed_resolution("em_1000_shallow");
  EXPECT_NEAR(em.beams * em.beam_spacing.degrees(), 150, 1e-9) << "50 is a slip";
  EXPECT_EQ(coarser_than_sonar(fine, em), "");
  EXPECT_THAT(coarser_than_sonar(coarse, em), testing::HasSubstr("thicker"));
  SphericalGridConfig wide = fine;
  wide.bucket = Angle::degrees(5);
  EXPECT_THAT(coarser_than_sonar(wide, em), testing::HasSubstr("wider"));
  EXPECT_THROW((void)listed_resolution("sonar"), Error);
}

// ledger: S4-01
TEST(SphericalMapper, TakesTheNearestEchoOfEachBeamOfAPing) {
  auto fan = std::make_shared<BeamFan>();
  for (int b = 0; b < 20; ++b) {
    fan->azimuth.push_back(Angle::degrees(-25 + 2.5 * b));
    fan->width.push_back(Angle::degrees(2.5));
  }
  Ping ping;
  ping.fan = fan;
  ping.window = {0, 0.1, 300};
  EchoDecisions decisions;
  decisions.reset(20, 300);
  decisions.p_detect.assign(300, 0.8f);
  decisions.set_hit(4, 150);
  decisions.set_hit(4, 250);
  decisions.set_hit(9, 20);
  decisions.set_unusable(20);
  SphericalGrid grid;
  SphericalMapper mapper({}, grid);
  mapper.update(ping, decisions, Pose{});
  int echoes = 0;
  grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      if (cell.echoes == 0) continue;
      ++echoes;
      EXPECT_LT((grid.point_of(cell) - 15.05 * towards(90 + 15, 0)).norm(), 0.3);
    }
  });
  EXPECT_EQ(echoes, 1);
  EXPECT_TRUE(grid.was_clear(29 * towards(90, 0.1)));
}

// A vehicle that pitches tilts its beams, not the grid: what it hears ahead stays where it is. ledger: S4-22 S4-E05
TEST(SphericalMapper, PitchTiltsTheBeamsAndNotTheGrid) {
  auto fan = std::make_shared<BeamFan>();
  fan->azimuth.emplace_back();
  fan->width.push_back(Angle::degrees(2.5));
  Ping ping;
  ping.fan = fan;
  ping.window = {0, 0.1, 300};
  EchoDecisions decisions;
  decisions.reset(1, 300);
  decisions.p_detect.assign(300, 0.8f);
  decisions.set_hit(0, 150);
  SphericalGrid grid;
  SphericalMapper mapper({}, grid);
  const auto pitched = [](double degrees) {
    return Rotation::from_heading_pitch_roll({}, Angle::degrees(degrees), {});
  };
  for (const double pitch : {-20.0, 0.0, 20.0}) {
    ping.X_BS.rotation = pitched(-pitch);  // the head keeps its bearing to the target
    mapper.update(ping, decisions, Pose{pitched(pitch), Vector3d::Zero()});
  }
  std::uint32_t echoes = 0;
  grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      if (cell.echoes == 0) continue;
      EXPECT_LT((grid.point_of(cell) - 15.05 * towards(90, 0)).norm(), 0.3);
      echoes += cell.echoes;
    }
  });
  EXPECT_EQ(echoes, 3u);
}

/// A ping of narrow beams 0.5 degrees apart, ahead, to 30 m.
struct NarrowBeams {
  Ping ping;
  EchoDecisions decisions;
  NarrowBeams() {
    auto fan = std::make_shared<BeamFan>();
    for (int b = 0; b < 5; ++b) {
      fan->azimuth.push_back(Angle::degrees(-1 + 0.5 * b));
      fan->width.push_back(Angle::degrees(0.5));
    }
    ping.fan = fan;
    ping.window = {0, 0.1, 300};
    decisions.reset(5, 300);
    decisions.p_detect.assign(300, 0.8f);
  }
  [[nodiscard]] std::uint64_t echoes_in(SphericalGrid& grid, SphericalMapper& mapper) const {
    mapper.update(ping, decisions, Pose{});
    std::uint64_t echoes = 0;
    grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
      for (const SphericalCell& cell : beam) echoes += cell.echoes;
    });
    return echoes;
  }
};

// ledger: S4-05
TEST(SphericalMapper, TakesBeamsThatAreNarrowerThanADirectionTogether) {
  NarrowBeams heard;
  for (int b = 0; b < 5; ++b) heard.decisions.set_hit(b, 150 + 10 * b);
  SphericalGrid grid;
  SphericalMapper mapper({}, grid);
  EXPECT_EQ(heard.echoes_in(grid, mapper), 1u) << "the nearest one";
  EXPECT_TRUE(grid.was_clear(14 * towards(90, 0)));
  EXPECT_FALSE(grid.was_clear(16 * towards(90, 0)));
}

// Behind bins that tell nothing the water may hold an echo, but it is not clear.
// ledger: S4-50
TEST(SphericalMapper, CallsWaterClearOnlyAsFarAsABeamTells) {
  NarrowBeams heard;
  for (int bin = 100; bin < 120; ++bin) heard.decisions.set_unusable(bin);
  heard.decisions.set_hit(2, 200);
  SphericalGrid grid;
  SphericalMapper mapper({}, grid);
  EXPECT_EQ(heard.echoes_in(grid, mapper), 1u);
  EXPECT_TRUE(grid.was_clear(9 * towards(90, 0)));
  EXPECT_FALSE(grid.was_clear(11 * towards(90, 0))) << "not heard";
  EXPECT_FALSE(grid.was_clear(15 * towards(90, 0))) << "behind it";

  NarrowBeams far;
  for (int bin = 0; bin < 100; ++bin) far.decisions.set_unusable(bin);
  SphericalGrid unheard;
  SphericalMapper mapper_of_it({}, unheard);
  (void)far.echoes_in(unheard, mapper_of_it);
  EXPECT_FALSE(unheard.was_clear(6 * towards(90, 0))) << "no blind zone is that long";
}

}  // namespace
}  // namespace isobath
