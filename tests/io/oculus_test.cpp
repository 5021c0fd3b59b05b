#include <algorithm>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/io/formats/oculus/oculus_device.hpp>
#include <isobath/io/formats/oculus/oculus_logs.hpp>
#include <isobath/io/open_source.hpp>
#include <tests/io/oculus_messages.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using test::drain;
using test::hex;
using test::in_memory;
using test::OculusMessage;

const std::string kSheetPing = hex(
    "53 4F D4 1E 00 00 23 00 01 00 76 00 00 00 00 00 01 00 FF 7F 19 | 00 00 00 00 00 00 24 40 | 00 00 00 00 00 00 49 "
    "40 | 00 00 00 00 00 70 97 40 | 00 00 00 00 00 80 41 40 07 00 00 00 00 00 00 00 | 00 00 00 00 80 4F 32 41 | 00 "
    "00 00 00 00 00 2E 40 | 00 00 00 00 00 00 F8 3F | 00 00 00 00 00 70 97 40 E8 03 00 00 | 00 | 7B 14 AE 47 E1 7A "
    "94 3F | 02 00 | 03 00 | 80 00 00 00 | 06 00 00 00 | 86 00 00 00 48 F4 00 00 B8 0B 01 02 03 04 05 06");

std::vector<Event> events_of(const std::string& stream, const InputConfig& config = {}) {
  return drain(*open_oculus_stream(in_memory(stream), config));
}
const Ping& ping_of(const std::vector<Event>& events, std::size_t i = 0) { return std::get<Ping>(events.at(i)); }

TEST(OculusMessage, PingOfTheFormatSheetIsAFan) {
  ASSERT_EQ(kSheetPing.size(), 134u);
  ASSERT_TRUE(looks_like_oculus_stream(bytes_of(kSheetPing)));
  const auto source = open_oculus_stream(in_memory(kSheetPing), {});
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 1u);
  const Ping& ping = ping_of(events);
  EXPECT_EQ(check(ping), PingFault::kNone);
  ASSERT_EQ(ping.fan->beams(), 3);
  EXPECT_DOUBLE_EQ(ping.fan->azimuth[0].degrees(), -30) << "port first";
  EXPECT_DOUBLE_EQ(ping.fan->azimuth[2].degrees(), 30);
  EXPECT_NEAR(ping.fan->width[1].degrees(), 30, 1e-12) << "unknown model: the spacing";
  EXPECT_DOUBLE_EQ(ping.fan->height.degrees(), 20);
  EXPECT_EQ(ping.window, (RangeWindow{0, 0.02, 2}));
  EXPECT_EQ(ping.sound_speed, 1500);
  EXPECT_THAT(test::beam(ping, 0), testing::ElementsAre(1, 4)) << "nearest row first";
  EXPECT_THAT(test::beam(ping, 2), testing::ElementsAre(3, 6));
  EXPECT_EQ(source->report().details.at("frequency"), "1200 kHz");
}

TEST(OculusMessage, BothVersionsAndAllSampleSizesAreRead) {
  for (const int version : {0, 1, 2}) {
    for (const int size : {1, 2, 3, 4}) {
      for (const bool gain : {false, true}) {
        OculusMessage message{.version = version, .bytes_per_sample = size, .gain_per_row = gain};
        message.image.clear();
        for (int row = 0; row < 2; ++row) {
          if (gain) message.image += "GAIN";
          for (int b = 0; b < 3; ++b) {
            const auto value = static_cast<std::uint32_t>((row * 3 + b + 1) * (size == 1 ? 1 : 300));
            message.image += test::little(value).substr(0, static_cast<std::size_t>(size));
          }
        }
        const auto events = events_of(message.bytes());
        ASSERT_EQ(events.size(), 1u) << version << size << gain;
        const Ping& ping = ping_of(events);
        EXPECT_EQ(check(ping), PingFault::kNone);
        const float unit = size == 1 ? 1 : 300;
        EXPECT_THAT(test::beam(ping, 1), testing::ElementsAre(2 * unit, 5 * unit)) << version << size << gain;
        EXPECT_FLOAT_EQ(ping.full_scale, std::ldexp(1.0f, 8 * size) - 1);
      }
    }
  }
}

TEST(OculusMessage, TableFromStarboardToPortIsMirrored) {
  const auto events = events_of(OculusMessage{.bearings = {3000, 0, -3000}}.bytes());
  EXPECT_EQ(check(ping_of(events)), PingFault::kNone);
  EXPECT_DOUBLE_EQ(ping_of(events).fan->azimuth[0].degrees(), -30);
  EXPECT_THAT(test::beam(ping_of(events), 0), testing::ElementsAre(3, 6));
  const auto source = open_oculus_stream(in_memory(OculusMessage{.bearings = {-3000, 10, 5}}.bytes()), {});
  EXPECT_TRUE(drain(*source).empty());
  EXPECT_EQ(source->report().rejected.at("beams not in the order of their bearings"), 1u);
}

TEST(OculusMessage, BearingsBeyondAsternAreRefused) {
  const auto source = open_oculus_stream(in_memory(OculusMessage{.bearings = {-18001, 0, 3000}}.bytes()), {});
  EXPECT_TRUE(drain(*source).empty());
  EXPECT_EQ(source->report().rejected.at("bearing out of the range of the device"), 1u);
}

TEST(OculusMessage, OneTableHasOneFan) {
  const std::string a = OculusMessage{}.bytes(), b = OculusMessage{.bearings = {-2000, 0, 2000}}.bytes();
  const auto events = events_of(a + b + a + b);
  ASSERT_EQ(events.size(), 4u);
  EXPECT_EQ(ping_of(events, 0).fan, ping_of(events, 2).fan);
  EXPECT_EQ(ping_of(events, 1).fan, ping_of(events, 3).fan);
  EXPECT_NE(ping_of(events, 0).fan, ping_of(events, 1).fan);
}

TEST(OculusMessage, LostPingsLeaveTheirGapInMadeTimes) {
  const auto events = events_of(OculusMessage{.ping_id = 7}.bytes() + OculusMessage{.ping_id = 8}.bytes() +
                                OculusMessage{.ping_id = 11}.bytes());
  EXPECT_EQ(time_of(events.at(1)) - time_of(events.at(0)), std::chrono::milliseconds(100));
  EXPECT_EQ(time_of(events.at(2)) - time_of(events.at(1)), std::chrono::milliseconds(300));
  const auto device = events_of(OculusMessage{.version = 2, .start_time = 12.5}.bytes());
  EXPECT_EQ(time_of(device.at(0)), Time{seconds(12.5)}) << "version 2 has a time of its own";
}

TEST(OculusMessage, SizesThatDisagreeAreNoMessage) {
  const std::string good = OculusMessage{}.bytes();
  const auto broken = [&](std::size_t at, const std::string& bytes) {
    return std::string(good).replace(at, bytes.size(), bytes);
  };
  for (const auto& bad : {broken(106, hex("00 00")), broken(108, hex("01 04")), broken(110, hex("79 00 00 00")),
                          broken(110, hex("FF FF FF FF")), broken(114, hex("07 00 00 00")), broken(97, hex("09")),
                          broken(10, hex("FF FF FF 00")), broken(8, hex("03 00"))}) {
    const auto source = open_oculus_stream(in_memory(bad + good), {});
    EXPECT_EQ(drain(*source).size(), 1u);
    EXPECT_EQ(source->report().bytes_skipped, bad.size());
  }
}

TEST(OculusMessage, MessageThatPromises2To31BytesIsAnError) {
  std::string message = OculusMessage{}.bytes();
  message.replace(10, 4, hex("00 00 00 80"));
  ASSERT_TRUE(looks_like_oculus_stream(bytes_of(message)));
  EXPECT_THROW(open_oculus_stream(in_memory(message), {}), Error);
}

std::vector<std::string> oculus_messages(int count) {
  Random random(11);
  std::vector<std::string> messages;
  for (int i = 0; i < count; ++i) {
    OculusMessage message{.version = 1 + i % 2, .ranges = 40, .ping_id = static_cast<std::uint32_t>(i)};
    message.image.resize(120);
    for (char& c : message.image) c = random.index(4) == 0 ? 'S' : static_cast<char>(random.index(256));
    messages.push_back(message.bytes());
  }
  return messages;
}

TEST(OculusStream, FindsTheSameMessagesHoweverTheBytesArrive) {
  const auto messages = oculus_messages(3);
  const std::string dummy = "SO" + hex("00 00 00 00 FF 00 02 00 04 00 00 00 00 00 01 02 03 04");
  const std::string bytes = "SSO" + messages[0] + dummy + messages[1] + "SO" + messages[2];
  for (std::size_t a = 0; a <= bytes.size(); ++a) {
    FrameStream stream(oculus_message_at);
    SourceReport report;
    std::vector<std::string> found;
    for (const auto& [from, to] : {std::pair{std::size_t{0}, a}, {a, bytes.size()}}) {
      stream.push(bytes_of(bytes).subspan(from, to - from), {}, from);
      while (const auto f = stream.next(report)) found.emplace_back(text_of(f->frame));
    }
    ASSERT_THAT(found, testing::ElementsAre(messages[0], dummy, messages[1], messages[2])) << a;
    ASSERT_EQ(report.bytes_skipped, 5u);
  }
}

// Messages have no checksum: bytes that are missing are noticed by the next message that starts too early.
TEST(OculusStream, BytesThatAreMissingCostTheirMessagesOnly) {
  const auto messages = oculus_messages(12);
  std::string stream;
  std::vector<std::size_t> begins;
  for (const auto& m : messages) {
    begins.push_back(stream.size());
    stream += m;
  }
  begins.push_back(stream.size());
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    // More than a header is lost, so that the damaged message does not end within the next one's header.
    const std::size_t begin = random.index(stream.size()),
                      end = std::min(stream.size(), begin + 32 + random.index(400));
    const std::string damaged = std::string(stream).erase(begin, end - begin);
    ByteWindow input = in_memory(damaged);
    SourceReport report;
    std::vector<std::string> found;
    while (const auto f = next_frame(input, oculus_message_at, report)) found.emplace_back(text_of(*f));
    const auto hit = static_cast<std::size_t>(std::ranges::upper_bound(begins, begin) - begins.begin()) - 1;
    for (std::size_t i = hit + 1; i < messages.size(); ++i) {
      if (begins[i] < end) continue;
      // The one exception: the damaged message ends just where the next has shown no more than its magic.
      const std::size_t swallowed = begins[hit + 1] + (end - begin) - begins[i];
      if (swallowed >= 1 && swallowed <= 3) continue;
      EXPECT_TRUE(std::ranges::count(found, messages[i]) == 1) << i << ": " << begin << " .. " << end;
    }
    for (std::size_t i = 0; i < hit; ++i) EXPECT_TRUE(std::ranges::count(found, messages[i]) == 1) << i;
  }
}

// Real: three pings of a 2.1 MHz head as they came off the wire.
TEST(OculusStream, RealPingsAreFansOf256Beams) {
  ISOBATH_NEEDS_DATA(folder, "oculus-m1200");
  const auto source = open_source(folder / "three_pings_8bit.raw", {});
  EXPECT_EQ(source->report().format, "Oculus message stream");
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 3u);
  for (const Event& e : events) {
    const Ping& ping = std::get<Ping>(e);
    EXPECT_EQ(check(ping), PingFault::kNone);
    EXPECT_EQ(ping.window.bins, 703);
    ASSERT_EQ(ping.fan->beams(), 256);
    EXPECT_DOUBLE_EQ(ping.fan->azimuth.front().degrees(), -30);
    EXPECT_DOUBLE_EQ(ping.fan->azimuth.back().degrees(), 30);
    EXPECT_NEAR(ping.window.end_m(), 1.998, 5e-4);
    EXPECT_NEAR(ping.sound_speed, 1490.66, 0.01);
    EXPECT_EQ(ping.fan, ping_of(events).fan);
  }
  EXPECT_EQ(time_of(events[2]) - time_of(events[0]), std::chrono::milliseconds(200));
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_THAT(source->report().details.at("sonar"), testing::StartsWith("Oculus M1200d"));
}

const std::string kSheetItem =
    hex("DD CC BB AA 28 00 00 00 0A 00 00 00 00 00 00 00 00 00 50 40 FC 54 D9 41 00 00 00 00 86 00 "
        "00 00 86 00 00 00 00 00 00 00") +
    kSheetPing;

std::unique_ptr<Source> container(const std::string& log) {
  EXPECT_TRUE(looks_like_oculus_container(bytes_of(log)));
  return open_oculus_container(in_memory(log), {});
}

TEST(OculusContainer, ItemOfTheFormatSheetHasTheRecordersTime) {
  const auto events = drain(*container(test::oculus_file_header() + kSheetItem));
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(time_of(events[0]), Time{seconds(1700000001.25)});
  EXPECT_THAT(test::beam(ping_of(events), 1), testing::ElementsAre(2, 5));
  EXPECT_EQ(test::oculus_item(1700000001.25, kSheetPing), kSheetItem)
      << "the writer of these tests writes the sheet's item";
}

TEST(OculusContainer, CompressedItemsAreReadAndOthersPassedOver) {
  const std::string message = OculusMessage{}.bytes();
  const auto source = container(test::oculus_file_header() + test::oculus_item(1, test::qt_compressed(message), 10, 1) +
                                test::oculus_item(2, "text", 2) + test::oculus_item(3, message));
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_TRUE(test::beam(ping_of(events, 0)) == test::beam(ping_of(events, 1)));
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_EQ(source->report().details.at("other items"), "1, not read");
}

TEST(OculusContainer, CompressedItemThatLiesAboutItsSizeIsDamage) {
  const std::string message = OculusMessage{}.bytes();
  for (const char* size : {"FF FF FF FF", "01 00 00 00", "00 00 00 00", "00 00 00 20", "00 00 FF FF"}) {
    std::string packed = test::qt_compressed(message);
    packed.replace(0, 4, hex(size));
    const auto source = container(test::oculus_file_header() + test::oculus_item(1, packed, 10, 1) + kSheetItem);
    EXPECT_EQ(drain(*source).size(), 1u) << size;
    EXPECT_EQ(source->report().bytes_skipped, packed.size() + 40);
  }
}

TEST(OculusContainer, DamagedItemCostsItself) {
  std::string log = test::oculus_file_header();
  std::vector<std::size_t> begins;
  for (const auto& message : oculus_messages(10)) {
    begins.push_back(log.size());
    log += test::oculus_item(static_cast<double>(begins.size()), message);
  }
  begins.push_back(log.size());
  Random random(8);
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t begin = begins[0] + random.index(log.size() - begins[0]);
    const std::size_t end = std::min(log.size(), begin + 1 + random.index(500));
    const auto source = container(std::string(log).erase(begin, end - begin));
    std::vector<double> times;
    for (const Event& e : drain(*source)) times.push_back(to_seconds(time_of(e)));
    for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
      if (begins[i] < end && begins[i + 1] > begin) continue;
      EXPECT_THAT(times, testing::Contains(double(i + 1))) << begin << " .. " << end;
    }
  }
}

TEST(OculusContainer, WhatCannotBeReadIsRefusedAtOnce) {
  EXPECT_THROW(container(test::oculus_file_header(1) + kSheetItem), Error) << "encrypted";
  EXPECT_THROW(container(test::oculus_file_header()), Error) << "nothing recorded";
  EXPECT_THROW(container(test::oculus_file_header().substr(0, 30)), Error) << "cut in its header";
  std::string huge = test::oculus_file_header() + kSheetItem;
  huge.replace(4, 4, hex("00 00 00 80"));
  EXPECT_THROW(container(huge), Error);
}

}  // namespace
}  // namespace isobath
