// The ring of echoes that a tall beam hears of the bottom, and of the surface, is no obstacle; what stands in it is.
#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <tests/sim/worlds.hpp>
#include <tests/support/kept_scans.hpp>

namespace isobath {
namespace {

constexpr double kPing_s = 0.1;
constexpr double kRun_s = 60;
constexpr double kDepth = 7;
constexpr std::uint64_t kSeeds = 2;
constexpr double kThreshold = 0.26;  // of full scale: open water is louder in 2 % of its bins
constexpr int kLearnt = 5;           // scans, after which the level of the ring is known

/// A Micron in water 12 m deep; the bottom rises by `slope` to the north.
struct Water12 {
  explicit Water12(const std::string& bodies = "", double slope = 0)
      : tank(
            "[water]\nwind = 2\n[bottom]\nkind = \"terrain\"\nmaterial = \"sand\"\nextent_m = 150\n"
            "cell_m = 5\nrelief_m = 0\ndepth = 12\nslope = [" +
            std::to_string(-slope) + ", 0]\n" + bodies) {}
  test::Tank tank;
  std::function<Pose(double)> pose = [](double) { return test::at_depth(kDepth); };
  bool altimeter = true;
};

struct Seen {
  std::vector<test::KeptScan> scans;
  PipelineCounts counts;
  [[nodiscard]] std::size_t obstacles() const {
    std::size_t all = 0;
    for (const test::KeptScan& scan : scans) all += scan.number > kLearnt ? scan.obstacles.size() : 0;
    return all;
  }
};

/// What the pipeline makes of navigation, pings and an altimeter, ten of each a second. A sonar that was calibrated in
/// deep water: what learns its thresholds on the way learns a ring that stays.
Seen run(const Water12& water, std::uint64_t seed) {
  SonarConfig config = sonar_preset("micron");
  config.spurious_share = 0;
  config.blanking_m = 1.5;
  SimulatedSonar sonar(config, *water.tank.world, *water.tank.water, seed, 1);
  test::ScanKeeper keeper;
  Configuration configuration;
  configuration.echoes.method = DetectionMethod::kGlobal;
  configuration.echoes.global_threshold = kThreshold;
  Pipeline pipeline(configuration, keeper);
  for (int i = 0; i * kPing_s < kRun_s; ++i) {
    const Time time{seconds(i * kPing_s)};
    const Pose X_WB = water.pose(i * kPing_s);
    Navigation fix;
    fix.time = time;
    fix.X_WB = X_WB;
    pipeline.on_event(fix);
    if (water.altimeter) {
      RangeReading down;
      down.time = time;
      down.X_BS.rotation = Rotation::from_heading_pitch_roll({}, Angle::degrees(-90), {});
      down.width = Angle::degrees(30);
      down.max_range_m = 100;
      const Eigen::Vector3d p = X_WB.translation;
      down.range_m = water.tank.world->bottom_depth(p.x(), p.y()).value() - p.z();
      pipeline.on_event(down);
    }
    SimulatedSonar::Output heard = sonar.ping(time, X_WB, static_cast<std::uint64_t>(i));
    if (heard.ping) pipeline.on_event(std::move(*heard.ping));
  }
  pipeline.finish();
  return {keeper.scans, pipeline.counts()};
}

Pose turned(double heading_deg, double pitch_deg, double depth = kDepth) {
  return test::at_depth(depth, heading_deg, pitch_deg);
}

// Without an altitude the ring is there, as before, and the pings without one are counted; with one it is not.
// ledger: S6-69 S6-F06
TEST(BottomRing, IsNoObstacleWhereTheAltitudeIsKnown) {
  std::size_t with = 0, without = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Water12 water;
    const Seen known = run(water, seed);
    water.altimeter = false;
    const Seen unknown = run(water, seed);
    with += known.obstacles();
    without += unknown.obstacles();
    EXPECT_EQ(known.counts.no_bottom, 0u);
    EXPECT_EQ(unknown.counts.no_bottom, unknown.counts.pings);
    EXPECT_GT(known.counts.dim, 0u) << "that it tells less of the ring is counted";
  }
  EXPECT_GT(without, 10u * kSeeds) << "the ring that this is about";
  EXPECT_LE(20 * with, without);
}

// Measured over six seeds, obstacles of a ring with the altitude known, without, and by chance in water without a ring:
// turning 113, 882 and 75; pitching 1, 384, 1; turning with the nose down 108, 2219, 77; diving 9, 33, 0; a slope 20,
// 650, 0.
// ledger: S6-69
TEST(BottomRing, IsNoObstacleForAVehicleThatTurnsPitchesOrDives) {
  struct Motion {
    const char* name;
    std::function<Pose(double)> pose;
    double slope = 0;
  };
  const std::vector<Motion> motions = {
      {"turns", [](double t) { return turned(6 * t, 0); }},
      {"pitches", [](double t) { return turned(0, 5 * std::sin(0.7 * t)); }},
      {"turns with its nose down", [](double t) { return turned(6 * t, -5); }},
      {"dives", [](double t) { return turned(0, 0, 4 + t / 16); }},
      {"looks up a slope", [](double) { return turned(0, 0); }, 0.06},
  };
  for (const Motion& motion : motions) {
    std::size_t with = 0, without = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      Water12 water("", motion.slope);
      water.pose = motion.pose;
      with += run(water, seed).obstacles();
      water.altimeter = false;
      without += run(water, seed).obstacles();
    }
    EXPECT_LE(4 * with, without) << motion.name;
  }
}

std::string pole_at(double north) {
  return "[[cylinder]]\nname = \"pole\"\nradius = 0.4\nlength = 10\nmaterial = \"steel\"\ncentre = [" +
         std::to_string(north) + ", 0, 7]\n";
}

int scans_with_pole(const Seen& seen, double north) {
  constexpr double kNear = 2.3;  // two bins
  return static_cast<int>(std::count_if(seen.scans.begin(), seen.scans.end(), [&](const test::KeptScan& scan) {
    return std::any_of(scan.obstacles.begin(), scan.obstacles.end(), [&](const Obstacle& o) {
      return std::abs(o.nearest.x() - north) < kNear && std::abs(o.nearest.y()) < kNear;
    });
  }));
}

// ledger: S6-69
TEST(BottomRing, APoleInTheRingIsFound) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Seen seen = run(Water12(pole_at(20)), seed);
    EXPECT_GE(2 * scans_with_pole(seen, 20), static_cast<int>(seen.scans.size())) << seed;
  }
}

// What is nearer than the beam's edge meets the bottom is heard as ever.
// ledger: S6-69
TEST(BottomRing, WhatStandsBeforeItIsFound) {
  const Seen seen = run(Water12(pole_at(7.5)), 1);
  EXPECT_GE(2 * scans_with_pole(seen, 7.5), static_cast<int>(seen.scans.size()));
}

}  // namespace
}  // namespace isobath
