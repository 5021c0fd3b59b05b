// Whether a path is passable, pixel by pixel and block by block.
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/planning/area_traversability.hpp>
#include <isobath/planning/traversability.hpp>
#include <set>
#include <tests/planning/array_field.hpp>

namespace isobath::traversability_test {
namespace {

using Eigen::Vector2d;
using Path = std::vector<Eigen::Vector3d>;
using test::ArrayField;
using testing::HasSubstr;

/// 40 m x 40 m of 0.5 m pixels, north-west corner at (20, -20).
const PixelGrid kGrid{{20, -20}, 0.5};
const PixelWindow kWindow{0, 0, 80, 80};
const PassageConfig kPassage{1, 1};

Traversability along(const DepthField& map, const Path& path, const PassageConfig& passage = kPassage,
                     std::span<const ChartObstacle> chart = {}) {
  const auto t = traversability(map, path, passage, chart);
  EXPECT_TRUE(t);
  return t.value_or(Traversability{});
}

/// Independent of the closed form: the leg in small steps, the distance of each to each square.
std::set<std::pair<int, int>> swept_by_steps(const PixelGrid& grid, const Path& path, double half_width) {
  std::set<std::pair<int, int>> met;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    constexpr int kSteps = 4000;
    for (int k = 0; k <= kSteps; ++k) {
      const Vector2d p = (path[i] + (path[i + 1] - path[i]) * (static_cast<double>(k) / kSteps)).head<2>();
      const Pixel low = grid.at({p.x() + half_width, p.y() - half_width});
      const Pixel high = grid.at({p.x() - half_width, p.y() + half_width});
      for (int row = low.row - 1; row <= high.row + 1; ++row) {
        for (int column = low.column - 1; column <= high.column + 1; ++column) {
          const Vector2d off = (p - grid.centre({column, row})).cwiseAbs() - Vector2d::Constant(grid.pixel_m / 2);
          if (off.cwiseMax(0).norm() <= half_width) met.insert({row, column});
        }
      }
    }
  }
  return met;
}

// ledger: S1-41
TEST(Corridor, MeetsEveryPixelThatComesWithinTheHalfWidth) {
  Random random(1);
  for (int trial = 0; trial < 12; ++trial) {
    const double half_width = trial % 3 == 0 ? 0 : random.uniform(0, 1.5);
    const Path path = {{random.uniform(-6, 6), random.uniform(-6, 6), 1},
                       {random.uniform(-6, 6), random.uniform(-6, 6), 2}};
    const auto swept = sweep(kGrid, path, half_width);
    ASSERT_TRUE(swept);
    std::set<std::pair<int, int>> found;
    for (const SweptPixel& p : *swept) found.insert({p.pixel.row, p.pixel.column});
    EXPECT_EQ(found.size(), swept->size());
    const auto expected = swept_by_steps(kGrid, path, half_width);
    for (const auto& p : expected) EXPECT_TRUE(found.contains(p)) << p.first << " " << p.second;
    EXPECT_LE(found.size(), expected.size() + 2);  // the steps may miss a corner that is only just touched
  }
}

// A leg along a diagonal of the pixels touches both neighbours at each corner. ledger: S1-41
TEST(Corridor, CutsNoCorners) {
  const Path staircase = {{0.25, 0.35, 0}, {1.25, 1.35, 0}};
  EXPECT_EQ(sweep({{4, 0}, 0.5}, staircase, 0)->size(), 5u);
  const Path through_corners = {{0.25, 0.25, 0}, {1.25, 1.25, 0}};
  EXPECT_EQ(sweep({{4, 0}, 0.5}, through_corners, 0)->size(), 7u);
}

// ledger: S1-41
TEST(Corridor, TheVehicleIsAsDeepAsItGetsOverAPixel) {
  const Path path = {{0.25, 0.25, 0}, {0.25, 10.25, 10}};  // a metre deeper a metre
  const auto swept = sweep({{4, 0}, 0.5}, path, 0);
  ASSERT_EQ(swept->size(), 21u);
  for (const SweptPixel& p : *swept) {
    EXPECT_NEAR(p.vehicle_z, std::min(10.0, 0.5 * (p.pixel.column + 1) - 0.25), 1e-6);
    EXPECT_NEAR(p.along_m, std::max(0.0, 0.5 * p.pixel.column - 0.25), 1e-6);
  }
  const Path back = {{0.25, 0.25, 3}, {0.25, 4.25, 3}, {0.25, 0.25, 8}};
  const auto twice = sweep({{4, 0}, 0.5}, back, 0);
  ASSERT_EQ(twice->size(), 9u);
  for (const SweptPixel& p : *twice) {
    EXPECT_EQ(p.leg, 0);
    EXPECT_NEAR(p.vehicle_z, 8 - 5.0 * std::max(0.0, 0.5 * p.pixel.column - 0.25) / 4, 1e-6);
  }
}

// ledger: S1-41
TEST(Corridor, RefusesWhatNoMapHolds) {
  EXPECT_EQ(sweep(kGrid, {}, 1).error(), CorridorRefusal::kNoPath);
  EXPECT_EQ(sweep(kGrid, Path{{NAN, 0, 0}}, 1).error(), CorridorRefusal::kNotFinite);
  EXPECT_EQ(sweep(kGrid, Path{{0, 0, 0}, {1e12, 0, 0}}, 1).error(), CorridorRefusal::kTooLarge);
  EXPECT_EQ(sweep(kGrid, Path{{0, 0, 0}, {100, 0, 0}}, 1e6).error(), CorridorRefusal::kTooLarge);
  EXPECT_EQ(sweep(kGrid, Path{{0.25, 0.25, 5}}, 0)->size(), 1u);
}

// A wall of one row of pixels across a corridor that runs north over 10 m. ledger: S1-41
TEST(Traversability, AWallGivesZeroStrictlyAndItsShareInFractions) {
  ArrayField map(kGrid, kWindow, 10);
  for (int column = 0; column < 80; ++column) map.set({column, 30}, 3.5);
  const Path path = {{-5, 0.25, 3}, {5, 0.25, 3}};
  const Traversability t = along(map, path);
  EXPECT_EQ(t.strict(), 0);
  const std::size_t wide = 5;  // from 0.25 - 1 to 0.25 + 1: four whole pixels and two halves, less the corners
  EXPECT_EQ(t.pixels - t.clear, wide);
  EXPECT_NEAR(t.fraction, 1 - static_cast<double>(wide) / static_cast<double>(t.pixels), 1e-12);
  ASSERT_TRUE(t.blocking);
  EXPECT_EQ(t.blocking->pixel.row, 30);
  EXPECT_NEAR(t.blocking->along_m, 5 + 4.5 - 1, 1e-6);  // the wall begins at north 4.5, the vehicle is there 1 m before
  EXPECT_EQ(t.map_version, map.version());
  EXPECT_EQ(along(map, {{-5, 0.25, 2.5}, {5, 0.25, 2.5}}).strict(), 1) << "exactly the clearance is enough";
}

// Every single pixel of the corridor, one after the other. ledger: S1-41
TEST(Traversability, NoObstacleOfOnePixelIsMissed) {
  ArrayField map(kGrid, kWindow, 10);
  const Path path = {{-7.3, -3.1, 2}, {4.9, 6.2, 4}};
  const auto swept = swept_by_steps(kGrid, path, 0.7);
  ASSERT_GT(swept.size(), 60u);
  for (const auto& [row, column] : swept) {
    map.set({column, row}, 1.0);
    const Traversability t = along(map, path, {0.7, 0.5});
    EXPECT_EQ(t.pixels - t.clear, 1u);
    EXPECT_EQ(t.blocking->pixel, (Pixel{column, row}));
    EXPECT_EQ(t.worst->pixel, (Pixel{column, row}));
    map.set({column, row}, 10.0);
  }
}

// ledger: S1-41
TEST(Traversability, UnknownDepthIsNotSafeDepth) {
  ArrayField map(kGrid, kWindow, 10);
  map.set({40, 40}, DepthPixel{});
  const Path path = {{0, -5, 2}, {0, 5, 2}};
  const Traversability t = along(map, path);
  EXPECT_EQ(t.unknown, 1u);
  EXPECT_EQ(t.pixels - t.clear, 1u);
  EXPECT_EQ(t.strict(), 0);
  EXPECT_THAT(t.reason(), HasSubstr("leg 1: unknown depth at north -0.25 m, east 0.25 m"));
  EXPECT_EQ(along(map, {{0, 30, 2}, {0, 40, 2}}).fraction, 0) << "outside of the map";
}

// ledger: S1-41
TEST(Traversability, WeighsByConfidence) {
  ArrayField map(kGrid, kWindow, 10);
  const Path path = {{0, -5, 2}, {0, 5, 2}};
  EXPECT_EQ(along(map, path).weighted, 1);
  const auto with = [&](const DepthPixel& p) {
    ArrayField changed = map;
    changed.set({40, 40}, p);
    return along(changed, path);
  };
  const double n = static_cast<double>(along(map, path).pixels);
  EXPECT_NEAR(with(ArrayField::of(1, 20)).weighted, (n - 1) / n, 1e-12);
  EXPECT_NEAR(with(ArrayField::of(1, 0)).weighted, (n - 1) / (n - 1 + 1.0 / 21), 1e-12);
  EXPECT_NEAR(with({}).weighted, (n - 1) / n, 1e-12);
}

// A path cut into more legs is the same path. ledger: S1-41
TEST(Traversability, DoesNotDependOnHowThePathIsCut) {
  ArrayField map(kGrid, kWindow, 10);
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    map.set({static_cast<int>(random.index(80)), static_cast<int>(random.index(80))}, random.uniform(0, 9));
  }
  const Path whole = {{-9, -8, 1}, {8, 3, 6}};
  Path cut;
  for (int i = 0; i <= 17; ++i) cut.push_back(whole[0] + (whole[1] - whole[0]) * (i / 17.0));
  const Traversability a = along(map, whole), b = along(map, cut);
  EXPECT_EQ(a.pixels, b.pixels);
  EXPECT_EQ(a.clear, b.clear);
  EXPECT_EQ(a.blocking->pixel, b.blocking->pixel);
  EXPECT_NEAR(a.blocking->along_m, b.blocking->along_m, 1e-6);
}

// ledger: S1-41
TEST(Traversability, SaysWhyInOneLine) {
  ArrayField map(kGrid, kWindow, 10);
  const Path path = {{-10, 0.25, 3}, {0, 0.25, 3}, {0, 10, 3}};
  EXPECT_THAT(along(map, path, {0, 0.5}).reason(), HasSubstr("clear: "));
  EXPECT_THAT(along(map, path, {0, 0.5}).reason(), HasSubstr("6.50 m to spare"));
  map.set({50, 40}, 1.85);
  EXPECT_EQ(along(map, path, {0, 0.5}).reason(),
            "leg 2: 1.85 m of water at north -0.25 m, east 5.25 m; 3.00 m draught and 0.50 m clearance needed");
}

// ledger: S1-41
TEST(Traversability, RocksAndPipelinesOfTheChartBlock) {
  const ArrayField map(kGrid, kWindow, 10);
  const Path path = {{0.25, -10, 3}, {0.25, 10, 3}};
  const auto with = [&](const ChartObstacle& o) { return along(map, path, {1, 1}, std::span(&o, 1)); };
  EXPECT_EQ(with({{3, 0}, {3, 0}, 1}).strict(), 1) << "2.75 m beside the line, with 1 m of its own and 1 m of ours";
  const Traversability rock = with({{1.75, 0.25}, {1.75, 0.25}, 1});
  EXPECT_EQ(rock.strict(), 0);
  EXPECT_EQ(rock.blocking->obstacle, 0u);
  EXPECT_EQ(rock.unknown, 0u);
  EXPECT_THAT(rock.reason(), HasSubstr("obstacle 0 of the chart at north"));
  const Traversability pipe = with({{-15, 5}, {15, 5}, 0.2});
  EXPECT_EQ(pipe.strict(), 0);
  EXPECT_NEAR(pipe.blocking->along_m, 10 + 4.5 - 1, 1e-6);  // its pixels begin at east 4.5
  EXPECT_EQ(with({{-15, 5}, {15, 5}, 0.2, 4}).strict(), 1) << "its top is the clearance below the vehicle";
  EXPECT_EQ(with({{-15, 5}, {15, 5}, 0.2, 3.99}).strict(), 0);
}

/// The 80 x 80 pixels of the array in the middle of a depth map of 128 x 128 pixels.
std::shared_ptr<const DepthSnapshot> depths_of(const ArrayField& from) {
  DepthMapConfig config;
  config.window_pixels = 64;
  config.area_m = 64;
  const DepthArea area = area_of(config);
  DepthMap map(config, area, DepthTrees(area.levels), {0, 0});
  std::vector<std::pair<Pixel, DepthPixel>> pixels;
  for (std::int32_t row = 0; row < 80; ++row) {
    for (std::int32_t column = 0; column < 80; ++column) {
      DepthPixel pixel = from.at({column, row});
      if (!pixel.known()) continue;
      pixel.state_word = DepthPixel::word_of_state(pixel.confidence(), kSensed | kSeenByDepth, 1);
      pixels.emplace_back(map.grid().at(kGrid.centre({column, row})), pixel);
    }
  }
  map.write(pixels);
  map.flush();
  return map.snapshot();
}

// ledger: S1-82 S1-41
TEST(AreaTraversability, BracketsTheFineMap) {
  Random random(8);
  for (int trial = 0; trial < 30; ++trial) {
    ArrayField map(kGrid, kWindow, 10);
    for (int patch = 0; patch < 12; ++patch) {
      const int column = static_cast<int>(random.index(66)), row = static_cast<int>(random.index(66));
      const bool unknown = random.uniform() < 0.3;
      const double depth = random.uniform(0, 9);
      for (int i = 0; i < 14 * 14; ++i) {
        const Pixel p{column + i % 14, row + i / 14};
        unknown ? map.set(p, DepthPixel{}) : map.set(p, depth);
      }
    }
    const auto depths = depths_of(map);
    const Path path = {{random.uniform(-18, 18), random.uniform(-18, 18), random.uniform(0, 5)},
                       {random.uniform(-18, 18), random.uniform(-18, 18), random.uniform(0, 5)},
                       {random.uniform(-18, 18), random.uniform(-18, 18), random.uniform(0, 5)}};
    const auto area = corridor_traversability(*depths, path, kPassage);
    ASSERT_TRUE(area);
    const double fine = along(*depths, path).fraction;
    EXPECT_EQ(fine, along(map, path).fraction);
    EXPECT_LE(area->least(), fine + 1e-12);
    EXPECT_GE(area->most(), fine - 1e-12);
    EXPECT_NEAR(area->value(), area->least() + area->mixed_share() / 2, 1e-12);
  }
}

// ledger: S1-82
TEST(AreaTraversability, AGapForOneIsNotAGapForTwo) {
  ArrayField map(kGrid, kWindow, 10);
  for (int column = 0; column < 80; ++column) {
    if (column >= 32 && column < 48) continue;  // a gap of 8 m in a wall of one block
    for (int row = 40; row < 48; ++row) map.set({column, row}, 1);
  }
  const auto depths = depths_of(map);
  const Path path = {{-10, 0, 3}, {10, 0, 3}};
  const auto abreast = vehicles_abreast(*depths, path, kPassage, {4, 6.5, 0});
  ASSERT_TRUE(abreast);
  EXPECT_EQ(abreast->sure, 1);
  EXPECT_EQ(abreast->possible, 1);
  EXPECT_EQ(vehicles_abreast(*depths, path, kPassage, {4, 2.5, 0})->sure, 3);  // 2 * (1 + 2.5) = 7 m
  EXPECT_EQ(vehicles_abreast(*depths, path, kPassage, {4, 2.5, 6.5})->sure, 0) << "the deepest touches the bottom";
  EXPECT_FALSE(corridor_traversability(*depths, path, kPassage, {2, 6.5, 0})->possible());
}

// Six blocks in a row: deep, shoal, half shoal, deep with an unknown pixel, unknown, beyond the map. ledger: S1-82
TEST(AreaTraversability, ABlockIsClearBlockedOrMixed) {
  ArrayField map(kGrid, kWindow, 9);
  for (int i = 0; i < 8 * 8; ++i) {
    map.set({8 + i % 8, i / 8}, 2);
    if (i % 8 < 4) map.set({16 + i % 8, i / 8}, 2);
    map.set({32 + i % 8, i / 8}, DepthPixel{});
  }
  map.set({24, 0}, DepthPixel{});
  const auto depths = depths_of(map);
  const auto verdict = [&](int block) {
    const Vector2d middle = kGrid.centre({8 * block + 3, 3});
    const Path there = {{middle.x(), middle.y(), 3}};
    return *corridor_traversability(*depths, there, {0.1, 1});
  };
  EXPECT_TRUE(verdict(0).sure());
  EXPECT_GT(verdict(1).blocked, 0u);
  EXPECT_EQ(verdict(2).mixed_share(), 1);
  EXPECT_EQ(verdict(3).mixed_share(), 1);
  EXPECT_GT(verdict(4).blocked, 0u);
  EXPECT_GT(verdict(-2).blocked, 0u) << "outside is unknown";
  const Vector2d a = kGrid.centre({3, 3}), b = kGrid.centre({36, 3});
  const auto all = corridor_traversability(*depths, Path{{a.x(), a.y(), 3}, {b.x(), b.y(), 3}}, {0, 1});
  EXPECT_NEAR(all->value(), 0.5 * (all->least() + all->most()), 1e-12);
  EXPECT_FALSE(all->possible());
}

}  // namespace
}  // namespace isobath::traversability_test
