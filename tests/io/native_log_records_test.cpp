// The bytes of each kind of record in a native log. Logs are kept longer than the program that wrote them: a change of
// these bytes, of a name or of a definition makes recorded logs unreadable. The bytes are written by hand from the
// definitions; mcap_test.cpp shows that reading gives the same events back.
#include <fstream>
#include <gtest/gtest.h>
#include <isobath/io/mcap/mcap_records.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <map>
#include <memory>
#include <string>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using test::hex;

/// A record as a foreign reader sees it: where it stands in the file, how it is encoded, its bytes.
struct StoredRecord {
  std::string topic, kind, schema_encoding, message_encoding, bytes;
  std::uint64_t log_time = 0;
};

/// What `write` writes into a log, record by record.
template <class Write>
std::vector<StoredRecord> stored_records(Write write) {
  const std::filesystem::path file = test::scratch_folder() / "log.mcap";
  NativeLogWriter writer(file, {McapCompression::kNone, 1024});
  write(writer);
  writer.close();
  McapReader reader(std::make_unique<std::ifstream>(file, std::ios::binary), file.string());
  std::vector<StoredRecord> records;
  while (const auto message = reader.next()) {
    const McapChannel& channel = *reader.channel(message->channel_id);
    const McapSchema& schema = *reader.schema(channel.schema_id);
    records.push_back({channel.topic, schema.name, schema.encoding, channel.message_encoding,
                       std::string(message->data.begin(), message->data.end()), message->log_time});
  }
  return records;
}

StoredRecord stored_event(const Event& event) {
  const auto records = stored_records([&](NativeLogWriter& writer) { EXPECT_TRUE(writer.write(event)); });
  EXPECT_EQ(records.size(), 1u);
  return records.empty() ? StoredRecord() : records[0];
}

void expect_record(const StoredRecord& record, const std::string& topic, const std::string& kind,
                   const std::string& bytes) {
  EXPECT_EQ(record.topic, topic);
  EXPECT_EQ(record.kind, kind);
  EXPECT_EQ(record.schema_encoding, "ros2msg");
  EXPECT_EQ(record.message_encoding, "cdr");
  EXPECT_EQ(record.bytes, bytes);
}

const Time kWhen{Duration(0x0102030405060708)};
const std::string kHeadAndTime =
    "00 01 00 00 "               // CDR, little-endian
    "08 07 06 05 04 03 02 01 ";  // time_ns

Pose golden_pose() {
  return {Rotation::from_unit_quaternion(Eigen::Quaterniond(0, 0, 1, 0)), Eigen::Vector3d(1, 2, -3)};
}
const std::string kPoseBytes =
    "00x6 F0 3F 00x7 40 00x6 08 C0 "  // x 1, y 2, z -3
    "00x8 00x6 F0 3F 00x8 00x8 ";     // qx 0, qy 1, qz 0, qw 0

/// Two beams of three bins, samples 1 to 6, all other values different from each other.
Ping golden_ping(SampleType type, const void* samples, std::ptrdiff_t sample_bytes) {
  auto fan = std::make_shared<BeamFan>();
  fan->azimuth = {Angle::radians(-0.5), Angle::radians(0.5)};
  fan->width = {Angle::radians(1), Angle::radians(2)};
  fan->height = Angle::radians(0.25);
  Ping ping;
  ping.time = kWhen;
  ping.fan = std::move(fan);
  ping.window = {1, 0.125, 3};
  ping.intensity = Intensities(samples, type, 2, 3, 3 * sample_bytes, sample_bytes);
  ping.X_BS = golden_pose();
  ping.sound_speed = 1500;
  ping.full_scale = 255;
  ping.sweep = SweepMark::kEnd;
  ping.blanking_m = 0.75;
  return ping;
}
const std::string kPingBytes = kHeadAndTime + kPoseBytes +
                               "00x5 70 97 40 "                       // sound_speed 1500
                               "00x6 F0 3F 00x6 C0 3F "               // range_start 1, bin_length 0.125
                               "03 00x3 00x2 7F 43 "                  // bins 3, full_scale 255
                               "00x6 E8 3F "                          // blanking_m 0.75
                               "02 00x7 "                             // sweep: its end
                               "00x6 D0 3F "                          // beam_height 0.25
                               "02 00x3 00x4 00x6 E0 BF 00x6 E0 3F "  // azimuth -0.5, 0.5
                               "02 00x3 00x4 00x6 F0 3F 00x7 40 ";    // beam_width 1, 2

TEST(NativeLogRecords, PingOfBytes) {
  const std::uint8_t samples[] = {1, 2, 3, 4, 5, 6};
  const StoredRecord record = stored_event(golden_ping(SampleType::kU8, samples, 1));
  expect_record(record, "/ping", "isobath/msg/Ping",
                hex(kPingBytes + "06 00x3 01 02 03 04 05 06 00x2 "  // samples_u8
                                 "00x4 00x4 "                       // samples_u16, samples_f32
                                 "00x4"));                          // sampled: all
  EXPECT_EQ(record.log_time, 0x0102030405060708u);
}

TEST(NativeLogRecords, PingOfWordsWithTheBinsThatWereSampled) {
  const std::uint8_t samples[] = {1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 1};
  Ping ping = golden_ping(SampleType::kU16, samples, 2);
  ping.sampled = std::make_shared<std::vector<BinSpan>>(std::vector<BinSpan>{{0, 3}, {1, 2}});
  expect_record(stored_event(ping), "/ping", "isobath/msg/Ping",
                hex(kPingBytes + "00x4 "                                         // samples_u8
                                 "06 00x3 01 00 02 00 03 00 04 00 05 00 06 01 "  // samples_u16
                                 "00x4 "                                         // samples_f32
                                 "04 00x3 00x4 03 00x3 01 00x3 02 00x3"));       // sampled: 0 to 3, 1 to 2
}

TEST(NativeLogRecords, PingOfFloats) {
  const float samples[] = {1, 2, 3, 4, 5, 6};
  expect_record(stored_event(golden_ping(SampleType::kF32, samples, 4)), "/ping", "isobath/msg/Ping",
                hex(kPingBytes + "00x4 00x4 "  // samples_u8, samples_u16
                                 "06 00x3 00x2 80 3F 00x3 40 00x2 40 40 00x2 80 40 00x2 A0 40 00x2 C0 40 "
                                 "00x4"));  // sampled: all
}

TEST(NativeLogRecords, Navigation) {
  isobath::Navigation fix{kWhen, golden_pose(), Eigen::Vector3d(1, 2, -3), {}, 0.5};
  fix.covariance.emplace().setZero();
  (*fix.covariance)(0, 1) = 0.25;
  (*fix.covariance)(5, 4) = 0.75;
  expect_record(stored_event(fix), "/navigation", "isobath/msg/Navigation",
                hex(kHeadAndTime + kPoseBytes +
                    "03 00x3 00x4 00x6 F0 3F 00x7 40 00x6 08 C0 "           // velocity 1, 2, -3
                    "24 00x3 00x4 00x8 00x6 D0 3F 00x256 00x6 E8 3F 00x8 "  // covariance, by rows
                    "01 00x3 00x4 00x6 E0 3F"));                            // velocity_sigma 0.5
  expect_record(stored_event(isobath::Navigation{kWhen, golden_pose(), {}, {}}), "/navigation",
                "isobath/msg/Navigation", hex(kHeadAndTime + kPoseBytes + "00x4 00x4 00x4"));
}

TEST(NativeLogRecords, RangeReading) {
  isobath::RangeReading reading{kWhen, 0.75, 50, Angle::radians(0.5), golden_pose(), 0.25f};
  const std::string head = kHeadAndTime + kPoseBytes +
                           "00x6 49 40 00x6 E0 3F "  // max_range 50, width 0.5
                           "00x2 80 3E ";            // confidence 0.25
  expect_record(stored_event(reading), "/range", "isobath/msg/RangeReading",
                hex(head + "01 00x3 00x6 E8 3F"));  // range 0.75
  reading.range_m.reset();
  expect_record(stored_event(reading), "/range", "isobath/msg/RangeReading", hex(head + "00x4"));
}

TEST(NativeLogRecords, Health) {
  const isobath::Health health{kWhen, "dvl", HealthState::kLost, 0.5f, true, "ab"};
  expect_record(stored_event(health), "/health", "isobath/msg/Health",
                hex(kHeadAndTime + "04 00x3 64 76 6C 00 "         // source
                                   "02 00x3 00x3 3F "             // state lost, battery 0.5
                                   "01 00x3 03 00x3 61 62 00"));  // leak, note
}

TEST(NativeLogRecords, Swath) {
  isobath::Swath swath;
  swath.time = kWhen;
  swath.frame = isobath::Swath::Frame::kLevel;
  swath.beam_width = Angle::radians(0.25);
  swath.sound_speed = 1500;
  swath.beam_height = Angle::radians(0.5);
  swath.soundings = {{{1, 2, 3}, 4, 0.5f, 0x0102, Sounding::Kind::kBottom, 0.5f},
                     {{-1, -2, -3}, 5, 0.25f, 0x0304, Sounding::Kind::kWater, 0.25f}};
  const std::string rest =
      "00x6 D0 3F 00x5 70 97 40 "       // beam_width 0.25, sound_speed 1500
      "02 00x3 00x2 80 3F 00x2 80 BF "  // x 1, -1
      "02 00x3 00x3 40 00x3 C0 "        // y 2, -2
      "02 00x3 00x2 40 40 00x2 40 C0 "  // z 3, -3
      "02 00x3 00x2 80 40 00x2 A0 40 "  // range 4, 5
      "02 00x3 00x3 3F 00x2 80 3E "     // sigma 0.5, 0.25
      "02 00x3 02 01 04 03 "            // beam
      "02 00x3 00 01 "                  // kind: bottom, water
      "00x6 00x6 E0 3F "                // beam_height 0.5
      "02 00x3 00x3 3F 00x2 80 3E";     // sigma_range 0.5, 0.25
  expect_record(stored_event(swath), "/swath", "isobath/msg/Swath",
                hex(kHeadAndTime + "01 00x3 00x4 " + rest));  // frame level, heading that of the pose
  swath.heading = Angle::radians(1.5);
  expect_record(stored_event(swath), "/swath", "isobath/msg/Swath",
                hex(kHeadAndTime + "01 00x3 01 00x3 00x6 F8 3F " + rest));  // heading 1.5
}

TEST(NativeLogRecords, OperatorFrame) {
  expect_record(stored_event(isobath::OperatorFrame{kWhen, {0xaa, 0xbb, 0xcc}}), "/operator",
                "isobath/msg/OperatorFrame", hex(kHeadAndTime + "03 00x3 AA BB CC"));
}

TEST(NativeLogRecords, PassiveBearing) {
  isobath::PassiveBearing heard{.time = kWhen,
                                .bearing = Angle::radians(0.5),
                                .sigma = Angle::radians(0.25),
                                .elevation = {},
                                .frequency_hz = 50,
                                .resolution_hz = 2,
                                .snr_db = -3,
                                .X_BS = golden_pose()};
  const std::string head = kHeadAndTime + kPoseBytes +
                           "00x6 E0 3F 00x6 D0 3F "           // bearing 0.5, sigma 0.25
                           "00x6 49 40 00x7 40 00x6 08 C0 ";  // frequency 50, resolution 2, snr -3
  expect_record(stored_event(heard), "/bearing", "isobath/msg/PassiveBearing", hex(head + "00x4"));
  heard.elevation = Angle::radians(0.75);
  expect_record(stored_event(heard), "/bearing", "isobath/msg/PassiveBearing", hex(head + "01 00x3 00x4 00x6 E8 3F"));
}

TEST(NativeLogRecords, TrueMotion) {
  isobath::TrueMotion motion;
  motion.time = kWhen;
  motion.state.X_WB = golden_pose();
  motion.state.v_B = {1, 2, -3};
  motion.state.w_B = {0.5, 0.25, 0.75};
  motion.current_W = {-3, 2, 1};
  const std::string head = kHeadAndTime + kPoseBytes +
                           "03 00x3 00x4 00x6 F0 3F 00x7 40 00x6 08 C0 "     // velocity
                           "03 00x3 00x4 00x6 E0 3F 00x6 D0 3F 00x6 E8 3F "  // rates
                           "03 00x3 00x4 00x6 08 C0 00x7 40 00x6 F0 3F ";    // current
  const auto stored = [&] { return stored_records([&](NativeLogWriter& writer) { writer.write(motion); }).at(0); };
  expect_record(stored(), "/truth/motion", "isobath/msg/TrueMotion", hex(head + "00x4"));
  motion.altitude_m = 1.5;
  expect_record(stored(), "/truth/motion", "isobath/msg/TrueMotion", hex(head + "01 00x3 00x4 00x6 F8 3F"));
}

TEST(NativeLogRecords, EchoTruth) {
  const isobath::EchoTruth echoes{
      kWhen, "fls", 1, 3, {{0, EchoPath::kNoise}, {3, EchoPath::kDirect}, {0x123, EchoPath::kDisturbance}}};
  const auto records = stored_records([&](NativeLogWriter& writer) { writer.write(echoes); });
  expect_record(records.at(0), "/truth/echoes", "isobath/msg/EchoTruth",
                hex(kHeadAndTime + "04 00x3 66 6C 73 00 "          // sonar
                                   "01 00x3 03 00x3 "              // beams, bins
                                   "03 00x3 00 00 31 00 3A 12"));  // labels
}

TEST(NativeLogRecords, Setpoint) {
  const isobath::Setpoint setpoint{Angle::radians(0.5), 2, 1.5, -3};
  const auto records = stored_records([&](NativeLogWriter& writer) { writer.write(kWhen, setpoint); });
  expect_record(records.at(0), "/setpoint", "isobath/msg/Setpoint",
                hex(kHeadAndTime + "00x6 E0 3F 00x7 40 00x6 F8 3F 00x6 08 C0"));  // heading, depth, speed, sway_speed
}

TEST(NativeLogRecords, Decision) {
  const std::string json = R"({"time_ns":1})";
  const auto records = stored_records([&](NativeLogWriter& writer) { writer.write_decision(kWhen, json); });
  EXPECT_EQ(records.at(0).topic, "/decisions");
  EXPECT_EQ(records.at(0).kind, "isobath/msg/Decision");
  EXPECT_EQ(records.at(0).schema_encoding, "jsonschema");
  EXPECT_EQ(records.at(0).message_encoding, "json");
  EXPECT_EQ(records.at(0).bytes, json);
}

// MCAP has no times before 1970; the message holds the exact time.
TEST(NativeLogRecords, ATimeBefore1970IsZeroInTheContainer) {
  const StoredRecord record = stored_event(isobath::OperatorFrame{Time{Duration(-2)}, {}});
  EXPECT_EQ(record.log_time, 0u);
  EXPECT_EQ(record.bytes, hex("00 01 00 00 FE FFx7 00x4"));
}

// CRC-32 of the definitions by which foreign readers decode the records.
TEST(NativeLogRecords, DefinitionsOfAllKinds) {
  const std::filesystem::path file = test::scratch_folder() / "log.mcap";
  NativeLogWriter writer(file, {McapCompression::kNone, 1024});
  writer.write(isobath::OperatorFrame{kWhen, {}});
  writer.write(isobath::PassiveBearing{});
  writer.write(isobath::TrueMotion{});
  writer.write(isobath::EchoTruth{});
  writer.write(kWhen, isobath::Setpoint{});
  writer.write_decision(kWhen, "{}");
  writer.close();
  McapReader reader(std::make_unique<std::ifstream>(file, std::ios::binary), file.string());
  while (reader.next()) {
  }
  std::map<std::string, std::uint32_t> checksums;
  for (const auto& [id, channel] : reader.channels()) {
    const McapSchema& schema = *reader.schema(channel.schema_id);
    checksums[schema.name] =
        mcap::crc32({reinterpret_cast<const std::uint8_t*>(schema.data.data()), schema.data.size()});
  }
  const std::map<std::string, std::uint32_t> stated = {
      {"isobath/msg/Ping", 0x4ddfaf70},           {"isobath/msg/Navigation", 0x91d98934},
      {"isobath/msg/RangeReading", 0x1993bb3d},   {"isobath/msg/Health", 0x09da48a1},
      {"isobath/msg/Swath", 0x4263c83b},          {"isobath/msg/OperatorFrame", 0xf0f42c71},
      {"isobath/msg/PassiveBearing", 0xf9bfb52f}, {"isobath/msg/TrueMotion", 0xd6a1f079},
      {"isobath/msg/EchoTruth", 0xb2f4c192},      {"isobath/msg/Setpoint", 0x10547a1a},
      {"isobath/msg/Decision", 0x63bf8db5}};
  EXPECT_EQ(checksums, stated);
}

TEST(NativeLogRecords, WhatALogSaysOfItself) {
  const std::filesystem::path file = test::scratch_folder() / "log.mcap";
  NativeLogWriter writer(file);
  writer.set_details({{"sonar", "made up"}});
  writer.set_configuration("a = 1\n");
  writer.set_origin({60.125, -10.5});
  writer.close();
  const McapReader reader(std::make_unique<std::ifstream>(file, std::ios::binary), file.string());
  using Values = std::map<std::string, std::string>;
  ASSERT_EQ(reader.metadata().size(), 3u);
  EXPECT_EQ(reader.metadata()[0].name, "isobath/source");
  EXPECT_EQ(reader.metadata()[0].values, (Values{{"sonar", "made up"}}));
  EXPECT_EQ(reader.metadata()[1].name, "isobath/configuration");
  EXPECT_EQ(reader.metadata()[1].values, (Values{{"toml", "a = 1\n"}}));
  EXPECT_EQ(reader.metadata()[2].name, "isobath/origin");
  EXPECT_EQ(reader.metadata()[2].values, (Values{{"latitude_deg", "60.125"}, {"longitude_deg", "-10.5"}}));
}

}  // namespace
}  // namespace isobath
