// Sonar 3D-15 logs: a packet made byte by byte with the encodings written out here, cuts at every byte, damage that
// costs only itself, headers that promise too much, and a recording of a ship.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <gmock/gmock.h>
#include <isobath/io/formats/sonar3d.hpp>
#include <isobath/io/open_source.hpp>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/support/data.hpp>
#include <zlib.h>

namespace isobath {
namespace {

using test::drain;
using test::hex;
using test::in_memory;
using test::little;

// Encodings by their publications: protobuf.dev/programming-guides/encoding, google/snappy format_description.txt.

std::string wire_varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
  return bytes + static_cast<char>(value);
}
std::string wire_whole(int number, std::uint64_t value) {
  return wire_varint(static_cast<std::uint64_t>(number) << 3) + wire_varint(value);
}
std::string wire_real(int number, float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, 4);
  return wire_varint(static_cast<std::uint64_t>(number) << 3 | 5) + little(bits);
}
std::string wire_bytes(int number, const std::string& bytes) {
  return wire_varint(static_cast<std::uint64_t>(number) << 3 | 2) + wire_varint(bytes.size()) + bytes;
}

/// A Snappy block of literals only, at most 60 bytes each.
std::string snappy_literals(const std::string& plain) {
  std::string packed = wire_varint(plain.size());
  for (std::size_t at = 0; at < plain.size(); at += 60) {
    const std::string part = plain.substr(at, 60);
    packed += static_cast<char>((part.size() - 1) << 2);
    packed += part;
  }
  return packed;
}

std::string packet_of(const std::string& payload) {
  std::string bytes = "RIP2" + little(static_cast<std::uint32_t>(payload.size() + 12)) + payload;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
  return bytes + little(static_cast<std::uint32_t>(sum));
}

/// Three columns, two rows: 90 by 40 degrees, a millimetre a count.
struct Shot {
  std::string type = "waterlinked.sonar.protocol.RangeImage";
  std::uint64_t seconds = 1716815835, width = 3, height = 2;
  float view_deg = 90, metres = 0.001f;
  std::vector<std::uint64_t> counts{1000, 0, 2000, 0, 3000, 70000};

  [[nodiscard]] std::string message() const {
    std::string packed;
    for (const std::uint64_t c : counts) packed += wire_varint(c);
    const std::string header = wire_bytes(1, wire_whole(1, seconds) + wire_whole(2, 840'000'000)) + wire_whole(2, 4448);
    return wire_bytes(1, header) + wire_real(2, 1491) + wire_real(3, 15) + wire_whole(4, 1) + wire_whole(5, width) +
           wire_whole(6, height) + wire_real(7, view_deg) + wire_real(8, 40) + wire_real(9, metres) +
           wire_bytes(10, packed);
  }
  [[nodiscard]] std::string packet() const {
    return packet_of(
        snappy_literals(wire_bytes(1, wire_bytes(1, "type.googleapis.com/" + type) + wire_bytes(2, message()))));
  }
};

std::unique_ptr<Source> shots(const std::string& bytes, const InputConfig& config = {}) {
  return open_sonar3d(in_memory(bytes), config);
}

TEST(Sonar3d, AShotIsASwathOfPointsWithTrueElevation) {
  const auto source = shots(Shot{}.packet());
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 1u);
  const Swath& swath = std::get<Swath>(events[0]);
  EXPECT_EQ(to_text(swath.time), "2024-05-27T13:17:15.840Z");
  EXPECT_EQ(swath.frame, Swath::Frame::kBody);
  EXPECT_EQ(swath.sound_speed, 1491);
  EXPECT_NEAR(swath.beam_width.degrees(), 30, 1e-9);
  ASSERT_EQ(swath.soundings.size(), 4u);
  const double c45 = std::sqrt(0.5), c20 = std::cos(0.3490658504), s20 = std::sin(0.3490658504);
  const std::array<std::array<double, 5>, 4> expected{{{0, 1, c20 * c45, -c20 * c45, -s20},  // port, up
                                                       {2, 2, c20 * c45, c20 * c45, -s20},   // starboard, up
                                                       {4, 3, c20, 0, s20},                  // ahead, down
                                                       {5, 70, c20 * c45, c20 * c45, s20}}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Sounding& s = swath.soundings[i];
    EXPECT_EQ(s.kind, Sounding::Kind::kWater);
    EXPECT_EQ(s.beam, expected[i][0]);
    EXPECT_NEAR(s.range_m, expected[i][1], 1e-4);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(s.point[a], expected[i][1] * expected[i][2 + a], 1e-4) << i << " " << a;
  }
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_TRUE(source->report().rejected.empty());
}

// The bytes of a packet by hand: a copy of the Snappy block reaches back four bytes.
TEST(Sonar3d, UnpacksCopies) {
  // Packet { 1: Any { 1: "RangeImageRangeImage" } }: the second half of the name is a copy of the first.
  const std::string packed = hex("18 | 34 0a 16 0a 14 | 52 61 6e 67 65 49 6d 61 67 65 | 19 0a");
  const auto source = shots(packet_of(packed));
  EXPECT_TRUE(drain(*source).empty());
  EXPECT_THAT(source->report().rejected,
              testing::ElementsAre(testing::Pair("image whose size disagrees with its echoes", 1)));
}

TEST(Sonar3d, IsMountedAsConfigured) {
  InputConfig config;
  config.mount_heading = Angle::degrees(90);
  config.mount_m[2] = 0.5;
  const auto events = drain(*shots(Shot{}.packet(), config));
  const Sounding& ahead = std::get<Swath>(events.at(0)).soundings.at(2);
  EXPECT_NEAR(ahead.point.x(), 0, 1e-5);
  EXPECT_NEAR(ahead.point.y(), 3 * std::cos(0.3490658504), 1e-4);
  EXPECT_NEAR(ahead.point.z(), 0.5 + 3 * std::sin(0.3490658504), 1e-4);
}

TEST(Sonar3d, PassesOtherPacketsOver) {
  Shot other;
  other.type = "waterlinked.sonar.protocol.BitmapImageGreyscale8";
  const auto source = shots(other.packet() + Shot{}.packet() + other.packet());
  EXPECT_EQ(drain(*source).size(), 1u);
  EXPECT_EQ(source->report().details.at("other packets"), "2, not read");
}

TEST(Sonar3d, ACutAtEveryByteCostsOnlyWhatIsCut) {
  const std::string one = Shot{}.packet(), log = one + one + one;
  for (std::size_t cut = 1; cut < log.size(); ++cut) {
    const auto source = shots(log.substr(0, cut));
    ASSERT_EQ(drain(*source).size(), cut / one.size()) << cut;
    ASSERT_EQ(source->report().bytes_skipped, cut % one.size()) << cut;
  }
}

TEST(Sonar3d, ADamagedByteCostsItsOwnShot) {
  const std::string one = Shot{}.packet(), log = one + one + one;
  for (std::size_t at = one.size(); at < 2 * one.size(); ++at) {
    std::string damaged = log;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const auto source = shots(damaged);
    ASSERT_EQ(drain(*source).size(), 2u) << at;
    ASSERT_EQ(source->report().bytes_skipped, one.size()) << at;
  }
}

TEST(Sonar3d, RefusesWhatIsNoImage) {
  const auto reason = [](auto change) {
    Shot shot;
    change(shot);
    const auto source = shots(shot.packet());
    EXPECT_TRUE(drain(*source).empty());
    return source->report().rejected.empty() ? "" : source->report().rejected.begin()->first;
  };
  EXPECT_EQ(reason([](Shot& s) { s.counts.pop_back(); }), "image whose size disagrees with its echoes");
  EXPECT_EQ(reason([](Shot& s) { s.width = std::uint64_t{1} << 63; }), "image whose size disagrees with its echoes");
  EXPECT_EQ(reason([](Shot& s) { s.width = 1, s.height = 6; }), "image whose size disagrees with its echoes");
  EXPECT_EQ(reason([](Shot& s) { s.view_deg = NAN; }), "image with an impossible view");
  EXPECT_EQ(reason([](Shot& s) { s.metres = -1; }), "image with an impossible scale");
  EXPECT_EQ(reason([](Shot& s) { s.seconds = std::uint64_t{1} << 60; }), "time out of range");
  const auto refused = [](const std::string& payload) {
    const auto source = shots(packet_of(payload));
    EXPECT_TRUE(drain(*source).empty());
    return source->report().rejected.empty() ? "" : source->report().rejected.begin()->first;
  };
  EXPECT_EQ(refused(hex("ff ff ff ff 0f 00 00")), "packet that cannot be unpacked") << "promises 4 GB";
  EXPECT_EQ(refused(hex("08 04 61 62")), "packet that cannot be unpacked") << "cut";
}

TEST(Sonar3d, APacketThatPromisesTooMuchIsDamage) {
  const std::string log = "RIP2" + little(0xFFFFFFF0u) + Shot{}.packet();
  const auto source = shots(log);
  EXPECT_EQ(drain(*source).size(), 1u);
  EXPECT_EQ(source->report().bytes_skipped, 8u);
}

TEST(Sonar3d, ReadsARecordingOfAShip) {
  ISOBATH_NEEDS_DATA(file, "sonar3d-ship/ship_short.sonar");
  const auto source = open_source(file, {});
  EXPECT_EQ(source->report().format, "Sonar 3D-15");
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 6u);
  std::vector<float> medians;
  for (const Event& event : events) {
    const Swath& swath = std::get<Swath>(event);
    EXPECT_GE(swath.soundings.size(), 10037u);
    EXPECT_LE(swath.soundings.size(), 10976u);
    EXPECT_FLOAT_EQ(static_cast<float>(swath.sound_speed), 1491);
    std::vector<float> ranges;
    for (const Sounding& s : swath.soundings) ranges.push_back(s.range_m);
    EXPECT_NEAR(*std::min_element(ranges.begin(), ranges.end()), 1.73, 0.4);
    EXPECT_LE(*std::max_element(ranges.begin(), ranges.end()), 12.61);
    std::sort(ranges.begin(), ranges.end());
    medians.push_back(ranges[ranges.size() / 2]);
  }
  EXPECT_NEAR(medians.front(), 3.5, 0.1);
  EXPECT_NEAR(medians.back(), 3.3, 0.1);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_EQ(source->report().details.at("other packets"), "6, not read");
  EXPECT_TRUE(source->report().rejected.empty());
}

}  // namespace
}  // namespace isobath
