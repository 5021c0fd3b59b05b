// How a sonar is mounted, from walls whose bearings are known.
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/links/mounting_check.hpp>
#include <isobath/sonar/ping.hpp>

namespace isobath::mounting {
namespace {

using testing::Contains;
using testing::HasSubstr;
using Kind = MountingVerdict::Kind;

const KnownWall kRight{Angle::degrees(40), 12}, kLeft{Angle::degrees(-100), 7};

/// Echoes as a scanning head that is truly mounted so shows them in a vehicle that believes `config`.
EchoPanorama turned_around(const DeviceConfig& config, double true_heading_deg, bool truly_upside_down,
                           const std::vector<KnownWall>& walls) {
  EchoPanorama echoes;
  for (int step = 0; step < 133; ++step) {
    const double raw = -180 + 2.7 * step;  // as the head counts it
    const double truth = true_heading_deg + (truly_upside_down ? -raw : raw);
    const RangeWindow window{0, 0.04, 500};
    std::vector<std::uint8_t> samples(500, 4);
    for (const KnownWall& wall : walls) {  // flat, 50 degrees wide, saturated: what is nearest tells its direction
      const Angle off = (Angle::degrees(truth) - wall.bearing).wrapped();
      if (std::abs(off.degrees()) < 25) samples[static_cast<std::size_t>(wall.range_m / cos(off) / 0.04)] = 250;
    }
    const double shown = config.upside_down ? -raw : raw;
    auto fan = std::make_shared<const BeamFan>(
        BeamFan{{Angle::degrees(shown).wrapped()}, {Angle::degrees(2)}, Angle::degrees(25)});
    Ping ping = make_ping({}, fan, window, samples);
    ping.X_BS.rotation = Rotation::from_heading(config.heading);
    echoes.add(ping);
  }
  return echoes;
}

MountingVerdict verdict(const DeviceConfig& config, double true_heading_deg, bool truly_upside_down,
                        const std::vector<KnownWall>& walls) {
  const EchoPanorama echoes = turned_around(config, true_heading_deg, truly_upside_down, walls);
  EXPECT_EQ(echoes.heard(), 1);
  std::vector<std::optional<EchoPanorama::Echo>> seen;
  for (const KnownWall& wall : walls) seen.push_back(echoes.wall_at(wall.range_m));
  return check_mounting(config, walls, seen);
}

TEST(Mounting, IsRightWhereTheWallIsSeen) {
  const auto found = verdict({}, 0, false, {kRight});
  EXPECT_EQ(found.kind, Kind::kRight);
  EXPECT_THAT(found.remarks, Contains(HasSubstr("the wall at 40 degrees and 12 m is seen at 40 degrees and 12.0 m")));
  DeviceConfig turned;
  turned.heading = Angle::degrees(90);
  turned.upside_down = true;
  EXPECT_EQ(verdict(turned, 90, true, {kRight, kLeft}).kind, Kind::kRight);
}

TEST(Mounting, OfAMirroredHeadIsProposedUpsideDown) {
  const auto found = verdict({}, 0, true, {kRight});
  EXPECT_EQ(found.kind, Kind::kMirrored);
  EXPECT_TRUE(found.proposed.upside_down);
  EXPECT_EQ(found.proposed.heading.degrees(), 0);
  EXPECT_THAT(found.remarks, Contains(HasSubstr("a second wall")));
  EXPECT_EQ(verdict({}, 0, true, {kRight, kLeft}).kind, Kind::kMirrored);
}

TEST(Mounting, OfATurnedHeadIsProposedWithTheTurn) {
  const auto found = verdict({}, 90, false, {kRight});
  EXPECT_EQ(found.kind, Kind::kTurned);
  EXPECT_NEAR(found.proposed.heading.degrees(), 90, 2);
  EXPECT_FALSE(found.proposed.upside_down);
  EXPECT_THAT(found.remarks, Contains(HasSubstr("a second wall")));
}

TEST(Mounting, TwoWallsTellATurnFromAMirror) {
  const auto found = verdict({}, 130, true, {kRight, kLeft});
  EXPECT_EQ(found.kind, Kind::kMirrored);
  EXPECT_TRUE(found.proposed.upside_down);
  EXPECT_NEAR(found.proposed.heading.degrees(), 130, 2);
  const DeviceConfig proposed = found.proposed;
  EXPECT_EQ(verdict(proposed, 130, true, {kRight, kLeft}).kind, Kind::kRight) << "the proposal holds";
}

TEST(Mounting, OfAFanIsMirroredByItsRoll) {
  DeviceConfig fan;
  fan.kind = DeviceKind::kOculus;
  const std::vector<KnownWall> walls{kRight};
  const std::vector<std::optional<EchoPanorama::Echo>> seen{EchoPanorama::Echo{Angle::degrees(-40), 12}};
  const auto found = check_mounting(fan, walls, seen);
  EXPECT_EQ(found.kind, Kind::kMirrored);
  EXPECT_EQ(std::abs(found.proposed.roll.degrees()), 180);
}

TEST(Mounting, IsUnclearWithoutEchoesOrWhereTheWallsDisagree) {
  const std::vector<KnownWall> walls{kRight, kLeft};
  const std::vector<std::optional<EchoPanorama::Echo>> nothing(2);
  EXPECT_EQ(check_mounting({}, walls, nothing).kind, Kind::kUnclear);
  const std::vector<std::optional<EchoPanorama::Echo>> odd{EchoPanorama::Echo{Angle::degrees(40), 12},
                                                           EchoPanorama::Echo{Angle::degrees(160), 7}};
  EXPECT_EQ(check_mounting({}, walls, odd).kind, Kind::kUnclear);
}

TEST(Mounting, NeedsAnEchoNearTheRangeOfTheWall) {
  const EchoPanorama echoes = turned_around({}, 0, false, {kRight});
  EXPECT_FALSE(echoes.wall_at(4));
  EXPECT_FALSE(EchoPanorama().wall_at(4));
  EXPECT_EQ(echoes.at(Angle::degrees(40), 25), 0) << "beyond its range";
}

}  // namespace
}  // namespace isobath::mounting
