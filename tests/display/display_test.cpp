// What a page is shown of a run: taken apart again and held against what was put in.
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/display/display.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tests/support/display_records.hpp>
#include <tests/support/echoes.hpp>
#include <tests/support/events.hpp>

namespace isobath {
namespace {

using nlohmann::json;
using test::number_at;
using test::Record;
using test::records_of;
using Kind = DisplayKind;

std::vector<Record> of_kind(const DisplayState& items, Kind kind) {
  return test::of_kind(records_of(items.changes_after(0).records), kind);
}

Record only(const DisplayState& items, Kind kind) {
  const auto found = of_kind(items, kind);
  EXPECT_EQ(found.size(), 1U);
  return found.at(0);
}

/// A ping whose decisions are: every sample of 200 and more.
struct Heard {
  Ping ping;
  EchoDecisions decisions;
  Pose X_WB;

  explicit Heard(Ping p, Pose pose = {}) : ping(std::move(p)), X_WB(pose) {
    decisions.reset(ping.fan->beams(), ping.window.bins);
    for (int b = 0; b < ping.fan->beams(); ++b) {
      for (int k = 0; k < ping.window.bins; ++k) {
        if (ping.intensity(b, k) >= 200) decisions.set_hit(b, k);
      }
    }
  }
  [[nodiscard]] PosedPing posed() const { return {ping, X_WB, decisions}; }
};

TEST(SonarDisplay, ShowsAFanAsItWasHeard) {
  DisplayState items;
  SonarDisplay display(items);
  const auto value = [](int beam, int bin) { return beam == 2 && bin == 5 ? 220 : 10 * beam + bin; };
  Ping ping = test::ping_of<std::uint8_t>(test::fan_of(4, Angle::degrees(-2)), {1, 0.5, 9}, value);
  ping.time = Time(seconds(3.0));
  const Heard heard(ping, {Rotation::from_heading(Angle::degrees(90)), {10, 20, 3}});
  display.on_ping(heard.posed());

  const json sonar = json::parse(only(items, Kind::kSonar).payload);
  EXPECT_EQ(sonar["azimuth"].size(), 4U);
  EXPECT_NEAR(sonar["azimuth"][0].get<double>(), Angle::degrees(-2).radians(), 1e-5);
  EXPECT_EQ(sonar["first_m"], 1.0);
  EXPECT_EQ(sonar["bin_m"], 0.5);
  EXPECT_EQ(sonar["bins"], 9);
  EXPECT_FALSE(sonar["scanning"].get<bool>());
  EXPECT_EQ(sonar["scale"]["high"], 100);

  const Record echoes = only(items, Kind::kEchoes);
  EXPECT_EQ(echoes.time, Time(seconds(3.0)));
  ASSERT_EQ(echoes.payload.size(), 48U + 40 + 5);  // 36 samples, padded to 8, and a bit for each
  EXPECT_EQ(number_at<std::uint16_t>(echoes.payload, 0), 4);
  EXPECT_EQ(number_at<std::uint16_t>(echoes.payload, 2), 9);
  EXPECT_EQ(number_at<double>(echoes.payload, 8), 10);
  EXPECT_EQ(number_at<double>(echoes.payload, 16), 20);
  EXPECT_NEAR(number_at<float>(echoes.payload, 32), std::sqrt(0.5), 1e-6);
  for (int b = 0; b < 4; ++b) {
    for (int k = 0; k < 9; ++k) {
      const int i = 9 * b + k;
      EXPECT_EQ(static_cast<std::uint8_t>(echoes.payload[48 + i]), value(b, k));
      EXPECT_EQ(echoes.payload[88 + i / 8] >> (i % 8) & 1, b == 2 && k == 5) << b << ' ' << k;
    }
  }
}

TEST(SonarDisplay, PoolsALargeFanWithoutLosingAnEcho) {
  DisplayState items;
  SonarDisplay display(items);
  const auto value = [](int beam, int bin) { return beam == 301 && bin == 407 ? 255 : 0; };
  display.on_ping(
      Heard(test::ping_of<std::uint8_t>(test::fan_of(512, {}, Angle::degrees(0.2)), {0, 0.1, 500}, value)).posed());
  const std::string echoes = only(items, Kind::kEchoes).payload;
  const int beams = number_at<std::uint16_t>(echoes, 0), bins = number_at<std::uint16_t>(echoes, 2);
  EXPECT_LE(beams, SonarDisplay::kMaxBeams);
  EXPECT_LE(bins, SonarDisplay::kMaxBins);
  EXPECT_EQ(beams, 256);
  EXPECT_EQ(bins, 250);
  const std::size_t at = 150 * 250 + 203;
  EXPECT_EQ(static_cast<std::uint8_t>(echoes[48 + at]), 255);
  const std::size_t hits = 48 + 64000;
  EXPECT_EQ(echoes[hits + at / 8] >> (at % 8) & 1, 1);
  EXPECT_EQ(std::count(echoes.begin() + 48, echoes.begin() + 48 + 64000, '\0'), 63999);
}

TEST(SonarDisplay, ShowsDecibelsOfSamplesWithALargeRange) {
  DisplayState items;
  SonarDisplay display(items);
  const auto value = [](int, int bin) { return bin == 0 ? 1.0 : bin == 1 ? 0.1 : 0.0; };
  display.on_ping(Heard(test::ping_of<float>(test::fan_of(2), {0, 1, 3}, value, 1)).posed());
  const std::string echoes = only(items, Kind::kEchoes).payload;
  EXPECT_EQ(static_cast<std::uint8_t>(echoes[48]), 255);
  EXPECT_EQ(static_cast<std::uint8_t>(echoes[49]), 170);  // -20 of -60 dB
  EXPECT_EQ(static_cast<std::uint8_t>(echoes[50]), 0);
}

TEST(SonarDisplay, ShadesOfDecibelsAreThoseOfTheLogarithm) {
  constexpr int kBins = 300;
  DisplayState items;
  SonarDisplay display(items);
  const auto share = [](int bin) { return std::pow(10.0, -70.0 / 20 * bin / kBins); };  // 0 to -70 dB
  const auto value = [&](int, int bin) { return 40'000 * share(bin); };
  display.on_ping(Heard(test::ping_of<std::uint16_t>(test::fan_of(2), {0, 1, kBins}, value, 40'000)).posed());
  const std::string echoes = only(items, Kind::kEchoes).payload;
  for (int k = 0; k < kBins; ++k) {
    const double level = 255 * (1 + 20 * std::log10(std::round(value(0, k)) / 40'000) / 60);
    EXPECT_NEAR(static_cast<std::uint8_t>(echoes[48 + k]), std::max(0.0, level), 0.6) << k;
  }
}

TEST(SonarDisplay, KeepsTheBeamsOfAScanningHeadByTheirPlaceInTheTurn) {
  DisplayState items;
  SonarDisplay display(items);
  for (int i = 0; i < 60; ++i) {
    Heard heard(test::ping_at(0.1 * i, {1, 2, 3, static_cast<std::uint8_t>(i)}, Angle::degrees(6.0 * (i % 50))));
    display.on_ping(heard.posed());
  }
  const json sonar = json::parse(only(items, Kind::kSonar).payload);
  EXPECT_TRUE(sonar["scanning"].get<bool>());
  EXPECT_EQ(sonar["azimuth"].size(), 60U);
  const auto beams = of_kind(items, Kind::kEchoes);
  ASSERT_EQ(beams.size(), 50U);
  for (const Record& beam : beams) {
    const int i = static_cast<std::uint8_t>(beam.payload[48 + 3]);
    EXPECT_EQ(beam.number, static_cast<std::uint64_t>(i % 50));
    EXPECT_TRUE(i >= 10) << "of the second turn where there was one";
  }
}

TEST(SonarDisplay, ShowsAFastFanTenTimesASecond) {
  DisplayState items;
  SonarDisplay display(items);
  const auto fan = test::fan_of(8);
  std::uint64_t stamp = 0;
  int shown = 0;
  for (int i = 0; i < 80; ++i) {
    Ping ping = test::ping_of<std::uint8_t>(fan, {0, 1, 4}, [](int, int) { return 3; });
    ping.time = Time(seconds(i / 40.0));
    display.on_ping(Heard(ping).posed());
    shown += items.stamp() > stamp ? 1 : 0;
    stamp = items.stamp();
  }
  EXPECT_EQ(shown, 20);
}

TEST(MapDisplay, ShowsOccupancyWhereItLies) {
  DisplayState items;
  MapDisplay display(items);
  BodyGridConfig config;
  config.cells_x = config.cells_y = 21;
  BodyGrid grid(config);
  const Pose X_WB{Rotation::from_heading(Angle::degrees(30)), {100, 200, 5}};
  const Eigen::Vector2d buoy_L(6.5, -3.5);
  grid.set_probability(*grid.cell_at(buoy_L), 0.9);
  grid.set_probability(*grid.cell_at({2, 2}), 1e-3);
  display.show(Time(seconds(1.0)), grid, X_WB);

  const std::string bytes = only(items, Kind::kGrid).payload;
  const auto cells = test::unpacked(bytes.substr(32));
  ASSERT_EQ(cells.size(), 21U * 21);
  const double cell = number_at<float>(bytes, 4), heading = number_at<float>(bytes, 24);
  EXPECT_NEAR(number_at<float>(bytes, 28), 0.8, 1e-6);
  const auto at = static_cast<std::size_t>(std::find(cells.begin(), cells.end(), 225) - cells.begin());
  ASSERT_LT(at, cells.size());
  // as docs/live-page.md has it: cell (x, y) at x * ny + y, x axis by the heading, y axis to starboard of it
  const double x = (static_cast<double>(at / 21) + 0.5) * cell, y = (static_cast<double>(at % 21) + 0.5) * cell;
  const double north = number_at<double>(bytes, 8) + x * std::cos(heading) - y * std::sin(heading);
  const double east = number_at<double>(bytes, 16) + x * std::sin(heading) + y * std::cos(heading);
  const Eigen::Vector3d buoy_W = X_WB * Eigen::Vector3d(buoy_L.x(), buoy_L.y(), 0);
  EXPECT_NEAR(north, buoy_W.x(), cell);
  EXPECT_NEAR(east, buoy_W.y(), cell);
  EXPECT_EQ(std::count(cells.begin(), cells.end(), 255), 21 * 21 - 2) << "what nobody has seen is unknown";
  EXPECT_EQ(std::count(cells.begin(), cells.end(), 0), 1) << "free";
}

TEST(MapDisplay, ShadesOfCellsAreThoseOfTheirProbabilities) {
  DisplayState items;
  MapDisplay display(items);
  BodyGridConfig config;
  config.cells_x = config.cells_y = 40;
  BodyGrid grid(config);
  for (std::size_t i = 0; i < grid.cells().size(); ++i) {
    grid.log_odds()[i] = std::lerp(grid.log_odds_min(), grid.log_odds_max(), static_cast<double>(i) / 1599);
  }
  display.show(Time(seconds(1.0)), grid, Pose{});
  const auto shades = test::unpacked(only(items, Kind::kGrid).payload.substr(32));
  ASSERT_EQ(shades.size(), 1600U);
  for (std::size_t i = 0; i < shades.size(); ++i) {
    const double p = probability_of(grid.log_odds()[i]);
    if (!grid.is_free(i) && p < config.threshold / 9) {
      EXPECT_EQ(shades[i], 255) << i;
    } else {
      EXPECT_NEAR(shades[i], 250 * p, 0.7) << i;
    }
  }
}

TEST(MapDisplay, ManyVoxelsThatChangedAtOnceAreShownInEightLooks) {
  constexpr int kBlocks = 400;
  DisplayState items;
  MapDisplay display(items);
  VoxelMap voxels;
  voxels.advance();
  for (int i = 0; i < kBlocks; ++i) voxels.layer("sonar").add({i * VoxelBlocks::kSide, 0, 0}, 3000);
  const auto shown = [&](double s) {
    display.show(Time(seconds(s)), voxels);
    return of_kind(items, Kind::kVoxels).size();
  };
  EXPECT_EQ(shown(1), kBlocks / 8 + 1U);
  for (int look = 1; look < 7; ++look) shown(1);
  EXPECT_LT(of_kind(items, Kind::kVoxels).size(), 1U * kBlocks);
  EXPECT_EQ(shown(1), 1U * kBlocks);
}

TEST(MapDisplay, ShowsOccupiedVoxelsAndThatABlockIsEmptyAgain) {
  DisplayState items;
  MapDisplay display(items);
  VoxelMap voxels;
  const VoxelIndex v(-3, 17, 40);
  voxels.layer("sonar").add(v, 3000);
  voxels.layer("sonar").add(v + VoxelIndex(1, 0, 0), -3000);
  display.show(Time(seconds(1.0)), voxels);
  const std::string block = only(items, Kind::kVoxels).payload;
  EXPECT_EQ(number_at<float>(block, 0), 0.25F);
  EXPECT_EQ(number_at<std::uint32_t>(block, 16), 1U);
  const VoxelIndex corner(-16, 16, 32);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(number_at<std::int32_t>(block, 4 + 4 * static_cast<std::size_t>(axis)), corner[axis]);
  }
  const auto shades = test::unpacked(block.substr(20));
  ASSERT_EQ(shades.size(), 4096U);
  const std::size_t place = (13U << 8) + (1U << 4) + 8;  // v from the corner
  EXPECT_NEAR(shades[place] / 250.0, voxels.probability(v), 0.003);
  EXPECT_EQ(std::count(shades.begin(), shades.end(), 0), 4095);

  voxels.advance();
  voxels.layer("sonar").add(v, -6000);
  display.show(Time(seconds(5.0)), voxels);
  EXPECT_TRUE(of_kind(items, Kind::kVoxels).empty());
  EXPECT_TRUE(of_kind(items, Kind::kCubes).empty());
}

/// Each cube is as likely as the likeliest voxel in it, and the cubes of 64 x 64 x 64 voxels are one item.
TEST(MapDisplay, ShowsVoxelsInLargerCubesToo) {
  DisplayState items;
  MapDisplay display(items);
  VoxelMap voxels;
  const auto say = [&](const VoxelIndex& v, LogOdds16 evidence) { voxels.layer("sonar").add(v, evidence); };
  say({-3, 17, 40}, 1000);
  say({-4, 16, 43}, 3000);  // the same cube
  say({-5, 16, 43}, 2000);  // the one beside it
  say({0, 17, 40}, 3000);   // another region
  display.show(Time(seconds(1.0)), voxels);
  ASSERT_EQ(of_kind(items, Kind::kCubes).size(), 2U);
  std::map<std::array<int, 3>, int> cubes;
  std::uint32_t told = 0;
  for (const auto& item : of_kind(items, Kind::kCubes)) {
    EXPECT_EQ(number_at<float>(item.payload, 0), 1.0F) << "four voxels of 0.25 m";
    told += number_at<std::uint32_t>(item.payload, 16);
    const auto shades = test::unpacked(item.payload.substr(20));
    ASSERT_EQ(shades.size(), 4096U);
    for (int i = 0; i < 4096; ++i) {
      if (shades[static_cast<std::size_t>(i)] == 0) continue;
      const auto corner = [&](std::size_t axis) { return number_at<std::int32_t>(item.payload, 4 + 4 * axis); };
      cubes[{corner(0) + (i >> 8), corner(1) + (i >> 4 & 15), corner(2) + (i & 15)}] =
          shades[static_cast<std::size_t>(i)];
    }
  }
  EXPECT_EQ(told, 4U);
  ASSERT_EQ(cubes.size(), 3U);
  const auto shade_of = [&](const VoxelIndex& v) { return static_cast<int>(std::lround(250 * voxels.probability(v))); };
  EXPECT_EQ((cubes.at({-1, 4, 10})), shade_of({-4, 16, 43}));
  EXPECT_EQ((cubes.at({-2, 4, 10})), shade_of({-5, 16, 43}));
  EXPECT_EQ((cubes.at({0, 4, 10})), shade_of({0, 17, 40}));

  voxels.advance();
  say({-4, 16, 43}, -6000);
  display.show(Time(seconds(5.0)), voxels);
  told = 0;
  for (const auto& item : of_kind(items, Kind::kCubes)) told += number_at<std::uint32_t>(item.payload, 16);
  EXPECT_EQ(told, 3U) << "no more voxels than the blocks hold";
}

TEST(MapDisplay, ShowsMeasuredDepthsTileByTileFromTheSouthWest) {
  DisplayState items;
  MapDisplay display(items);
  DepthMapConfig config;
  config.window_pixels = 128;
  config.area_m = 256;
  DepthMap map(config, area_of(config), DepthTrees(area_of(config).levels), {0, 0});
  const Eigen::Vector2d place(7.2, -11.3);
  const Pixel pixel = map.grid().at(place);
  const std::uint32_t state = DepthPixel::word_of_state(7, kSensed | kSeenByDepth, 1);
  map.window().set(pixel, {DepthPixel::word_of_depth(12.34), state});
  display.show(Time(seconds(1.0)), map.snapshot());

  const std::string tile = only(items, Kind::kDepth).payload;
  const int side = number_at<std::uint16_t>(tile, 0);
  const double pixel_m = number_at<float>(tile, 4), unit = number_at<float>(tile, 24);
  const int row = static_cast<int>((place.x() - number_at<double>(tile, 8)) / pixel_m);
  const int column = static_cast<int>((place.y() - number_at<double>(tile, 16)) / pixel_m);
  const std::size_t i = static_cast<std::size_t>(row * side + column), pixels = static_cast<std::size_t>(side * side);
  const auto planes = test::unpacked(tile.substr(32));
  ASSERT_EQ(planes.size(), 4 * pixels);
  const auto units_of = [&](std::size_t at) { return planes[at] + 256 * planes[pixels + at]; };
  EXPECT_NEAR(units_of(i) * unit, 12.34, 0.006);
  EXPECT_EQ(planes[2 * pixels + i], 7);
  EXPECT_EQ(planes[3 * pixels + i], 2) << "measured, not charted";
  EXPECT_EQ(units_of(i + 1), 65535) << "its neighbour nobody knows";

  const std::uint64_t stamp = items.stamp();
  display.show(Time(seconds(3.0)), map.snapshot());
  EXPECT_EQ(items.stamp(), stamp) << "nothing has changed";
}

TEST(Display, ShowsTheVehicleItsTrackAndWhatItIsTold) {
  DisplayState items;
  Display display(items);
  for (int i = 0; i <= 1000; ++i) {
    Navigation fix = test::fix_at(0.1 * i, 0.1 * i, 45);
    fix.v_WB = Eigen::Vector3d(1, 1, 0);
    display.on_event(fix);
    display.want({Angle::degrees(50), 2, 1.5, 0});
  }
  const std::string vehicle = only(items, Kind::kVehicle).payload;
  ASSERT_EQ(vehicle.size(), 72U);
  EXPECT_NEAR(number_at<double>(vehicle, 0), 100, 1e-9);
  EXPECT_NEAR(number_at<float>(vehicle, 32), Angle::degrees(45).radians(), 1e-6);
  EXPECT_NEAR(number_at<float>(vehicle, 36), std::sqrt(2), 1e-6) << "surge";
  EXPECT_NEAR(number_at<float>(vehicle, 40), 0, 1e-6) << "sway";
  EXPECT_TRUE(std::isnan(number_at<float>(vehicle, 52))) << "altitude";
  EXPECT_NEAR(number_at<float>(vehicle, 56), Angle::degrees(50).radians(), 1e-6);

  const auto track = of_kind(items, Kind::kTrack);
  ASSERT_EQ(track.size(), 2U);
  EXPECT_EQ(track[0].payload.size(), 64U * 16);
  EXPECT_EQ(track[1].payload.size(), 37U * 16);
  EXPECT_NEAR(number_at<float>(track[1].payload, 4), 64, 0.2);
}

/// Values of a signal by the seconds of its samples.
std::map<float, float> samples_of(const DisplayState& items, const std::string& name) {
  std::map<float, float> samples;
  for (const Record& item : of_kind(items, Kind::kSignals)) {
    const auto size = number_at<std::uint32_t>(item.payload, 0);
    const json names = json::parse(item.payload.substr(4, size));
    std::size_t column = 0;
    while (names.at(column)[0] != name) ++column;
    for (std::size_t at = 4 + (size + 3) / 4 * 4; at < item.payload.size(); at += 4 * (names.size() + 1)) {
      samples[number_at<float>(item.payload, at)] = number_at<float>(item.payload, at + 4 * (column + 1));
    }
  }
  return samples;
}

TEST(Display, KeepsWhatTheVehicleMeasuredAndWasTold) {
  DisplayState items;
  Display display(items);
  for (int i = 0; i <= 400; ++i) {
    Navigation fix = test::fix_at(0.1 * i, 0.1 * i, -10);
    fix.X_WB.translation.z() = i < 200 ? 1 : 3;
    fix.v_WB = Eigen::Vector3d(3, 4, 9);
    display.on_event(fix);
    if (i == 95) display.want({Angle::degrees(50), 3, 1.5, 0});
    if (i == 95) display.on_event(Health{.time = fix.time, .source = "pack", .battery_share = 0.5F});
    if (i == 195) display.on_event(Health{.time = fix.time, .source = "spare", .battery_share = 0.9F});
  }
  const auto depth = samples_of(items, "depth");
  ASSERT_EQ(depth.size(), 41U) << "one a second, over three items";
  EXPECT_EQ(depth.at(19), 1);
  EXPECT_EQ(depth.at(20), 3);
  EXPECT_TRUE(std::isnan(samples_of(items, "depth set-point").at(9))) << "nothing was wanted yet";
  EXPECT_EQ(samples_of(items, "depth set-point").at(10), 3);
  EXPECT_NEAR(samples_of(items, "heading").at(40), 350, 1e-3);
  EXPECT_NEAR(samples_of(items, "speed").at(40), 5, 1e-6) << "level";
  EXPECT_EQ(samples_of(items, "battery").at(40), 50) << "of the part that has least";
  EXPECT_TRUE(std::isnan(samples_of(items, "nearest obstacle").at(40)));
}

TEST(Display, ShowsObstaclesInTheWorld) {
  DisplayState items;
  Display display(items);
  BodyGrid grid{BodyGridConfig{}};
  Detection found;
  found.time = Time(seconds(1.0));
  found.X_WB = {Rotation::from_heading_pitch_roll(Angle::degrees(90), Angle::degrees(10), {}), {100, 200, 5}};
  Obstacle o;
  o.outline = {{10, -1}, {12, -1}, {12, 1}};
  o.range_m = 10;
  o.existence = 0.98;
  o.nearest = o.centre = {10, 0};
  o.covariance.setIdentity();
  found.obstacles = {o};
  display.on_scan({1, true, found, grid});
  const json shown = json::parse(only(items, Kind::kObstacles).payload)["pieces"];
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_NEAR(shown[0]["outline"][0][0].get<double>(), 101, 1e-3);
  EXPECT_NEAR(shown[0]["outline"][0][1].get<double>(), 210, 1e-3);
  EXPECT_EQ(shown[0]["existence"], 0.98);
}

Obstacle piece_of(int number, const Eigen::Vector2d& corner, double side, double existence) {
  Obstacle o;
  o.number = number;
  o.outline = {corner, corner + Eigen::Vector2d(side, 0), corner + Eigen::Vector2d(side, side),
               corner + Eigen::Vector2d(0, side)};
  o.nearest = corner;
  o.range_m = corner.norm();
  o.existence = existence;
  return o;
}

// A wall of two pieces and a pole nearer than it.
TEST(Display, ListsObstaclesAsThingsBeforeTheirPieces) {
  DisplayState items;
  Display display(items);
  BodyGrid grid{BodyGridConfig{}};
  Detection found;
  found.time = Time(seconds(1.0));
  found.X_WB = {Rotation::from_heading(Angle::degrees(90)), {100, 200, 5}};
  found.obstacles = {piece_of(7, {5, 0}, 1, 0.8), piece_of(3, {20, 0}, 5, 0.9), piece_of(3, {20, 5}, 5, 0.98)};
  display.on_scan({1, true, found, grid});
  const json shown = json::parse(only(items, Kind::kObstacles).payload);
  ASSERT_EQ(shown["obstacles"].size(), 2U) << "whatever they are cut into";
  const json& pole = shown["obstacles"][0];
  EXPECT_EQ(pole["number"], 7) << "the nearest first";
  EXPECT_EQ(pole["kind"], "compact");
  EXPECT_EQ(pole["nearest"], json::array({100.0, 205.0})) << "5 m ahead of a vehicle that heads east";
  EXPECT_EQ(pole["range_m"], 5.0);
  EXPECT_EQ(pole["pieces"], 1);
  const json& wall = shown["obstacles"][1];
  EXPECT_EQ(wall["number"], 3);
  EXPECT_EQ(wall["kind"], "extended");
  EXPECT_NEAR(wall["extent_m"].get<double>(), std::hypot(5, 10), 1e-3);
  EXPECT_EQ(wall["pieces"], 2);
  EXPECT_EQ(wall["existence"], 0.98);
  EXPECT_TRUE(wall["in_scan"].get<bool>());
  EXPECT_FALSE(wall.contains("seen_s")) << "no agent remembers it";
  ASSERT_EQ(shown["pieces"].size(), 3U);
  EXPECT_EQ(shown["pieces"][2]["number"], 3) << "each says what it belongs to";
}

/// Heads east at (100, 200); obstacle 4, of 1 m, 5 m ahead of it, moves.
Detection moving_body_ahead() {
  Detection found;
  found.time = Time(seconds(10.0));
  found.X_WB = {Rotation::from_heading(Angle::degrees(90)), {100, 200, 5}};
  Obstacle body = piece_of(4, {5, 0}, 1, 0.9);
  body.motion.velocity_W = {-0.5, 1.25};
  body.motion.position_covariance << 0.04, 0.01, 0.01, 0.09;
  body.motion.velocity_covariance << 0.002, -0.001, -0.001, 0.003;
  body.motion.track = 12;
  found.obstacles = {body, piece_of(5, {20, 0}, 1, 0.9)};
  return found;
}

TEST(Display, SaysHowABodyMovesAndHowSureThatIs) {
  DisplayState items;
  Display display(items);
  const BodyGrid grid{BodyGridConfig{}};
  display.on_scan({1, true, moving_body_ahead(), grid});
  const json pieces = json::parse(only(items, Kind::kObstacles).payload)["pieces"];
  ASSERT_EQ(pieces.size(), 2U);
  EXPECT_EQ(pieces[0]["track"], 12);
  EXPECT_EQ(pieces[0]["velocity"], json::array({-0.5, 1.25}));
  EXPECT_EQ(pieces[0]["covariance_m2"], json::array({0.04, 0.01, 0.09}));
  EXPECT_EQ(pieces[0]["velocity_covariance"], json::array({0.002, -0.001, 0.003}));
  for (const char* name : {"track", "velocity", "covariance_m2", "velocity_covariance"}) {
    EXPECT_FALSE(pieces[1].contains(name)) << name << " of what lies still";
  }
}

TEST(Display, SaysWhereTheBodyOfAClosestApproachWillBe) {
  DisplayState items;
  Display display(items);
  const BodyGrid grid{BodyGridConfig{}};
  display.on_scan({1, true, moving_body_ahead(), grid});
  Decision decision;
  decision.time = Time(seconds(10.5));
  decision.number = 1;
  decision.obstacle_number = 4;
  decision.approach = ClosestApproach{3.5, 1.25};
  display.on_message({1, decision.time, "goal selector", decision});
  decision.number = 2;
  decision.obstacle_number = 5;  // is not known to move
  display.on_message({2, decision.time, "goal selector", decision});
  const auto shown = of_kind(items, Kind::kDecision);
  ASSERT_EQ(shown.size(), 2U);
  const json approach = json::parse(shown[0].payload)["approach"];
  EXPECT_EQ(approach["in_s"], 3.5);
  EXPECT_EQ(approach["gap_m"], 1.25);
  ASSERT_TRUE(approach.contains("obstacle_m"));
  EXPECT_NEAR(approach["obstacle_m"][0].get<double>(), 99.5 - 4 * 0.5, 1e-6) << "four seconds after the scan";
  EXPECT_NEAR(approach["obstacle_m"][1].get<double>(), 205.5 + 4 * 1.25, 1e-6);
  EXPECT_FALSE(json::parse(shown[1].payload)["approach"].contains("obstacle_m"));
}

constexpr const char* kDetector = "fls detector";

RememberedObstacle remembered(std::uint32_t id, const Eigen::Vector2d& middle, double last_seen_s = 0) {
  RememberedObstacle o;
  o.id = id;
  o.number = static_cast<int>(id) / 2;  // 2 k and 2 k + 1 are pieces of obstacle k
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
    o.outline_W.emplace_back(middle + corner);
  }
  o.margin_m = 1.5;
  o.last_seen = Time(seconds(last_seen_s));
  return o;
}

/// What the agents say they remember after a sweep.
ObstacleScan scan_of(int sweep, std::vector<RememberedObstacle> obstacles, std::vector<std::uint32_t> seen_as = {}) {
  ObstacleScan scan;
  scan.time = Time(seconds(sweep));
  scan.known = std::make_shared<const KnownObstacles>(KnownObstacles{sweep, std::move(obstacles), std::move(seen_as)});
  return scan;
}

// ledger: S6-66
TEST(Display, ShowsWhatTheAgentsRememberByItsNumberBesideWhatIsSeen) {
  DisplayState items;
  Display display(items);
  BodyGrid grid{BodyGridConfig{}};
  display.on_event(test::fix_at(100, 0, 0));  // the run begins
  Detection found;
  found.time = Time(seconds(160));
  found.obstacles.resize(4);
  for (Obstacle& o : found.obstacles) {
    o.outline = {{10, -1}, {12, -1}, {12, 1}};
    o.number = 9;
  }

  RememberedObstacle away = remembered(17, {105, 205}, 130.26), in_view = remembered(18, {110, 200}, 160);
  away.first_seen = in_view.first_seen = Time(seconds(112));
  in_view.whole = true;
  // the third is one that the executor does not count on yet, the fourth it took for none
  display.on_message({1, found.time, kDetector, scan_of(9, {away, in_view}, {18, 18, 44, 0})});
  display.on_scan({9, true, found, grid});
  const json both = json::parse(only(items, Kind::kObstacles).payload), shown = both["pieces"];
  ASSERT_EQ(shown.size(), 6U);
  for (const int i : {0, 1}) EXPECT_EQ(shown[i]["of"], 18) << "both are pieces of it";
  for (const int i : {2, 3}) EXPECT_FALSE(shown[i].contains("of"));
  for (const int i : {0, 1, 2, 3}) EXPECT_FALSE(shown[i].contains("id")) << "the next scan finds it anew";
  EXPECT_EQ(shown[4]["id"], 17);
  EXPECT_EQ(shown[4]["margin_m"], 1.5);
  EXPECT_EQ(shown[4]["since_s"], 12.0) << "since the start of the run";
  EXPECT_EQ(shown[4]["seen_s"], 30.3);
  EXPECT_EQ(shown[4]["outline"][0], json::array({104.0, 204.0}));
  EXPECT_FALSE(shown[4].contains("trail")) << "it was nowhere else";
  EXPECT_EQ(shown[5]["id"], 18);
  EXPECT_EQ(shown[5]["seen_s"], 60.0);
  EXPECT_FALSE(shown[5].contains("outline")) << "the scan has shown all of it";
  const json& things = both["obstacles"];
  ASSERT_EQ(things.size(), 2U);
  EXPECT_EQ(things[0]["number"], 9);
  EXPECT_EQ(things[0]["since_s"], 12.0) << "the agents remember it, too";
  EXPECT_EQ(things[1]["number"], 8) << "then what the scan does not show";
  EXPECT_FALSE(things[1]["in_scan"].get<bool>());
  EXPECT_EQ(things[1]["seen_s"], 30.3);
  EXPECT_NEAR(things[1]["extent_m"].get<double>(), std::hypot(2, 2), 1e-3);

  display.on_scan({10, true, found, grid});  // of which the agents have said nothing yet
  const auto pieces = [&] { return json::parse(only(items, Kind::kObstacles).payload)["pieces"]; };
  for (const json& o : pieces()) EXPECT_FALSE(o.contains("of"));
  display.on_message({2, found.time, kDetector, scan_of(10, {})});
  EXPECT_EQ(pieces().size(), 4U) << "forgotten";
}

TEST(Display, ShowsWhereTheMiddleOfARememberedObstacleHasBeen) {
  DisplayState items;
  Display display(items);
  const auto trail_after = [&](int sweep, const Eigen::Vector2d& middle) {
    display.on_message({1, Time(seconds(sweep)), kDetector, scan_of(sweep, {remembered(3, middle)})});
    return json::parse(only(items, Kind::kObstacles).payload)["pieces"].at(0).value("trail", json::array());
  };
  EXPECT_TRUE(trail_after(1, {10, 20}).empty());
  EXPECT_TRUE(trail_after(2, {10.3, 20.3}).empty()) << "not half a metre";
  EXPECT_EQ(trail_after(3, {10.61, 20.44}), json::parse("[[10.0, 20.0], [10.6, 20.4]]"));
}

TEST(ObstacleTrails, KeepTheirBeginningAndTheirEndAndNeverMoreThanSixteenPlaces) {
  ObstacleTrails trails;
  std::size_t longest = 0;
  for (int i = 0; i <= 1000; ++i) {
    const Eigen::Vector2d middle(0.7 * i, 5);
    trails.update({i, {remembered(1, middle), remembered(2, {0, 0})}, {}});
    const auto trail = trails.of(1);
    longest = std::max(longest, trail.size());
    ASSERT_EQ(trail.front(), Eigen::Vector2d(0, 5));
    ASSERT_LT((trail.back() - middle).norm(), ObstacleTrails::kStep_m);
    for (std::size_t k = 1; k < trail.size(); ++k) ASSERT_LT(trail[k - 1].x(), trail[k].x()) << i;
  }
  EXPECT_EQ(longest, ObstacleTrails::kMaxPlaces);
  EXPECT_EQ(ObstacleTrails::kMaxPlaces, 16U) << "as docs/live-page.md has it";
  EXPECT_EQ(trails.of(2).size(), 1U) << "each has its own";
  trails.update({1001, {remembered(2, {0, 0})}, {}});
  EXPECT_TRUE(trails.of(1).empty()) << "what is forgotten begins anew";
}

TEST(Display, SaysWhatTheAgentsDecideAndWhatIsWrong) {
  DisplayState items;
  Display display(items);
  const auto say = [&](const char* sender, Message message, double t) {
    display.on_message({1, Time(seconds(t)), sender, std::move(message)});
  };
  RoutePlanned route;
  route.version = 3;
  route.waypoints = {{1, 2, 3, 1, {}}, {4, 5, 6, 1, {}}};
  route.avoiding = true;
  say("navigator", route, 1);
  say("executive officer", RouteRequest{1, 4, {}, false}, 1.1);
  const json way = json::parse(only(items, Kind::kWay).payload);
  EXPECT_EQ(way["points"][1][2], 6.0);
  EXPECT_EQ(way["target"], 4);
  EXPECT_TRUE(way["avoiding"].get<bool>());

  Decision decision;
  decision.what = "replan";
  decision.number = 1;
  decision.obstacle_number = 4;
  say("navigator", decision, 2);
  decision.what = "stop";
  decision.number = 3;  // the second was dropped from a queue that was full
  decision.obstacle_number = 0;
  say("safety officer", decision, 3);
  const auto decisions = of_kind(items, Kind::kDecision);
  ASSERT_EQ(decisions.size(), 2U);
  EXPECT_EQ(decisions[1].number, 3U) << "a decision keeps its own number, whatever the page has missed";
  EXPECT_EQ(json::parse(decisions[1].payload)["number"], 3);
  EXPECT_EQ(json::parse(decisions[1].payload)["what"], "stop");
  EXPECT_FALSE(json::parse(decisions[1].payload).contains("obstacle"));
  EXPECT_EQ(json::parse(decisions[0].payload)["obstacle"], 4);

  say("safety officer", SafetyReport{"sonar silent", true, false, MissionEnd::kSurface, "no ping for 3 s"}, 4);
  say("supervisor", AgentLost{"pilot", true, "no turn for 0.5 s"}, 4);
  EXPECT_TRUE(display.wants_counts(Time(seconds(4.0))));
  display.show(Time(seconds(4.0)), DisplayCounts{});
  const auto health = [&] { return json::parse(only(items, Kind::kHealth).payload); };
  EXPECT_EQ(health()["faults"][0]["fault"], "sonar silent");
  EXPECT_EQ(health()["faults"][0]["why"], "no ping for 3 s");
  bool lost = false;
  const json agents = health()["agents"];
  for (const json& agent : agents) lost = lost || (agent["name"] == "pilot" && agent["state"] == "lost");
  EXPECT_TRUE(lost);
  say("safety officer", SafetyReport{"sonar silent", false, false, MissionEnd::kSurface, ""}, 6);
  display.show(Time(seconds(6.0)), DisplayCounts{});
  EXPECT_TRUE(health()["faults"].empty());
}

// ledger: S4-37
TEST(MapDisplay, ShowsTheCellsWithEchoesOfTheSphericalGrid) {
  DisplayState items;
  MapDisplay display(items);
  GridSnapshot sphere{SphericalGridConfig{}};
  sphere.X_WB.translation = {30, -20, 5};
  const Eigen::Vector3d at(0, 10, 0);  // north of the vehicle
  const auto place = *sphere.grid.place_at(at);
  sphere.grid.set_log_odds(place, 5);
  sphere.grid.add_echo(at, 0.1, Time{});
  sphere.grid.set_log_odds({place.direction, place.layer + 1}, 5);  // occupied, but without an echo
  display.show(Time(seconds(2.0)), sphere);
  const std::string bytes = only(items, Kind::kSphere).payload;
  EXPECT_EQ(number_at<double>(bytes, 0), 30);
  EXPECT_EQ(number_at<double>(bytes, 8), -20);
  EXPECT_EQ(number_at<float>(bytes, 16), 5);
  const auto azimuth = static_cast<double>(number_at<float>(bytes, 20)),
             step = static_cast<double>(number_at<float>(bytes, 28));
  const auto layers = number_at<std::uint32_t>(bytes, 32);
  ASSERT_EQ(number_at<std::uint32_t>(bytes, 36), 1u);
  ASSERT_EQ(number_at<std::uint32_t>(bytes, 40), 1u) << "of all";
  ASSERT_EQ(bytes.size(), 44 + 4 * layers + 8);
  const std::size_t row = 44 + 4 * layers;
  const auto layer = number_at<std::uint16_t>(bytes, row);
  EXPECT_NEAR(number_at<float>(bytes, 44 + 4 * layer), 10, 0.5);
  EXPECT_NEAR(azimuth + (number_at<std::uint16_t>(bytes, row + 2) + 0.5) * step, std::numbers::pi / 2, step);
  constexpr int kLocked = 0x8000;
  const auto state = [&](const std::string& of) { return int{number_at<std::uint16_t>(of, row + 6)}; };
  EXPECT_GT(state(bytes), 240);
  EXPECT_EQ(state(bytes) & kLocked, 0);
  sphere.grid.begin_scan();
  for (int i = 0; i < 5; ++i) sphere.grid.add_echo(at, 0.1, Time{});
  display.show(Time(seconds(5.0)), sphere);
  EXPECT_EQ(state(only(items, Kind::kSphere).payload), state(bytes) | kLocked) << "further echoes change it no more";
}

// ledger: S2-52
TEST(Display, ShowsTheCommandInForceAtEachLevel) {
  DisplayState items;
  Display display(items);
  std::uint64_t number = 0;
  const auto say = [&](double s, const char* by, Message message, CommandLevel level, std::uint64_t parent) {
    display.on_message({++number, Time(seconds(s)), by, std::move(message), CommandLink{level, parent}});
  };
  const auto levels = [&] { return json::parse(only(items, Kind::kLevels).payload); };
  RouteRequest request;
  request.target.name = "lane 2, station 3";
  say(1, "executive officer", request, CommandLevel::kVehicle, 7);
  say(1.5, "pilot", HelmOrder{{Angle::degrees(5), 12, 1.5, 0}}, CommandLevel::kPrimitive, 1);
  ASSERT_EQ(levels().size(), 1u) << "set-points are shown once a second";
  say(2.1, "pilot", HelmOrder{{Angle::degrees(5), 12, 1.5, 0}}, CommandLevel::kPrimitive, 1);
  ASSERT_EQ(levels().size(), 2u);
  EXPECT_EQ(levels()[0]["command"], "go to lane 2, station 3");
  EXPECT_EQ(levels()[0]["parent"], 7);
  EXPECT_EQ(levels()[1]["level"], "primitive");
  EXPECT_EQ(levels()[1]["command"], "heading 5 deg, depth 12.0 m, 1.50 m/s");
  EXPECT_EQ(levels()[1]["since_ns"], 1'500'000'000) << "the same command since then";
  auto graph = std::make_shared<PlanGraph>(PlanGraph{"plan"});
  const std::size_t first = graph->add("point 1", {"go to"});
  graph->join(first, PlanEvent::timeout(60), graph->add("end", {"finish"}));
  display.on_message({++number, Time(seconds(2.2)), "executive officer", PlanStep{graph, 0, true}, {}});
  display.on_message(
      {++number, Time(seconds(2.2)), "executive officer", LevelPlan{CommandLevel::kVehicle, 240, true}, {}});
  EXPECT_EQ(levels()[0]["plan"], "\"point 1\" (node 1 of 2); next \"end\" on timeout 60 s");
  display.on_servo(Time(seconds(4.0)), 3, "propeller 6.9 N");
  EXPECT_EQ(levels()[0]["horizon_s"], 240);
  EXPECT_EQ(levels()[2]["by"], "helm gate");
  EXPECT_EQ(levels()[2]["parent"], 3);
  say(4.1, "captain", MissionOrder{MissionOrder::Kind::kHold, nullptr, MissionEnd::kHold, "the operator asks for it"},
      CommandLevel::kMission, 0);
  EXPECT_EQ(levels()[0]["command"], "hold: the operator asks for it") << "at once";
}

// ledger: S4-54
TEST(Display, ShowsWhereSoundsComeFrom) {
  DisplayState items;
  Display display(items);
  Contact barge;
  barge.number = 1;
  barge.frequency_hz = 120.25;
  barge.p_W = {3, -4};
  barge.bearing = Angle::degrees(90);
  barge.sigma = Angle::degrees(2);
  barge.origin = Contact::Origin::kObstacle;
  barge.obstacle = barge.likeliest = 7;
  barge.probability = 0.99;
  barge.nearest = {3, 20};
  Contact alone = barge;
  alone.number = 2;
  alone.origin = Contact::Origin::kNone;
  alone.obstacle = 0;
  alone.none = 0.97;
  alone.place = SoundPlace{{40, -90}, Eigen::Matrix2d::Identity()};
  Contact open = barge;
  open.number = 3;
  open.origin = Contact::Origin::kUnknown;
  const std::array contacts{barge, alone, open};
  display.show(Time(seconds(5.0)), contacts);
  const json sounds = json::parse(only(items, Kind::kSounds).payload);
  ASSERT_EQ(sounds.size(), 3U);
  EXPECT_EQ(sounds[0]["origin"], "obstacle");
  EXPECT_EQ(sounds[0]["obstacle"], 7);
  EXPECT_EQ(sounds[0]["frequency_hz"], 120.25);
  EXPECT_NEAR(sounds[0]["bearing_deg"].get<double>(), 90, 1e-3);
  EXPECT_EQ(sounds[0]["from"], json({3.0, -4.0}));
  EXPECT_EQ(sounds[0]["to"], json({3.0, 20.0}));
  EXPECT_EQ(sounds[1]["origin"], "none");
  EXPECT_EQ(sounds[1]["probability"], 0.97);
  EXPECT_EQ(sounds[1]["to"], json({40.0, -90.0})) << "where its bearings cross";
  EXPECT_FALSE(sounds[1].contains("obstacle"));
  EXPECT_EQ(sounds[2]["origin"], "unknown");
  EXPECT_FALSE(sounds[2].contains("to")) << "its place is unknown";
}

}  // namespace
}  // namespace isobath
