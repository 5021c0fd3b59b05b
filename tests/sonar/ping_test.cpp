#include <gtest/gtest.h>
#include <isobath/sonar/ping.hpp>

namespace isobath {
namespace {

const RangeWindow kFourBins{.start_m = 1, .bin_m = 0.5, .bins = 4};

TEST(EvenFan, HasItsOuterBeamsAtTheEdgesOfTheSectorAndEvenSteps) {
  const auto fan = even_fan(5, Angle::degrees(60), Angle::degrees(2), Angle::degrees(15));
  ASSERT_EQ(fan->beams(), 5);
  for (int b = 0; b < 5; ++b) {
    EXPECT_NEAR(fan->azimuth[static_cast<std::size_t>(b)].degrees(), -30 + 15 * b, 1e-12);
    EXPECT_EQ(fan->width[static_cast<std::size_t>(b)], Angle::degrees(2));
  }
  EXPECT_EQ(fan->height, Angle::degrees(15));
}

TEST(EvenFan, OfOneBeamLooksAhead) {
  const auto fan = even_fan(1, Angle::degrees(60), Angle::degrees(2), Angle::degrees(15));
  ASSERT_EQ(fan->beams(), 1);
  EXPECT_EQ(fan->azimuth[0], Angle{});
}

TEST(MadePing, OwnsItsSamplesBeamAfterBeam) {
  const auto fan = even_fan(2, Angle::degrees(10), Angle::degrees(2), Angle::degrees(15));
  std::vector<std::uint8_t> samples{0, 1, 2, 3, 10, 11, 12, 13};
  const Ping ping = make_ping(Time(seconds(7)), fan, kFourBins, samples);
  samples.assign(8, 99);
  EXPECT_EQ(check(ping), PingFault::kNone);
  EXPECT_EQ(ping.time, Time(seconds(7)));
  EXPECT_EQ(ping.fan, fan) << "pings of one fan share it";
  EXPECT_EQ(ping.window, kFourBins);
  for (int beam = 0; beam < 2; ++beam) {
    for (int bin = 0; bin < 4; ++bin) EXPECT_EQ(ping.intensity(beam, bin), static_cast<float>(10 * beam + bin));
  }
}

TEST(MadePing, OfAnotherNumberOfSamplesIsRefusedByItsCheck) {
  const auto fan = even_fan(2, Angle::degrees(10), Angle::degrees(2), Angle::degrees(15));
  for (const std::size_t count : {0, 4, 7, 9, 16}) {
    const Ping ping = make_ping(Time{}, fan, kFourBins, std::vector<std::uint8_t>(count));
    EXPECT_EQ(check(ping), PingFault::kSizeMismatch) << count;
  }
}

}  // namespace
}  // namespace isobath
