// What a spherical grid says of echoes, ways, clusters and known things, against brute force over all of its cells.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/map/spherical/spherical_clusters.hpp>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <isobath/map/spherical/spherical_passage.hpp>
#include <malloc.h>
#include <numbers>
#include <tests/support/directions.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using test::kRadiansADegree, test::towards;

void occupy_at(SphericalGrid& grid, const Vector3d& p, double probability = 0.95) {
  const auto place = grid.add_echo(p, 0.1, Time{});
  if (place) grid.set_log_odds(*place, std::log(probability / (1 - probability)));
}
const SphericalCell& only_cell(const SphericalGrid& grid) {
  return grid.cells().beam(*grid.cells().directions().first()).front();
}

// ledger: S4-13
TEST(SphericalGrid, KeepsTheRecordOfItsEchoes) {
  SphericalGrid grid;
  const Vector3d p = 10.02 * towards(31, 6);
  const double at[] = {1, 2.5, 2.5, 7};
  for (const double t : at) {
    if (t != 2.5) grid.begin_scan();
    grid.add_echo(p, 0.1, Time{} + seconds(t));
  }
  ASSERT_EQ(grid.cells().size(), 1u);
  const SphericalCell& cell = only_cell(grid);
  EXPECT_EQ(cell.echoes, 4u);
  EXPECT_EQ(cell.scans, 2u);
  EXPECT_EQ(to_seconds(cell.first_echo), 1);
  EXPECT_EQ(to_seconds(cell.last_echo), 7);
  EXPECT_FALSE(cell.locked || cell.prior);
  EXPECT_LE(grid.layers().inner(cell.layer), 10.02);
  EXPECT_GT(grid.layers().outer(cell.layer), 10.02);
  EXPECT_LT((grid.point_of(cell) - p).norm(), 0.01);
  EXPECT_FALSE(grid.add_echo(50.01 * towards(0, 0), 0.1, Time{})) << "beyond the range";
  EXPECT_EQ(grid.log_odds({{0, 0}, 0}), grid.prior_log_odds());
}

// ledger: S4-14
TEST(SphericalGrid, LocksACellOnEvidenceAndKeepsItsStateThen) {
  SphericalGrid grid;
  const Vector3d p = 20 * towards(100, -3);
  const auto echo = [&] { return *grid.add_echo(p, 0.1, Time{}); };
  const SphericalPlace place = echo();
  grid.set_log_odds(place, 4);
  for (int i = 0; i < 5; ++i) echo();
  EXPECT_FALSE(only_cell(grid).locked) << "six echoes of one scan";
  grid.begin_scan();
  echo();
  EXPECT_TRUE(only_cell(grid).locked);
  grid.set_log_odds(place, -5);
  grid.decay(seconds(1e6), seconds(1), Time{});
  EXPECT_EQ(grid.log_odds(place), 4);
  echo();
  EXPECT_EQ(only_cell(grid).echoes, 8u) << "counts go on";
}

// ledger: S4-11
TEST(SphericalGrid, SaysWhetherAnythingIsInADirection) {
  SphericalGrid grid;
  occupy_at(grid, 12 * towards(45.1, 10.1));
  EXPECT_FALSE(grid.is_empty(towards(46, 11)));
  EXPECT_TRUE(grid.is_empty(towards(48, 11)));
}

// ledger: S4-12
TEST(SphericalPassage, AgreesWithBruteForceOverAllCells) {
  Random random(11);
  int blocked = 0;
  for (int round = 0; round < 40; ++round) {
    SphericalGrid grid;
    for (int i = 0; i < 60; ++i) {
      const double a = random.uniform(-180, 180), e = random.uniform(-70, 70), r = random.uniform(1, 40);
      occupy_at(grid, r * towards(a, e), random.uniform(0.2, 0.99));
    }
    if (round % 2 == 1) grid.turn(Angle::degrees(41.3));
    grid.translate({0.03, -0.02, 0.01});  // less than a filling
    for (int i = 0; i < 30; ++i) {
      const double a = random.uniform(-180, 180), e = random.uniform(-60, 60);
      const Vector3d course = towards(a, e);
      const double distance = random.uniform(2, 40), radius = random.uniform(0.2, 3);
      double nearest = 1e9;
      grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
        for (const SphericalCell& cell : beam) {
          if (SphericalGrid::probability(cell) < grid.config().occupied) continue;
          const Vector3d p = grid.point_of(cell);
          const double along = p.dot(course), aside = (p - along * course).norm();
          const double wide = radius + grid.layers().thickness(cell.layer) / 2;
          if (along >= 0 && along <= distance && aside <= wide) nearest = std::min(nearest, along);
        }
      });
      const WayAhead way = way_ahead(grid, 3 * course, distance, radius);
      if (nearest > 1e8) {
        ASSERT_EQ(way.verdict, WayAhead::Verdict::kUnknown) << "nobody has looked";
        ASSERT_FALSE(way.blocking);
      } else {
        ASSERT_EQ(way.verdict, WayAhead::Verdict::kBlocked);
        ASSERT_NEAR(way.blocked_m, nearest, 1e-6);
        ASSERT_TRUE(grid.cells().find(way.blocking->direction, way.blocking->layer));
        ++blocked;
      }
    }
  }
  EXPECT_GT(blocked, 300);
}

// ledger: S4-12
TEST(SphericalPassage, TellsClearFromUnknownAndSeesWhatIsBesideTheBeam) {
  SphericalGrid grid;
  for (double a = 45; a <= 135; a += 2.5) {
    grid.add_clear(Vector3d::Zero(), towards(a, 1), Angle::degrees(1.25), {.to_m = 25}, Time{});
  }
  EXPECT_EQ(way_ahead(grid, towards(90, 1), 20, 1).verdict, WayAhead::Verdict::kClear);
  const WayAhead far = way_ahead(grid, towards(90, 1), 40, 1);
  EXPECT_EQ(far.verdict, WayAhead::Verdict::kUnknown);
  EXPECT_NEAR(far.clear_m, 25, grid.layers().thickness(grid.layers().layer_at(25)));
  EXPECT_EQ(way_ahead(grid, towards(-90, 1), 5, 1).verdict, WayAhead::Verdict::kUnknown) << "nobody looked back";
  occupy_at(grid, {1.3, 15, 0.3});  // five degrees off: beside the beam, and within the vehicle's width
  const WayAhead way = way_ahead(grid, towards(90, 1), 20, 1.2);
  EXPECT_EQ(way.verdict, WayAhead::Verdict::kBlocked);
  EXPECT_NEAR(way.blocked_m, 15, 0.01);
  EXPECT_TRUE(grid.is_empty(towards(90, 1)));
  EXPECT_EQ(way_ahead(grid, towards(90, 1), 20, 0.5).verdict, WayAhead::Verdict::kClear) << "a thin one passes";
}

// ledger: S4-29
TEST(SphericalClusters, AreWhatHangsTogether) {
  SphericalGrid grid;
  const auto pipe = [&](double azimuth) {
    for (double e = -20; e <= 20; e += 2.5) occupy_at(grid, 15 * towards(azimuth, e + 1));
  };
  pipe(31);
  pipe(31 + 3 * 2.5);  // two empty buckets between
  for (double a = 0; a < 360; a += 10) {
    for (double e = -80; e <= 80; e += 10) occupy_at(grid, Vector3d(-20, 1, 1) + 1.5 * towards(a, e));
  }
  for (double a = 176; a <= 186; a += 2.5) occupy_at(grid, 8 * towards(a, 30));  // across +-180
  for (double a = 0; a < 360; a += 2.5) occupy_at(grid, 30 * towards(a, 89.5));  // round the pole
  const auto all = clusters(grid, 0.5);
  ASSERT_EQ(all.size(), 5u);
  std::vector<std::size_t> sizes;
  std::size_t cells = 0;
  for (const SphericalCluster& c : all) {
    sizes.push_back(c.cells.size());
    cells += c.cells.size();
  }
  EXPECT_EQ(cells, grid.cells().size());
  EXPECT_TRUE(std::is_sorted(sizes.rbegin(), sizes.rend()));
  const auto near = [&](const Vector3d& p) {
    return std::count_if(all.begin(), all.end(), [&](const auto& c) { return (c.centroid - p).norm() < 1.5; });
  };
  EXPECT_EQ(near({-20, 1, 1}), 1) << "a sphere is one";
  EXPECT_EQ(near(8 * towards(181, 30)), 1) << "not cut at 180 degrees";
  EXPECT_EQ(near({0, 0, 30}), 1) << "nor at the pole";
  EXPECT_TRUE(clusters(grid, 0.99).empty());
}

// ledger: S4-29
TEST(SphericalClusters, AgreeWithFloodingFromCellToCell) {
  Random random(12);
  SphericalGrid grid;
  std::vector<SphericalPlace> places;
  for (int i = 0; i < 700; ++i) {
    const double a = random.uniform(150, 210), e = random.uniform(-20, 20), r = random.uniform(8, 14);
    occupy_at(grid, r * towards(a, e));
  }
  grid.cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) places.push_back({d, cell.layer});
  });
  const auto touch = [](const SphericalPlace& a, const SphericalPlace& b) {
    const int across = std::abs(a.direction.azimuth - b.direction.azimuth);
    return std::min(across, 144 - across) <= 1 && std::abs(a.direction.elevation - b.direction.elevation) <= 1 &&
           std::abs(a.layer - b.layer) <= 1;
  };
  std::vector<int> label(places.size(), -1);
  int count = 0;
  for (std::size_t seed = 0; seed < places.size(); ++seed) {
    if (label[seed] >= 0) continue;
    std::vector<std::size_t> waiting{seed};
    label[seed] = count;
    while (!waiting.empty()) {
      const std::size_t at = waiting.back();
      waiting.pop_back();
      for (std::size_t i = 0; i < places.size(); ++i) {
        if (label[i] >= 0 || !touch(places[at], places[i])) continue;
        label[i] = count;
        waiting.push_back(i);
      }
    }
    ++count;
  }
  const auto all = clusters(grid, 0.5);
  ASSERT_EQ(all.size(), static_cast<std::size_t>(count));
  for (const SphericalCluster& c : all) {
    std::vector<SphericalPlace> expected;
    const auto first = std::find(places.begin(), places.end(), c.cells.front()) - places.begin();
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (label[i] == label[static_cast<std::size_t>(first)]) expected.push_back(places[i]);
    }
    EXPECT_EQ(c.cells, expected);
  }
}

// ledger: S4-17
TEST(SphericalZoom, ACoarseCellFollowsFromItsParts) {
  Random random(13);
  SphericalGridConfig fine;
  fine.lock_echoes = 0;
  SphericalGridConfig coarse = fine;
  coarse.bucket = Angle::degrees(10);
  coarse.min_layer_m = 0.6;
  for (const ZoomRule rule : {ZoomRule::kAny, ZoomRule::kLargest}) {
    SphericalGrid from(fine), to(coarse);
    for (int i = 0; i < 800; ++i) {
      const double a = random.uniform(0, 60), e = random.uniform(0, 40), r = random.uniform(5, 20);
      occupy_at(from, r * towards(a, e), random.uniform(0.02, 0.6));
    }
    zoom(from, rule, to);
    std::map<SphericalPlace, double> expected;  // 1 - P, or P
    std::uint64_t echoes = 0;
    from.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
      for (const SphericalCell& cell : beam) {
        const double p = SphericalGrid::probability(cell);
        const SphericalPlace place = *to.place_at(from.point_of(cell));
        const auto [at, added] = expected.emplace(place, rule == ZoomRule::kAny ? 1 : 0);
        at->second = rule == ZoomRule::kAny ? at->second * (1 - p) : std::max(at->second, p);
        echoes += cell.echoes;
      }
    });
    EXPECT_EQ(to.cells().size(), expected.size());
    std::uint64_t kept = 0;
    for (const auto& [place, value] : expected) {
      const SphericalCell* cell = to.cells().find(place.direction, place.layer);
      ASSERT_TRUE(cell);
      ASSERT_NEAR(SphericalGrid::probability(*cell), rule == ZoomRule::kAny ? 1 - value : value, 1e-5);
      kept += cell->echoes;
    }
    EXPECT_EQ(kept, echoes);
  }
}

// ledger: S4-17
TEST(SphericalZoom, AFinerGridSeparatesTwoTargetsOfOneCoarseCell) {
  const Vector3d one = 20 * towards(31, 1), other = 20 * towards(33.4, 1);
  SphericalGridConfig coarse;
  coarse.bucket = Angle::degrees(5);
  SphericalGridConfig fine;
  fine.bucket = Angle::degrees(0.5);
  SphericalGrid far(coarse), close(fine);
  for (SphericalGrid* grid : {&far, &close}) {
    occupy_at(*grid, one);
    occupy_at(*grid, other);
  }
  EXPECT_EQ(clusters(far, 0.5).size(), 1u);
  EXPECT_EQ(clusters(close, 0.5).size(), 2u);
}

// A thousand grids of 10,000 cells are made, filled and ended; what the program has allocated does not grow.
// ledger: S4-18
TEST(SphericalGrid, IsMadeFilledAndEndedAThousandTimesInTheSameMemory) {
  const SphericalGrid layout;
  std::vector<SphericalPlace> places;
  for (int azimuth = 0; azimuth < 100; ++azimuth) {
    for (int layer = 10; layer < 60; ++layer) {
      for (const int elevation : {30, 40}) places.push_back({{azimuth, elevation}, layer});
    }
  }
  ASSERT_EQ(places.size(), 10'000u);
  const auto in_use = [] {
    const auto memory = mallinfo2();
    return memory.uordblks + memory.hblkhd;
  };
  constexpr std::size_t kPage = 4096;  // what the allocator keeps at hand differs by less
  std::size_t left = 0;
  for (int i = 0; i < 1000; ++i) {
    {
      SphericalGrid grid;
      for (const SphericalPlace& place : places) grid.set_log_odds(place, 2);
      ASSERT_EQ(grid.cells().size(), places.size());
    }
    if (i == 0) left = in_use();
    ASSERT_LT(in_use(), left + kPage) << "after " << i << " grids";
  }
}

TEST(SphericalGrid, RefusesWhatMakesNoSense) {
  const auto refused = [](void (*change)(SphericalGridConfig&)) {
    SphericalGridConfig config;
    change(config);
    EXPECT_THROW(SphericalGrid{config}, Error);
  };
  refused([](SphericalGridConfig& c) { c.prior = 0.6; });
  refused([](SphericalGridConfig& c) { c.min_layer_m = 0; });
  refused([](SphericalGridConfig& c) { c.range_m = 0.1; });
  refused([](SphericalGridConfig& c) { c.bucket = Angle::degrees(7); });
  refused([](SphericalGridConfig& c) { c.rebin_at = 0; });
}

}  // namespace
}  // namespace isobath
