// The automatic detector on recordings of real sonars (see their README for what stands where).
#include <gmock/gmock.h>
#include <cmath>
#include <fstream>
#include <isobath/sonar/echo_detector.hpp>
#include <sstream>
#include <tests/support/data.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

/// For each of 200 bearings the share of pings, from the third turn on, that hit each bin.
struct Tank {
  static constexpr double kBin = 0.01253133;
  std::vector<std::vector<double>> share = std::vector<std::vector<double>>(200, std::vector<double>(399, 0));

  explicit Tank(const std::filesystem::path& csv) {
    std::ifstream in(csv);
    EchoDetector detector{EchoDetectorConfig{}};
    EchoDecisions out;
    std::vector<int> pings(200, 0);
    std::string line;
    for (int n = 0; std::getline(in, line);) {
      if (line[0] == '#') continue;
      std::istringstream row(line);
      const auto next = [&] {
        std::string cell;
        std::getline(row, cell, ',');
        return std::stod(cell);
      };
      next();
      const double bearing = next();
      const Ping ping = test::ping_of<std::uint8_t>(test::fan_of(1, Angle::degrees(bearing)), {0, next(), 399},
                                                    [&](int, int k) { return k == 0 ? (next(), next()) : next(); });
      detector.detect(ping, out);
      if (n++ < 300) continue;  // a turn of 100 pings, and one of 200
      const int at = static_cast<int>(std::lround(bearing / 1.8)) % 200;
      ++pings[at];
      for (int k = 0; k < 399; ++k) share[at][k] += out.hit(0, k);
    }
    for (int b = 0; b < 200; ++b) {
      for (double& s : share[b]) s /= pings[b];
    }
  }
  /// Ranges where stretches of bins begin that hit in most pings.
  [[nodiscard]] std::vector<double> echoes(int bearing_deg) const {
    const auto& s = share[bearing_deg * 200 / 360];
    std::vector<double> begins;
    for (int k = 1, last = -9; k < 399; ++k) {
      if (s[k] <= 0.5) continue;
      if (k - last > 3) begins.push_back(k * kBin);
      last = k;
    }
    return begins;
  }
};

TEST(TankRecording, FirstEchoOfEachWallIsTheWall) {
  ISOBATH_NEEDS_DATA(csv, "msis-tank/msis-tank-rev00-20.csv");
  const Tank tank(csv);
  const auto first = [&](int bearing) { return tank.echoes(bearing).empty() ? 0 : tank.echoes(bearing)[0]; };
  EXPECT_NEAR(first(0), 2.12, 0.07);
  EXPECT_NEAR(first(90), 1.79, 0.07);
  EXPECT_NEAR(first(180), 2.31, 0.07);
  EXPECT_NEAR(first(270), 1.49, 0.05) << "the compact echo";
  using testing::AllOf, testing::Contains, testing::Gt, testing::Lt;
  EXPECT_THAT(tank.echoes(270), Contains(AllOf(Gt(2.70), Lt(2.80)))) << "the wall behind it";
  double hits = 0;
  for (const auto& s : tank.share) {
    for (int k = 64; k < 112; ++k) hits += s[k];  // 0.8 .. 1.4 m: reverberation of 40 to 60 counts, no wall
  }
  EXPECT_LT(hits / (200 * 48), 0.005);
}

}  // namespace
}  // namespace isobath
