#include <algorithm>
#include <cassert>
#include <isobath/io/formats/mavlink/mavlink_frames.hpp>

namespace isobath {
namespace {

constexpr std::byte kMagic1{0xFE}, kMagic2{0xFD};
constexpr std::size_t kHead1 = 6, kHead2 = 10, kCrcBytes = 2;

constexpr std::array kKinds{
    MavlinkKind{0, "HEARTBEAT", 50},
    MavlinkKind{1, "SYS_STATUS", 124},
    MavlinkKind{2, "SYSTEM_TIME", 137},
    MavlinkKind{21, "PARAM_REQUEST_LIST", 159},
    MavlinkKind{22, "PARAM_VALUE", 220},
    MavlinkKind{23, "PARAM_SET", 168},
    MavlinkKind{24, "GPS_RAW_INT", 24},
    MavlinkKind{27, "RAW_IMU", 144},
    MavlinkKind{29, "SCALED_PRESSURE", 115},
    MavlinkKind{30, "ATTITUDE", 39},
    MavlinkKind{31, "ATTITUDE_QUATERNION", 246},
    MavlinkKind{32, "LOCAL_POSITION_NED", 185},
    MavlinkKind{33, "GLOBAL_POSITION_INT", 104},
    MavlinkKind{36, "SERVO_OUTPUT_RAW", 222},
    MavlinkKind{40, "MISSION_REQUEST", 230},
    MavlinkKind{41, "MISSION_SET_CURRENT", 28},
    MavlinkKind{42, "MISSION_CURRENT", 28},
    MavlinkKind{43, "MISSION_REQUEST_LIST", 132},
    MavlinkKind{44, "MISSION_COUNT", 221},
    MavlinkKind{45, "MISSION_CLEAR_ALL", 232},
    MavlinkKind{46, "MISSION_ITEM_REACHED", 11},
    MavlinkKind{47, "MISSION_ACK", 153},
    MavlinkKind{48, "SET_GPS_GLOBAL_ORIGIN", 41},
    MavlinkKind{49, "GPS_GLOBAL_ORIGIN", 39},
    MavlinkKind{51, "MISSION_REQUEST_INT", 196},
    MavlinkKind{62, "NAV_CONTROLLER_OUTPUT", 183},
    MavlinkKind{65, "RC_CHANNELS", 118},
    MavlinkKind{66, "REQUEST_DATA_STREAM", 148},
    MavlinkKind{69, "MANUAL_CONTROL", 243},
    MavlinkKind{73, "MISSION_ITEM_INT", 38},
    MavlinkKind{74, "VFR_HUD", 20},
    MavlinkKind{75, "COMMAND_INT", 158},
    MavlinkKind{76, "COMMAND_LONG", 152},
    MavlinkKind{77, "COMMAND_ACK", 143},
    MavlinkKind{84, "SET_POSITION_TARGET_LOCAL_NED", 143},
    MavlinkKind{85, "POSITION_TARGET_LOCAL_NED", 140},
    MavlinkKind{86, "SET_POSITION_TARGET_GLOBAL_INT", 5},
    MavlinkKind{102, "VISION_POSITION_ESTIMATE", 158},
    MavlinkKind{103, "VISION_SPEED_ESTIMATE", 208},
    MavlinkKind{111, "TIMESYNC", 34},
    MavlinkKind{116, "SCALED_IMU2", 76},
    MavlinkKind{125, "POWER_STATUS", 203},
    MavlinkKind{132, "DISTANCE_SENSOR", 85},
    MavlinkKind{137, "SCALED_PRESSURE2", 195},
    MavlinkKind{147, "BATTERY_STATUS", 154},
    MavlinkKind{148, "AUTOPILOT_VERSION", 178},
    MavlinkKind{150, "SENSOR_OFFSETS", 134},
    MavlinkKind{152, "MEMINFO", 208},
    MavlinkKind{158, "MOUNT_STATUS", 134},
    MavlinkKind{163, "AHRS", 127},
    MavlinkKind{165, "HWSTATUS", 21},
    MavlinkKind{173, "RANGEFINDER", 83},
    MavlinkKind{178, "AHRS2", 47},
    MavlinkKind{193, "EKF_STATUS_REPORT", 71},
    MavlinkKind{232, "GPS_INPUT", 151},
    MavlinkKind{241, "VIBRATION", 90},
    MavlinkKind{242, "HOME_POSITION", 104},
    MavlinkKind{244, "MESSAGE_INTERVAL", 95},
    MavlinkKind{251, "NAMED_VALUE_FLOAT", 170},
    MavlinkKind{253, "STATUSTEXT", 83},
    MavlinkKind{261, "STORAGE_INFORMATION", 179},
    MavlinkKind{321, "PARAM_EXT_REQUEST_LIST", 88},
    MavlinkKind{322, "PARAM_EXT_VALUE", 243},
    MavlinkKind{330, "OBSTACLE_DISTANCE", 23},
    MavlinkKind{331, "ODOMETRY", 91},
    MavlinkKind{11011, "VISION_POSITION_DELTA", 106},
    MavlinkKind{11037, "OBSTACLE_DISTANCE_3D", 130},
    MavlinkKind{11038, "WATER_DEPTH", 47},
};
static_assert(std::ranges::is_sorted(kKinds, {}, &MavlinkKind::id));

/// CRC-16/MCRF4XX: reflected polynomial 0x8408 from 0xFFFF.
std::uint16_t crc_after(std::uint16_t crc, std::uint8_t byte) {
  auto t = static_cast<std::uint8_t>(byte ^ (crc & 0xFF));
  t = static_cast<std::uint8_t>(t ^ (t << 4));
  return static_cast<std::uint16_t>((crc >> 8) ^ (t << 8) ^ (t << 3) ^ (t >> 4));
}

}  // namespace

const MavlinkKind* mavlink_kind(std::uint32_t id) {
  const auto* const found = std::ranges::lower_bound(kKinds, id, {}, &MavlinkKind::id);
  return found != kKinds.end() && found->id == id ? found : nullptr;
}

std::vector<std::byte> MavlinkWriter::frame(std::uint32_t id, Bytes payload, Time now) {
  const MavlinkKind* const kind = mavlink_kind(id);
  assert(kind && payload.size() <= 255);
  while (payload.size() > 1 && payload.back() == std::byte{}) payload = payload.first(payload.size() - 1);
  std::vector<std::byte> bytes{kMagic2,
                               static_cast<std::byte>(payload.size()),
                               signer_ ? kMavlinkSigned : std::byte{},
                               {},
                               std::byte{sequence_++},
                               std::byte{system_},
                               std::byte{component_}};
  for (int shift = 0; shift < 24; shift += 8) bytes.push_back(static_cast<std::byte>(id >> shift));
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  std::uint16_t crc = 0xFFFF;
  for (const std::byte b : std::span(bytes).subspan(1)) crc = crc_after(crc, std::to_integer<std::uint8_t>(b));
  crc = crc_after(crc, kind->crc_extra);
  bytes.push_back(static_cast<std::byte>(crc));
  bytes.push_back(static_cast<std::byte>(crc >> 8));
  if (signer_) signer_->sign(bytes, now);
  return bytes;
}

Framing mavlink_structure_at(Bytes bytes) {
  const auto other = [&] {
    std::size_t at = 1;
    while (at < bytes.size() && bytes[at] != kMagic1 && bytes[at] != kMagic2) ++at;
    return Framing{Framing::Kind::kNoise, at};
  };
  if (bytes.empty()) return {Framing::Kind::kIncomplete, 1};
  if (bytes[0] != kMagic1 && bytes[0] != kMagic2) return other();
  const bool second = bytes[0] == kMagic2;
  if (bytes.size() < (second ? 3U : 2U)) return {Framing::Kind::kIncomplete, second ? 3U : 2U};
  const auto flags = second ? std::to_integer<unsigned>(bytes[2]) : 0;
  if ((flags & ~1U) != 0) return other();  // a frame that must not be read without knowing its flags
  const std::size_t length = std::to_integer<std::size_t>(bytes[1]) + (second ? kHead2 : kHead1) + kCrcBytes +
                             ((flags & 1U) != 0 ? kMavlinkSignatureBytes : 0);
  return {bytes.size() < length ? Framing::Kind::kIncomplete : Framing::Kind::kFrame, length};
}

Framing mavlink_frame_at(Bytes bytes) {
  const Framing found = mavlink_structure_at(bytes);
  if (found.kind != Framing::Kind::kFrame) return found;
  const bool wrong = mavlink_frame(bytes.first(found.bytes)).checksum == MavlinkFrame::Checksum::kWrong;
  return wrong ? Framing{Framing::Kind::kNoise, 1} : found;
}

MavlinkFrame mavlink_frame(Bytes frame) {
  const bool second = frame[0] == kMagic2;
  const std::size_t head = second ? kHead2 : kHead1, length = std::to_integer<std::size_t>(frame[1]);
  const RecordView view(frame);
  MavlinkFrame parts;
  parts.sequence = view.at<std::uint8_t>(second ? 4 : 2);
  parts.system = view.at<std::uint8_t>(second ? 5 : 3);
  parts.component = view.at<std::uint8_t>(second ? 6 : 4);
  parts.id =
      second ? view.at<std::uint16_t>(7) + (std::uint32_t{view.at<std::uint8_t>(9)} << 16) : view.at<std::uint8_t>(5);
  parts.payload = frame.subspan(head, length);
  const MavlinkKind* const kind = mavlink_kind(parts.id);
  if (!kind) return parts;
  std::uint16_t crc = 0xFFFF;
  for (const std::byte b : frame.subspan(1, head - 1 + length)) crc = crc_after(crc, std::to_integer<std::uint8_t>(b));
  crc = crc_after(crc, kind->crc_extra);
  const bool right = crc == view.at<std::uint16_t>(head + length);
  parts.checksum = right ? MavlinkFrame::Checksum::kRight : MavlinkFrame::Checksum::kWrong;
  return parts;
}

}  // namespace isobath
