// What a sonar learns that chooses its sectors, beside one that goes round and round.
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/scan_control.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <tests/support/directions.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using test::towards;

// ledger: S4-41
TEST(ScanControl, LooksWhereTheGridIsLeastSureAndWeighsTheTurn) {
  EXPECT_NEAR(binary_entropy(0.5), std::log(2), 1e-12);
  EXPECT_EQ(binary_entropy(0), 0);
  EXPECT_EQ(binary_entropy(1), 0);
  SphericalGrid grid;
  const auto chosen_first = [&](const ScanLimits& limits) {
    return ScanControl(limits).next(grid, Angle::degrees(100)).azimuth;
  };
  EXPECT_NEAR(ScanControl().next(grid, {}).worth, 0, 0.01) << "nothing is known, and no turn is worth while";
  const auto put = [&](double azimuth, double probability) {
    const auto place = grid.place_at(15 * towards(azimuth, 0.1));
    grid.set_log_odds(*place, std::log(probability / (1 - probability)));
  };
  put(100, 0.99);
  put(-50, 0.5);
  const auto is_near = [](Angle azimuth, double wanted) {
    return std::abs((azimuth - Angle::degrees(wanted)).wrapped().degrees()) < 16;
  };
  EXPECT_TRUE(is_near(chosen_first({}), -50));
  ScanLimits lazy;
  lazy.turn_cost = 0.5;
  EXPECT_TRUE(is_near(chosen_first(lazy), 100));
  put(70, 0.5);  // as unsure, and nearer
  EXPECT_TRUE(is_near(chosen_first({}), 85));
  ScanControl control;
  EXPECT_TRUE(is_near(control.next(grid, Angle::degrees(100)).azimuth, 85));
  EXPECT_TRUE(is_near(control.next(grid, Angle::degrees(100)).azimuth, -50)) << "it has looked at the other by now";
  grid.add_known(15 * towards(70, 0.1), 0.1);
  EXPECT_TRUE(is_near(chosen_first({}), -50)) << "what is known is settled";
  grid.turn(Angle::degrees(90));
  EXPECT_TRUE(is_near(chosen_first({}), 40));
  double sum = 0;
  for (const double h : entropy_by_azimuth(grid, Angle::degrees(10))) sum += h;
  EXPECT_NEAR(sum, std::log(2) + binary_entropy(0.99), 1e-6);
}

/// Mean distance of what is known of each target from the target, m.
double error_on_targets(bool controlled, std::uint64_t seed) {
  Random random(seed);
  const std::vector<Vector3d> targets{12 * towards(20, 0), 18 * towards(133, 0), 9 * towards(-100, 0)};
  SphericalGridConfig config;
  config.lock_echoes = 0;
  SphericalGrid grid(config);
  SphericalMapper mapper({}, grid);
  const auto ping = [&](double azimuth) {
    const double off = 2.5 / 2.355 * random.normal();
    std::optional<double> range;
    for (const Vector3d& target : targets) {
      const double true_azimuth = std::atan2(target.y(), target.x()) / test::kRadiansADegree;
      if (std::abs(std::remainder(true_azimuth - azimuth, 360)) > 1.25) continue;
      range = target.norm() + 0.3 * random.normal();
    }
    mapper.add({Vector3d::Zero(), towards(azimuth + (range ? off : 0), 0.1), Angle::degrees(2.5), range, 30, Time{}});
  };
  int pings = 0;
  for (; pings < 144; ++pings) ping(pings * 2.5);  // once round
  Angle looking;
  ScanControl control;
  while (pings < 720) {
    if (!controlled) {
      ping(pings++ * 2.5);
      continue;
    }
    looking = control.next(grid, looking).azimuth;
    for (int k = 0; k < 12; ++k, ++pings) ping(std::round(looking.degrees() / 2.5) * 2.5 + (k - 5.5) * 2.5);
  }
  double sum = 0;
  for (const Vector3d& target : targets) {
    Vector3d mean = Vector3d::Zero();
    double echoes = 0;
    grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
      for (const SphericalCell& cell : beam) {
        const Vector3d p = grid.point_of(cell);
        if (cell.echoes == 0 || (p - target).norm() > 2) continue;
        mean += static_cast<double>(cell.echoes) * p;
        echoes += static_cast<double>(cell.echoes);
      }
    });
    sum += echoes > 0 ? (mean / echoes - target).head<2>().norm() : 2;
  }
  return sum / 3;
}

// ledger: S4-41
TEST(ScanControl, MapsTargetsBetterThanUniformScansOfAsManyPings) {
  double chosen = 0, uniform = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    chosen += error_on_targets(true, seed) / 30;
    uniform += error_on_targets(false, seed) / 30;
  }
  EXPECT_LT(chosen, 0.7 * uniform);
}

}  // namespace
}  // namespace isobath
