// Packets between the modems of vehicles: delay, bit rate, range, chance, and packets that meet.
#include <gtest/gtest.h>
#include <isobath/sim/acoustic_link.hpp>

namespace isobath {
namespace {

class AcousticLinkTest : public testing::Test {
 protected:
  static Time at(double s) { return Time{} + seconds(s); }
  /// Two vehicles 750 m apart, and a third beside the second.
  std::vector<Eigen::Vector3d> places = {{0, 0, 5}, {750, 0, 5}, {750, 10, 5}};
  AcousticLinkConfig config{.range_m = 1000, .delay_s = 0.5, .loss = 0, .bit_rate = 80};
};

// ledger: S2-51
TEST_F(AcousticLinkTest, APacketArrivesAfterModemSoundAndItsLength) {
  AcousticLink link(config, 3, 1);
  link.send(0, at(10), std::vector<std::uint8_t>(20, 7), places);
  // 20 bytes take 2 s, 750 m take 0.5 s, the modem 0.5 s.
  EXPECT_TRUE(link.arrived(at(12.99)).empty());
  const auto arrived = link.arrived(at(13.1));
  ASSERT_EQ(arrived.size(), 2u);
  EXPECT_EQ(arrived[0].to, 1u);
  EXPECT_NEAR(to_seconds(arrived[0].time - at(0)), 13, 1e-6);
  EXPECT_EQ(arrived[0].bytes, std::vector<std::uint8_t>(20, 7));
  EXPECT_TRUE(link.arrived(at(20)).empty()) << "once";
  EXPECT_EQ(link.counts()[0].bytes, 20u);
  EXPECT_EQ(link.counts()[0].received, 2u);
}

// ledger: S2-51
TEST_F(AcousticLinkTest, PacketsThatMeetAreLostAndAModemThatSendsIsDeaf) {
  AcousticLink link(config, 3, 1);
  link.send(0, at(0), std::vector<std::uint8_t>(10), places);    // at the others from 1 to 2 s
  link.send(1, at(0.6), std::vector<std::uint8_t>(10), places);  // sends until 1.6 s; at 2 from 1.1 to 2.1 s
  EXPECT_TRUE(link.arrived(at(1.9)).empty());
  const auto arrived = link.arrived(at(5));
  ASSERT_EQ(arrived.size(), 1u);
  EXPECT_EQ(arrived[0].to, 0u) << "it had sent its packet by then";
  EXPECT_EQ(link.counts()[0].deaf, 1u);
  EXPECT_EQ(link.counts()[0].collided, 1u);
  EXPECT_EQ(link.counts()[1].collided, 1u);
}

// ledger: S2-51
TEST_F(AcousticLinkTest, AModemSendsOneAfterTheOtherAndHoldsSoMany) {
  AcousticLink link(config, 2, 1);
  places.resize(2);
  for (std::size_t i = 0; i < AcousticLink::kQueue + 3; ++i) {
    link.send(0, at(0), {static_cast<std::uint8_t>(i), 0, 0, 0, 0, 0, 0, 0, 0, 0}, places);
  }
  const auto arrived = link.arrived(at(60));
  ASSERT_EQ(arrived.size(), AcousticLink::kQueue + 1);
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    EXPECT_EQ(arrived[i].bytes[0], i);
    EXPECT_NEAR(to_seconds(arrived[i].time - at(0)), 2 + static_cast<double>(i), 1e-6);
  }
  EXPECT_EQ(link.counts()[0].dropped, 2u);
}

// ledger: S2-51
TEST_F(AcousticLinkTest, LosesAShareByChanceAndAllBeyondItsRange) {
  config.loss = 0.3;
  AcousticLink link(config, 2, 5), again(config, 2, 5);
  places.resize(2);
  int received = 0;
  for (int i = 0; i < 1000; ++i) {
    link.send(0, at(10 * i), {1}, places);
    again.send(0, at(10 * i), {1}, places);
    const auto arrived = link.arrived(at(10 * i + 9));
    EXPECT_EQ(arrived.size(), again.arrived(at(10 * i + 9)).size()) << "the same seed";
    received += static_cast<int>(arrived.size());
  }
  EXPECT_NEAR(received, 700, 45) << "three standard deviations";
  places[1].x() = 1001;
  link.send(0, at(20000), {1}, places);
  EXPECT_TRUE(link.arrived(at(20010)).empty());
  EXPECT_EQ(link.counts()[0].out_of_range, 1u);
}

}  // namespace
}  // namespace isobath
