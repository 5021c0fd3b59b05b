// A sonar that is told how to look, while it runs.
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/sim/simulator.hpp>
#include <tests/sim/worlds.hpp>

namespace isobath {
namespace {

using namespace test;

constexpr const char* kPole =
    "[water]\nsound_speed = [[0, 1500]]\nabsorption = \"none\"\n[[cylinder]]\nname = \"pole\"\ncentre = [0, 20, 10]\n"
    "radius = 0.5\nlength = 20\n";

SonarConfig sweeping_head() {
  SonarConfig c = clean_beam(3, 20);
  c.kind = SonarKind::kScanning;
  c.sector = Angle::degrees(30);
  c.step = Angle::degrees(3);
  c.blanking_m = 0;
  return c;
}
double head_of(const SimulatedSonar::Output& heard) { return heard.ping->fan->azimuth[0].degrees(); }

// ledger: S4-40
TEST(ScanCommand, TheNextPingOfASweepingHeadObeys) {
  const Tank tank(kPole);
  SimulatedSonar sonar(sweeping_head(), *tank.world, *tank.water, 1, 1);
  for (std::uint64_t n = 0; n < 7; ++n) {
    EXPECT_NEAR(head_of(sonar.ping(Time{}, at_depth(10), n)), -15 + 3.0 * static_cast<double>(n), 1e-9);
  }
  ScanCommand command;
  command.sector = Angle::degrees(60);
  command.step = Angle::degrees(5);
  command.range_m = 30;
  sonar.command(command);
  const auto next = sonar.ping(Time{}, at_depth(10), 7);
  EXPECT_NEAR(head_of(next), -30, 1e-9) << "the first end of the new sector";
  EXPECT_NEAR(next.ping->window.end_m(), 30, 1e-9);
  EXPECT_EQ(next.ping->window.bins, 600);
  for (std::uint64_t n = 8; n < 32; ++n) {  // there and back
    const int k = static_cast<int>(n - 7) % 24;
    EXPECT_NEAR(head_of(sonar.ping(Time{}, at_depth(10), n)), -30 + 5.0 * (k < 13 ? k : 24 - k), 1e-9) << n;
  }
}

// ledger: S4-40
TEST(ScanCommand, TurnsTiltsAndStandsUpThePlaneOfAFan) {
  const Tank tank(kPole);  // 20 m to the east
  SonarConfig fan = clean_beam(2, 10);
  fan.beams = 16;
  fan.sector = Angle::degrees(30);
  fan.blanking_m = 0;
  SimulatedSonar sonar(fan, *tank.world, *tank.water, 1, 1);
  const auto power = [&] {
    (void)sonar.ping(Time{}, at_depth(10), 0);
    return total(sonar.image());
  };
  EXPECT_EQ(power(), 0) << "it looks north";
  ScanCommand to_pole;
  to_pole.heading = Angle::degrees(90);
  to_pole.beams = 31;
  sonar.command(to_pole);
  EXPECT_GT(power(), 0);
  const auto heard = sonar.ping(Time{}, at_depth(10), 2);
  EXPECT_EQ(heard.ping->fan->beams(), 31);
  EXPECT_NEAR((heard.ping->X_BS.rotation * Eigen::Vector3d::UnitX()).y(), 1, 1e-9) << "the ping says where it looked";
  ScanCommand over_it;
  over_it.pitch = Angle::degrees(60);
  sonar.command(over_it);
  EXPECT_EQ(power(), 0) << "over the pole's head, still to the east";
  ScanCommand vertical;
  vertical.pitch = Angle{};
  vertical.roll = Angle::degrees(90);
  sonar.command(vertical);
  int beams = 0;
  (void)sonar.ping(Time{}, at_depth(10), 3);
  for (int b = 0; b < sonar.image().beams; ++b) {
    double sum = 0;
    for (int k = 0; k < sonar.image().bins; ++k) {
      const auto i = static_cast<std::size_t>(b * sonar.image().bins + k);
      sum += static_cast<double>(sonar.image().rough[i] + sonar.image().steady[i]);
    }
    beams += sum > 0 ? 1 : 0;
  }
  EXPECT_GT(beams, 20) << "along the pole";
}

// ledger: S4-40
TEST(ScanCommand, RefusesWhatNoSonarDoesAndGoesOnAsBefore) {
  const Tank tank(kPole);
  SimulatedSonar sonar(sweeping_head(), *tank.world, *tank.water, 1, 1);
  (void)sonar.ping(Time{}, at_depth(10), 0);
  ScanCommand command;
  command.step = Angle{};
  EXPECT_THROW(sonar.command(command), Error);
  command = {};
  command.range_m = -3;
  EXPECT_THROW(sonar.command(command), Error);
  command = {};
  command.sector = Angle::degrees(400);
  EXPECT_THROW(sonar.command(command), Error);
  EXPECT_NEAR(head_of(sonar.ping(Time{}, at_depth(10), 1)), -12, 1e-9) << "its second step";
}

// ledger: S4-40
TEST(ScanCommand, ReachesASonarOfARunningSimulationWithinOnePing) {
  const Scene scene = parse_scene(
      "[scene]\nduration_s = 20\n[[sonar]]\npreset = \"micron\"\nname = \"head\"\nsector_deg = 90\nstep_deg = 3\n",
      "command.toml");
  Simulator simulator(scene, {});
  int pings = 0, after = 0;
  bool told = false;
  while (auto event = simulator.next()) {
    const auto* ping = std::get_if<Ping>(&*event);
    if (!ping) continue;
    ++pings;
    if (pings == 20) {
      ScanCommand narrow;
      narrow.heading = Angle::degrees(45);
      narrow.sector = Angle::degrees(12);
      narrow.step = Angle::degrees(4);
      simulator.command_scanning(narrow);
      told = true;
      continue;
    }
    const double azimuth = ping->fan->azimuth[0].degrees(), mount = ping->X_BS.rotation.heading().degrees();
    if (!told) {
      EXPECT_NEAR(mount, 0, 1e-9);
      continue;
    }
    ++after;
    if (after == 1) continue;  // may have been on its way
    EXPECT_NEAR(mount, 45, 1e-9);
    EXPECT_LE(std::abs(azimuth), 6 + 1e-9);
  }
  EXPECT_GT(after, 20);
}

// ledger: S2-16 S4-40
TEST(ScanCommand, TakesASonarBackToItsConfiguration) {
  const Scene scene = parse_scene(
      "[scene]\nduration_s = 20\n[[sonar]]\npreset = \"micron\"\nsector_deg = 90\nstep_deg = 3\nrange_m = 40\n",
      "command.toml");
  Simulator simulator(scene, {});
  int pings = 0;
  double widest_after = 0;
  while (auto event = simulator.next()) {
    const auto* ping = std::get_if<Ping>(&*event);
    if (!ping) continue;
    ++pings;
    ScanCommand round;
    round.sector = Angle::degrees(360);
    round.range_m = 20;
    if (pings == 20) simulator.command_scanning(round);
    if (pings == 60) {
      EXPECT_GT(std::abs(ping->fan->azimuth[0].degrees()), 46);
      simulator.command_scanning({.as_configured = true});
    }
    if (pings < 62) continue;
    widest_after = std::max(widest_after, std::abs(ping->fan->azimuth[0].degrees()));
  }
  EXPECT_GT(pings, 120);
  EXPECT_NEAR(widest_after, 45, 1e-9);
}

}  // namespace
}  // namespace isobath
