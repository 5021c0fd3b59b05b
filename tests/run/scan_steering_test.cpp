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

}  // namespace
}  // namespace isobath
