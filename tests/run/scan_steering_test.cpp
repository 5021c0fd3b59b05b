// A scanning sonar that the program steers: every other sweep looks where the spherical grid is least certain.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/run/closed_loop.hpp>
#include <isobath/scenario/scenario.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

/// One pole 30 degrees to starboard, which a slow vehicle passes.
constexpr const char* kPole = R"(
[scene]
title = "A pole on the bow"
duration_s = 25
[bottom]
kind = "flat"
material = "mud"
depth = 30
[vehicle]
file = "vehicles/hovering_rov.toml"
dynamic = true
start = [0, 0, 15]
speed = 0.2
[[cylinder]]
name = "pole"
centre = [20, 11.5, 15]
radius = 0.6
length = 30
[[sonar]]
preset = "micron"
sector_deg = 120
range_m = 40
bins = 80
interval_s = 0.06
[mission]
title = "Past a pole"
speed = 0.2
[[mission_point]]
north = 40
depth_m = 15
)";

struct Sweep {
  double from_deg = 180, to_deg = -180;
  int pings = 0;
};

/// The sweeps of the sonar: a new one begins where the head turns back or jumps.
class Sweeps : public OnboardObserver {
 public:
  std::vector<Sweep> all;
  void on_ping(const PosedPing& posed) override {
    const double now = posed.ping.fan->azimuth[0].wrapped().degrees(), step = now - last_;
    const bool begins = all.empty() || std::abs(step) > 10 || step * step_ < 0;
    if (begins) all.emplace_back();
    Sweep& sweep = all.back();
    sweep.from_deg = std::min(sweep.from_deg, now);
    sweep.to_deg = std::max(sweep.to_deg, now);
    ++sweep.pings;
    step_ = begins ? 0 : step;
    last_ = now;
  }

 private:
  double last_ = 0, step_ = 0;
};

std::vector<Sweep> sweeps(bool steered) {
  const Scenario scenario = parse_scenario(kPole, (test::source_folder() / "pole.toml").string());
  Sweeps log;
  LoopRequest request;
  request.observers = {&log};
  request.configuration.scan.on = steered;
  run_closed_loop(scenario, request);
  std::erase_if(log.all, [](const Sweep& s) { return s.pings < 5; });  // the head has overrun the end of its sweep
  return log.all;
}

// ledger: S4-40 S4-41
TEST(ScanSteering, LooksAtWhatItIsUnsureOfInEveryOtherSweep) {
  int whole = 0, at_the_pole = 0, elsewhere = 0;
  for (const Sweep& sweep : sweeps(true)) {
    const double width = sweep.to_deg - sweep.from_deg;
    if (width > 100) {
      ++whole;
    } else if (sweep.from_deg < 30 && sweep.to_deg > 30) {
      ++at_the_pole;
    } else {
      ++elsewhere;
    }
  }
  EXPECT_GE(whole, 5);
  EXPECT_GE(at_the_pole, 4);
  EXPECT_LE(elsewhere, at_the_pole);
  for (const Sweep& sweep : sweeps(false)) EXPECT_TRUE(sweep.pings < 35 || sweep.to_deg - sweep.from_deg > 100);
}

/// What the spherical grid of a run holds of the pole at the end.
struct PoleInGrid {
  double echoes = 0;
  double sigma_m = 0;  ///< standard deviation of their mean, in plan
};

class LastSphere : public OnboardObserver {
 public:
  int pings = 0;
  void on_ping(const PosedPing&) override { ++pings; }
  void on_sphere(Time, const std::shared_ptr<const GridSnapshot>& sphere) override { sphere_ = sphere; }
  [[nodiscard]] PoleInGrid pole() const {
    double echoes = 0, squares = 0;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    sphere_->grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
      for (const SphericalCell& cell : beam) {
        const Eigen::Vector3d p_W = sphere_->X_WB.translation + world_from_grid_axes(sphere_->grid.point_of(cell));
        const Eigen::Vector2d off = p_W.head<2>() - Eigen::Vector2d(20, 11.5);
        if (off.norm() > 4) continue;
        echoes += cell.echoes;
        sum += cell.echoes * off;
        squares += cell.echoes * off.squaredNorm();
      }
    });
    const double variance = squares / echoes - (sum / echoes).squaredNorm();
    return {echoes, std::sqrt(variance / echoes)};
  }

 private:
  std::shared_ptr<const GridSnapshot> sphere_;
};

// As many pings, more echoes of the pole: the error of its place that chance leaves is smaller. ledger: S4-41
TEST(ScanSteering, PlacesAPoleBetterThanWholeSweepsOfAsManyPings) {
  constexpr int kRuns = 8;
  const auto run = [](int seed, bool steered) {
    Scenario scenario = parse_scenario(kPole, (test::source_folder() / "pole.toml").string());
    scenario.scene.about.seed = seed;
    LastSphere last;
    LoopRequest request;
    request.observers = {&last};
    request.configuration.scan.on = steered;
    request.configuration.scan.limits.sector = Angle::degrees(20);
    request.configuration.mission.chart_room.sphere = true;  // keeps the grid
    run_closed_loop(scenario, request);
    return std::pair(last.pings, last.pole());
  };
  PoleInGrid steered, whole;  // sums
  for (int seed = 1; seed <= kRuns; ++seed) {
    const auto [steered_pings, by_steering] = run(seed, true);
    const auto [whole_pings, by_whole] = run(seed, false);
    EXPECT_EQ(steered_pings, whole_pings);
    steered.echoes += by_steering.echoes;
    steered.sigma_m += by_steering.sigma_m;
    whole.echoes += by_whole.echoes;
    whole.sigma_m += by_whole.sigma_m;
  }
  EXPECT_GT(steered.echoes, 1.4 * whole.echoes);
  EXPECT_LT(steered.sigma_m, 0.9 * whole.sigma_m);
}

}  // namespace
}  // namespace isobath
