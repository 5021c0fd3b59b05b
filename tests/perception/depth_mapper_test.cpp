// The mapper of depths against a made-up world, whose echoes are found by brute force.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <limits>
#include <tests/perception/mapper_rig.hpp>
#include <tests/support/count_allocations.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180;

/// Half the height of a level cone of 10 degrees over the middle of a pixel whose centre is a quarter of a metre abeam.
double half_height(double ahead_m) { return std::sqrt(std::pow(ahead_m * std::tan(5 * kDegree), 2) - 0.25 * 0.25); }

std::uint64_t refused(const Rig& rig, DepthRefusal why) {
  return rig.mapper->counts().refused[static_cast<std::size_t>(why)];
}

// ledger: S1-D01, S1-47, S1-48, S1-63
TEST(DepthMapper, an_unmapped_wall_appears_after_three_or_four_readings_at_the_beams_upper_side) {
  const auto world = [](double north, double) { return north >= 20 ? 0.0 : 30.0; };
  for (const auto& [base, readings] : {std::pair{4, 3}, std::pair{5, 4}}) {
    Rig rig;
    rig.charted_m = 30;
    rig.parts.rules.base_prior = base;
    rig.build();
    const Pose X_WB = at(0, 0, 5);
    const RangeReading reading = heard(world, looking(0, 10), X_WB);
    ASSERT_NEAR(reading.range_m.value(), 20, 0.02);
    const double wall = 20.25;  // the first pixel whose centre lies behind the echo
    for (int i = 1; i <= readings; ++i) {
      EXPECT_EQ(rig.depth(wall, 0.1), 30) << "before reading " << i;
      EXPECT_FALSE(rig.at(wall, 0.1).has(kSensed));
      rig.mapper->update(reading, X_WB, 0);
    }
    EXPECT_NEAR(rig.depth(wall, 0.1), 5 - half_height(wall), 0.01);
    EXPECT_TRUE(rig.at(wall, 0.1).has(kSensed));
    EXPECT_EQ(rig.at(wall, 0.1).confidence(), rig.parts.rules.base_sensor);
    EXPECT_EQ(rig.depth(19.75, 0.1), 30) << "clear water over a deep bottom says nothing of it";
    EXPECT_EQ(rig.at(19.75, 0.1).confidence(), base);
    EXPECT_EQ(rig.depth(22.25, 0.1), 30) << "the shadow of the wall";
    for (int i = 0; i < 30; ++i) rig.mapper->update(reading, X_WB, 0);
    EXPECT_EQ(rig.at(wall, 0.1).confidence(), kFullConfidence);
  }
}

// ledger: S1-50, S1-D08
TEST(DepthMapper, a_higher_base_confidence_means_later_obstacles_and_fewer_false_ones) {
  int last_delay = 0, last_false = 1 << 30;
  for (const int base : {2, 3, 5, 8, 15}) {
    Rig rig;
    rig.charted_m = 30;
    rig.parts.rules.base_prior = base;
    rig.parts.rules.base_sensor = base + 1;
    rig.build();
    int shallower = 0;
    rig.mapper->on_change([&](const PixelChange& c) { shallower += c.after.depth_cm() < c.before.depth_cm(); });
    Random random(11);
    const Pose X_WB = at(0, 0, 5);
    for (int i = 0; i < 2000; ++i) {  // clear water, and an echo of nothing in 5 % of the readings
      const bool spurious = random.uniform() < 0.05;
      rig.mapper->update(with_range(looking(0, 6), spurious ? std::optional(random.uniform(5, 45)) : std::nullopt),
                         X_WB, 0);
    }
    const int false_obstacles = shallower;
    int delay = 0;
    const Pose elsewhere = at(0, 0, 5, 180);
    while (rig.depth(-20.25, 0.1) > 10 && delay < 100) {
      rig.mapper->update(with_range(looking(0, 6), 20.0), elsewhere, 0);
      ++delay;
    }
    EXPECT_EQ(delay, base - rig.parts.rules.threshold + 1);
    EXPECT_GT(delay, last_delay);
    EXPECT_LT(false_obstacles, last_false);
    last_delay = delay;
    last_false = false_obstacles;
  }
}

// ledger: S1-66, S1-63
TEST(DepthMapper, what_only_forward_beams_have_seen_explains_no_echo) {
  // A rock of the chart is cleared away: the pixel is then as deep as the beam reaches down, where ground would be
  // heard. A wall that comes to stand there is seen all the same.
  Rig rig;
  rig.charted_m = 30;
  rig.patches = {{12.5, -0.5, 1, 2}};
  rig.build();
  const Pose X_WB = at(0, 0, 5);
  for (int i = 0; i < 8; ++i) rig.mapper->update(with_range(looking(0, 10), {}), X_WB, 0);
  ASSERT_GT(rig.depth(12.25, 0.1), 6);
  for (int i = 0; i < 8; ++i) rig.mapper->update(with_range(looking(0, 10), 12.0), X_WB, 0);
  EXPECT_NEAR(rig.depth(12.25, 0.1), 5 - half_height(12.25), 0.01);
  EXPECT_EQ(rig.mapper->counts().explained, 0U);
}

// ledger: S1-D02, S1-62, S1-63
TEST(DepthMapper, a_false_obstacle_of_the_chart_is_removed_and_the_real_one_put_in) {
  Rig rig;
  rig.charted_m = 30;
  rig.patches = {{14, -2, 4, 2}};  // a rock 10 .. 14 m ahead that is not there
  rig.build();
  const auto world = [](double north, double) { return north >= 25 ? 0.0 : 30.0; };
  const Pose X_WB = at(0, 0, 5);
  const RangeReading reading = heard(world, looking(0, 10), X_WB);
  for (int i = 0; i < 3; ++i) rig.mapper->update(reading, X_WB, 0);
  EXPECT_EQ(rig.depth(12.25, 0.1), 2);
  rig.mapper->update(reading, X_WB, 0);  // 5 - 4 < 2
  EXPECT_NEAR(rig.depth(12.25, 0.1), 5 + half_height(12.25), 0.01) << "as deep as the beam has seen";
  EXPECT_NEAR(rig.depth(25.25, 0.1), 5 - half_height(25.25), 0.01);
  EXPECT_EQ(rig.depth(13.75, 1.9), 2) << "beside the beam, which is 1.2 m wide there, the chart stands";
}

// ledger: S1-76
TEST(DepthMapper, an_obstacle_confirmed_500_times_is_unlearned_after_19_clear_readings) {
  Rig rig;
  rig.charted_m = 30;
  rig.build();
  const Pose X_WB = at(0, 0, 5);
  const RangeReading wall = with_range(looking(0, 10), 20.0), nothing = with_range(looking(0, 10), {});
  for (int i = 0; i < 500; ++i) rig.mapper->update(wall, X_WB, 0);
  ASSERT_EQ(rig.at(20.25, 0.1).confidence(), kFullConfidence);
  ASSERT_LT(rig.depth(20.25, 0.1), 4);
  for (int i = 0; i < 18; ++i) rig.mapper->update(nothing, X_WB, 0);
  EXPECT_LT(rig.depth(20.25, 0.1), 4);
  rig.mapper->update(nothing, X_WB, 0);
  EXPECT_NEAR(rig.depth(20.25, 0.1), 5 + half_height(20.25), 0.01);
}

// ledger: S1-D03, S1-54, S1-48
TEST(DepthMapper, a_depth_sonar_corrects_a_wrong_chart_in_a_square_of_pixels) {
  Rig rig;
  rig.charted_m = 20;  // the pit is 22 m deep
  rig.build();
  const Pose X_WB = at(0.25, 0.25, 2);
  const RangeReading reading = heard([](double, double) { return 22.0; }, looking(90, 10), X_WB);
  rig.mapper->update(reading, X_WB, 0);
  EXPECT_EQ(rig.at(0.25, 0.25).confidence(), 3);
  EXPECT_EQ(rig.depth(0.25, 0.25), 20);
  rig.mapper->update(reading, X_WB, 0);
  EXPECT_EQ(rig.at(0.25, 0.25).confidence(), 6);
  EXPECT_NEAR(rig.depth(0.25, 0.25), 22, 0.02);
  rig.mapper->update(reading, X_WB, 0);
  EXPECT_EQ(rig.at(0.25, 0.25).confidence(), 8) << "affirmed by 10 %";
  const Pixel middle = rig.map->grid().at({0.25, 0.25});
  const auto snapshot = rig.map->snapshot();
  for (int row = -8; row <= 8; ++row) {
    for (int column = -8; column <= 8; ++column) {
      // 20 m x tan 5 deg = 1.75 m: 3 pixels to each side of the middle one.
      const bool inside = std::max(std::abs(row), std::abs(column)) <= 3;
      const DepthPixel pixel = snapshot->at({middle.column + column, middle.row + row});
      EXPECT_EQ(pixel.has(kSensed), inside) << row << ' ' << column;
      EXPECT_NEAR(pixel.depth_m(), inside ? 22 : 20, 0.02);
    }
  }
}

// ledger: S1-D05, S1-29, S1-32
TEST(DepthMapper, a_run_at_full_speed_shifts_once_in_42_7_s_and_loses_no_reading) {
  for (const bool background : {false, true}) {
    Rig rig;
    rig.map_config.area_m = 1024;
    rig.parts.mapper.background = background;
    rig.start = {-250, 0};
    rig.build();
    std::vector<double> shifts_at;
    std::uint64_t shifts = 0, taken = 0;
    for (double t = 0; t <= 300; t += 0.6) {
      const Pose X_WB = at(-250 + 1.5 * t, 0, 2);
      rig.mapper->update(with_range(looking(90, 10), 10 + 0.01 * t, t), X_WB, 0);
      rig.mapper->passed(Time{} + seconds(t), X_WB);
      ++taken;
      if (rig.mapper->counts().shifts > shifts) shifts_at.push_back(t);
      shifts = rig.mapper->counts().shifts;
    }
    rig.mapper->finish();
    ASSERT_EQ(shifts_at.size(), 7U);
    // The window moves by whole tiles of 16 m: the mean is 64 m, one span may be a tile shorter or longer.
    EXPECT_NEAR((shifts_at.back() - shifts_at.front()) / 6, 64 / 1.5, 16 / 1.5 / 6 + 0.6);
    EXPECT_EQ(rig.mapper->counts().readings, taken);
    EXPECT_EQ(rig.mapper->counts().applied, taken);
    for (double north = -249.75; north < 200; north += 0.5) {
      ASSERT_TRUE(rig.at(north, 0).known()) << north;
      ASSERT_TRUE(rig.at(north, 0).has(kTrack)) << north;
      // What was first put there agrees with the next ones to half a metre.
      ASSERT_NEAR(rig.depth(north, 0), 2 + 10 + 0.01 * (north + 250) / 1.5, 0.05) << north;
    }
  }
}

// ledger: S1-66
TEST(DepthMapper, a_level_run_over_a_flat_mapped_bottom_makes_no_wall) {
  const auto world = [](double, double) { return 10.0; };
  for (const bool explain : {true, false}) {
    Rig rig;
    rig.charted_m = 10;
    rig.parts.mapper.affirm_predicted = explain;
    rig.build();
    int echoes = 0;
    for (int i = 0; i < 20; ++i) {
      const Pose X_WB = at(0.2 * i, 0, 8);  // 2 m above it
      const RangeReading reading = heard(world, looking(0, 10), X_WB, 0.6 * i);
      echoes += reading.range_m.has_value();
      rig.mapper->update(reading, X_WB, 0);
    }
    EXPECT_EQ(echoes, 20);
    double shallowest = 10;
    for (double north = 0; north < 90; north += 0.5) {
      for (double east = -10; east < 10; east += 0.5) shallowest = std::min(shallowest, rig.depth(north, east));
    }
    if (explain) {
      EXPECT_EQ(shallowest, 10);
      EXPECT_EQ(rig.mapper->counts().explained, 20U);
    } else {
      EXPECT_LT(shallowest, 7) << "without the prediction there is a phantom";
    }
  }
}

// ledger: S1-66
TEST(DepthMapper, half_a_metre_below_the_surface_no_depth_becomes_negative) {
  const auto world = [](double north, double) { return north > 30 ? 1.0 : 15.0; };
  Rig rig;
  rig.build();  // uncharted
  for (int i = 0; i < 20; ++i) {
    for (const double azimuth : {-30.0, 0.0, 30.0}) {
      const Pose X_WB = at(0.9 * i, 0, 0.5, 0, 3 * std::sin(i), 4 * std::cos(i));
      rig.mapper->update(heard(world, looking(0, 10, azimuth), X_WB, 0.6 * i), X_WB, 0);
    }
  }
  int known = 0;
  for (double north = -5; north < 80; north += 0.5) {
    for (double east = -40; east < 40; east += 0.5) {
      const DepthPixel pixel = rig.at(north, east);
      known += pixel.known();
      if (pixel.known()) {
        ASSERT_GE(pixel.depth_cm(), 0) << north << ' ' << east;
      }
    }
  }
  EXPECT_GT(known, 500);
}

// ledger: S1-64
TEST(DepthMapper, silence_makes_no_obstacle_at_the_limit_and_clears_a_false_one) {
  for (const auto& range : {std::optional<double>(), std::optional<double>(50.0), std::optional<double>(70.0)}) {
    Rig rig;
    rig.charted_m = 30;
    rig.patches = {{40, -1, 2, 1}};
    rig.build();
    for (int i = 0; i < 10; ++i) rig.mapper->update(with_range(looking(0, 10), range), at(0, 0, 5), 0);
    double shallowest = 30;
    for (double north = 0; north < 60; north += 0.5) {
      for (double east = -8; east < 8; east += 0.5) shallowest = std::min(shallowest, rig.depth(north, east));
    }
    EXPECT_GT(shallowest, 5);
    EXPECT_LE(rig.depth(39.25, 0.1), 5 + half_height(39.25) + 0.01);
  }
}

// ledger: S1-64
TEST(DepthMapper, readings_that_failed_change_nothing_and_are_counted) {
  Rig rig;
  rig.charted_m = 30;
  rig.parts.evidence.min_confidence = 0.5;
  rig.parts.mapper.quarantine = rig.parts.mapper.prefilter = true;
  rig.build();
  const DepthTrees before = rig.map->trees();
  const Pose here = at(0, 0, 5);
  std::uint64_t taken = 0;
  const auto take = [&](const RangeReading& reading, const Pose& X_WB) {
    for (int i = 0; i < 5; ++i, ++taken) rig.mapper->update(reading, X_WB, 0);
  };
  for (const double depression : {0.0, 90.0}) {
    const RangeReading good = with_range(looking(depression, 10), 10.0);
    take(with_range(good, kNaN), here);
    take(with_range(good, -1.0), here);
    take(with_range(good, std::numeric_limits<double>::infinity()), here);
    RangeReading unsure = good, wide = good;
    unsure.confidence = 0.4F;
    take(unsure, here);
    unsure.confidence = std::numeric_limits<float>::quiet_NaN();
    take(unsure, here);
    wide.width = Angle::degrees(178.5);
    take(wide, here);
    wide.width = Angle::radians(kNaN);
    take(wide, here);
    take(good, at(kNaN, 0, 5));
    take(good, at(0, 1e300, 5));
    take(good, at(-1e12, 0, 5));
  }
  take(with_range(looking(-80, 10), 3.0), here);  // up
  rig.mapper->passed(Time{}, at(0, kNaN, 0));
  rig.mapper->passed(Time{}, at(1e200, 0, 0));
  rig.mapper->finish();
  rig.map->flush();
  EXPECT_TRUE(rig.map->trees().state() == before.state());
  EXPECT_TRUE(rig.map->trees().sensed() == before.sensed());
  EXPECT_EQ(rig.mapper->counts().applied, 0U);
  EXPECT_EQ(refused(rig, DepthRefusal::kUseless) + rig.mapper->counts().merged, taken);
}

// ledger: S1-55
TEST(DepthMapper, rolling_over_a_step_maps_its_edge_within_a_pixel) {
  ISOBATH_NOT_SANITIZED();
  const auto world = [](double, double east) { return east < 10 ? 22.0 : 17.0; };
  const auto edge_of = [&](bool with_attitude) {
    Rig rig;
    rig.build();
    // Along the step, on lines to both sides of it: the roll carries the spot across.
    for (int pass = -6; pass <= 6; ++pass) {
      for (int i = 0; i < 60; ++i) {
        const double roll = 10 * std::sin(0.7 * i + pass);
        const Pose X_WB = at(0.25 * i, 10 + 1.0 * pass, 2, 0, 0, roll);
        const RangeReading reading = heard(world, looking(90, 3), X_WB);
        rig.mapper->update(reading, with_attitude ? X_WB : level(X_WB), 0);
      }
    }
    // Farthest place of a pixel on the wrong side of the step: deep where it is shallow, or the other way round.
    double worst = 0;
    for (double north = 3.25; north < 12; north += 0.5) {
      for (double east = 4.25; east < 16; east += 0.5) {
        if (!rig.at(north, east).known()) continue;
        const bool deep = rig.depth(north, east) > 19.5;
        if (deep != (east < 10)) worst = std::max(worst, std::abs(east - 10));
      }
    }
    return worst;
  };
  const double spot = 20 * std::tan(1.5 * kDegree) + 0.25;  // half the footprint, on whole pixels
  EXPECT_LE(edge_of(true), spot + 0.5);
  EXPECT_GT(edge_of(false), 3 * 0.5 + 0.5);
}

// ledger: S1-67
TEST(DepthMapper, several_beams_find_the_top_of_a_pole_and_one_does_not) {
  const double top = 12.5;
  const auto world = [&](double north, double east) {
    return north >= 20 && north < 21 && std::abs(east) < 0.5 ? top : 30.0;
  };
  const auto mapped = [&](const std::vector<double>& depressions) {
    Rig rig;
    rig.charted_m = 30;
    rig.build();
    const Pose X_WB = at(0, 0, 10);
    for (int i = 0; i < 10; ++i) {
      for (const double depression : depressions) {
        rig.mapper->update(heard(world, looking(depression, 10), X_WB, 0.6 * i), X_WB, 0);
      }
    }
    return rig.depth(20.25, 0.1);
  };
  for (const std::vector<double>& order : {std::vector<double>{0, 20, 8}, {8, 20, 0}, {20, 8, 0}, {20, 0, 8}}) {
    EXPECT_NEAR(mapped(order), top, half_height(20.25)) << "the beam at " << order[0] << " deg first";
  }
  EXPECT_GT(mapped({20}) - top, half_height(20.25));
  EXPECT_EQ(mapped({0}), 30) << "it passes above";
}

// ledger: S1-68, S1-69
TEST(DepthMapper, filtered_and_unfiltered_runs_over_a_static_scene_end_alike) {
  const auto world = [](double north, double) { return north > 25 ? 1.0 : 18.0; };
  Rig plain, filtered;
  filtered.parts.mapper.prefilter = true;
  for (Rig* rig : {&plain, &filtered}) {
    rig->charted_m = 15;
    rig->build();
    const Pose X_WB = at(0, 0, 3);
    const RangeReading ahead = heard(world, looking(0, 10), X_WB), down = heard(world, looking(90, 10), X_WB);
    for (int i = 0; i < 48; ++i) {
      rig->mapper->update(with_range(ahead, ahead.range_m, 0.6 * i), X_WB, 0);
      rig->mapper->update(with_range(down, down.range_m, 0.6 * i), X_WB, 0);
    }
    rig->mapper->finish();
  }
  EXPECT_EQ(filtered.mapper->counts().applied, 24U);
  EXPECT_EQ(filtered.mapper->counts().merged, 72U);
  int sensed = 0;
  for (double north = -5; north < 40; north += 0.5) {
    for (double east = -8; east < 8; east += 0.5) {
      const DepthPixel a = plain.at(north, east), b = filtered.at(north, east);
      sensed += a.has(kSensed);
      EXPECT_EQ(a.depth_word, b.depth_word);
      EXPECT_NEAR(a.confidence(), b.confidence(), 2);
    }
  }
  EXPECT_GT(sensed, 60);
}

/// Root mean square error of a map that near and far soundings have made, whose noise grows with range, with a vehicle
/// whose place is as unsure as it says.
double error_of_survey(bool honest, std::uint64_t seed, double noise_share, bool far_only) {
  const auto world = [](double north) { return 50 + 2 * std::sin(north / 8); };
  Rig rig;
  rig.parts.mapper.range_weighting = honest;
  rig.parts.evidence.deviation.share = noise_share;
  rig.charted_m = 47;
  rig.build();
  Random random(seed);
  for (int pass = 0; pass < 12; ++pass) {
    const bool near = !far_only && pass % 3 == 0;
    for (double north = -30; north <= 30; north += 0.5) {
      const double z = near ? 44 : 6, range = world(north) - z;
      const double sigma = rig.parts.evidence.deviation.of_range(range);
      const double sigma_place = near ? 0.2 : 1.5;  // far from the bottom there is no bottom lock
      const RangeReading reading = with_range(looking(90, 2), range + sigma * random.normal());
      rig.mapper->update(reading, at(north + sigma_place * random.normal(), 0, z), sigma_place);
    }
  }
  double sum = 0;
  int count = 0;
  const auto snapshot = rig.map->snapshot();
  for (double north = -29.75; north < 30; north += 0.5) {
    const double error = snapshot->at(rig.map->grid().at({north, 0.1})).depth_m() - world(north);
    sum += error * error;
    ++count;
  }
  return std::sqrt(sum / count);
}

// ledger: S1-73
TEST(DepthMapper, honest_steps_make_a_better_map_of_noise_that_grows_with_range) {
  double honest = 0, constant = 0;
  int better = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const double a = error_of_survey(true, seed, 0.02, false);
    const double b = error_of_survey(false, seed, 0.02, false);
    honest += a / 12;
    constant += b / 12;
    better += a < b;
  }
  EXPECT_LT(honest, 0.9 * constant) << honest << " m against " << constant;
  EXPECT_GE(better, 9) << "of 12";
}

// ledger: S1-73
TEST(DepthMapper, weak_readings_that_agree_are_heard_in_the_end) {
  // Nobody comes near, and each reading is worth less than half a unit: the chart, 3 m off, must not stand for ever.
  double honest = 0, constant = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    honest += error_of_survey(true, seed, 0.05, true) / 6;
    constant += error_of_survey(false, seed, 0.05, true) / 6;
  }
  EXPECT_LT(honest, 1.1 * constant) << honest << " m against " << constant;
  EXPECT_LT(honest, 2.5);
}

// ledger: S1-72
TEST(DepthMapper, a_depth_that_nothing_supports_is_held_back_until_others_agree) {
  Rig rig;
  rig.parts.mapper.quarantine = true;
  rig.parts.evidence.range_cap_m = 400;
  rig.build();
  const auto sound = [&](double north, double range_m) {
    RangeReading reading = with_range(looking(90, 3), range_m);
    reading.max_range_m = 400;
    rig.mapper->update(reading, at(north, 0, 0), 0);
  };
  for (int i = 0; i < 20; ++i) sound(0.5 * i, 9);
  EXPECT_EQ(rig.mapper->counts().applied, 20U) << "the first two as well";
  sound(10, 300);  // an echo of the one before the last transmission
  EXPECT_EQ(rig.mapper->counts().applied, 20U);
  for (int i = 21; i < 30; ++i) sound(0.5 * i, 9);
  EXPECT_EQ(refused(rig, DepthRefusal::kHeldAlone), 1U);
  for (double north = 0; north < 20; north += 0.5) {
    if (rig.at(north, 0).known()) {
      EXPECT_EQ(rig.depth(north, 0), 9) << north;
    }
  }
  for (int i = 30; i < 33; ++i) sound(0.5 * i, 3);  // a quay
  EXPECT_EQ(rig.depth(16, 0), 3);
  EXPECT_EQ(refused(rig, DepthRefusal::kHeldAlone), 1U);
  sound(16.5, 300);
  rig.mapper->finish();
  EXPECT_EQ(refused(rig, DepthRefusal::kHeldAlone), 2U);
  RangeReading silent = looking(90, 3);
  rig.mapper->update(with_range(silent, 60.0), at(17, 0, 0), 0);  // at or beyond the limit: no echo, no depth to judge
  EXPECT_EQ(refused(rig, DepthRefusal::kImpossible), 0U);
}

// ledger: S1-72
TEST(DepthMapper, beams_of_a_swath_that_their_neighbours_contradict_are_refused) {
  Rig rig;
  rig.parts.mapper.quarantine = true;
  rig.build();
  Swath swath;
  swath.beam_width = Angle::degrees(1);
  for (int i = -20; i <= 20; ++i) {
    const float z = i == 5 ? 3.0F : 18.0F;
    swath.soundings.push_back({{0, static_cast<float>(i), z}, std::hypot(static_cast<float>(i), z), 0.05F});
  }
  rig.mapper->update(swath, at(0, 0, 2, 90), 0);  // to the east: starboard is south
  EXPECT_EQ(refused(rig, DepthRefusal::kBeamAlone), 1U);
  EXPECT_EQ(rig.mapper->counts().soundings, 41U);
  EXPECT_EQ(rig.mapper->counts().applied, 40U);
  EXPECT_NEAR(rig.depth(-10, 0), 20, 0.01);
  EXPECT_FALSE(rig.at(-5.1, 0).known());
  swath.frame = Swath::Frame::kLevel;
  swath.heading = Angle::degrees(0);
  rig.mapper->update(swath, at(30, 0, 2, 90, 5, 5), 0);  // corrected already, depths below the surface, its own heading
  EXPECT_NEAR(rig.depth(30, -10), 18, 0.01);
}

// ledger: S1-68
TEST(DepthMapper, sensors_beyond_the_64th_are_refused) {
  Rig rig;
  rig.build();
  for (int i = 0; i < 70; ++i) {
    RangeReading reading = with_range(looking(90, 3), 10.0);
    reading.X_BS.translation.x() = 0.01 * i;
    rig.mapper->update(reading, at(0, 0, 0), 0);
  }
  EXPECT_EQ(refused(rig, DepthRefusal::kManySensors), 6U);
  Rig bad;
  bad.parts.rules.base_sensor = bad.parts.rules.base_prior;
  EXPECT_THROW(bad.build(), Error);
}

// Design, section 9: the mapping path allocates nothing after warm-up.
TEST(DepthMapper, readings_and_fixes_allocate_nothing) {
  ISOBATH_NOT_SANITIZED();
  const auto world = [](double north, double) { return north > 35 ? 1.0 : 6.0; };
  Rig rig;
  rig.charted_m = 6;
  rig.parts.mapper.prefilter = rig.parts.mapper.quarantine = true;
  rig.build();
  Swath swath;
  for (int i = -20; i <= 20; ++i) swath.soundings.push_back({{0, static_cast<float>(i), 5}, 6, 0.05F});
  std::vector<RangeReading> heard_there;
  std::vector<Pose> poses;
  for (int i = 0; i < 40; ++i) {
    poses.push_back(at(0.5 * i, 0, 1, 3.0 * i, std::sin(i), 2 * std::cos(i)));
    for (const double depression : {0.0, 5.0, 90.0}) {
      heard_there.push_back(heard(world, looking(depression, 10), poses.back(), 0.6 * i));
    }
  }
  heard_there[5].range_m = 30;  // held, refused
  const auto mission = [&](double later) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) {
        RangeReading reading = heard_there[k];
        reading.time += seconds(later);
        rig.mapper->update(reading, poses[i], 0.2);
      }
      rig.mapper->update(swath, poses[i], 0.2);
      rig.mapper->passed(Time{} + seconds(later + 0.6 * static_cast<double>(i)), poses[i]);
    }
  };
  mission(0);
  const std::uint64_t before = allocations();
  mission(100);
  mission(200);
  EXPECT_EQ(allocations(), before);
  EXPECT_GT(rig.mapper->counts().explained, 0U);
}

}  // namespace
}  // namespace isobath::test
