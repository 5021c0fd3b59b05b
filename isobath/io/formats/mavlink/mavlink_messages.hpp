// The MAVLink messages that a companion computer and an autopilot exchange: set-points, mission, state, obstacles
// (message definitions common.xml and ardupilotmega.xml; wire order after the serialization rules of mavlink.io).
//
// Each message is a struct with the units of the definition in its field names or comments, `body()` with the payload
// up to the longest extension, and `of` that reads an untrusted payload: absent fields are zero. MavlinkWriter makes
// the frame.
#pragma once

#include <isobath/io/formats/mavlink/mavlink_frames.hpp>
#include <string>
#include <vector>

namespace isobath::mavlink {

using PayloadBytes = std::vector<std::byte>;

/// Values of the definitions that are used here.
constexpr std::uint8_t kSubmarine = 12, kOnboardController = 18, kGroundStation = 6;  // MAV_TYPE
constexpr std::uint8_t kArduPilot = 3, kNoAutopilot = 8;                              // MAV_AUTOPILOT
constexpr std::uint8_t kArmed = 128, kCustomMode = 1;                                 // MAV_MODE_FLAG
constexpr std::uint8_t kStateActive = 4;                                              // MAV_STATE
constexpr std::uint8_t kObstacleAvoidance = 196;                                      // MAV_COMPONENT
constexpr std::uint8_t kLocalNed = 1, kBodyFrd = 12, kGlobalRelative = 6;             // MAV_FRAME
constexpr std::uint16_t kSetMessageInterval = 511;                                    // MAV_CMD

/// Modes of ArduSub (custom_mode of a heartbeat).
enum class SubMode : std::uint32_t {
  kStabilize = 0,
  kDepthHold = 2,
  kAuto = 3,
  kGuided = 4,
  kSurface = 9,
  kPositionHold = 16,
  kManual = 19
};
/// "GUIDED"; "mode 7" for a mode that the table lacks.
std::string mode_text(std::uint32_t mode);

struct Heartbeat {
  static constexpr std::uint32_t kId = 0;
  std::uint32_t custom_mode = 0;
  std::uint8_t type = 0, autopilot = 0, base_mode = 0, status = 0;
  [[nodiscard]] PayloadBytes body() const;
  static Heartbeat of(const MavlinkPayload& p);
  [[nodiscard]] bool armed() const { return (base_mode & kArmed) != 0; }
};

struct SystemStatus {  // SYS_STATUS: the charge only
  static constexpr std::uint32_t kId = 1;
  std::int8_t battery_percent = -1;  ///< -1: unknown
  [[nodiscard]] PayloadBytes body() const;
  static SystemStatus of(const MavlinkPayload& p);
};

struct Attitude {
  static constexpr std::uint32_t kId = 30;
  std::uint32_t boot_ms = 0;
  float roll = 0, pitch = 0, yaw = 0;  ///< rad
  [[nodiscard]] PayloadBytes body() const;
};

struct LocalPosition {
  static constexpr std::uint32_t kId = 32;
  std::uint32_t boot_ms = 0;
  float x = 0, y = 0, z = 0, vx = 0, vy = 0, vz = 0;  ///< north-east-down, m and m/s
  [[nodiscard]] PayloadBytes body() const;
};

struct Origin {  // GPS_GLOBAL_ORIGIN
  static constexpr std::uint32_t kId = 49;
  std::int32_t latitude_e7 = 0, longitude_e7 = 0;
  [[nodiscard]] PayloadBytes body() const;
};

struct TimeSync {
  static constexpr std::uint32_t kId = 111;
  std::int64_t tc1_ns = 0, ts1_ns = 0;
  [[nodiscard]] PayloadBytes body() const;
  static TimeSync of(const MavlinkPayload& p);
};

/// SET_POSITION_TARGET_LOCAL_NED: velocity and yaw.
struct VelocityTarget {
  static constexpr std::uint32_t kId = 84;
  static constexpr std::uint16_t kVelocityAndYaw = 0x09C7;  ///< ignores position, acceleration, yaw rate
  std::uint32_t boot_ms = 0;
  float vx = 0, vy = 0, vz = 0, yaw = 0;  ///< north-east-down, m/s, rad
  std::uint16_t mask = kVelocityAndYaw;
  std::uint8_t system = 1, component = 1, frame = kLocalNed;
  [[nodiscard]] PayloadBytes body() const;
  static VelocityTarget of(const MavlinkPayload& p);
};

struct CommandLong {
  static constexpr std::uint32_t kId = 76;
  std::array<float, 7> params{};
  std::uint16_t command = 0;
  std::uint8_t system = 1, component = 1;
  [[nodiscard]] PayloadBytes body() const;
  static CommandLong of(const MavlinkPayload& p);
};

struct CommandAck {
  static constexpr std::uint32_t kId = 77;
  std::uint16_t command = 0;
  std::uint8_t result = 0;
  [[nodiscard]] PayloadBytes body() const;
};

/// Which of the three lists of a vehicle (MAV_MISSION_TYPE).
enum class MissionKind : std::uint8_t { kMission = 0, kFence = 1, kRally = 2 };

struct MissionRequestList {
  static constexpr std::uint32_t kId = 43;
  std::uint8_t system = 1, component = 1;
  MissionKind kind = MissionKind::kMission;
  [[nodiscard]] PayloadBytes body() const;
  static MissionRequestList of(const MavlinkPayload& p);
};

struct MissionCount {
  static constexpr std::uint32_t kId = 44;
  std::uint16_t count = 0;
  std::uint8_t system = 1, component = 1;
  MissionKind kind = MissionKind::kMission;
  [[nodiscard]] PayloadBytes body() const;
  static MissionCount of(const MavlinkPayload& p);
};

struct MissionRequest {  // MISSION_REQUEST_INT; its elder, 40, has the same fields
  static constexpr std::uint32_t kId = 51, kOldId = 40;
  std::uint16_t sequence = 0;
  std::uint8_t system = 1, component = 1;
  MissionKind kind = MissionKind::kMission;
  [[nodiscard]] PayloadBytes body() const;
  static MissionRequest of(const MavlinkPayload& p);
};

struct MissionItem {  // MISSION_ITEM_INT
  static constexpr std::uint32_t kId = 73;
  std::array<float, 4> params{};
  std::int32_t x = 0, y = 0;  ///< latitude and longitude, 1e-7 degrees
  float z = 0;                ///< altitude, m
  std::uint16_t sequence = 0, command = 0;
  std::uint8_t system = 1, component = 1, frame = kGlobalRelative, current = 0, goes_on = 1;
  MissionKind kind = MissionKind::kMission;
  [[nodiscard]] PayloadBytes body() const;
  static MissionItem of(const MavlinkPayload& p);
};

struct MissionAck {
  static constexpr std::uint32_t kId = 47;
  std::uint8_t system = 1, component = 1, result = 0;  ///< 0: accepted
  MissionKind kind = MissionKind::kMission;
  [[nodiscard]] PayloadBytes body() const;
  static MissionAck of(const MavlinkPayload& p);
};

struct MissionItemReached {
  static constexpr std::uint32_t kId = 46;
  std::uint16_t sequence = 0;
  [[nodiscard]] PayloadBytes body() const;
};

struct StatusText {
  static constexpr std::uint32_t kId = 253;
  static constexpr std::size_t kLongest = 50;
  std::uint8_t severity = 6;  ///< 2 critical, 4 warning, 6 information
  std::string text;           ///< longer ones are cut
  [[nodiscard]] PayloadBytes body() const;
  static StatusText of(const MavlinkPayload& p);
};

struct NamedValue {  // NAMED_VALUE_FLOAT
  static constexpr std::uint32_t kId = 251;
  std::uint32_t boot_ms = 0;
  float value = 0;
  std::string name;  ///< at most ten characters
  [[nodiscard]] PayloadBytes body() const;
};

struct ObstacleDistance {
  static constexpr std::uint32_t kId = 330;
  static constexpr std::size_t kDirections = 72;
  static constexpr std::uint16_t kUnknown = 65535;
  std::uint64_t time_us = 0;
  std::array<std::uint16_t, kDirections> cm{};  ///< from the bow, clockwise, 5 degrees each; max + 1: nothing seen
  std::uint16_t min_cm = 0, max_cm = 0;
  [[nodiscard]] PayloadBytes body() const;
  static ObstacleDistance of(const MavlinkPayload& p);
};

struct VisionDelta {  // VISION_POSITION_DELTA
  static constexpr std::uint32_t kId = 11011;
  std::uint64_t time_us = 0, since_us = 0;  ///< since the last such message
  float turned[3] = {}, moved[3] = {};      ///< rad and m, in the body (forward, starboard, down) of then
  float confidence = 0;                     ///< percent
  [[nodiscard]] PayloadBytes body() const;
  static VisionDelta of(const MavlinkPayload& p);
};

struct ObstacleDistance3d {
  static constexpr std::uint32_t kId = 11037;
  std::uint32_t boot_ms = 0;  ///< obstacles of one set have the same
  float x = 0, y = 0, z = 0;  ///< forward, starboard, down, m
  float min_m = 0, max_m = 0;
  std::uint16_t number = 65535;  ///< 65535: unknown
  [[nodiscard]] PayloadBytes body() const;
};

}  // namespace isobath::mavlink
