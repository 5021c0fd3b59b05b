// What a host sends to devices and to an autopilot, against frames that others made: node-mavlink, and the frames of
// Blue Robotics' own definitions.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/io/formats/mavlink/mavlink_messages.hpp>
#include <isobath/io/formats/oculus/oculus_commands.hpp>
#include <isobath/io/formats/oculus/oculus_protocol.hpp>
#include <isobath/io/formats/oculus/oculus_status.hpp>
#include <isobath/io/formats/ping/ping_commands.hpp>
#include <isobath/io/formats/ping/ping_discovery.hpp>
#include <isobath/io/formats/tritech/tritech_commands.hpp>
#include <tests/io/bytes_by_hand.hpp>

namespace isobath::device_messages {
namespace {

using test::hex;

std::string text(Bytes bytes) { return std::string(text_of(bytes)); }

/// A writer whose next frame has this sequence number.
MavlinkWriter writer_at(int sequence, std::uint8_t component = 191) {
  MavlinkWriter writer(1, component);
  for (int i = 0; i < sequence; ++i) (void)writer.frame(mavlink::Heartbeat::kId, mavlink::Heartbeat{}.body());
  return writer;
}

TEST(MavlinkMessages, AreTheFramesOfNodeMavlink) {
  using namespace mavlink;
  EXPECT_EQ(
      text(writer_at(0).frame(Heartbeat::kId, Heartbeat{0, kOnboardController, kNoAutopilot, 0, kStateActive}.body())),
      hex("FD 09 00 00 00 01 BF 00 00 00 00 00 00 00 12 08 00 04 03 AE C6"));
  VelocityTarget target;
  target.mask = 0x0DF8;  // of a position: the frame that is at hand has x, y, z
  PayloadBytes body = target.body();
  const auto put = [&](std::size_t at, float value) { std::memcpy(body.data() + at, &value, sizeof value); };
  put(4, 10);
  put(8, 2);
  put(12, -3);
  body[52] = std::byte{1};
  body[0] = std::byte{0xD2};
  body[1] = std::byte{0x04};
  EXPECT_EQ(text(writer_at(4).frame(VelocityTarget::kId, body)),
            hex("FD 35 00 00 04 01 BF 54 00 00 D2 04 00 00 00 00 20 41 00 00 00 40 00 00 40 C0") +
                std::string(32, '\0') + hex("F8 0D 01 01 01 6F BD"));
  // A golden frame of another source: system 1, component 196.
  const auto golden =
      hex("fd 1c 00 00 00 01 c4 1d 2b 00 e8 03 00 00 00 00 c0 3f 00 00 00 c0 00 00 80 3e 00 00 40 3f 00 00 48 42 ff ff "
          "01 0c 28 ba");
  EXPECT_EQ(text(MavlinkWriter(1, 196).frame(ObstacleDistance3d::kId,
                                             ObstacleDistance3d{1000, 1.5F, -2, 0.25F, 0.75F, 50}.body())),
            golden);
}

TEST(MavlinkMessages, ARingOfObstaclesIsTheFrameOfNodeMavlink) {
  mavlink::ObstacleDistance ring;
  ring.time_us = 1'000'000;
  ring.cm.fill(mavlink::ObstacleDistance::kUnknown);
  ring.cm[0] = ring.cm[1] = ring.cm[2] = 250;
  ring.min_cm = 30;
  ring.max_cm = 5000;
  const std::string frame = text(writer_at(1).frame(mavlink::ObstacleDistance::kId, ring.body()));
  EXPECT_EQ(frame.substr(0, 26), hex("FD A7 00 00 01 01 BF 4A 01 00 40 42 0F 00 00 00 00 00 FA 00 FA 00 FA 00 FF FF"));
  EXPECT_EQ(frame.size(), 179u);
  const MavlinkFrame read = mavlink_frame(bytes_of(frame));
  EXPECT_EQ(read.checksum, MavlinkFrame::Checksum::kRight);
  EXPECT_EQ(mavlink::ObstacleDistance::of(MavlinkPayload(read.payload)).cm, ring.cm);
}

TEST(MavlinkMessages, AMissionItemIsReadAsItWasWritten) {
  mavlink::MissionItem item;
  item.params = {1, 2, 3, 4};
  item.x = 13120000;
  item.y = -1037420000;
  item.z = -0.5F;
  item.sequence = 7;
  item.command = 16;
  item.kind = mavlink::MissionKind::kFence;
  const auto bytes = MavlinkWriter(1, 1).frame(mavlink::MissionItem::kId, item.body());
  const auto read = mavlink::MissionItem::of(MavlinkPayload(mavlink_frame(bytes).payload));
  EXPECT_EQ(read.params, item.params);
  EXPECT_EQ(read.x, item.x);
  EXPECT_EQ(read.y, item.y);
  EXPECT_EQ(read.z, item.z);
  EXPECT_EQ(read.sequence, item.sequence);
  EXPECT_EQ(read.kind, item.kind);
}

TEST(MavlinkMessages, AFalseStartDoesNotHideTheFrameBehindIt) {
  const auto frame = MavlinkWriter(1, 1).frame(mavlink::Heartbeat::kId, mavlink::Heartbeat{}.body());
  const std::string damaged = hex("FD 09 00 00 00") + text(frame) + std::string(40, '\xFD') + text(frame);
  SourceReport report;
  FrameStream frames(mavlink_frame_at);
  int found = 0;
  for (const char c : damaged + std::string(300, '\0')) {
    frames.push(bytes_of(std::string_view(&c, 1)), {}, 0);
    while (frames.next(report)) ++found;
  }
  EXPECT_EQ(found, 2);
}

TEST(Ping360Commands, AreTheFramesOfTheDefinitions) {
  Ping360Settings s;
  s.gain = 0;
  s.pulse_us = 32;
  s.sample_period = 88;
  s.frequency_khz = 750;
  s.samples = 1200;
  EXPECT_EQ(text(ping360_transducer(s, 200)),
            hex("42 52 0E 00 29 0A 00 02 01 00 C8 00 20 00 58 00 EE 02 B0 04 01 00 BD 03"));
  EXPECT_EQ(text(ping360_auto_transmit(s)),
            hex("42 52 10 00 2A 0A 00 02 01 00 20 00 58 00 EE 02 B0 04 00 00 8F 01 01 00 88 03"));
  EXPECT_EQ(text(ping_request(ping_message::kDistance)), hex("42 52 02 00 06 00 00 00 BC 04 5C 01"));
}

TEST(Ping360Commands, RangeAndSectorBecomeTheUnitsOfTheHead) {
  const Ping360Settings s = ping360_settings({.middle = Angle::degrees(0),
                                              .sector = Angle::degrees(120),
                                              .step = Angle::degrees(2.7),
                                              .range_m = 20,
                                              .samples = 500,
                                              .sound_speed = 1500});
  EXPECT_EQ(s.step_grad, 3);
  EXPECT_EQ(s.start_grad, 333);  // -60 degrees
  EXPECT_EQ(s.stop_grad, 67);
  EXPECT_NEAR(1500 * s.sample_period * 25e-9 * s.samples / 2, 20, 0.01);
  // A range that would need samples below 2 us has fewer of them.
  const Ping360Settings near = ping360_settings(
      {.middle = Angle{}, .sector = Angle::degrees(360), .step = Angle{}, .range_m = 0.9, .samples = 1200});
  EXPECT_EQ(near.sample_period, 80);
  EXPECT_NEAR(1500 * near.sample_period * 25e-9 * near.samples / 2, 0.9, 0.01);
  EXPECT_EQ(near.start_grad, 0);
  EXPECT_EQ(near.stop_grad, 399);
  const auto asked = ping360_request(ping_frame(ping360_auto_transmit(near)));
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->settings.samples, near.samples);
  EXPECT_TRUE(asked->sweeps);
}

TEST(OculusCommands, AnImageIsReadAsItWasWritten) {
  OculusImage image;
  image.fire.range_m = 5;
  image.range_step_m = 0.05;
  image.bearings = {-3000, -100, 0, 2500};
  for (int i = 0; i < 4 * 100; ++i) image.samples.push_back(static_cast<std::byte>(i % 251));
  const auto bytes = oculus_ping_result(image);
  const Framing found = oculus_message_at(bytes);
  ASSERT_EQ(found.kind, Framing::Kind::kFrame);
  const auto ping = oculus_ping(Bytes(bytes).first(found.bytes));
  ASSERT_TRUE(ping);
  EXPECT_EQ(ping->beams, 4);
  EXPECT_EQ(ping->ranges, 100);
  EXPECT_DOUBLE_EQ(ping->range_step_m, 0.05);
  EXPECT_TRUE(std::ranges::equal(ping->image, image.samples));
  const auto fire = oculus_fire_of(oculus_fire({.range_m = 7, .sound_speed = 1480}));
  ASSERT_TRUE(fire);
  EXPECT_EQ(fire->range_m, 7);
  EXPECT_EQ(fire->sound_speed, 1480);
}

// Frames of the published layout; no head was at hand.
TEST(TritechCommands, AreTheFramesOfTheProtocol) {
  EXPECT_EQ(text(tritech_send_version()), hex("40 30 30 30 38 08 00 FF 02 03 17 80 02 0A"));
  EXPECT_EQ(text(tritech_send_data()), hex("40 30 30 30 43 0C 00 FF 02 07 19 80 02 00 00 00 00 0A"));
  TritechSettings settings = tritech_settings({.middle = {},
                                               .sector = Angle::degrees(90),
                                               .step = Angle::degrees(0.9),
                                               .range_m = 10,
                                               .samples = 400,
                                               .gain_percent = 50,
                                               .sound_speed = 1500});
  settings.full_circle = true;  // as the published frame has it
  EXPECT_EQ(
      text(tritech_head_command(settings)),
      hex("40 30 30 33 43 3C 00 FF 02 37 13 80 02 01 07 23 11") + std::string(16, '\0') +
          hex("00 00 64 00 60 09 A0 0F FF 00 69 69 00 00 00 00 19 10 34 00 90 01 F4 01 64 00 40 06 01 00 00 00 0A"));
}

TEST(TritechCommands, SettingsAreReadAsTheyWereWritten) {
  const TritechSettings settings = tritech_settings({.middle = Angle::degrees(-170),
                                                     .sector = Angle::degrees(60),
                                                     .step = Angle::degrees(1.8),
                                                     .range_m = 0.75,
                                                     .samples = 1200,
                                                     .gain_percent = 30,
                                                     .sound_speed = 1480});
  EXPECT_LT(settings.bins * 1480 * settings.bin_time * 640e-9 / 2, 0.76);
  EXPECT_GT(settings.left_limit, 5800) << "the sector lies across astern";
  EXPECT_LT(settings.right_limit, 800);
  const auto request = tritech_request(tritech_frame(tritech_head_command(settings)));
  ASSERT_TRUE(request);
  EXPECT_EQ(request->settings.left_limit, settings.left_limit);
  EXPECT_EQ(request->settings.right_limit, settings.right_limit);
  EXPECT_EQ(request->settings.bins, settings.bins);
  EXPECT_FALSE(request->settings.full_circle);
  auto damaged = tritech_head_command(settings);
  damaged[13 + 25] = std::byte{0xff};  // the left limit is no bearing
  EXPECT_FALSE(tritech_request(tritech_frame(damaged)));
}

TEST(TritechCommands, ALineIsReadAsItWasWritten) {
  const std::vector<std::byte> samples{std::byte{'@'}, std::byte{'\n'}, std::byte{255}};
  TritechSettings settings;
  settings.bin_time = 52;
  const auto frame = tritech_line_bytes(settings, 4800, samples);
  ASSERT_EQ(tritech_frame_at(frame).kind, Framing::Kind::kFrame);
  const auto line = tritech_line(tritech_frame(frame).payload);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->bearing, 4800);
  EXPECT_EQ(line->bin_time, 52);
  EXPECT_TRUE(std::ranges::equal(line->samples, samples));
  EXPECT_TRUE(line->widths_agree());
  EXPECT_TRUE(tritech_alive(tritech_frame(tritech_alive_bytes({.has_no_settings = true})))->has_no_settings);
  EXPECT_FALSE(tritech_alive(tritech_frame(tritech_alive_bytes({.has_no_settings = false})))->has_no_settings);
  EXPECT_EQ(tritech_frame_at(tritech_version_bytes(7)).kind, Framing::Kind::kFrame);
}

TEST(OculusStatus, SaysWhereTheSonarIs) {
  const auto bytes = oculus_status_bytes({.device = 7892, .part = 1032, .ip = 0xC0A80204, .client = 0});
  ASSERT_EQ(bytes.size(), 142u);
  EXPECT_EQ(text(Bytes(bytes).subspan(52, 4)), hex("C0 A8 02 04")) << "its octets in order";
  const auto status = oculus_status_of(bytes);
  ASSERT_TRUE(status);
  EXPECT_EQ(status->device, 7892u);
  EXPECT_EQ(oculus_model(status->part), "M750d");
  EXPECT_EQ(oculus_address(*status, 0x7F000001), 0xC0A80204u);
  EXPECT_EQ(oculus_address({.ip = 0x0402A8C0}, 0xC0A80204), 0xC0A80204u) << "the octets may be reversed";
  EXPECT_EQ(oculus_address({.ip = 0}, 0xC0A80204), 0xC0A80204u);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(oculus_status_of(Bytes(bytes).first(size))) << size;
}

TEST(Ping360Discovery, FindsTheAddressInTheAnswer) {
  const std::string answer = ping360_discovery_answer("192.168.1.20");
  EXPECT_NE(answer.find("192.168.001.020"), std::string::npos);
  EXPECT_EQ(ping360_address_in(bytes_of(answer)), "192.168.1.20") << "padded octets are decimal";
  EXPECT_FALSE(ping360_address_in(bytes_of("SONAR PING360 v1.2.3 at 300.1.1.1, 1.2.3.4.5")));
  EXPECT_FALSE(ping360_address_in(bytes_of("another device, 192.168.1.20")));
}

}  // namespace
}  // namespace isobath::device_messages
