// The recording of a scanning sonar in a rectangular tank: what must be seen in it, and what must not. The expectations
// come from the recording's description, not from this program.
#include <algorithm>
#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <tests/support/data.hpp>
#include <tests/support/kept_scans.hpp>

namespace isobath::tank_test {
namespace {

using test::first_along;

constexpr double kBin = 0.01253133;
constexpr int kBins = 399, kBearings = 200;

const test::ScanKeeper& tank() {
  static const test::ScanKeeper kScans =
      test::scans_of(test::shared_data("msis-tank") / "msis-tank-rev00-20.csv", test::configured());
  return kScans;
}

/// Mean over all turns, by bearing and bin.
std::vector<std::vector<double>> mean_image() {
  std::vector<std::vector<double>> sum(kBearings, std::vector<double>(kBins, 0.0));
  std::vector<int> looks(kBearings, 0);
  const auto source = open_source(test::shared_data("msis-tank") / "msis-tank-rev00-20.csv", {});
  while (const auto event = source->next()) {
    const auto& ping = std::get<Ping>(*event);
    const int at = static_cast<int>(std::lround(ping.fan->azimuth[0].wrapped_positive().degrees() / 1.8)) % kBearings;
    ++looks[at];
    for (int k = 0; k < kBins; ++k) sum[at][k] += static_cast<double>(ping.intensity(0, k));
  }
  for (int b = 0; b < kBearings; ++b) {
    for (double& v : sum[b]) v /= looks[b];
  }
  return sum;
}

// ledger: S6-D04 S6-29
TEST(Tank, EveryTurnIsOneScan) {
  ISOBATH_NEEDS_DATA(folder, "msis-tank");
  EXPECT_EQ(tank().pings, 4100);
  EXPECT_GE(tank().scans.size(), 20u);
  EXPECT_LE(tank().scans.size(), 21u);
}

// ledger: S6-D04 S6-28
TEST(Tank, NearestObstaclesAreTheWallsAndTheCompactEcho) {
  ISOBATH_NEEDS_DATA(folder, "msis-tank");
  const auto& obstacles = tank().scans.back().obstacles;
  for (const auto& [bearing, wall] : {std::pair(0, 2.12), {90, 1.79}, {180, 2.31}}) {
    for (const double aside : {-2.0, 0.0, 2.0}) {
      const auto first = first_along(obstacles, bearing + aside, 0.6);
      ASSERT_TRUE(first) << bearing;
      EXPECT_NEAR(*first, wall, 0.10) << "bearing " << bearing + aside;
    }
  }
  const auto compact = first_along(obstacles, 270, 0.6);
  ASSERT_TRUE(compact);
  EXPECT_THAT(*compact, testing::AnyOf(testing::DoubleNear(1.49, 0.10), testing::DoubleNear(1.97, 0.10)));
  EXPECT_NEAR(first_along(obstacles, 270, 2.5).value_or(0), 2.76, 0.10) << "the wall behind it";
}

// The range that is listed with the obstacle in that direction agrees: what a user reads in obstacles.json.
TEST(Tank, ListedRangesAgree) {
  ISOBATH_NEEDS_DATA(folder, "msis-tank");
  for (const auto& [bearing, wall] : {std::pair(0, 2.12), {90, 1.79}, {180, 2.31}}) {
    double nearest = 100;
    for (const Obstacle& o : tank().scans.back().obstacles) {
      if (o.range_m > 0.6 && first_along({o}, bearing, 0.6)) nearest = std::min(nearest, o.range_m);
    }
    EXPECT_NEAR(nearest, wall, 0.12) << bearing;  // the nearest point of an outline of up to 4 degrees
  }
}

/// A cell of the mean image above 60 counts.
struct BrightCell {
  Eigen::Vector2d at;
  double beam;  ///< half a beam of 3 degrees, and a bin: an outline may lie between two
};

std::vector<BrightCell> bright_cells() {
  std::vector<BrightCell> bright;
  const auto mean = mean_image();
  for (int b = 0; b < kBearings; ++b) {
    const Angle bearing = Angle::degrees(1.8 * b);
    for (int k = 0; k < kBins; ++k) {
      const double r = (k + 0.5) * kBin;
      if (mean[b][k] > 60) bright.push_back({{r * cos(bearing), r * sin(bearing)}, r * 0.026 + 0.02});
    }
  }
  return bright;
}

// ledger: S6-30
TEST(Tank, FromTheThirdTurnOnNothingIsReportedWhereTheMeanImageIsDark) {
  ISOBATH_NEEDS_DATA(folder, "msis-tank");
  const auto bright = bright_cells();
  int judged = 0;
  for (std::size_t turn = 2; turn < tank().scans.size(); ++turn) {
    for (const Obstacle& o : tank().scans[turn].obstacles) {
      Eigen::AlignedBox2d box;
      for (const Eigen::Vector2d& corner : o.outline) box.extend(corner);
      const bool lit = std::any_of(bright.begin(), bright.end(), [&](const BrightCell& cell) {
        return box.exteriorDistance(cell.at) < cell.beam &&
               (nearest_point(o.outline, cell.at) - cell.at).norm() < cell.beam;
      });
      EXPECT_TRUE(lit) << "turn " << turn + 1 << ", bearing " << o.bearing.degrees() << ", range " << o.range_m;
      ++judged;
    }
  }
  EXPECT_GT(judged, 100);
}

// ledger: S6-64
TEST(Tank, SecondReturnsAreMarkedAsBehindTheWallAndPossibleMultiples) {
  ISOBATH_NEEDS_DATA(folder, "msis-tank");
  // Second returns are weak: they are heard where each bin has the whole rate of false alarms.
  const auto whole = test::scans_of(test::shared_data("msis-tank") / "msis-tank-rev00-20.csv",
                                    test::configured({"echoes.false_alarm_m=0"}));
  const auto& all = whole.scans.back().obstacles;
  for (const auto& [bearing, range] : {std::pair(90, 3.51), {180, 4.56}}) {
    const Eigen::Vector2d at(range * std::cos(bearing * M_PI / 180), range * std::sin(bearing * M_PI / 180));
    const Obstacle* found = nullptr;
    for (const Obstacle& o : all) {
      const bool here = (nearest_point(o.outline, at) - at).norm() < 0.1;
      if (here && (!found || o.range_m < found->range_m)) found = &o;
    }
    ASSERT_NE(found, nullptr) << bearing;
    EXPECT_TRUE(found->behind) << bearing;
    EXPECT_TRUE(found->possible_multiple) << bearing;
  }
  EXPECT_FALSE(all.front().behind) << "the nearest of all hides behind nothing";
}

}  // namespace
}  // namespace isobath::tank_test
