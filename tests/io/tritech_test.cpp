#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/io/formats/tritech/tritech_device.hpp>
#include <isobath/io/formats/tritech/tritech_logs.hpp>
#include <tests/io/tritech_frames.hpp>

namespace isobath::tritech_test {
namespace {

using test::drain;
using test::hex;
using test::in_memory;

const std::string kEightBit =
    hex("40 30 30 32 42 2B 00 02 FF 00 02 80 02 23 00 11 10 00 05 23 64 00 00 00 00 00 69 00 00 "
        "51 08 00 00 1E 00 60 09 A0 0F 10 80 0C 04 00 00 40 C8 FF 0A");
const std::string kFourBit =
    hex("40 30 30 32 39 29 00 02 FF 00 02 80 02 21 00 11 00 00 04 23 64 00 00 00 00 00 69 00 00 "
        "51 08 00 00 1E 00 60 09 A0 0F 10 90 0C 02 00 1F 20 0A");
const std::string kSendVersion = hex("40 30 30 30 38 08 00 FF 02 03 17 80 02 0A");
const std::string kReboot = hex("40 30 30 30 38 08 00 FF 02 03 10 80 02 0A");
const std::string kSendData = hex("40 30 30 30 43 0C 00 FF 02 07 19 80 02 00 00 00 00 0A");
const std::string kHeadCommand =
    hex("40 30 30 33 43 3C 00 FF 02 37 13 80 02 01 07 23 11 00x16 00 00 64 00 60 09 A0 0F FF "
        "00 69 69 00 00 00 00 19 10 34 00 90 01 F4 01 64 00 40 06 01 00 00 00 0A");

std::vector<Event> events_of(const std::string& stream, const InputConfig& config = {}) {
  return drain(*open_tritech_stream(in_memory(stream), config));
}
const Ping& ping_of(const std::vector<Event>& events, std::size_t i = 0) { return std::get<Ping>(events.at(i)); }

TEST(TritechProtocol, FramesOfEveryMessageAreFound) {
  for (const auto& frame : {kEightBit, kFourBit, kSendVersion, kReboot, kSendData, kHeadCommand}) {
    const Framing found = tritech_frame_at(bytes_of(frame));
    EXPECT_EQ(found.kind, Framing::Kind::kFrame);
    EXPECT_EQ(found.bytes, frame.size());
  }
  EXPECT_EQ(test::TritechMessage{}.frame(), kEightBit) << "the writer of these tests writes the sheet's frame";
}

TEST(TritechProtocol, EightBitHeadDataIsALine) {
  const auto events = events_of(kEightBit);
  ASSERT_EQ(events.size(), 1u);
  const Ping& ping = ping_of(events);
  EXPECT_EQ(check(ping), PingFault::kNone);
  EXPECT_NEAR(ping.fan->azimuth[0].radians(), 0, 1e-12) << "3200 is ahead";
  EXPECT_DOUBLE_EQ(ping.fan->width[0].degrees(), 3);
  EXPECT_DOUBLE_EQ(ping.fan->height.degrees(), 35);
  EXPECT_DOUBLE_EQ(ping.window.bin_m, 1500 * 30 * 640e-9 / 2);
  EXPECT_THAT(test::beam(ping), testing::ElementsAre(0, 64, 200, 255));
  EXPECT_EQ(ping.full_scale, 255);
}

TEST(TritechProtocol, FourBitSamplesFollowTheOrderThatIsSet) {
  InputConfig config;
  EXPECT_THAT(test::beam(ping_of(events_of(kFourBit, config))), testing::ElementsAre(1, 15, 2, 0));
  config.high_nibble_first = false;
  const auto events = events_of(kFourBit, config);
  EXPECT_THAT(test::beam(ping_of(events)), testing::ElementsAre(15, 1, 0, 2));
  EXPECT_EQ(ping_of(events).full_scale, 15);
  EXPECT_NEAR(ping_of(events).fan->azimuth[0].degrees(), 0.9, 1e-12) << "3216";
}

TEST(TritechProtocol, BearingsGrowClockwiseFromAstern) {
  const auto azimuth = [](int bearing) {
    const auto events = events_of(test::TritechMessage{.bearing = bearing}.frame());
    return ping_of(events).fan->azimuth[0].degrees();
  };
  EXPECT_NEAR(azimuth(1600), -90, 1e-9) << "port";
  EXPECT_NEAR(azimuth(4800), 90, 1e-9) << "starboard";
  EXPECT_NEAR(std::abs(azimuth(0)), 180, 1e-9) << "astern";
}

TEST(TritechProtocol, RangeOfASettingIsThatOfTheBinTime) {
  test::TritechMessage message{.bin_time = 52};
  message.samples.assign(400, 'x');
  EXPECT_NEAR(ping_of(events_of(message.frame())).window.end_m(), 9.984, 1e-9) << "10 m asked, 52 ticks of 640 ns";
  message.bin_time = 0;
  EXPECT_NEAR(ping_of(events_of(message.frame())).window.end_m(), 10, 1e-9) << "without bin time: the label";
  message.range_scale = 100 | 1 << 14;
  EXPECT_NEAR(ping_of(events_of(message.frame())).window.end_m(), 3.048, 1e-9) << "feet";
}

TEST(TritechProtocol, SweepCodesMarkTheEndsOfASector) {
  const auto mark = [](int control, int code) {
    return ping_of(events_of(test::TritechMessage{.head_control = control, .sweep = code}.frame())).sweep;
  };
  EXPECT_EQ(mark(0x2305, 0), SweepMark::kInside);
  EXPECT_EQ(mark(0x2305, 5), SweepMark::kInside);
  EXPECT_EQ(mark(0x2305, 1), SweepMark::kEnd);
  EXPECT_EQ(mark(0x2305, 2), SweepMark::kEnd);
  EXPECT_EQ(mark(0x2307, 0), SweepMark::kUnknown) << "a full circle has no limits";
}

TEST(TritechProtocol, LinesThatCannotBeUsedAreCountedByReason) {
  test::TritechMessage empty;
  empty.samples.clear();
  const std::string other_node = test::tritech_packet(2, 0x80, test::TritechMessage{}.payload(), 20);
  const std::string stream = test::TritechMessage{.bearing = 6400}.frame() + empty.frame() + other_node +
                             test::TritechMessage{.bin_time = 0, .range_scale = 0}.frame() +
                             test::TritechMessage{.status = 0}.frame();
  const auto source = open_tritech_stream(in_memory(stream), {});
  EXPECT_EQ(drain(*source).size(), 1u);
  const SourceReport& report = source->report();
  EXPECT_EQ(report.rejected.at("bearing out of the range of the device"), 1u);
  EXPECT_EQ(report.rejected.at("message without samples"), 1u);
  EXPECT_EQ(report.rejected.at("message of another kind of device"), 1u);
  EXPECT_EQ(report.rejected.at("no usable range setting"), 1u);
  EXPECT_THAT(report.details.at("sample width"), testing::StartsWith("command and head status disagree in 1 lines"));
  EXPECT_EQ(report.bytes_skipped, 0u);
}

TEST(TritechProtocol, MessagesOfSeveralPacketsAreJoined) {
  test::TritechMessage message;
  message.samples.assign(600, '\0');
  for (std::size_t i = 0; i < 600; ++i) message.samples[i] = static_cast<char>(i % 256);
  const std::string payload = message.payload();
  const std::string a = test::tritech_packet(2, 0x00, payload.substr(0, 300));
  const std::string b = test::tritech_packet(2, 0x01, payload.substr(300, 300));
  const std::string c = test::tritech_packet(2, 0x82, payload.substr(600));
  const auto whole = events_of(a + b + c + kEightBit);
  ASSERT_EQ(whole.size(), 2u);
  EXPECT_EQ(test::beam(ping_of(whole)), test::beam(ping_of(events_of(message.frame()))));

  const auto gap = open_tritech_stream(in_memory(a + c + kEightBit), {});
  EXPECT_EQ(drain(*gap).size(), 1u) << "a gap costs the message";
  EXPECT_EQ(gap->report().rejected.at("message with a packet missing"), 1u);
}

TEST(TritechStream, FindsTheSameFramesHoweverTheBytesArrive) {
  const std::string bytes = "@00" + kEightBit + "noise@" + kFourBit + kSendData + kEightBit + "@002B";
  const auto frames = [&](std::size_t a, std::size_t b) {
    FrameStream stream(tritech_frame_at);
    SourceReport report;
    std::vector<std::string> found;
    const auto collect = [&] {
      while (const auto f = stream.next(report)) found.emplace_back(text_of(f->frame));
    };
    for (const auto& [from, to] : {std::pair{std::size_t{0}, a}, {a, b}, {b, bytes.size()}}) {
      stream.push(bytes_of(bytes).subspan(from, to - from), {}, from);
      collect();
    }
    stream.finish();
    collect();
    return found;
  };
  const std::vector<std::string> expected{kEightBit, kFourBit, kSendData, kEightBit};
  for (std::size_t a = 0; a <= bytes.size(); ++a) {
    for (std::size_t b = a; b <= bytes.size(); b += 5) ASSERT_EQ(frames(a, b), expected) << a << ' ' << b;
  }
}

// Bytes that are lost, or overwritten in the frame's own fields: the other lines all come out. (An echo sample that is
// overwritten in place cannot be noticed: the protocol has no checksum.)
TEST(TritechStream, DamageInTheMiddleCostsThatStretchOnly) {
  Random random(7);
  std::string stream;
  std::vector<std::size_t> begins;
  for (int i = 0; i < 30; ++i) {
    test::TritechMessage message{.bearing = i * 16};
    message.samples.resize(80);
    for (char& c : message.samples) c = static_cast<char>(random.index(256));
    begins.push_back(stream.size());
    stream += message.frame();
  }
  const std::size_t size = begins[1];
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t begin = random.index(stream.size()), end = std::min(stream.size(), begin + 1 + random.index(200));
    const auto source = open_tritech_stream(in_memory(std::string(stream).erase(begin, end - begin)), {});
    std::vector<double> seen;
    for (const Event& e : drain(*source)) seen.push_back(std::get<Ping>(e).fan->azimuth[0].radians());
    for (int i = 0; i < 30; ++i) {
      if (begins[i] < end && begins[i] + size > begin) continue;
      EXPECT_THAT(seen, testing::Contains(tritech::bearing(i * 16).wrapped().radians()))
          << i << ": " << begin << ".." << end;
    }
    EXPECT_LE(source->report().bytes_skipped, 2 * size);
  }
}

TEST(TritechStream, TimesAreMadeFromListeningAndTheSerialLine) {
  const auto events = events_of(kEightBit + kEightBit);
  EXPECT_NEAR(to_seconds(time_of(events.at(1))), 4 * 30 * 640e-9 + 49 * 10 / 115200.0, 1e-8);
}

const std::string kCsvHeading =
    "Line Header,Time,Node,Status,HdCtrl,Range,Gain,Slope,ADLow,ADSpan,Left,Right,Step,Brg,Nbins\n";

TEST(SeanetCsv, ALineIsAPing) {
  const std::string log = kCsvHeading +
                          "1,23:59:59.900,2,16,8965,100,105,125,13,81,2400,4000,16,3216,4,0,64,200,255\r\n" +
                          "1,00:00:00.100,2,16,8965,100,105,125,13,81,2400,4000,16,3232,4,1,2,3,4\n" +
                          "1,00:00:00.200,2,16,8965,100,105,125,13,81,2400,4000,16,3232,2147483648,1,2,3,4\n" +
                          "1,00:00:00.300,2,16,8965,100,105,125,13,81,2400,4000,16,6400,1,1\n";
  ASSERT_TRUE(looks_like_seanet_csv(bytes_of(log)));
  const auto source = open_seanet_csv(in_memory(log), {});
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 2u);
  const Ping& ping = ping_of(events);
  EXPECT_EQ(check(ping), PingFault::kNone);
  EXPECT_NEAR(ping.fan->azimuth[0].degrees(), 0.9, 1e-12);
  EXPECT_DOUBLE_EQ(ping.window.bin_m, 2.5) << "10 m in 4 bins";
  EXPECT_THAT(test::beam(ping), testing::ElementsAre(0, 64, 200, 255));
  EXPECT_EQ(time_of(events[1]) - time_of(events[0]), std::chrono::milliseconds(200)) << "over midnight";
  EXPECT_EQ(source->report().damages.size(), 1u);
  EXPECT_EQ(source->report().rejected.at("bearing out of the range of the device"), 1u);
}

TEST(SeanetCsv, NothingBehindTheHeadingIsAnError) { EXPECT_THROW(open_seanet_csv(in_memory(kCsvHeading), {}), Error); }

}  // namespace
}  // namespace isobath::tritech_test
