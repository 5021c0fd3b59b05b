#include <gtest/gtest.h>
#include <isobath/sonar/side_lobes.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

// A floor that is loud in one beam is heard in all, 30 dB weaker; a wall that is 17 dB weaker is an echo of its own.
TEST(SideLobes, OfALoudEchoAreNoEchoesAndNoFreeWater) {
  constexpr int kBeams = 9, kBins = 80, kLoud = 40, kAlone = 60;
  const auto level = [](int b, int k) {
    if (k == kAlone) return b == 2 ? 0.01 : 0.0001;  // weak, and nothing is louder at its range
    if (k != kLoud) return 0.0001;
    return b == 4 ? 10.0 : b == 7 ? 10 * std::pow(10, -17.0 / 20) : 10 * std::pow(10, -30.0 / 20);
  };
  const Ping ping = test::ping_of<float>(test::fan_of(kBeams), {0, 0.1, kBins}, level, 100);
  EchoDecisions decisions;
  decisions.reset(kBeams, kBins);
  decisions.p_detect.assign(kBins, 0.8F);
  for (int b = 0; b < kBeams; ++b) {
    for (const int k : {kLoud, kLoud + 1, kAlone}) decisions.set_hit(b, k);
  }
  SideLobes().leave_out(ping, decisions);
  for (int b = 0; b < kBeams; ++b) {
    EXPECT_EQ(decisions.hit(b, kLoud), b == 4 || b == 7) << b;
    EXPECT_EQ(decisions.tells(b, kLoud), b == 4 || b == 7) << b;
    EXPECT_FALSE(decisions.hit(b, kLoud + 1)) << b << ": in the smear of the loud one";
    EXPECT_EQ(decisions.hit(b, kAlone), b == 2) << b;
    EXPECT_TRUE(decisions.tells(b, kLoud - 1)) << b << ": a clear bin stays clear";
  }
}

}  // namespace
}  // namespace isobath
