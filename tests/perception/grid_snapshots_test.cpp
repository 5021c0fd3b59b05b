// Four processes at once on one grid (the paper's figure 1): each sees whole snapshots, and finds in each what it finds
// when it is alone with it.
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/map/spherical/grid_snapshots.hpp>
#include <isobath/map/spherical/spherical_clusters.hpp>
#include <isobath/map/spherical/spherical_passage.hpp>
#include <isobath/perception/scan_control.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <isobath/perception/tangential_clusters.hpp>
#include <map>
#include <tests/support/directions.hpp>
#include <thread>

namespace isobath {
namespace {

using Eigen::Vector3d;
using test::towards;

constexpr int kScans = 15;
constexpr std::uint64_t kLast = kScans;

/// A vehicle in a box of 24 x 20 x 12 m, a metre to the north between scans; `end_of_scan` after each.
void survey_box(SphericalGrid& grid, const std::function<void(Time, const Pose&)>& end_of_scan) {
  Random random(1);
  SphericalMapper mapper({}, grid);
  const Vector3d half(10, 12, 6);
  for (int scan = 0; scan < kScans; ++scan) {
    Pose X_WB;
    X_WB.translation = {scan - 7.0, 0, 20};
    const Time now = Time{} + seconds(scan);
    mapper.move_to(X_WB, now);
    mapper.begin_scan();
    const Vector3d from(0, X_WB.translation.x(), 0);
    for (int i = 0; i < 150; ++i) {
      const double azimuth = random.uniform(-180, 180);
      const double elevation = random.uniform(-20, 20);
      const Vector3d u = towards(azimuth, elevation);
      double range = 1e9;
      for (Eigen::Index k = 0; k < 3; ++k) range = std::min(range, (std::copysign(half[k], u[k]) - from[k]) / u[k]);
      mapper.add({Vector3d::Zero(), u, Angle::degrees(2.5), range + 0.1 * random.normal(), 40, now});
    }
    end_of_scan(now, X_WB);
  }
}

/// What the four of the figure make of a snapshot, in one number each.
using Work = double (*)(const GridSnapshot&);
std::array<Work, 4> works() {
  const Work navigator = [](const GridSnapshot& s) {
    double sum = 0;
    for (int a = 0; a < 360; a += 10) sum += way_ahead(s.grid, towards(a, 0), 15, 0.5).clear_m;
    return sum;
  };
  const Work scan_control = [](const GridSnapshot& s) { return ScanControl().next(s.grid, Angle{}).worth; };
  const Work modelling = [](const GridSnapshot& s) {
    double sum = 0;
    const auto echoes = echoes_of(s.grid, 0.5);
    for (const TangentPlane& plane : tangential_clusters(echoes).planes) sum += plane.distance_m * plane.support;
    return sum + static_cast<double>(clusters(s.grid, 0.5).size());
  };
  const Work positioning = [](const GridSnapshot& s) {  // the mean of all that echoed, in W
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& p : echoes_of(s.grid, 0)) sum += world_from_grid_axes(p) + s.X_WB.translation;
    return sum.sum() + to_seconds(s.time);
  };
  return {navigator, scan_control, modelling, positioning};
}

// ledger: S4-48
TEST(GridSnapshots, FourReadersAndAWriterEachSeeWholeSnapshots) {
  const std::array<Work, 4> jobs = works();
  GridSnapshots snapshots({});
  std::array<std::map<std::uint64_t, double>, 4> found;
  std::array<std::atomic<std::uint64_t>, 4> seen{};
  std::vector<std::thread> readers;
  for (std::size_t r = 0; r < 4; ++r) {
    readers.emplace_back([&, r] {
      std::uint64_t version = 0;
      while (version < kLast) {
        const auto snapshot = snapshots.newest();
        if (!snapshot || snapshot->version == version) {
          std::this_thread::yield();
          continue;
        }
        EXPECT_GT(snapshot->version, version) << "never an older one";
        version = snapshot->version;
        found[r][version] = jobs[r](*snapshot);
        seen[r] = version;
      }
    });
  }
  SphericalGrid grid;
  int scan = 0;
  survey_box(grid, [&](Time time, const Pose& X_WB) {
    snapshots.publish(grid, time, X_WB);
    // now and then the writer lets all of them catch up, so that each sees several states whatever the machine does
    if (++scan % 5 != 0) return;
    for (const auto& reader : seen) {
      while (reader < static_cast<std::uint64_t>(scan)) std::this_thread::yield();
    }
  });
  for (std::thread& reader : readers) reader.join();
  EXPECT_LE(snapshots.copies(), 4u + 2u);

  // the same one after the other
  SphericalGrid alone;
  std::uint64_t version = 0;
  survey_box(alone, [&](Time time, const Pose& X_WB) {
    GridSnapshot snapshot({});
    snapshot.version = ++version;
    snapshot.time = time;
    snapshot.X_WB = X_WB;
    snapshot.grid.copy_from(alone);
    for (std::size_t r = 0; r < 4; ++r) {
      const auto at = found[r].find(version);
      if (at != found[r].end()) {
        EXPECT_EQ(at->second, jobs[r](snapshot)) << "reader " << r << ", version " << version;
      }
    }
  });
  for (const auto& results : found) {
    EXPECT_GE(results.size(), 3u);
    EXPECT_TRUE(results.count(kLast));
  }
}

// ledger: S4-48
TEST(GridSnapshots, StayAsTheyWereAndAreUsedAgain) {
  SphericalGrid grid;
  std::shared_ptr<const GridSnapshot> first;
  {
    GridSnapshots snapshots({});
    EXPECT_FALSE(snapshots.newest());
    grid.add_echo({10, 0.2, 0.2}, 0.1, Time{});
    grid.add_clear(Vector3d::Zero(), Vector3d::UnitX(), Angle::degrees(2), {.to_m = 9}, Time{});
    snapshots.publish(grid, Time{}, Pose{});
    first = snapshots.newest();
    grid.translate({1, 0, 0});
    grid.turn(Angle::degrees(33));
    for (int i = 0; i < 50; ++i) snapshots.publish(grid, Time{} + seconds(i), Pose{});
    EXPECT_EQ(snapshots.copies(), 3u) << "the first, the newest, and the one before it";
    EXPECT_EQ(snapshots.newest()->version, 51u);
    EXPECT_EQ(snapshots.newest()->grid.turned().degrees(), grid.turned().degrees());
  }
  EXPECT_EQ(first->version, 1u);
  EXPECT_FALSE(first->grid.is_empty({10, 0.2, 0.2}));
  EXPECT_TRUE(first->grid.was_clear({8, 0.01, 0.01}));
  EXPECT_EQ(first->grid.cells().size(), 1u);
  EXPECT_EQ(first->grid.turned().degrees(), 0);
}

}  // namespace
}  // namespace isobath
