#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/perception/scan_conversion.hpp>
#include <map>
#include <set>
#include <tests/support/count_allocations.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using PixelSet = std::set<std::pair<int, int>>;

constexpr PixelWindow kWindow{-10, -10, 60, 50};

PixelSet pixels(const std::vector<PixelSpan>& spans) {
  PixelSet out;
  int row = -1000;
  for (const PixelSpan& s : spans) {
    EXPECT_GT(s.row, row);
    EXPECT_LT(s.column_begin, s.column_end);
    row = s.row;
    for (int c = s.column_begin; c < s.column_end; ++c) out.insert({c, s.row});
  }
  return out;
}

PixelSet inside(const Polygon& polygon, const PixelWindow& clip = kWindow) {
  std::vector<PixelSpan> spans;
  pixels_inside(polygon, clip, spans);
  return pixels(spans);
}

PixelSet touched(const Polygon& polygon, const PixelWindow& clip = kWindow) {
  std::vector<PixelSpan> spans;
  pixels_touched(polygon, clip, spans);
  return pixels(spans);
}

/// Edge functions with the top-left rule; exact where coordinates are eighths.
bool centre_inside(Polygon p, int column, int row) {
  if (area(p) < 0) std::reverse(p.begin(), p.end());
  const Vector2d centre(column + 0.5, row + 0.5);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector2d a = p[i];
    const Vector2d side = p[(i + 1) % p.size()] - a;
    const double e = cross(side, centre - a);
    const bool west = side.y() < 0;
    const bool north = side.y() == 0 && side.x() > 0;
    if (e < 0 || (e == 0 && !west && !north)) return false;
  }
  return true;
}

/// Separating axes of a convex polygon and a unit square; how far they overlap, at least.
double overlap(const Polygon& p, int column, int row) {
  const Polygon square{
      {column + 0.0, row + 0.0}, {column + 1.0, row + 0.0}, {column + 1.0, row + 1.0}, {column + 0.0, row + 1.0}};
  std::vector<Vector2d> axes{{1, 0}, {0, 1}};
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector2d side = p[(i + 1) % p.size()] - p[i];
    if (side.norm() > 0) axes.push_back(Vector2d(-side.y(), side.x()).normalized());
  }
  double least = 1e9;
  for (const Vector2d& axis : axes) {
    double p0 = 1e9, p1 = -1e9, q0 = 1e9, q1 = -1e9;
    for (const Vector2d& v : p) {
      p0 = std::min(p0, axis.dot(v));
      p1 = std::max(p1, axis.dot(v));
    }
    for (const Vector2d& v : square) {
      q0 = std::min(q0, axis.dot(v));
      q1 = std::max(q1, axis.dot(v));
    }
    least = std::min(least, std::min(p1, q1) - std::max(p0, q0));
  }
  return least;
}

Vector2d eighths(Random& random) {
  const auto one = [&](double low, double high) { return std::round(8 * random.uniform(low, high)) / 8; };
  const double x = one(-15, 55);
  return {x, one(-15, 45)};
}

// ledger: S1-59
TEST(ScanConversion, EqualsBruteForceForEveryCentreTiesIncluded) {
  Random random(59);
  for (int i = 0; i < 60; ++i) {
    Polygon polygon;
    // Corners on centres and on whole numbers make ties likely.
    for (int k = 0; k < 3 + i % 4; ++k) polygon.push_back(eighths(random));
    polygon = convex_hull(polygon);
    if (polygon.size() < 3) continue;
    if (i % 2 == 0) std::reverse(polygon.begin(), polygon.end());
    PixelSet expected;
    for (int r = kWindow.row; r < kWindow.row + kWindow.height; ++r) {
      for (int c = kWindow.column; c < kWindow.column + kWindow.width; ++c) {
        if (centre_inside(polygon, c, r)) expected.insert({c, r});
      }
    }
    ASSERT_EQ(inside(polygon), expected);
  }
}

// ledger: S1-59
TEST(ScanConversion, ACentreOnANorthOrWestSideIsInsideOnASouthOrEastSideOutside) {
  const Polygon square{{0.5, 0.5}, {3.5, 0.5}, {3.5, 3.5}, {0.5, 3.5}};
  EXPECT_THAT(inside(square),
              testing::ElementsAre(std::pair(0, 0), std::pair(0, 1), std::pair(0, 2), std::pair(1, 0), std::pair(1, 1),
                                   std::pair(1, 2), std::pair(2, 0), std::pair(2, 1), std::pair(2, 2)));
}

// ledger: S1-59
TEST(ScanConversion, TrianglesOfAFanShareNoPixelAndLeaveNoneOut) {
  Random random(60);
  for (int i = 0; i < 50; ++i) {
    // Corners of a convex ring in any doubles, so that nothing is exact.
    Polygon ring;
    for (int k = 0; k < 9; ++k) {
      const double turn = (k + random.uniform(0.1, 0.9)) * 0.69;
      ring.emplace_back(20 + 18.3 * std::cos(turn), 15 + 18.3 * std::sin(turn));
    }
    const Vector2d hub(20 + random.uniform(-3, 3), 15 + random.uniform(-3, 3));
    PixelSet together;
    std::size_t sum = 0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const PixelSet one = inside({hub, ring[k], ring[(k + 1) % ring.size()]});
      sum += one.size();
      together.insert(one.begin(), one.end());
    }
    ASSERT_EQ(sum, together.size());
    ASSERT_EQ(together, inside(ring));
  }
}

// ledger: S1-59
TEST(ScanConversion, SupercoverHoldsEveryPixelThatThePolygonMeets) {
  ISOBATH_NOT_SANITIZED();
  Random random(61);
  for (int i = 0; i < 60; ++i) {
    Polygon polygon;
    if (i % 3 == 0) {  // thin, down to a line
      const Vector2d from(random.uniform(-12, 45), random.uniform(-12, 35));
      const Vector2d to(random.uniform(-12, 45), random.uniform(-12, 35));
      const auto segment = thick_segment(from, to, i % 2 == 0 ? 0 : random.uniform(0, 1));
      polygon.assign(segment.begin(), segment.end());
    } else {
      for (int k = 0; k < 5; ++k) polygon.emplace_back(random.uniform(-15, 55), random.uniform(-15, 45));
      polygon = convex_hull(polygon);
    }
    const PixelSet found = touched(polygon);
    for (int r = kWindow.row; r < kWindow.row + kWindow.height; ++r) {
      for (int c = kWindow.column; c < kWindow.column + kWindow.width; ++c) {
        const double by = overlap(polygon, c, r);
        if (std::abs(by) < 1e-9) continue;
        ASSERT_EQ(found.count({c, r}) == 1, by > 0) << c << " " << r << " " << by;
      }
    }
    for (const auto& p : inside(polygon)) ASSERT_TRUE(found.count(p));
  }
}

// ledger: S1-59
TEST(ScanConversion, ASliverThinnerThanAPixelStaysConnectedAlongItsAxis) {
  for (double heading = 0; heading < 6.3; heading += 0.1) {
    const Vector2d e(std::cos(heading), std::sin(heading));
    const Vector2d n(-e.y(), e.x());
    const Vector2d apex(20.3, 15.4);
    const PixelSet found = touched({apex, apex + 12 * e - 0.05 * n, apex + 12 * e + 0.05 * n});
    for (double t = 0; t <= 12; t += 0.01) {
      const Vector2d p = apex + t * e;
      ASSERT_TRUE(found.count({static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y()))})) << t;
    }
    // From any pixel to any other by sides: as many steps as the set allows.
    std::vector<std::pair<int, int>> open{*found.begin()};
    PixelSet seen{*found.begin()};
    while (!open.empty()) {
      const auto [c, r] = open.back();
      open.pop_back();
      for (const auto& next : {std::pair(c + 1, r), std::pair(c - 1, r), std::pair(c, r + 1), std::pair(c, r - 1)}) {
        if (found.count(next) && seen.insert(next).second) open.push_back(next);
      }
    }
    EXPECT_EQ(seen, found);
  }
}

// ledger: S1-59
TEST(ScanConversion, ClipsToTheWindowAndNothingElse) {
  Random random(62);
  for (int i = 0; i < 100; ++i) {
    const Polygon triangle = convex_hull({eighths(random), eighths(random), eighths(random)});
    if (triangle.size() < 3) continue;
    const PixelWindow clip{static_cast<int>(random.index(40)) - 15, static_cast<int>(random.index(40)) - 15,
                           static_cast<int>(random.index(20)), static_cast<int>(random.index(20))};
    for (const auto& convert : {inside, touched}) {
      PixelSet expected;
      for (const auto& p : convert(triangle, {-100, -100, 300, 300})) {
        if (clip.contains({p.first, p.second})) expected.insert(p);
      }
      ASSERT_EQ(convert(triangle, clip), expected);
    }
  }
}

TEST(ScanConversion, FarAwayPolygonsAndWindowsNeverOverflow) {
  std::vector<PixelSpan> spans;
  const PixelWindow all{-(1 << 29), -(1 << 29), 1 << 30, 1 << 30};
  const Polygon far{{-1e15, 10}, {1e15, 10}, {1e15, 12}, {-1e15, 12}};
  pixels_inside(far, all, spans);
  ASSERT_EQ(spans.size(), 2U);
  EXPECT_EQ(spans[0], (PixelSpan{10, -(1 << 29), 1 << 29}));
  pixels_touched(far, {0, 0, 5, 5}, spans);
  EXPECT_TRUE(spans.empty());
}

TEST(ScanConversion, AllocatesNothingWhereThereIsRoom) {
  std::vector<PixelSpan> spans;
  spans.reserve(64);
  const Polygon triangle{{0, 0}, {40, 5}, {3, 39}};
  const std::uint64_t before = test::allocations();
  pixels_inside(triangle, kWindow, spans);
  pixels_touched(triangle, kWindow, spans);
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace isobath
