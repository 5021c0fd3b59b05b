#include <gmock/gmock.h>
#include <isobath/io/formats/ping/ping_protocol.hpp>
#include <tests/io/ping_frames.hpp>

namespace isobath {
namespace {

using test::hex;

Ping1DReading reading_of(const std::string& frame) { return ping1d_reading(ping_frame(bytes_of(frame))).value(); }
Ping360Line line_of(const std::string& frame) { return ping360_line(ping_frame(bytes_of(frame))).value(); }

bool is_whole_frame(const std::string& bytes) {
  const Framing found = ping_frame_at(bytes_of(bytes));
  return found.kind == Framing::Kind::kFrame && found.bytes == bytes.size();
}

const std::string kRequest = hex("42 52 02 00 06 00 00 00 BC 04 5C 01");
const std::string kDistance =
    hex("42 52 18 00 BC 04 01 00 29 09 00 00 62 00 64 00 07 00 00 00 64 00 00 00 88 13 00 00 "
        "03 00 00 00 6E 03");
const std::string kProfile =
    hex("42 52 1E 00 14 05 01 00 29 09 00 00 62 00 64 00 07 00 00 00 64 00 00 00 88 13 00 00 "
        "03 00 00 00 04 00 0A C8 FF 03 A5 04");
const std::string kTransducer = hex("42 52 0E 00 29 0A 00 02 01 00 C8 00 20 00 58 00 EE 02 B0 04 01 00 BD 03");
const std::string kDeviceData =
    hex("42 52 14 00 FC 08 02 00 01 00 C8 00 20 00 58 00 EE 02 06 00 06 00 FF 80 40 20 10 "
        "08 E2 05");
const std::string kAutoData =
    hex("42 52 18 00 FD 08 02 00 01 00 5E 01 20 00 58 00 EE 02 5E 01 32 00 01 00 04 00 04 00 "
        "09 08 07 06 33 04");
const std::string kAutoTransmit = hex("42 52 10 00 2A 0A 00 02 01 00 20 00 58 00 EE 02 B0 04 00 00 8F 01 01 00 88 03");

TEST(PingProtocol, FramesOfEveryMessageAreFound) {
  for (const auto& frame : {kRequest, kDistance, kProfile, kTransducer, kDeviceData, kAutoData, kAutoTransmit}) {
    EXPECT_TRUE(is_whole_frame(frame));
  }
}

TEST(PingProtocol, DistanceHoldsRangeAndConfidence) {
  const Ping1DReading r = reading_of(kDistance);
  EXPECT_EQ(r.distance_mm, 2345u);
  EXPECT_EQ(r.confidence_percent, 98);
  EXPECT_EQ(r.start_mm, 100u);
  EXPECT_EQ(r.length_mm, 5000u);
  EXPECT_EQ(r.gain, 3u);
  EXPECT_TRUE(r.detected());
  EXPECT_TRUE(r.samples.empty());
}

TEST(PingProtocol, ProfileHoldsSamplesToo) {
  const Ping1DReading r = reading_of(kProfile);
  EXPECT_EQ(r.distance_mm, 2345u);
  EXPECT_EQ(text_of(r.samples), std::string("\x0a\xc8\xff\x03", 4));
}

TEST(PingProtocol, DeviceDataIsOneLine) {
  const Ping360Line l = line_of(kDeviceData);
  EXPECT_EQ(l.gain, 0);
  EXPECT_EQ(l.angle_grad, 200);
  EXPECT_EQ(l.pulse_us, 32);
  EXPECT_EQ(l.sample_period, 88);
  EXPECT_EQ(l.frequency_khz, 750);
  EXPECT_EQ(text_of(l.samples), "\xff\x80\x40\x20\x10\x08");
  EXPECT_NEAR(l.bin_m(1500) * 1200, 1.98, 1e-9) << "88 ticks, 1200 samples: 1.98 m";
}

TEST(PingProtocol, AutoDeviceDataHoldsItsSectorBeforeTheSamples) {
  const Ping360Line l = line_of(kAutoData);
  EXPECT_EQ(l.angle_grad, 350);
  EXPECT_EQ(text_of(l.samples), "\x09\x08\x07\x06");
}

TEST(PingProtocol, WhatCannotBeUsedIsNamed) {
  const auto fault = [](const test::Ping360Message& message) {
    const std::string frame = message.frame();
    return ping360_line(ping_frame(bytes_of(frame))).error();
  };
  EXPECT_EQ(fault({.angle = 400}), MessageFault::kBadBearing);
  EXPECT_EQ(fault({.sample_period = 0}), MessageFault::kBadRange);
  EXPECT_EQ(fault({.samples = ""}), MessageFault::kNoSamples);
  const std::string promise =
      test::ping_protocol_frame(2300, hex("01 00 C8 00 20 00 58 00 EE 02 07 00 07 00 01 02 03"));
  EXPECT_EQ(ping360_line(ping_frame(bytes_of(promise))).error(), MessageFault::kShort);
  const std::string tail = test::ping_protocol_frame(2300, hex("01 00 C8 00 20 00 58 00 EE 02 07 00 02 00 01 02 03"));
  EXPECT_EQ(line_of(tail).samples.size(), 2u) << "bytes behind the samples are ignored";
}

// A head that states no confidence has seen nothing: never an obstacle at 0 m.
TEST(PingProtocol, NoConfidenceIsNoDetection) {
  Ping1DReading r;
  r.length_mm = 1000;
  EXPECT_FALSE(r.detected());
  r.distance_mm = 500;
  r.confidence_percent = 101;
  EXPECT_FALSE(r.detected());
}

std::vector<std::string> frames_in_chunks(const std::string& bytes, const std::vector<std::size_t>& cuts) {
  FrameStream stream(ping_frame_at);
  SourceReport report;
  std::vector<std::string> found;
  const auto collect = [&] {
    while (const auto f = stream.next(report)) found.emplace_back(text_of(f->frame));
  };
  std::size_t at = 0;
  for (const std::size_t cut : cuts) {
    stream.push(bytes_of(bytes).subspan(at, cut - at), {}, at);
    collect();
    at = cut;
  }
  stream.push(bytes_of(bytes).subspan(at), {}, at);
  collect();
  stream.finish();
  collect();
  std::size_t kept = 0;
  for (const auto& f : found) kept += f.size();
  EXPECT_EQ(kept + report.bytes_skipped, bytes.size()) << "every byte is in a frame or counted as skipped";
  return found;
}

TEST(FrameStream, FindsTheSameFramesHoweverTheBytesArrive) {
  const std::string noise = "BBRx";  // a start, a false start whose second byte starts again, and rubbish
  const std::string bytes = noise + kDistance + "B" + kDeviceData + hex("42 52 40 00") + kProfile + kAutoData;
  const auto expected = frames_in_chunks(bytes, {});
  ASSERT_THAT(expected, testing::ElementsAre(kDistance, kDeviceData, kProfile, kAutoData));
  for (std::size_t a = 0; a <= bytes.size(); ++a) {
    ASSERT_EQ(frames_in_chunks(bytes, {a}), expected) << "cut at " << a;
    for (std::size_t b = a; b <= bytes.size(); b += 7) ASSERT_EQ(frames_in_chunks(bytes, {a, b}), expected);
  }
  std::vector<std::size_t> every(bytes.size());
  for (std::size_t i = 0; i < every.size(); ++i) every[i] = i;
  EXPECT_EQ(frames_in_chunks(bytes, every), expected) << "byte by byte";
}

TEST(FrameStream, FramesKeepTimeAndPlaceOfTheChunkInWhichTheyBegin) {
  FrameStream stream(ping_frame_at);
  SourceReport report;
  stream.push(bytes_of(kDistance.substr(0, 10)), Time{seconds(1)}, 100);
  EXPECT_FALSE(stream.next(report));
  stream.push(bytes_of(kDistance.substr(10) + kProfile.substr(0, 3)), Time{seconds(2)}, 200);
  auto found = stream.next(report);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->time, Time{seconds(1)});
  EXPECT_EQ(found->offset, 100u);
  EXPECT_FALSE(stream.next(report));
  stream.push(bytes_of(kProfile.substr(3)), Time{seconds(3)}, 300);
  found = stream.next(report);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->time, Time{seconds(2)});
  EXPECT_EQ(found->offset, 200 + kDistance.size() - 10);
  EXPECT_EQ(report.bytes_skipped, 0u);
}

}  // namespace
}  // namespace isobath
