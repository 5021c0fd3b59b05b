#include <fmt/format.h>
#include <isobath/io/bytes/record_writer.hpp>
#include <isobath/io/formats/mavlink/mavlink_messages.hpp>

namespace isobath::mavlink {
namespace {

MissionKind kind_at(const MavlinkPayload& p, std::size_t offset) {
  return static_cast<MissionKind>(p.at<std::uint8_t>(offset));
}

}  // namespace

std::string mode_text(std::uint32_t mode) {
  switch (static_cast<SubMode>(mode)) {
    case SubMode::kStabilize: return "STABILIZE";
    case SubMode::kDepthHold: return "ALT_HOLD";
    case SubMode::kAuto: return "AUTO";
    case SubMode::kGuided: return "GUIDED";
    case SubMode::kSurface: return "SURFACE";
    case SubMode::kPositionHold: return "POSHOLD";
    case SubMode::kManual: return "MANUAL";
  }
  return fmt::format("mode {}", mode);
}

PayloadBytes Heartbeat::body() const {
  return RecordWriter(9)
      .put(0, custom_mode)
      .put(4, type)
      .put(5, autopilot)
      .put(6, base_mode)
      .put(7, status)
      .put(8, std::uint8_t{3})
      .take();
}
Heartbeat Heartbeat::of(const MavlinkPayload& p) {
  return {p.at<std::uint32_t>(0), p.at<std::uint8_t>(4), p.at<std::uint8_t>(5), p.at<std::uint8_t>(6),
          p.at<std::uint8_t>(7)};
}

PayloadBytes SystemStatus::body() const { return RecordWriter(31).put(30, battery_percent).take(); }
SystemStatus SystemStatus::of(const MavlinkPayload& p) { return {p.at<std::int8_t>(30)}; }

PayloadBytes Attitude::body() const {
  return RecordWriter(28).put(0, boot_ms).put(4, roll).put(8, pitch).put(12, yaw).take();
}

PayloadBytes LocalPosition::body() const {
  return RecordWriter(28).put(0, boot_ms).put(4, x).put(8, y).put(12, z).put(16, vx).put(20, vy).put(24, vz).take();
}

PayloadBytes Origin::body() const { return RecordWriter(20).put(0, latitude_e7).put(4, longitude_e7).take(); }

PayloadBytes TimeSync::body() const { return RecordWriter(16).put(0, tc1_ns).put(8, ts1_ns).take(); }
TimeSync TimeSync::of(const MavlinkPayload& p) { return {p.at<std::int64_t>(0), p.at<std::int64_t>(8)}; }

PayloadBytes VelocityTarget::body() const {
  return RecordWriter(53)
      .put(0, boot_ms)
      .put(16, vx)
      .put(20, vy)
      .put(24, vz)
      .put(40, yaw)
      .put(48, mask)
      .put(50, system)
      .put(51, component)
      .put(52, frame)
      .take();
}
VelocityTarget VelocityTarget::of(const MavlinkPayload& p) {
  return {p.at<std::uint32_t>(0), p.at<float>(16),        p.at<float>(20),
          p.at<float>(24),        p.at<float>(40),        p.at<std::uint16_t>(48),
          p.at<std::uint8_t>(50), p.at<std::uint8_t>(51), p.at<std::uint8_t>(52)};
}

PayloadBytes CommandLong::body() const {
  RecordWriter out(33);
  for (std::size_t i = 0; i < params.size(); ++i) out.put(4 * i, params[i]);
  return out.put(28, command).put(30, system).put(31, component).take();
}
CommandLong CommandLong::of(const MavlinkPayload& p) {
  CommandLong c;
  for (std::size_t i = 0; i < c.params.size(); ++i) c.params[i] = p.at<float>(4 * i);
  c.command = p.at<std::uint16_t>(28);
  c.system = p.at<std::uint8_t>(30);
  c.component = p.at<std::uint8_t>(31);
  return c;
}

PayloadBytes CommandAck::body() const { return RecordWriter(10).put(0, command).put(2, result).take(); }

PayloadBytes MissionRequestList::body() const {
  return RecordWriter(3).put(0, system).put(1, component).put(2, kind).take();
}
MissionRequestList MissionRequestList::of(const MavlinkPayload& p) {
  return {p.at<std::uint8_t>(0), p.at<std::uint8_t>(1), kind_at(p, 2)};
}

PayloadBytes MissionCount::body() const {
  return RecordWriter(9).put(0, count).put(2, system).put(3, component).put(4, kind).take();
}
MissionCount MissionCount::of(const MavlinkPayload& p) {
  return {p.at<std::uint16_t>(0), p.at<std::uint8_t>(2), p.at<std::uint8_t>(3), kind_at(p, 4)};
}

PayloadBytes MissionRequest::body() const {
  return RecordWriter(5).put(0, sequence).put(2, system).put(3, component).put(4, kind).take();
}
MissionRequest MissionRequest::of(const MavlinkPayload& p) {
  return {p.at<std::uint16_t>(0), p.at<std::uint8_t>(2), p.at<std::uint8_t>(3), kind_at(p, 4)};
}

PayloadBytes MissionItem::body() const {
  RecordWriter out(38);
  for (std::size_t i = 0; i < params.size(); ++i) out.put(4 * i, params[i]);
  out.put(16, x).put(20, y).put(24, z).put(28, sequence).put(30, command);
  return out.put(32, system).put(33, component).put(34, frame).put(35, current).put(36, goes_on).put(37, kind).take();
}
MissionItem MissionItem::of(const MavlinkPayload& p) {
  MissionItem item;
  for (std::size_t i = 0; i < item.params.size(); ++i) item.params[i] = p.at<float>(4 * i);
  item.x = p.at<std::int32_t>(16);
  item.y = p.at<std::int32_t>(20);
  item.z = p.at<float>(24);
  item.sequence = p.at<std::uint16_t>(28);
  item.command = p.at<std::uint16_t>(30);
  item.system = p.at<std::uint8_t>(32);
  item.component = p.at<std::uint8_t>(33);
  item.frame = p.at<std::uint8_t>(34);
  item.current = p.at<std::uint8_t>(35);
  item.goes_on = p.at<std::uint8_t>(36);
  item.kind = kind_at(p, 37);
  return item;
}

PayloadBytes MissionAck::body() const {
  return RecordWriter(8).put(0, system).put(1, component).put(2, result).put(3, kind).take();
}
MissionAck MissionAck::of(const MavlinkPayload& p) {
  return {p.at<std::uint8_t>(0), p.at<std::uint8_t>(1), p.at<std::uint8_t>(2), kind_at(p, 3)};
}

PayloadBytes MissionItemReached::body() const { return RecordWriter(2).put(0, sequence).take(); }

PayloadBytes StatusText::body() const { return RecordWriter(54).put(0, severity).put_text(1, kLongest, text).take(); }
StatusText StatusText::of(const MavlinkPayload& p) {
  StatusText status{p.at<std::uint8_t>(0), {}};
  for (std::size_t i = 1; i <= kLongest && p.at<char>(i) != 0; ++i) status.text.push_back(p.at<char>(i));
  return status;
}

PayloadBytes NamedValue::body() const {
  return RecordWriter(18).put(0, boot_ms).put(4, value).put_text(8, 10, name).take();
}

PayloadBytes ObstacleDistance::body() const {
  RecordWriter out(167);
  out.put(0, time_us);
  for (std::size_t i = 0; i < kDirections; ++i) out.put(8 + 2 * i, cm[i]);
  constexpr std::uint8_t kUltrasound = 1, kDegrees = 5;
  return out.put(152, min_cm).put(154, max_cm).put(156, kUltrasound).put(157, kDegrees).put(166, kBodyFrd).take();
}
ObstacleDistance ObstacleDistance::of(const MavlinkPayload& p) {
  ObstacleDistance o;
  o.time_us = p.at<std::uint64_t>(0);
  for (std::size_t i = 0; i < kDirections; ++i) o.cm[i] = p.at<std::uint16_t>(8 + 2 * i);
  o.min_cm = p.at<std::uint16_t>(152);
  o.max_cm = p.at<std::uint16_t>(154);
  return o;
}

PayloadBytes ObstacleDistance3d::body() const {
  constexpr std::uint8_t kUltrasound = 1;
  return RecordWriter(28)
      .put(0, boot_ms)
      .put(4, x)
      .put(8, y)
      .put(12, z)
      .put(16, min_m)
      .put(20, max_m)
      .put(24, number)
      .put(26, kUltrasound)
      .put(27, kBodyFrd)
      .take();
}

PayloadBytes VisionDelta::body() const {
  RecordWriter out(44);
  out.put(0, time_us).put(8, since_us).put(40, confidence);
  for (std::size_t i = 0; i < 3; ++i) out.put(16 + 4 * i, turned[i]).put(28 + 4 * i, moved[i]);
  return out.take();
}
VisionDelta VisionDelta::of(const MavlinkPayload& p) {
  VisionDelta d{.time_us = p.at<std::uint64_t>(0), .since_us = p.at<std::uint64_t>(8), .confidence = p.at<float>(40)};
  for (std::size_t i = 0; i < 3; ++i) {
    d.turned[i] = p.at<float>(16 + 4 * i);
    d.moved[i] = p.at<float>(28 + 4 * i);
  }
  return d;
}

}  // namespace isobath::mavlink
