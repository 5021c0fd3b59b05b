// The spherical grid under way: what it holds stays where it is in the world, whatever the vehicle does.
#include <array>
#include <cmath>
#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/map/spherical/spherical_clusters.hpp>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <map>
#include <numbers>
#include <set>
#include <tests/support/count_allocations.hpp>
#include <tests/support/directions.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::kRadiansADegree, test::towards;

Vector3d point_between(Random& random, double near, double far) {
  const double z = random.uniform(-0.8, 0.8), a = random.uniform(-180, 180), range = random.uniform(near, far);
  return range * towards(a, std::asin(z) / kRadiansADegree);
}

/// Of everything in the grid together.
struct GridMoments {
  std::uint64_t echoes = 0;
  double weight = 0;
  Vector3d mean = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();  ///< about the origin
};
template <class Visit>
void each_cell(const SphericalGrid& grid, const Visit& visit) {
  grid.cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) visit(SphericalPlace{d, cell.layer}, cell);
  });
}
GridMoments moments_of(const SphericalGrid& grid) {
  GridMoments m;
  each_cell(grid, [&](const SphericalPlace&, const SphericalCell& cell) {
    const double w = static_cast<double>(cell.weight);
    const Vector3d p = grid.point_of(cell);
    Matrix3d spread;
    const auto& c = cell.spread;
    spread << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    m.echoes += cell.echoes;
    m.weight += w;
    m.mean += w * p;
    m.second += w * (spread + p * p.transpose());
  });
  m.mean /= m.weight;
  m.second /= m.weight;
  return m;
}

SphericalGridConfig without_locks() {
  SphericalGridConfig config;
  config.lock_echoes = 0;
  return config;
}

// ledger: S4-23 S4-E09
TEST(SphericalMotion, KeepsEchoesAndTheFirstTwoMomentsOfEverything) {
  Random random(1);
  SphericalGrid grid(without_locks());
  for (int i = 0; i < 500; ++i) grid.add_echo(point_between(random, 6, 30), 0.1, Time{});
  const GridMoments before = moments_of(grid);
  Vector3d t = Vector3d::Zero();
  for (int i = 0; i < 150; ++i) {
    Vector3d step;
    for (Eigen::Index k = 0; k < 3; ++k) step[k] = random.uniform(-0.1, 0.12);
    grid.translate(step);
    t -= step;
  }
  const GridMoments after = moments_of(grid);
  EXPECT_EQ(after.echoes, before.echoes);
  EXPECT_NEAR(after.weight, before.weight, 1e-3 * before.weight);
  EXPECT_LT((after.mean - (before.mean + t)).norm(), 2e-3);
  const Matrix3d second = before.second + before.mean * t.transpose() + t * before.mean.transpose() + t * t.transpose();
  EXPECT_LT((after.second - second).cwiseAbs().maxCoeff(), 5e-4 * second.trace());
}

// ledger: S4-23
TEST(SphericalMotion, AWallHasNoHolesWhenItIsApproachedNorWhenItIsLeft) {
  for (const double way : {-1.0, 1.0}) {
    SphericalGrid grid(without_locks());
    const double start = way < 0 ? 40 : 12, end = way < 0 ? 8 : 25;
    for (double a = -60; a <= 60; a += 2.5) {
      for (double e = -60; e <= 60; e += 2.5) {
        const Vector3d u = towards(a + 1.25, e + 1.25);
        grid.add_echo(start / u.x() * u, 0.05, Time{});  // the plane x = start
      }
    }
    for (double at = start; way * at < way * end; at += way * 0.076) {
      grid.translate({-way * 0.076, 0, 0});
    }
    for (double a = -28.75; a < 30; a += 2.5) {
      for (double e = -28.75; e < 30; e += 2.5) {
        EXPECT_FALSE(grid.is_empty(towards(a, e))) << "at " << a << " " << e << (way < 0 ? " near" : " far");
      }
    }
    each_cell(grid, [&](const SphericalPlace& place, const SphericalCell& cell) {
      EXPECT_NEAR(grid.point_of(cell).x(), end, 0.1 + grid.layers().thickness(place.layer));
    });
  }
}

// ledger: S4-01 S4-23
TEST(SphericalMotion, APointThatIsPassedStaysWithinACellOfTheTruth) {
  for (const bool heard_again : {false, true}) {
    SphericalGrid grid(without_locks());
    Vector3d target(25, 3, -1);
    grid.add_echo(target, 0.05, Time{});
    const double first_cell = grid.layers().thickness(grid.layers().layer_at(target.norm()));
    for (int i = 0; i < 500; ++i) {  // 50 m, abeam halfway
      grid.translate({0.1, 0, 0});
      target.x() -= 0.1;
      if (heard_again) grid.add_echo(target, 0.05, Time{});
      const double cell = grid.layers().thickness(grid.layers().layer_at(target.norm()));
      ASSERT_LT((moments_of(grid).mean - target).norm(), heard_again ? cell : 0.01) << i;
    }
    each_cell(grid, [&](const SphericalPlace&, const SphericalCell& cell) {
      EXPECT_LT((grid.point_of(cell) - target).norm(), first_cell) << "no wider than it was first heard";
    });
  }
}

// ledger: S4-24
TEST(SphericalMotion, HandsOverWhatLeavesTheRangeOnce) {
  ISOBATH_NOT_SANITIZED();
  Random random(2);
  SphericalGridConfig config = without_locks();
  config.range_m = 30;
  SphericalGrid grid(config);
  std::vector<Vector3d> points;
  for (int i = 0; i < 2000; ++i) {
    points.push_back(point_between(random, 5, 30));
    grid.add_echo(points.back(), 0.1, Time{});
  }
  const std::uint64_t before = moments_of(grid).echoes;
  std::uint64_t dropped = 0;
  double way = 0;
  std::set<std::array<float, 3>> handed_over;  // means, as the world has them: no content comes twice
  grid.on_dropped([&](const SphericalCell& cell, const Vector3d& p_G) {
    dropped += cell.echoes;
    EXPECT_GT(p_G.norm(), 30 - 1e-5) << "beyond the range as the vehicle stands, to the rounding of a float";
    EXPECT_LT(p_G.norm(), 30 + 0.2 + 0.33) << "at the first step beyond it, or half of a content that was cut there";
    const Vector3d p = p_G + Vector3d(0, way + 0.2, 0);
    const auto mm = [](double m) { return static_cast<float>(std::round(1000 * m)); };
    EXPECT_TRUE(handed_over.insert({mm(p.x()), mm(p.y()), mm(p.z())}).second);
  });
  for (; way < 25; way += 0.2) {
    grid.translate({0, 0.2, 0});
    each_cell(grid, [&](const SphericalPlace& place, const SphericalCell& cell) {
      ASSERT_LE(cell.point().norm(), 30.0 + 1e-4);
      ASSERT_NEAR(grid.place_at(cell.point() * (1 - 1e-6))->layer, place.layer, 1) << "a mean lies on a chord";
    });
    ASSERT_EQ(moments_of(grid).echoes + dropped, before) << way;
  }
  const auto left = std::count_if(points.begin(), points.end(),
                                  [&](const Vector3d& p) { return (p - Vector3d(0, way, 0)).norm() > 30; });
  EXPECT_NEAR(static_cast<double>(dropped), static_cast<double>(left), 0.02 * static_cast<double>(left));
}

// ledger: S4-20 S4-21
TEST(SphericalMotion, TurnsKeepTheirRemainderAndCopyNothing) {
  Random random(4);
  SphericalGrid grid(without_locks());
  for (int i = 0; i < 300; ++i) grid.add_echo(point_between(random, 5, 40), 0.1, Time{});
  std::vector<Vector3d> points;
  each_cell(grid, [&](const SphericalPlace&, const SphericalCell& cell) { points.push_back(cell.point()); });
  const std::uint64_t moved = grid.cells().records_moved();
  double heading = 0;
  for (int i = 0; i < 500; ++i) {
    const double by = random.uniform(-40, 40);
    grid.turn(Angle::degrees(by));
    heading += by;
    ASSERT_LE(std::abs(grid.remainder().degrees()), 1.25 + 1e-9);
  }
  EXPECT_EQ(grid.cells().records_moved(), moved);
  const Matrix3d R = Eigen::AngleAxisd(heading * kRadiansADegree, Vector3d::UnitZ()).toRotationMatrix();
  std::size_t found = 0;
  each_cell(grid, [&](const SphericalPlace& place, const SphericalCell& cell) {
    const Vector3d now = grid.point_of(cell), there = R * cell.point();
    EXPECT_LT((now - there).norm(), 1e-6) << "points are exact";
    const double azimuth = std::atan2(now.y(), now.x());
    const double middle = grid.buckets().azimuth_edge(place.direction.azimuth).radians() + 1.25 * kRadiansADegree;
    EXPECT_LE(std::abs(std::remainder(azimuth - middle, 2 * std::numbers::pi)), 2.5 * kRadiansADegree + 1e-6)
        << "buckets to half a bucket more than their own half";
    ++found;
  });
  EXPECT_EQ(found, points.size());
  // what is heard after a turn falls into the cells of what was heard before
  const Vector3d again = grid.point_of(*grid.cells().beam(*grid.cells().directions().first()).begin());
  const std::size_t size = grid.cells().size();
  grid.add_echo(again, 0.1, Time{});
  EXPECT_EQ(grid.cells().size(), size);
}

// ledger: S4-20
TEST(SphericalMotion, ATurnToStarboardOf30DegreesTurnsContentsBy30DegreesOfAzimuth) {
  SphericalGrid grid(without_locks());
  grid.add_echo({0, 20, 0}, 0.1, Time{});  // dead ahead: azimuth +90
  EXPECT_FALSE(grid.is_empty(towards(90.1, 0.1)));
  grid.turn(Angle::degrees(30));
  EXPECT_TRUE(grid.is_empty(towards(90.1, 0.1)));
  EXPECT_FALSE(grid.is_empty(towards(120.1, 0.1)));
}

/// A pile of eight sides, 8 m high and 0.4 m across; its triangles, and points of them about 1 cm apart.
struct Pile {
  Vector3d foot = Vector3d(12, 9, -4), head = Vector3d(12, 9, 4);
  std::vector<std::array<Vector3d, 3>> triangles;
  std::vector<Vector3d> surface;

  Pile() {
    const auto rim = [](int i) {
      const double a = i * 45 * kRadiansADegree;
      return Vector3d(0.2 * std::cos(a), 0.2 * std::sin(a), 0);
    };
    for (int i = 0; i < 8; ++i) {
      const Vector3d a = foot + rim(i), b = foot + rim(i + 1), up = head - foot;
      triangles.push_back({a, b, b + up});
      triangles.push_back({a, b + up, a + up});
      for (double s = 0.03; s < 1; s += 0.06) {
        for (double z = 0.00063; z < 1; z += 0.00125) surface.emplace_back(a + s * (b - a) + z * up);
      }
    }
  }
  void put_into(SphericalGrid& grid, const Vector3d& from) const {
    for (const auto& t : triangles) add_known_triangle(grid, {t[0] - from, t[1] - from, t[2] - from});
  }
};

// ledger: S4-15
TEST(SphericalMotion, AKnownPileIsInTheCellsThatItsSurfacePassesThroughFromAnyPose) {
  const Pile pile;
  Random random(5);
  for (int i = 0; i < 5; ++i) {
    const double x = random.uniform(-5, 5);
    const double y = random.uniform(-5, 5);
    const double z = random.uniform(-2, 2);
    const Vector3d from(x, y, z);
    SphericalGrid grid;
    pile.put_into(grid, from);
    std::map<SphericalPlace, int> passed;
    for (const Vector3d& p : pile.surface) ++passed[*grid.place_at(p - from)];
    each_cell(grid, [&](const SphericalPlace& place, const SphericalCell& cell) {
      EXPECT_TRUE(cell.prior && cell.locked);
      EXPECT_TRUE(passed.count(place)) << "a cell that the pile does not pass through";
    });
    // The surface is laid out in parts of half a cell: one that passes through a cell with less than a part may be left
    // out of it, and a cell that holds a quarter of a cell's face is never.
    for (const auto& [place, points] : passed) {
      const double edge = grid.layers().middle(place.layer) * 2.5 * kRadiansADegree;
      const double area = points * (0.4 * std::sin(22.5 * kRadiansADegree) * 0.06) * (8 * 0.00125);
      if (area > edge * edge / 4) {
        EXPECT_TRUE(grid.cells().find(place.direction, place.layer)) << area;
      }
    }
  }
}

// ledger: S4-15 S4-21
TEST(SphericalMotion, AKnownPileTurnsAndStaysWhereItIsOnTheWay) {
  const Pile pile;
  const auto covers = [&](const SphericalGrid& grid, const Vector3d& from, double turned) {
    const Matrix3d R = Eigen::AngleAxisd(turned, Vector3d::UnitZ()).toRotationMatrix();
    std::vector<Vector3d> known;
    each_cell(grid, [&](const SphericalPlace& place, const SphericalCell& cell) {
      EXPECT_TRUE(cell.prior && cell.locked);
      known.push_back(R.transpose() * grid.point_of(cell) + from);
      const double half = grid.layers().thickness(place.layer) / 2;
      EXPECT_LT((known.back() - pile.foot).head<2>().norm(), 0.2 + half) << "within half a cell of the surface";
      EXPECT_LT(std::abs(known.back().z()), 4 + half);
    });
    for (double z = -3.9; z < 3.9; z += 0.1) {
      const Vector3d axis = pile.foot + Vector3d(0, 0, 4 + z);
      double least = 1e9;
      for (const Vector3d& p : known) least = std::min(least, (p - axis).norm());
      const double cell = (axis - from).norm() * 2.5 * kRadiansADegree;
      EXPECT_LT(least, std::hypot(0.2, cell / 2) + 0.25 * cell) << "no gap at " << z;
    }
  };
  Random random(5);
  for (int i = 0; i < 5; ++i) {
    const double x = random.uniform(-5, 5);
    const double y = random.uniform(-5, 5);
    const double z = random.uniform(-2, 2);
    const Vector3d from(x, y, z);
    SphericalGrid there;
    pile.put_into(there, from);
    covers(there, from, 0);
    there.turn(Angle::degrees(37));
    covers(there, from, 37 * kRadiansADegree);
    SphericalGrid moved;
    pile.put_into(moved, Vector3d::Zero());
    const Vector3d step = from / 40;
    for (int k = 0; k < 40; ++k) moved.translate(step);
    covers(moved, from, 0);
  }
}

// ledger: S4-50
TEST(SphericalMotion, DensityKeepsTheExpectedNumberOfThingsAndLargestTheState) {
  using Merging = SphericalGridConfig::Merging;
  for (const Merging merging : {Merging::kDensity, Merging::kLargest}) {
    SphericalGridConfig config = without_locks();
    config.merging = merging;
    SphericalGrid grid(config);
    const auto place = grid.add_echo({30, 0.5, 0.5}, 0.3, Time{});
    grid.set_log_odds(*place, std::log(0.95 / 0.05));
    const auto number = [&] {
      double sum = 0;
      each_cell(grid, [&](const SphericalPlace&, const SphericalCell& cell) {
        sum -= std::log1p(-SphericalGrid::probability(cell));
      });
      return sum;
    };
    const auto largest = [&] {
      double most = 0;
      each_cell(grid, [&](const SphericalPlace&, const SphericalCell& cell) {
        most = std::max(most, SphericalGrid::probability(cell));
      });
      return most;
    };
    for (int i = 0; i < 220; ++i) grid.translate({0.1, 0, 0});
    EXPECT_GT(grid.cells().size(), 3u);
    EXPECT_NEAR(merging == Merging::kDensity ? number() + std::log(0.05) : largest() - 0.95, 0, 1e-3);
    for (int i = 0; i < 220; ++i) grid.translate({-0.1, 0, 0});
    EXPECT_NEAR(merging == Merging::kDensity ? number() + std::log(0.05) : largest() - 0.95, 0, 1e-3);
  }
}

// ledger: S4-12 S4-24
TEST(SphericalMotion, ClearWaterStaysClearWhereItWasSeenAndIsForgottenWithItsView) {
  SphericalGrid grid;
  for (double a = 0; a < 360; a += 2.5) {
    grid.add_clear(Vector3d::Zero(), towards(a + 1.25, 0), Angle::degrees(1.25), {.to_m = 20}, Time{});
  }
  EXPECT_TRUE(grid.was_clear({15, 0, 0}));
  EXPECT_FALSE(grid.was_clear({20.5, 0, 0}));
  EXPECT_FALSE(grid.was_clear({10, 0, 3}));
  for (int i = 0; i < 100; ++i) grid.translate({0.1, 0, 0});
  grid.turn(Angle::degrees(90));  // what was ahead along x is along y now
  EXPECT_TRUE(grid.was_clear({0, 9, 0}));
  EXPECT_FALSE(grid.was_clear({0, 10.5, 0}));
  EXPECT_TRUE(grid.was_clear({0, -29, 0}));
  grid.decay(seconds(10), seconds(10), Time{} + seconds(11));
  EXPECT_FALSE(grid.was_clear({0, 9, 0}));
}

// ledger: S4-18 S4-30
TEST(SphericalMotion, AllocatesNothingOnceItHasBeenSo) {
  SphericalGrid grid(without_locks());
  const auto fill = [&] {
    for (int i = 0; i < 300; ++i) {
      const Vector3d u = towards(i * 2.5, 0.5);
      grid.add_echo(20 * u, 0.1, Time{});
      grid.add_clear(Vector3d::Zero(), u, Angle::degrees(1.25), {.to_m = 19}, Time{});
    }
  };
  const auto sail = [&] {
    for (int i = 0; i < 400; ++i) {
      grid.translate({i % 200 < 100 ? 0.1 : -0.1, 0, 0});
      if (i % 20 == 0) fill();
    }
    EXPECT_GT(grid.cells().size(), 1000u);
    grid.decay(seconds(1e6), seconds(1), Time{});  // cells are forgotten, views are not
    EXPECT_EQ(grid.cells().size(), 0u);
  };
  for (int round = 0; round < 4; ++round) sail();
  const auto before = test::allocations();
  sail();
  EXPECT_EQ(test::allocations() - before, 0u);
}

}  // namespace
}  // namespace isobath
