#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/sector_overlap.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

double by_counting(const AnnularSector& s, const Square& q, int n) {
  int inside = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const Eigen::Vector2d p = q.low + q.side * Eigen::Vector2d(i + 0.5, j + 0.5) / n;
      const Angle off = (Angle::radians(std::atan2(p.y(), p.x())) - s.centre).wrapped();
      inside += p.norm() >= s.inner && p.norm() < s.outer && abs(off) <= s.width / 2;
    }
  }
  return q.side * q.side * inside / (n * n);
}

// ledger: S6-11
TEST(SectorOverlap, AgreesWithCountingPointsForAnySector) {
  ISOBATH_NOT_SANITIZED();
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const double inner = random.uniform(0, 2);
    const AnnularSector s{inner, inner + random.uniform(0.05, 2), Angle::degrees(random.uniform(-180, 180)),
                          Angle::degrees(random.uniform(1, 360))};
    const Square q{{random.uniform(-3, 2), random.uniform(-3, 2)}, 1};
    EXPECT_NEAR(overlap_area(s, q), by_counting(s, q, 200), 0.015) << i;
  }
}

TEST(SectorOverlap, KnowsTheWholeSquareTheWholeSectorAndNothing) {
  const AnnularSector ring{1, 3, {}, Angle::degrees(360)};
  EXPECT_NEAR(overlap_area(ring, {{1.2, 0.5}, 1}), 1, 1e-15);
  EXPECT_NEAR(overlap_area(ring, {{-5, -5}, 10}), std::numbers::pi * 8, 1e-12);
  EXPECT_EQ(overlap_area(ring, {{4, 4}, 1}), 0);
  EXPECT_NEAR(overlap_area({0, 1, {}, Angle::degrees(180)}, {{-2, -2}, 4}), std::numbers::pi / 2, 1e-14);
}

// ledger: S6-11
TEST(SectorOverlap, ContiguousBinsShareACellWithoutRest) {
  for (const Square& cell : {Square{{30, 4}, 1}, Square{{11, -3}, 1}, Square{{2, 1}, 1}}) {
    double sum = 0;
    for (int beam = -60; beam <= 60; ++beam) {
      for (int k = 0; k < 60; ++k) {
        sum += overlap_area({k * 1.14, (k + 1) * 1.14, Angle::degrees(3.0 * beam), Angle::degrees(3)}, cell);
      }
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

// ledger: S6-11
TEST(SectorOverlap, BinsHaveTheSizeOfTheThesis) {
  const auto bin_area = [](double r) {
    return overlap_area({r - 0.57, r + 0.57, {}, Angle::degrees(3)}, {{-100, -100}, 200});
  };
  EXPECT_NEAR(bin_area(50), 1.14 * 2.62, 0.01);
  EXPECT_NEAR(bin_area(12), 1.14 * 0.63, 0.01);
}

}  // namespace
}  // namespace isobath
