// How a spherical grid is laid out: layers, directions, tables and runs of cells, against plain arithmetic and
// std::map.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/map/spherical/spherical_cells.hpp>
#include <isobath/map/spherical/spherical_layers.hpp>
#include <map>
#include <numbers>
#include <set>

namespace isobath {
namespace {

using Eigen::Vector3d;
using testing::ElementsAreArray;

// ledger: S4-04 S4-E07 S4-D03
TEST(SphericalLayers, AreAsManyAsThePaperCounts) {
  const Angle bucket = Angle::degrees(2.5);
  for (const auto& [range, growing] : {std::pair(50.0, 63), {100.0, 79}, {200.0, 96}}) {
    const SphericalLayers layers(0.15, bucket, range);
    EXPECT_EQ(layers.uniform(), 23);
    EXPECT_EQ(layers.count() - layers.uniform(), growing) << range;
  }
  EXPECT_NEAR(0.15 / bucket.radians(), 3.44, 0.005) << "where growth begins";
  const SphericalLayers layers(0.15, bucket, 50);
  EXPECT_NEAR(layers.thickness(layers.count() - 1), 2.1, 0.05);
  EXPECT_NEAR(layers.thickness(24) / layers.thickness(23), 1.0436, 1e-4);
  for (int i = 0; i < layers.count(); ++i) EXPECT_GE(layers.thickness(i), 0.15 - 1e-12);
}

// ledger: S4-04
TEST(SphericalLayers, IndexAndEdgesAreInverse) {
  Random random(4);
  for (const double step : {2.5, 1.0, 0.5, 10.0}) {
    const SphericalLayers layers(0.15, Angle::degrees(step), 100);
    for (int i = 0; i < layers.count(); ++i) {
      ASSERT_EQ(layers.layer_at(layers.inner(i)), i) << step;
      ASSERT_EQ(layers.layer_at(std::nextafter(layers.outer(i), 0)), i) << step;
    }
    for (int i = 0; i < 25'000; ++i) {
      const double r = random.uniform(0, 100);
      const int layer = layers.layer_at(r);
      ASSERT_LE(layers.inner(layer), r);
      ASSERT_GT(layers.outer(layer), r);
      // the closed form of S4-04
      const double r_0 = layers.inner(layers.uniform()), d = step * std::numbers::pi / 180;
      const double closed = r < r_0 ? r / 0.15 : layers.uniform() + std::log1p((r - r_0) * d / 0.15) / std::log1p(d);
      ASSERT_NEAR(layer + 0.5, closed, 0.5 + 1e-9);
    }
  }
  EXPECT_THROW(SphericalLayers(1e-9, Angle::degrees(0.25), 500), Error);
}

// ledger: S4-02 S4-03 S4-E02
TEST(DirectionBuckets, AgreeWithTheArcFunctionsAndReturnTheirOwnCentres) {
  Random random(5);
  for (const double step : {2.5, 0.5, 10.0}) {
    const DirectionBuckets buckets(Angle::degrees(step));
    double sum = 0;
    for (int e = 0; e < buckets.elevations(); ++e) {
      sum += buckets.azimuths() * buckets.solid_angle(e);
      for (int a = 0; a < buckets.azimuths(); a += 7) {
        ASSERT_EQ(buckets.at(buckets.middle({a, e})), (SphericalDirection{a, e}));
      }
    }
    EXPECT_NEAR(sum, 4 * std::numbers::pi, 1e-9);
    for (int i = 0; i < 30'000; ++i) {
      Vector3d p;
      for (Eigen::Index k = 0; k < 3; ++k) p[k] = random.normal() * (i % 3 == k ? 1e-3 : 1);
      const double azimuth = std::atan2(p.y(), p.x()) * 180 / std::numbers::pi;
      const double elevation = std::atan2(p.z(), p.head<2>().norm()) * 180 / std::numbers::pi;
      const SphericalDirection d = buckets.at(p);
      ASSERT_EQ(d.azimuth, static_cast<int>(std::floor((azimuth + 180) / step)));
      ASSERT_EQ(d.elevation, static_cast<int>(std::floor((elevation + 90) / step)));
    }
  }
  const DirectionBuckets buckets(Angle::degrees(2.5));
  EXPECT_EQ(buckets.count(), 10368);
  EXPECT_NEAR(buckets.solid_angle(36) / buckets.solid_angle(71), 46, 1);
  EXPECT_EQ(buckets.at({-1, 0.0, 0}).azimuth, 0) << "pi is -pi";
  EXPECT_EQ(buckets.at({-1, -0.0, 0}).azimuth, 0);
  EXPECT_EQ(buckets.at({-1, 1e-9, 0}).azimuth, 143);
  EXPECT_EQ(buckets.at({0, 0, 5}).elevation, 71) << "the poles";
  EXPECT_EQ(buckets.at({0, 0, -5}).elevation, 0);
  EXPECT_THROW(DirectionBuckets(Angle::degrees(7)), Error) << "half a turn is no multiple";
}

using PlainBeams = std::map<SphericalDirection, std::set<int>>;

std::vector<SphericalDirection> forwards(const DirectionTable& table) {
  std::vector<SphericalDirection> all;
  for (auto d = table.first(); d; d = table.after(*d)) all.push_back(*d);
  return all;
}

void expect_same_beams(const SphericalCells& cells, const PlainBeams& plain) {
  std::vector<SphericalDirection> beams;
  std::set<int> azimuths;
  std::size_t count = 0;
  for (const auto& [d, layers] : plain) {
    beams.push_back(d);
    azimuths.insert(d.azimuth);
    count += layers.size();
    std::vector<int> held;
    for (const SphericalCell& cell : cells.beam(d)) held.push_back(cell.layer);
    ASSERT_THAT(held, ElementsAreArray(layers)) << "nearest first";
    for (const int layer : layers) ASSERT_EQ(cells.find(d, layer)->echoes, static_cast<unsigned>(7 * layer));
  }
  ASSERT_EQ(forwards(cells.directions()), beams);
  ASSERT_EQ(cells.directions().second_tables(), static_cast<int>(azimuths.size()));
  ASSERT_EQ(cells.size(), count);
}

// ledger: S4-07 S4-08 S4-09 S4-10 S4-D05 S4-E10
TEST(SphericalCells, HoldWhatAPlainMapHoldsInTheSameOrders) {
  Random random(6);
  SphericalCells cells(144, 72, 102);
  PlainBeams plain;
  for (int round = 0; round < 40; ++round) {
    for (int i = 0; i < 400; ++i) {
      SphericalDirection d;
      d.azimuth = static_cast<int>(random.index(12)) * 13 % 144;
      d.elevation = static_cast<int>(random.index(72));
      const int layer = static_cast<int>(random.index(102));
      if (random.uniform() < (round % 10 < 6 ? 0.7 : 0.1)) {
        bool made = false;
        cells.at(d, layer, made).echoes = static_cast<unsigned>(7 * layer);
        ASSERT_EQ(made, plain[d].insert(layer).second);
      } else {
        const auto held = plain.find(d);
        const bool erased = held != plain.end() && held->second.erase(layer) > 0;
        if (erased && held->second.empty()) plain.erase(held);
        ASSERT_EQ(cells.erase(d, layer), erased);
      }
    }
    ASSERT_NO_FATAL_FAILURE(expect_same_beams(cells, plain)) << round;
  }
  const std::size_t before = cells.bytes();
  EXPECT_EQ(cells.find({5, 5}, 3), nullptr) << "no cell is made by asking";
  EXPECT_FALSE(cells.any({5, 5}));
  EXPECT_EQ(cells.bytes(), before);
  for (const auto& [d, layers] : PlainBeams(plain)) {
    for (const int layer : layers) cells.erase(d, layer);
  }
  expect_same_beams(cells, {});
}

// ledger: S4-16
TEST(SphericalCells, ThoseOfALayerAreAFilterOverAll) {
  Random random(7);
  SphericalCells cells(144, 72, 200);
  PlainBeams plain;
  for (int i = 0; i < 3000; ++i) {
    SphericalDirection d;
    d.azimuth = static_cast<int>(random.index(144));
    d.elevation = static_cast<int>(random.index(72));
    const int layer = static_cast<int>(random.index(200));
    bool made = false;
    cells.at(d, layer, made);
    plain[d].insert(layer);
  }
  for (const int layer : {0, 63, 64, 127, 128, 199}) {
    std::vector<SphericalDirection> expected, found;
    for (const auto& [d, layers] : plain) {
      if (layers.count(layer) > 0) expected.push_back(d);
    }
    cells.each_of_layer(layer, [&](const SphericalDirection& d, const SphericalCell& cell) {
      EXPECT_EQ(cell.layer, layer);
      found.push_back(d);
    });
    EXPECT_EQ(found, expected);
  }
}

// ledger: S4-08
TEST(SphericalCells, EchoesThatComeNearestFirstMoveHardlyAnyCell) {
  SphericalCells cells(144, 72, 102);
  bool made = false;
  for (int layer = 0; layer < 102; ++layer) cells.at({3, 4}, layer, made);
  EXPECT_EQ(cells.records_moved(), 0u) << "the only beam grows where it is";
  SphericalCells many(144, 72, 102);
  for (int layer = 0; layer < 102; ++layer) {
    for (int a = 0; a < 144; ++a) many.at({a, 30}, layer, made);
  }
  EXPECT_LT(many.records_moved(), 6 * many.size()) << "room doubles; what is left behind is swept up at times";
  SphericalCells against(144, 72, 102);
  for (int layer = 102; layer-- > 0;) against.at({3, 4}, layer, made);
  EXPECT_EQ(against.records_moved(), 101u * 102u / 2u) << "against the order each moves all";
  EXPECT_EQ(against.beam({3, 4}).front().layer, 0);
}

// ledger: S4-21
TEST(SphericalCells, TurnByWholeBucketsWithoutMovingARecord) {
  Random random(8);
  SphericalCells cells(144, 72, 102);
  PlainBeams plain;
  for (int i = 0; i < 2000; ++i) {
    SphericalDirection d;
    d.azimuth = static_cast<int>(random.index(144));
    d.elevation = static_cast<int>(random.index(72));
    const int layer = static_cast<int>(random.index(102));
    bool made = false;
    cells.at(d, layer, made).echoes = static_cast<unsigned>(7 * layer);
    plain[d].insert(layer);
  }
  const std::uint64_t moved = cells.records_moved();
  for (int turn = 0; turn < 144; ++turn) {
    PlainBeams turned;
    for (const auto& [d, layers] : plain) turned[{(d.azimuth + turn) % 144, d.elevation}] = layers;
    ASSERT_NO_FATAL_FAILURE(expect_same_beams(cells, turned)) << turn;
    cells.turn(1);
  }
  expect_same_beams(cells, plain);
  cells.turn(-50);
  cells.turn(50 - 288);
  expect_same_beams(cells, plain);
  EXPECT_EQ(cells.records_moved(), moved);
}

}  // namespace
}  // namespace isobath
