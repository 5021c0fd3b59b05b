#include <gtest/gtest.h>
#include <tests/run/simple_reservoir.hpp>

namespace isobath {
namespace {

using test::SimpleReservoir;
using test::SimpleReservoirConfig;

std::vector<Ping> pings_of(SimpleReservoirConfig config) {
  SimpleReservoir scene(config);
  std::vector<Ping> pings;
  while (auto step = scene.step()) pings.push_back(step->second);
  return pings;
}

// ledger: S6-01 S6-60
TEST(SimpleReservoir, ScansThirtyOneBearingsThereAndBack) {
  const auto pings = pings_of({});
  ASSERT_GT(pings.size(), 100u);
  EXPECT_NEAR(pings[0].fan->azimuth[0].degrees(), -45, 1e-9);
  EXPECT_NEAR(pings[30].fan->azimuth[0].degrees(), 45, 1e-9);
  EXPECT_NEAR(pings[31].fan->azimuth[0].degrees(), 42, 1e-9);
  EXPECT_NEAR(pings[60].fan->azimuth[0].degrees(), -45, 1e-9);
  for (const Ping& p : pings) ASSERT_EQ(check(p), PingFault::kNone);
  EXPECT_NEAR(pings[0].window.bin_m, 1.136, 1e-3);
}

TEST(SimpleReservoir, IsAFunctionOfItsSeed) {
  const auto sum = [](const std::vector<Ping>& pings) {
    double s = 0;
    for (const Ping& p : pings) {
      for (int k = 0; k < p.window.bins; ++k) s += static_cast<double>(p.intensity(0, k)) * (k + 1);
    }
    return s;
  };
  SimpleReservoirConfig other;
  other.seed = 2;
  EXPECT_EQ(sum(pings_of({})), sum(pings_of({})));
  EXPECT_NE(sum(pings_of({})), sum(pings_of(other)));
}

// The buoy dead ahead in bearing stands out of the background in the bin of its true range.
TEST(SimpleReservoir, EchoStandsAtTheTrueRangeAndBearing) {
  SimpleReservoirConfig quiet;
  quiet.noise_sigma = 0.1;
  quiet.snr_db = 40;
  quiet.spurious_share = 0;
  SimpleReservoir scene(quiet);
  double found = 0;
  while (auto step = scene.step()) {
    const auto& [fix, ping] = *step;
    const Eigen::Vector3d seen =
        fix.X_WB.inverse() * Eigen::Vector3d(SimpleReservoir::buoys()[0].x(), SimpleReservoir::buoys()[0].y(), 0.5);
    const double bearing = std::atan2(seen.y(), seen.x());
    if (std::abs(ping.fan->azimuth[0].radians() - bearing) > 0.02 || seen.norm() > 49 || seen.norm() < 12) continue;
    const int bin = static_cast<int>(seen.norm() / ping.window.bin_m);
    EXPECT_GT(ping.intensity(0, bin), quiet.noise_mean + 5);
    ++found;
  }
  EXPECT_GT(found, 2);
}

}  // namespace
}  // namespace isobath
