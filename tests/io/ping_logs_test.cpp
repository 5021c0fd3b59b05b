#include <fstream>
#include <gmock/gmock.h>
#include <isobath/io/formats/ping/ping_logs.hpp>
#include <isobath/io/open_source.hpp>
#include <set>
#include <tests/io/ping_frames.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using test::drain;
using test::hex;
using test::in_memory;

std::unique_ptr<Source> ping_viewer(const std::string& log, const InputConfig& config = {}) {
  EXPECT_TRUE(looks_like_ping_viewer_log(bytes_of(log)));
  return open_ping_viewer_log(in_memory(log), config);
}

TEST(PingViewerLog, RecordOfTheFormatSheetIsAPingAtItsTime) {
  const std::string record =
      hex("00 00 00 18 00 30 00 30 00 3A 00 30 00 30 00 3A 00 30 00 31 00 2E 00 32 00 35 00 30 00 00 00 1A "
          "42 52 10 00 FC 08 02 00 01 00 C8 00 20 00 58 00 EE 02 02 00 02 00 FF 01 DF 04");
  const auto source = ping_viewer(test::PingViewerWriter().log() + record);
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 1u);
  const Ping& ping = std::get<Ping>(events[0]);
  EXPECT_EQ(check(ping), PingFault::kNone);
  EXPECT_EQ(ping.time, Time{seconds(1.25)});
  EXPECT_NEAR(ping.fan->azimuth[0].wrapped_positive().degrees(), 180, 1e-9) << "200 gradians: astern";
  EXPECT_DOUBLE_EQ(ping.fan->width[0].degrees(), 2);
  EXPECT_DOUBLE_EQ(ping.fan->height.degrees(), 25);
  EXPECT_DOUBLE_EQ(ping.window.bin_m, 1500 * 88 * 25e-9 / 2);
  EXPECT_THAT(test::beam(ping), testing::ElementsAre(255, 1));
  EXPECT_EQ(source->report().format, "Ping Viewer log");
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  EXPECT_EQ(source->report().bytes_read, source->report().bytes_total);
  EXPECT_EQ(source->report().details.at("frequency"), "750 kHz");
}

TEST(PingViewerLog, UserSaysSenseMountingSpeedOfSoundAndBeam) {
  test::PingViewerWriter writer;
  writer.add(0, test::Ping360Message{.angle = 100}.frame());
  InputConfig config;
  config.clockwise = false;
  config.mount_heading = Angle::degrees(30);
  config.sound_speed = 1450;
  config.beam_width = Angle::degrees(5);
  const auto events = drain(*ping_viewer(writer.log(), config));
  const Ping& ping = std::get<Ping>(events.at(0));
  EXPECT_NEAR(ping.fan->azimuth[0].degrees(), -90, 1e-9);
  EXPECT_NEAR(ping.X_BS.rotation.heading().degrees(), 30, 1e-9);
  EXPECT_DOUBLE_EQ(ping.sound_speed, 1450);
  EXPECT_DOUBLE_EQ(ping.window.bin_m, 1450 * 88 * 25e-9 / 2);
  EXPECT_DOUBLE_EQ(ping.fan->width[0].degrees(), 5);
  EXPECT_DOUBLE_EQ(ping.fan->height.degrees(), 25);
}

TEST(PingViewerLog, OneBearingHasOneFanAndSamplesAreNotCopied) {
  test::PingViewerWriter writer;
  for (int i = 0; i < 4; ++i) writer.add(i * 50, test::Ping360Message{.angle = i % 2}.frame());
  const auto log = std::make_shared<const std::string>(writer.log());
  const auto source = open_ping_viewer_log({"log", bytes_of(*log), log}, {});
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 4u);
  EXPECT_EQ(std::get<Ping>(events[0]).fan, std::get<Ping>(events[2]).fan);
  EXPECT_NE(std::get<Ping>(events[0]).fan, std::get<Ping>(events[1]).fan);
  for (const Event& e : events) {
    const auto* data = reinterpret_cast<const char*>(std::get<Ping>(e).intensity.data());
    EXPECT_TRUE(data >= log->data() && data < log->data() + log->size());
  }
}

TEST(PingViewerLog, ReencodedTextsAreReadToo) {
  test::PingViewerWriter writer(2, false);
  writer.add(61'001, test::Ping360Message{}.frame());
  const auto events = drain(*ping_viewer(writer.log()));
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(time_of(events[0]), Time{seconds(61.001)});
}

TEST(PingViewerLog, MidnightIsPassed) {
  test::PingViewerWriter writer;
  const int day = 86'400'000;
  for (const int ms : {day - 200, day - 100, day + 50}) writer.add(ms, test::Ping360Message{}.frame());
  const auto events = drain(*ping_viewer(writer.log()));
  ASSERT_EQ(events.size(), 3u);
  EXPECT_EQ(time_of(events[2]), Time{seconds(86400.05)});
}

TEST(PingViewerLog, FramesMayLieAcrossRecordsOrShareOne) {
  const auto frames = test::ping360_frames(4, 50, 3);
  test::PingViewerWriter writer;
  writer.add(100, frames[0] + frames[1].substr(0, 20));
  writer.add(200, frames[1].substr(20) + frames[2]);
  writer.add(300, frames[3].substr(0, 1));
  writer.add(400, frames[3].substr(1));
  const auto source = ping_viewer(writer.log());
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 4u);
  const std::vector<double> times{0.1, 0.1, 0.2, 0.3};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(std::get<Ping>(events[i]).fan->azimuth[0].radians(), Angle::gradians(double(i)).radians(), 1e-12);
    EXPECT_EQ(time_of(events[i]), Time{seconds(times[i])});
  }
  EXPECT_EQ(source->report().bytes_skipped, 0u);
}

TEST(PingViewerLog, Ping1DGivesRangesAndProfiles) {
  test::PingViewerWriter writer(1);
  writer.add(0, hex("42 52 18 00 BC 04 01 00 29 09 00 00 62 00 64 00 07 00 00 00 64 00 00 00 88 13 00 00 03 00 00 00 "
                    "6E 03"));
  writer.add(100, hex("42 52 1E 00 14 05 01 00 29 09 00 00 62 00 64 00 07 00 00 00 64 00 00 00 88 13 00 00 03 00 00 00 "
                      "04 00 0A C8 FF 03 A5 04"));
  writer.add(200, test::ping_protocol_frame(1212, hex("00x24").replace(20, 4, std::string("\x88\x13\0\0", 4))));
  writer.add(300, test::ping_protocol_frame(1212, hex("00x16 88 13 00 00 00x4")));
  const auto source = ping_viewer(writer.log());
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 3u);
  const auto& reading = std::get<RangeReading>(events[0]);
  EXPECT_DOUBLE_EQ(reading.range_m.value(), 2.345);
  EXPECT_DOUBLE_EQ(reading.max_range_m, 5.1);
  EXPECT_FLOAT_EQ(reading.confidence, 0.98f);
  const auto& profile = std::get<Ping>(events[1]);
  EXPECT_EQ(check(profile), PingFault::kNone);
  EXPECT_DOUBLE_EQ(profile.window.start_m, 0.1);
  EXPECT_DOUBLE_EQ(profile.window.bin_m, 1.25);
  EXPECT_THAT(test::beam(profile), testing::ElementsAre(10, 200, 255, 3));
  EXPECT_FALSE(std::get<RangeReading>(events[2]).range_m) << "no confidence: no echo, which is evidence too";
  EXPECT_EQ(source->report().rejected.at("no usable range setting"), 1u);
}

TEST(PingViewerLog, DataOfTheOtherDeviceIsRefusedAndCounted) {
  test::PingViewerWriter writer(1);
  writer.add(0, test::Ping360Message{}.frame());
  const auto source = ping_viewer(writer.log());
  EXPECT_TRUE(drain(*source).empty());
  EXPECT_EQ(source->report().rejected.at("message of another kind of device"), 1u);
}

TEST(PingViewerLog, HeaderThatCannotBeRightIsAnError) {
  const std::string whole = test::PingViewerWriter().log();
  EXPECT_THROW(ping_viewer(whole), Error) << "nothing recorded";
  EXPECT_THROW(ping_viewer(whole.substr(0, whole.size() - 1)), Error) << "cut within the header";
  std::string huge = whole + "x";
  huge.replace(60, 4, hex("80 00 00 00"));  // the length of the second text: 2^31
  try {
    ping_viewer(huge);
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("a text of 2147483648 bytes in the header; allowed: up to 4096 bytes"));
  }
}

// One byte of a record's promise: everything else in the log must still come out.
TEST(PingViewerLog, ALengthOf2To31CostsNothing) {
  const auto frames = test::ping360_frames(3, 100, 1);
  test::PingViewerWriter writer;
  std::vector<std::size_t> at;
  for (int i = 0; i < 3; ++i) at.push_back(writer.add(i, frames[i]));
  std::string log = writer.log();
  log.replace(at[1] + 28, 4, hex("80 00 00 00"));
  EXPECT_EQ(drain(*ping_viewer(log)).size(), 3u) << "the next time stamp ends the record";
}

struct Loss {
  std::size_t begin, end;
};

// The property that makes damage bearable: events whose record lies outside of the damage all come out unchanged.
void expect_rest_survives(const std::string& log, const std::vector<std::size_t>& begins, const std::string& damaged,
                          Loss loss, const std::vector<Event>& all) {
  const auto source = ping_viewer(damaged);
  const auto events = drain(*source);
  std::size_t found = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::size_t end = i + 1 < begins.size() ? begins[i + 1] : log.size();
    if (begins[i] < loss.end && end > loss.begin) continue;  // hit
    while (found < events.size() && !test::same_samples(events[found], all[i])) ++found;
    ASSERT_LT(found, events.size()) << "record " << i << " lost to damage of " << loss.begin << " .. " << loss.end
                                    << (damaged.size() < log.size() ? ", removed" : ", overwritten");
    ++found;
  }
  std::uint64_t skipped = 0;
  for (const Damage& d : source->report().damages) skipped += d.bytes;
  EXPECT_EQ(skipped, source->report().bytes_skipped);
}

TEST(PingViewerLog, DamageInTheMiddleCostsThatStretchOnly) {
  test::PingViewerWriter writer;
  std::vector<std::size_t> begins;
  for (const auto& frame : test::ping360_frames(40, 60, 9)) {
    begins.push_back(writer.add(static_cast<int>(begins.size()) * 37, frame));
  }
  const std::string& log = writer.log();
  const auto all = drain(*ping_viewer(log));
  ASSERT_EQ(all.size(), 40u);
  Random random(5);
  for (int trial = 0; trial < 400; ++trial) {
    const std::size_t begin = begins[0] + random.index(log.size() - begins[0]);
    const std::size_t end = std::min(log.size(), begin + 1 + random.index(300));
    std::string damaged = log;
    for (std::size_t i = begin; i < end; ++i) damaged[i] = static_cast<char>(random.index(256));
    expect_rest_survives(log, begins, damaged, {begin, end}, all);
    expect_rest_survives(log, begins, std::string(log).erase(begin, end - begin), {begin, end}, all);
  }
}

TEST(PingViewerLog, CutAnywhereItKeepsWhatIsWhole) {
  test::PingViewerWriter writer;
  std::vector<std::size_t> begins;
  for (const auto& frame : test::ping360_frames(3, 10, 2)) begins.push_back(writer.add(0, frame));
  const std::string& log = writer.log();
  for (std::size_t size = begins[0] + 1; size < log.size(); ++size) {
    const auto source = ping_viewer(log.substr(0, size));
    const std::size_t whole = size >= begins[2] ? 2 : size >= begins[1] ? 1 : 0;
    ASSERT_EQ(drain(*source).size(), whole) << size;
    const bool at_border = size == begins[1] || size == begins[2];
    EXPECT_EQ(source->report().damages.empty(), at_border) << size;
  }
}

TEST(PingStream, TimesAreMadeFromTheRangeSetting) {
  std::string stream;
  for (const auto& frame : test::ping360_frames(3, 1200, 2)) stream += frame;
  ASSERT_TRUE(looks_like_ping_stream(bytes_of(stream)));
  const auto source = open_ping_stream(in_memory(stream), {});
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 3u);
  const double interval = 1200 * 88 * 25e-9 + 0.020;
  EXPECT_NEAR(to_seconds(time_of(events[2])), 2 * interval, 1e-8);
  EXPECT_THAT(source->report().details.at("time"), testing::StartsWith("estimated from"));
}

TEST(PingStream, NoiseAroundFramesIsCounted) {
  const std::string stream = "noise" + test::Ping360Message{}.frame() + "BR" + test::Ping360Message{}.frame() + "BR";
  const auto source = open_ping_stream(in_memory(stream), {});
  EXPECT_EQ(drain(*source).size(), 2u);
  EXPECT_EQ(source->report().bytes_skipped, 9u);
  ASSERT_EQ(source->report().damages.size(), 3u);
  EXPECT_EQ(source->report().damages[0].offset, 0u);
  EXPECT_EQ(source->report().damages[0].bytes, 5u);
}

const std::string kPrinted =
    "\"<bound method PingMessage.unpack_msg_data of \r\n\r\n--------------------------------------------------\r\n"
    "ID: 2300 - device_data\r\n"
    "Header: start_1: 66 start_2: 82 payload_length: 20 message_id: 2300 src_device_id: 2 dst_device_id: 0\r\n"
    "Payload:\r\n  - mode: 1\r\n  - gain_setting: 0\r\n  - angle: 200\r\n  - transmit_duration: 32\r\n"
    "  - sample_period: 88\r\n  - transmit_frequency: 750\r\n  - number_of_samples: 6\r\n  - data_length: 6\r\n"
    "  - data: ['0xff', '0x80', '0x40', '0x20', '0x10', '0x8']\r\n"
    "Checksum: 1506 check: 1506 pass: True>\",";

TEST(PingMessages, PrintedMessageIsTheFrameThatItCameFrom) {
  ASSERT_TRUE(looks_like_ping_messages(bytes_of(kPrinted)));
  const auto source = open_ping_messages(in_memory(kPrinted + kPrinted), {});
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_THAT(test::beam(std::get<Ping>(events[0])), testing::ElementsAre(255, 128, 64, 32, 16, 8));
  EXPECT_EQ(source->report().bytes_skipped, 0u);
}

TEST(PingMessages, MessageThatFailsItsChecksumIsDamage) {
  std::string text = kPrinted + kPrinted + kPrinted;
  const std::size_t at = text.find("0x80", kPrinted.size());
  text.replace(at, 4, "0x81");
  const auto source = open_ping_messages(in_memory(text), {});
  EXPECT_EQ(drain(*source).size(), 2u);
  ASSERT_EQ(source->report().damages.size(), 1u);
  const Damage& damage = source->report().damages[0];
  EXPECT_TRUE(damage.offset < at && at < damage.offset + damage.bytes);
  EXPECT_LE(damage.bytes, kPrinted.size());
}

// Real: one arc of a Ping360, as printed messages and as a table made from them.
TEST(PingLogs, BothFormsOfARealArcAgree) {
  ISOBATH_NEEDS_DATA(folder, "ping360-arc");
  const auto messages = open_source(folder / "2024-03-13_15-50-16_gain0_messages.txt", {});
  InputConfig config;
  config.range_m = 1500 * 90 * 25e-9 / 2 * 1200;
  const auto table = open_source(folder / "2024-03-13_15-50-16_gain0_results.csv", config);
  EXPECT_EQ(messages->report().format, "printed ping messages");
  EXPECT_EQ(table->report().format, "Ping360 arc table");
  const auto a = drain(*messages), b = drain(*table);
  ASSERT_EQ(a.size(), 101u);
  ASSERT_EQ(b.size(), 101u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Ping& p = std::get<Ping>(a[i]);
    const Ping& q = std::get<Ping>(b[i]);
    EXPECT_EQ(check(p), PingFault::kNone);
    EXPECT_EQ(check(q), PingFault::kNone);
    EXPECT_NEAR(p.fan->azimuth[0].radians(), Angle::gradians(150 + double(i)).wrapped().radians(), 1e-12);
    EXPECT_EQ(p.fan->azimuth, q.fan->azimuth);
    EXPECT_EQ(p.window.bins, 1200);
    EXPECT_NEAR(p.window.bin_m, q.window.bin_m, 1e-15);
    ASSERT_EQ(test::beam(p), test::beam(q));
  }
  EXPECT_NEAR(std::get<Ping>(a[0]).window.bin_m, 1.69e-3, 1e-5);
  EXPECT_TRUE(messages->report().damages.empty());
  EXPECT_TRUE(table->report().damages.empty());
  EXPECT_EQ(messages->report().details.at("frequency"), "1000 kHz");
}

TEST(PingLogs, TableWithCommasIsReadToo) {
  ISOBATH_NEEDS_DATA(folder, "ping360-arc");
  const auto source = open_source(folder / "object_data_demo.csv", {});
  const auto events = drain(*source);
  EXPECT_EQ(events.size(), 101u);
  EXPECT_TRUE(source->report().damages.empty());
  EXPECT_NEAR(std::get<Ping>(events[0]).window.end_m(), 2, 1e-12);
}

}  // namespace
}  // namespace isobath
