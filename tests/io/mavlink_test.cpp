// MAVLink frames against those that node-mavlink decoded, telemetry logs, DataFlash logs, damage, and logs of
// BlueROV2s.
#include <cmath>
#include <cstring>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/io/formats/mavlink/dataflash_log.hpp>
#include <isobath/io/formats/mavlink/mavlink_frames.hpp>
#include <isobath/io/formats/mavlink/telemetry_log.hpp>
#include <isobath/io/open_source.hpp>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/support/data.hpp>

namespace isobath::mavlink_logs {
namespace {

using test::big;
using test::drain;
using test::hex;
using test::in_memory;
using test::little;
using testing::HasSubstr;

// Frames that node-mavlink 2.3 decoded with these values.
const std::string kAttitude =
    hex("FD 1C 00 00 05 01 01 1E 00 00 D2 04 00 00 CD CC CC 3D CD CC 4C BD 00 00 C0 3F 00 00 00 00 00 00 00 00 0A D7 "
        "23 3C D0 F6");
const std::string kDistance =
    hex("FD 16 00 00 03 01 BF 84 00 00 D2 04 00 00 1E 00 88 13 FA 00 03 00 19 FF 33 33 B3 3E 33 33 B3 3E 66 8B");
const std::string kHeartbeat = hex("FD 09 00 00 00 01 BF 00 00 00 00 00 00 00 12 08 00 04 03 AE C6");
const std::string kHeartbeat1 = hex("FE 09 00 01 BF 00 00 00 00 00 12 08 00 04 03 05 8C");

template <class T>
std::string packed(std::initializer_list<T> values) {
  std::string bytes;
  for (const T v : values) bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
  return bytes;
}

/// A frame of version 2 with its checksum, by the textbook form of CRC-16/MCRF4XX: bit by bit.
std::string frame_of(std::uint32_t id, const std::string& payload, std::uint8_t system = 1) {
  std::string body = little(static_cast<std::uint8_t>(payload.size())) + std::string(2, '\0') + std::string(1, '\0') +
                     static_cast<char>(system) + '\1' + little(id).substr(0, 3) + payload;
  std::uint16_t crc = 0xFFFF;
  for (const char c : body + static_cast<char>(mavlink_kind(id) ? mavlink_kind(id)->crc_extra : 0)) {
    crc = static_cast<std::uint16_t>(crc ^ static_cast<unsigned char>(c));
    for (int i = 0; i < 8; ++i) crc = static_cast<std::uint16_t>((crc & 1) ? (crc >> 1) ^ 0x8408 : crc >> 1);
  }
  return "\xFD" + body + little(crc);
}

constexpr std::uint64_t kStart = 1'600'000'000'000'000;
std::string stamped(double t, const std::string& frame) {
  return big(kStart + static_cast<std::uint64_t>(t * 1e6)) + frame;
}
std::string local_position(float x, float y, float z, float vx = 0) {
  return frame_of(32, packed<std::uint32_t>({0}) + packed<float>({x, y, z, vx, 0, 0}));
}
std::unique_ptr<Source> opened(const std::string& log, const InputConfig& config = {}) {
  return open_telemetry_log(in_memory(log), config);
}

TEST(MavlinkFrames, BothVersionsAreReadAsAnotherLibraryReadsThem) {
  const Framing framing = mavlink_structure_at(bytes_of(kAttitude));
  EXPECT_EQ(framing.kind, Framing::Kind::kFrame);
  EXPECT_EQ(framing.bytes, kAttitude.size());
  const MavlinkFrame frame = mavlink_frame(bytes_of(kAttitude));
  EXPECT_EQ(frame.id, 30u);
  EXPECT_EQ(frame.sequence, 5);
  EXPECT_EQ(frame.checksum, MavlinkFrame::Checksum::kRight);
  EXPECT_EQ(MavlinkPayload(frame.payload).at<float>(12), 1.5f);
  for (const std::string& heartbeat : {kHeartbeat, kHeartbeat1}) {
    const MavlinkFrame f = mavlink_frame(bytes_of(heartbeat));
    EXPECT_EQ(mavlink_structure_at(bytes_of(heartbeat)).bytes, heartbeat.size());
    EXPECT_EQ(f.checksum, MavlinkFrame::Checksum::kRight);
    EXPECT_EQ(f.component, 0xBF);
    EXPECT_EQ(MavlinkPayload(f.payload).at<std::uint8_t>(4), 18);
  }
  const std::string obstacle =
      hex("fd 1c 00 00 00 01 c4 1d 2b 00 e8 03 00 00 00 00 c0 3f 00 00 00 c0 00 00 80 3e 00 00 40 3f 00 00 48 42 ff ff "
          "01 0c "
          "28 ba");
  EXPECT_EQ(mavlink_frame(bytes_of(obstacle)).checksum, MavlinkFrame::Checksum::kRight);
  EXPECT_EQ(mavlink_frame(bytes_of(obstacle)).id, 11037u);
}

TEST(MavlinkFrames, AChangedByteIsSeenAndACutFrameWaits) {
  for (std::size_t i = 4; i < kAttitude.size(); ++i) {
    if (i >= 7 && i <= 9) continue;  // the number of the message, which may become an unknown one
    std::string changed = kAttitude;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    EXPECT_EQ(mavlink_frame(bytes_of(changed)).checksum, MavlinkFrame::Checksum::kWrong) << i;
  }
  for (std::size_t cut = 0; cut < kAttitude.size(); ++cut) {
    EXPECT_EQ(mavlink_structure_at(bytes_of(kAttitude.substr(0, cut))).kind, Framing::Kind::kIncomplete) << cut;
  }
}

TEST(TelemetryLog, AttitudesAndPositionsMakeFixesAndDistancesRanges) {
  const std::string log = stamped(0, kHeartbeat) + stamped(1, local_position(10, 20, 3, 2)) + stamped(1.5, kAttitude) +
                          stamped(1.6, kDistance);
  ASSERT_TRUE(looks_like_telemetry_log(bytes_of(log)));
  const auto source = opened(log);
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 3u);  // the first position has no attitude yet
  const auto& fix = std::get<Navigation>(events[1]);
  EXPECT_TRUE(fix.X_WB.translation.isApprox(Eigen::Vector3d(11, 20, 3))) << "moved on by half a second";
  EXPECT_NEAR(fix.X_WB.rotation.heading().radians(), 1.5, 1e-6);
  EXPECT_NEAR(fix.X_WB.rotation.pitch().radians(), -0.05, 1e-6);
  EXPECT_NEAR(fix.X_WB.rotation.roll().radians(), 0.1, 1e-6);
  const auto& reading = std::get<RangeReading>(events[2]);
  EXPECT_NEAR(*reading.range_m, 2.5, 1e-9);
  EXPECT_NEAR(reading.max_range_m, 50, 1e-9);
  EXPECT_NEAR(reading.width.radians(), 0.35, 1e-6);
  EXPECT_TRUE((reading.X_BS.rotation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
  EXPECT_EQ(source->report().details.at("ATTITUDE"), "1, used as attitudes");
  EXPECT_EQ(source->report().bytes_skipped, 0u);
}

TEST(TelemetryLog, TrailingZerosThatASenderDropsAreFilledIn) {
  // 1.5 is 00 00 C0 3F: a payload cut after the third byte of a number would change it, were it not filled.
  std::string payload = packed<std::uint32_t>({0}) + packed<float>({1.5f, 0, 0, 0, 0, 0});
  payload.resize(8);
  const auto events = drain(*opened(stamped(0, frame_of(32, payload))));
  EXPECT_EQ(std::get<Navigation>(events.at(0)).X_WB.translation, Eigen::Vector3d(1.5, 0, 0));
}

TEST(TelemetryLog, PositionOnTheGlobeTiesTheLocalPlane) {
  const auto global = frame_of(33, packed<std::uint32_t>({0}) + packed<std::int32_t>({500000000, 100000000, 0, -4000}) +
                                       packed<std::int16_t>({100, 0, 0}) + packed<std::uint16_t>({0}));
  const auto alone = opened(stamped(0, global) + stamped(0.1, kAttitude));
  const auto events = drain(*alone);
  EXPECT_EQ(std::get<Navigation>(events.at(1)).X_WB.translation.z(), 4) << "relative altitude is negative under water";
  EXPECT_NEAR(alone->report().origin->latitude_deg, 50, 1e-9);
  const auto both = opened(stamped(0, global) + stamped(0.1, local_position(100, 0, 4)) + stamped(0.2, kAttitude));
  EXPECT_EQ(drain(*both).size(), 2u);
  EXPECT_NEAR(LocalPlane(*both->report().origin).to_plane({50, 10}).x(), 100, 1e-3);
}

/// ODOMETRY: a place, a heading (rad), a velocity forward; frames local north-east-down and body.
std::string odometry(float x, float y, float z, float heading, float forward, char frame = 1) {
  const std::string covariance(std::size_t{2} * 21 * 4, '\0');
  return frame_of(
      331, packed<std::uint64_t>({0}) +
               packed<float>({x, y, z, std::cos(heading / 2), 0, 0, std::sin(heading / 2), forward, 0, 0, 0, 0, 0}) +
               covariance + frame + '\x0C');
}

TEST(TelemetryLog, OdometryIsTheNavigationWhereNoOtherMessageStatesAPosition) {
  const auto source = opened(stamped(0, odometry(10, 20, 3, 1.5F, 2)) + stamped(1, odometry(10, 22, 3, 1.5F, 2)) +
                             stamped(1.5, odometry(0, 0, 0, 0, 0, 20)));
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 2u);
  const auto& fix = std::get<Navigation>(events[1]);
  EXPECT_NEAR((fix.X_WB.translation - Eigen::Vector3d(10, 22, 3)).norm(), 0, 1e-6);
  EXPECT_NEAR(fix.X_WB.rotation.heading().radians(), 1.5, 1e-6);
  ASSERT_TRUE(fix.v_WB);
  EXPECT_NEAR((*fix.v_WB - Eigen::Vector3d(2 * std::cos(1.5), 2 * std::sin(1.5), 0)).norm(), 0, 1e-6);
  EXPECT_EQ(source->report().rejected.at("odometry in other frames than local north-east-down and body"), 1u);
  const auto both =
      opened(stamped(0, odometry(10, 20, 3, 1, 2)) + stamped(0.1, local_position(100, 0, 4)) + stamped(0.2, kAttitude));
  EXPECT_EQ(std::get<Navigation>(drain(*both).at(0)).X_WB.translation.x(), 100);
}

TEST(TelemetryLog, LocalPositionsThatBeginLateDoNotMixWithThoseOnTheGlobe) {
  const auto global = frame_of(33, packed<std::uint32_t>({0}) + packed<std::int32_t>({500000000, 100000000, 0, 0}) +
                                       packed<std::int16_t>({0, 0, 0}) + packed<std::uint16_t>({0}));
  std::string log;
  for (int i = 0; i < 7000; ++i) log += stamped(0.01 * i, global);  // more than the reader looks ahead
  log += stamped(70.1, local_position(500, 0, 0)) + stamped(70.2, kAttitude);
  const auto source = opened(log);
  EXPECT_LT(std::get<Navigation>(drain(*source).back()).X_WB.translation.norm(), 1);
  EXPECT_EQ(source->report().details.at("LOCAL_POSITION_NED"), "1, not used");
}

TEST(TelemetryLog, FrameWithAWrongChecksumCostsOnlyItself) {
  std::string broken = kAttitude;
  broken[15] = 'x';
  const auto source = opened(stamped(0, local_position(0, 0, 0)) + stamped(1, broken) + stamped(2, kAttitude));
  EXPECT_EQ(drain(*source).size(), 2u);
  EXPECT_EQ(source->report().rejected.at("frame with a wrong checksum"), 1u);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
}

TEST(TelemetryLog, NoiseAndACutCostOnlyThemselves) {
  const std::string noise = hex("FD 03 FE 00x30 FE FE FD 05");
  const auto source = opened(stamped(0, local_position(0, 0, 0)) + noise + stamped(1, kAttitude));
  EXPECT_EQ(drain(*source).size(), 2u);
  EXPECT_EQ(source->report().bytes_skipped, noise.size());
  const std::string log = stamped(0, local_position(0, 0, 0)) + stamped(1, kAttitude) + stamped(2, kDistance);
  for (std::size_t cut = 0; cut < log.size(); ++cut) {
    const auto part = opened(log.substr(0, cut));
    EXPECT_LE(drain(*part).size(), 3u);
    EXPECT_LE(part->report().bytes_skipped, cut);
  }
}

TEST(TelemetryLog, MessagesOfOtherSystemsAreCountedAsTheirs) {
  const std::string log =
      stamped(0, kAttitude) + stamped(0.1, local_position(1, 2, 3)) +
      stamped(0.2, frame_of(32, packed<std::uint32_t>({0}) + packed<float>({9, 9, 9, 0, 0, 0}), 7)) +
      stamped(0.3, kAttitude);
  const auto source = opened(log);
  EXPECT_EQ(drain(*source).size(), 1u);
  EXPECT_EQ(source->report().details.at("LOCAL_POSITION_NED of system 7"), "1, not used");
  InputConfig config;
  config.mavlink_system = 7;
  EXPECT_EQ(std::get<Navigation>(drain(*opened(log, config)).at(0)).X_WB.translation.x(), 9);
}

TEST(TelemetryLog, RealLogOfABlueRov2) {
  ISOBATH_NEEDS_DATA(data, "bluerov2-logs");
  const auto source = open_source(data / "2023-05-04-small.tlog", {});
  EXPECT_EQ(source->report().format, "MAVLink telemetry log");
  const auto events = drain(*source);
  const SourceReport& report = source->report();
  EXPECT_EQ(report.bytes_skipped, 0u);
  EXPECT_TRUE(report.rejected.empty());
  // Counted by a script of another language.
  EXPECT_EQ(report.details.at("ATTITUDE"), "5245, used as attitudes");
  EXPECT_EQ(report.details.at("LOCAL_POSITION_NED"), "792, used as positions");
  EXPECT_EQ(report.details.at("SERVO_OUTPUT_RAW"), "528, not used");
  EXPECT_EQ(report.details.at("sonar"), "none: the log has neither DISTANCE_SENSOR nor RANGEFINDER");
  EXPECT_GT(events.size(), 5000u);
  EXPECT_NEAR(to_seconds(time_of(events.back()) - time_of(events.front())), 263, 3);
  EXPECT_TRUE(report.origin);
  for (const Event& e : events) {
    const double depth = std::get<Navigation>(e).X_WB.translation.z();
    ASSERT_LT(std::abs(depth), 2) << "at the surface";
  }
}

// DataFlash: A3 95, type, fields.
std::string format_record(std::uint8_t type, std::uint8_t length, const std::string& name, const std::string& format,
                          const std::string& labels) {
  const auto padded = [](std::string text, std::size_t size) { return text.resize(size), text; };
  return hex("A3 95 80") + static_cast<char>(type) + static_cast<char>(length) + padded(name, 4) + padded(format, 16) +
         padded(labels, 64);
}
std::string record(std::uint8_t type, const std::string& fields) {
  return hex("A3 95") + static_cast<char>(type) + fields;
}

std::string small_dataflash() {
  return format_record(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns") +
         format_record(10, 3 + 8 + 6, "ATT", "QccC", "TimeUS,Roll,Pitch,Yaw") +
         format_record(11, 3 + 9 + 24, "XKF1", "QBffffff", "TimeUS,C,VN,VE,VD,PN,PE,PD") +
         format_record(12, 3 + 8 + 5, "RFND", "QBCBB", "TimeUS,Instance,Dist,Stat,Orient") +
         record(11, packed<std::uint64_t>({1'000'000}) + '\0' + packed<float>({0, 0, 0, 5, 6, 7})) +
         record(11, packed<std::uint64_t>({1'000'000}) + '\1' + packed<float>({0, 0, 0, 50, 60, 70})) +
         record(10, packed<std::uint64_t>({1'100'000}) + packed<std::int16_t>({100, -200}) +
                        packed<std::uint16_t>({9000})) +
         record(12, packed<std::uint64_t>({1'200'000}) + '\0' + packed<std::uint16_t>({250}) + '\4' + '\x19') +
         record(12, packed<std::uint64_t>({1'300'000}) + '\0' + packed<std::uint16_t>({250}) + '\1' + '\x19');
}

TEST(DataflashLog, RecordsAreReadByTheLabelsThatTheLogStates) {
  ASSERT_TRUE(looks_like_dataflash_log(bytes_of(small_dataflash())));
  const auto source = open_dataflash_log(in_memory(small_dataflash()), {});
  const auto events = drain(*source);
  ASSERT_EQ(events.size(), 3u);
  const auto& fix = std::get<Navigation>(events[1]);
  EXPECT_EQ(to_seconds(fix.time), 1.1);
  EXPECT_EQ(fix.X_WB.translation, Eigen::Vector3d(5, 6, 7)) << "of the first core";
  EXPECT_NEAR(fix.X_WB.rotation.heading().degrees(), 90, 1e-9);
  EXPECT_NEAR(fix.X_WB.rotation.pitch().degrees(), -2, 1e-9);
  EXPECT_NEAR(fix.X_WB.rotation.roll().degrees(), 1, 1e-9);
  EXPECT_NEAR(*std::get<RangeReading>(events[2]).range_m, 2.5, 1e-9);
  EXPECT_EQ(source->report().rejected.at("distance that the sensor calls invalid"), 1u);
}

TEST(DataflashLog, DamageAndACutCostOnlyThemselves) {
  const std::string log = small_dataflash(), att = "\xA3\x95\x0A";
  const std::size_t at = log.rfind(att);
  const auto source = open_dataflash_log(in_memory(log.substr(0, at) + "\xA3noise" + log.substr(at)), {});
  EXPECT_EQ(drain(*source).size(), 3u);
  EXPECT_EQ(source->report().bytes_skipped, 6u);
  for (std::size_t cut = 1; cut < log.size(); ++cut) {
    const auto part = open_dataflash_log(in_memory(log.substr(0, cut)), {});
    EXPECT_LE(drain(*part).size(), 3u);
    EXPECT_LE(part->report().bytes_skipped, cut);
  }
}

TEST(DataflashLog, FormatThatDoesNotAddUpIsRefused) {
  const std::string log = small_dataflash() + format_record(10, 200, "ATT", "QccC", "TimeUS,Roll,Pitch,Yaw");
  const auto source = open_dataflash_log(in_memory(log), {});
  drain(*source);
  EXPECT_EQ(source->report().rejected.at("format of a record that cannot be read"), 1u);
}

TEST(DataflashLog, RealLogOfABlueRov2) {
  ISOBATH_NEEDS_DATA(data, "bluerov2-logs");
  const auto source = open_source(data / "2023-small.BIN", {});
  EXPECT_EQ(source->report().format, "ArduPilot DataFlash log");
  const auto events = drain(*source);
  EXPECT_EQ(source->report().bytes_skipped, 0u);
  // Counted by a script of another language.
  EXPECT_EQ(source->report().details.at("ATT"), "237, used as attitudes");
  EXPECT_EQ(source->report().details.at("PARM"), "876, not used");
  EXPECT_EQ(source->report().details.at("IMU"), "594, not used");
  EXPECT_NEAR(to_seconds(time_of(events.back()) - time_of(events.front())), 23.7, 0.3);
}

}  // namespace
}  // namespace isobath::mavlink_logs
