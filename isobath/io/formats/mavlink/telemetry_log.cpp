#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/mavlink/mavlink_frames.hpp>
#include <isobath/io/formats/mavlink/telemetry_log.hpp>
#include <isobath/io/input/navigation_parts.hpp>
#include <isobath/io/input/scanning_head.hpp>
#include <map>

namespace isobath {
namespace {

constexpr std::size_t kStampBytes = 8;
constexpr std::uint64_t kFirstYear = 946'684'800'000'000, kLastYear = 4'102'444'800'000'000;  // 2000, 2100, us
constexpr std::uint64_t kDayOfMicroseconds = 86'400'000'000;
constexpr double kGravity = 9.80665;  // m/s2
constexpr Angle kPing1dBeam = Angle::degrees(25);

std::uint64_t stamp_at(Bytes bytes, std::size_t at) { return ByteCursor(bytes, at).big<std::uint64_t>(); }

/// Whether a stamp and the first byte of a frame stand at a position, or begin to at the end of the bytes.
bool frame_may_begin(Bytes bytes, std::size_t at) {
  if (at + kStampBytes >= bytes.size()) return true;
  const std::uint64_t stamp = stamp_at(bytes, at);
  const std::byte magic = bytes[at + kStampBytes];
  return stamp >= kFirstYear && stamp < kLastYear && (magic == std::byte{0xFE} || magic == std::byte{0xFD});
}

Framing stamped_frame_at(Bytes bytes) {
  const auto other = [&] {
    std::size_t at = 1;
    while (at < bytes.size() && !frame_may_begin(bytes, at)) ++at;
    return Framing{Framing::Kind::kNoise, at};
  };
  if (bytes.size() <= kStampBytes) return {Framing::Kind::kIncomplete, kStampBytes + 1};
  if (!frame_may_begin(bytes, 0)) return other();
  const Framing frame = mavlink_structure_at(bytes.subspan(kStampBytes));
  if (frame.kind == Framing::Kind::kNoise) return other();
  const std::size_t end = kStampBytes + frame.bytes;
  if (frame.kind == Framing::Kind::kIncomplete) return {Framing::Kind::kIncomplete, end};
  const auto parts = mavlink_frame(bytes.subspan(kStampBytes, frame.bytes));
  if (parts.checksum == MavlinkFrame::Checksum::kRight || bytes.size() == end) return {Framing::Kind::kFrame, end};
  if (bytes.size() <= end + kStampBytes) return {Framing::Kind::kIncomplete, end + kStampBytes + 1};
  const std::uint64_t next = stamp_at(bytes, end), own = stamp_at(bytes, 0);
  const bool follows = frame_may_begin(bytes, end) && (next > own ? next - own : own - next) < kDayOfMicroseconds;
  return follows ? Framing{Framing::Kind::kFrame, end} : other();
}

/// The direction of a MAV_SENSOR_ORIENTATION in the body; empty: one that is not a plain direction.
std::optional<Rotation> orientation_of(const MavlinkPayload& p, std::uint8_t orientation) {
  if (orientation < 8) return Rotation::from_heading(Angle::degrees(45.0 * orientation));
  if (orientation == 24 || orientation == 25) {
    return Rotation::from_heading_pitch_roll({}, Angle::degrees(orientation == 24 ? 90 : -90), {});
  }
  if (orientation != 100) return {};
  const Eigen::Quaterniond q(p.at<float>(22), p.at<float>(26), p.at<float>(30), p.at<float>(34));
  if (!(std::abs(q.norm() - 1) < 0.1)) return {};
  return Rotation::from_quaternion(q.normalized());
}

class TelemetryLog final : public LogSource {
 public:
  TelemetryLog(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "MAVLink telemetry log"), config_(config), parts_(config_.survey, report_) {
    if (config_.mavlink_system > 0) system_ = static_cast<std::uint8_t>(config_.mavlink_system);
    look_ahead();
  }

 private:
  std::optional<Event> read() override {
    while (const auto stamped = next_frame(input_, stamped_frame_at, report_)) {
      const MavlinkFrame frame = mavlink_frame(stamped->subspan(kStampBytes));
      if (frame.checksum == MavlinkFrame::Checksum::kWrong) {
        reject("frame with a wrong checksum");
        continue;
      }
      ++counts_[{frame.system, frame.id}];
      const Time time{std::chrono::microseconds(stamp_at(*stamped, 0))};
      if (auto event = take(time, frame)) return event;
    }
    tell_counts();
    return {};
  }

  std::optional<Event> refused(const char* reason) {
    reject(reason);
    return {};
  }
  void look_ahead();
  std::optional<Event> take(Time time, const MavlinkFrame& frame);
  std::optional<Event> local_position(Time time, const MavlinkPayload& p);
  std::optional<Event> global_position(Time time, const MavlinkPayload& p);
  std::optional<Event> distance(Time time, const MavlinkPayload& p);
  std::optional<Event> rangefinder(Time time, const MavlinkPayload& p);
  void pressure(Time time, const MavlinkPayload& p);
  void tell_counts();
  [[nodiscard]] Pose mounted_along(const Rotation& R_BS) const {
    return {R_BS, Eigen::Vector3d(config_.mount_m[0], config_.mount_m[1], config_.mount_m[2])};
  }

  InputConfig config_;
  NavigationParts parts_;
  std::optional<std::uint8_t> system_;
  bool has_local_ = false, has_pressure2_ = false, has_distance_ = false, states_depth_ = false, uses_global_ = false;
  std::optional<GeoPoint> global_;                                          ///< the newest GLOBAL_POSITION_INT
  std::map<std::pair<std::uint8_t, std::uint32_t>, std::uint64_t> counts_;  ///< by system and message
};

/// Finds out of the first bytes which messages of one kind the log has.
void TelemetryLog::look_ahead() {
  constexpr std::size_t kLook = 1 << 18;
  Bytes bytes = input_.want(kLook);
  bytes = bytes.first(std::min(bytes.size(), kLook));
  while (bytes.size() > kStampBytes) {
    const Framing found = stamped_frame_at(bytes);
    if (found.kind == Framing::Kind::kIncomplete) break;
    if (found.kind == Framing::Kind::kFrame) {
      const MavlinkFrame frame = mavlink_frame(bytes.subspan(kStampBytes, found.bytes - kStampBytes));
      const auto id = static_cast<MavlinkId>(frame.id);
      const bool states =
          id == MavlinkId::kAttitude || id == MavlinkId::kLocalPositionNed || id == MavlinkId::kGlobalPositionInt;
      if (frame.checksum == MavlinkFrame::Checksum::kRight) {
        if (states && !system_) system_ = frame.system;
        has_local_ = has_local_ || (id == MavlinkId::kLocalPositionNed && frame.system == system_);
        has_pressure2_ = has_pressure2_ || (id == MavlinkId::kScaledPressure2 && frame.system == system_);
        has_distance_ = has_distance_ || (id == MavlinkId::kDistanceSensor && frame.system == system_);
      }
    }
    bytes = bytes.subspan(found.bytes);
  }
}

std::optional<Event> TelemetryLog::take(Time time, const MavlinkFrame& frame) {
  const auto id = static_cast<MavlinkId>(frame.id);
  const bool states =
      id == MavlinkId::kAttitude || id == MavlinkId::kLocalPositionNed || id == MavlinkId::kGlobalPositionInt;
  if (!system_ && states) system_ = frame.system;
  if (frame.system != system_.value_or(frame.system)) return {};
  const MavlinkPayload p(frame.payload);
  switch (id) {
    case MavlinkId::kAttitude: {
      const auto roll = p.at<float>(4), pitch = p.at<float>(8), yaw = p.at<float>(12);
      if (!std::isfinite(roll) || !std::isfinite(pitch) || !std::isfinite(yaw))
        return refused("attitude that is not a number");
      return parts_.on_attitude(
          time, Rotation::from_heading_pitch_roll(Angle::radians(yaw), Angle::radians(pitch), Angle::radians(roll)));
    }
    case MavlinkId::kLocalPositionNed: return local_position(time, p);
    case MavlinkId::kGlobalPositionInt: return global_position(time, p);
    case MavlinkId::kGpsGlobalOrigin: {
      const GeoPoint origin{p.at<std::int32_t>(0) * 1e-7, p.at<std::int32_t>(4) * 1e-7};
      if (!uses_global_ && !report_.origin && valid(origin) && origin != GeoPoint{}) report_.origin = origin;
      return {};
    }
    case MavlinkId::kScaledPressure2: pressure(time, p); return {};
    case MavlinkId::kScaledPressure:
      if (!has_pressure2_) pressure(time, p);
      return {};
    case MavlinkId::kDistanceSensor: has_distance_ = true; return distance(time, p);
    case MavlinkId::kRangefinder: return has_distance_ ? std::nullopt : rangefinder(time, p);
  }
  return {};
}

std::optional<Event> TelemetryLog::local_position(Time time, const MavlinkPayload& p) {
  if (uses_global_) return {};  // two frames do not mix
  has_local_ = states_depth_ = true;
  const Eigen::Vector2d north_east(p.at<float>(4), p.at<float>(8));
  if (!report_.origin && global_ && north_east.norm() < 1e5) report_.origin = origin_from(*global_, north_east);
  parts_.on_depth(time, p.at<float>(12));
  return parts_.on_position(time, north_east, Eigen::Vector3d(p.at<float>(16), p.at<float>(20), p.at<float>(24)));
}

std::optional<Event> TelemetryLog::global_position(Time time, const MavlinkPayload& p) {
  constexpr double kDegree = 1e-7, kMillimetre = 1e-3, kCentimetre = 1e-2, kMaxLatitude = 80;
  const GeoPoint point{p.at<std::int32_t>(4) * kDegree, p.at<std::int32_t>(8) * kDegree};
  if (valid(point) && point != GeoPoint{} && std::abs(point.latitude_deg) < kMaxLatitude) global_ = point;
  if (has_local_) return {};
  states_depth_ = uses_global_ = true;
  parts_.on_depth(time, -p.at<std::int32_t>(16) * kMillimetre);
  const Eigen::Vector3d v(p.at<std::int16_t>(20), p.at<std::int16_t>(22), p.at<std::int16_t>(24));
  return parts_.on_position(time, point, v * kCentimetre);
}

void TelemetryLog::pressure(Time time, const MavlinkPayload& p) {
  constexpr double kHectopascal = 100;
  if (states_depth_ || has_local_) return;
  parts_.on_depth(time,
                  (p.at<float>(4) * kHectopascal - config_.surface_pressure_pa) / (config_.water_density * kGravity));
}

std::optional<Event> TelemetryLog::distance(Time time, const MavlinkPayload& p) {
  constexpr double kCentimetre = 0.01;
  const auto most = p.at<std::uint16_t>(6), now = p.at<std::uint16_t>(8);
  const auto R_BS = orientation_of(p, p.at<std::uint8_t>(12));
  if (p.at<std::uint8_t>(38) == 1) return refused("distance that the sensor calls invalid");
  if (!R_BS || most == 0) return refused("distance without a direction or a limit");
  RangeReading reading;
  reading.time = time;
  reading.max_range_m = most * kCentimetre;
  if (now < most) reading.range_m = now * kCentimetre;
  const float stated = p.at<float>(14);
  const bool is_stated = std::isfinite(stated) && stated > 0 && stated < 3;
  reading.width = beam_size(config_, {is_stated ? Angle::radians(stated) : kPing1dBeam, {}}).width;
  reading.X_BS = mounted_along(*R_BS);
  const auto quality = p.at<std::uint8_t>(38);
  if (quality > 1 && quality <= 100) reading.confidence = quality / 100.0F;
  return reading;
}

std::optional<Event> TelemetryLog::rangefinder(Time time, const MavlinkPayload& p) {
  const float range = p.at<float>(0);
  if (!std::isfinite(range) || range <= 0) return refused("distance of 0: no bottom");
  RangeReading reading;
  reading.time = time;
  reading.range_m = range;
  reading.max_range_m = kAnyDepth;
  reading.width = beam_size(config_, {kPing1dBeam, {}}).width;
  reading.X_BS = mounted_along(looking_down(0).rotation);
  return reading;
}

void TelemetryLog::tell_counts() {
  constexpr const char* kNotUsed = ", not used";
  const auto used = [](std::uint32_t id) {
    switch (static_cast<MavlinkId>(id)) {
      case MavlinkId::kAttitude: return ", used as attitudes";
      case MavlinkId::kLocalPositionNed:
      case MavlinkId::kGlobalPositionInt: return ", used as positions";
      case MavlinkId::kGpsGlobalOrigin: return ", used as the origin";
      case MavlinkId::kDistanceSensor:
      case MavlinkId::kRangefinder: return ", used as ranges";
      case MavlinkId::kScaledPressure:
      case MavlinkId::kScaledPressure2: return ", used as depths";
    }
    return kNotUsed;
  };
  for (const auto& [key, count] : counts_) {
    const auto [system, id] = key;
    const MavlinkKind* const kind = mavlink_kind(id);
    const std::string name = kind ? std::string(kind->name) : fmt::format("message {}", id);
    const bool vehicle = system == system_.value_or(system);
    const char* note = vehicle ? used(id) : kNotUsed;
    const auto kept = static_cast<MavlinkId>(id);
    const bool is_pressure = kept == MavlinkId::kScaledPressure || kept == MavlinkId::kScaledPressure2;
    if ((is_pressure && states_depth_) || (kept == MavlinkId::kGlobalPositionInt && has_local_) ||
        (kept == MavlinkId::kLocalPositionNed && uses_global_)) {
      note = kNotUsed;
    }
    report_.details[vehicle ? name : fmt::format("{} of system {}", name, system)] = fmt::format("{}{}", count, note);
  }
  if (system_) report_.details["vehicle"] = fmt::format("system {}", *system_);
  const auto has = [&](MavlinkId id) {
    return std::ranges::any_of(counts_,
                               [&](const auto& c) { return c.first.second == static_cast<std::uint32_t>(id); });
  };
  if (!has(MavlinkId::kDistanceSensor) && !has(MavlinkId::kRangefinder)) {
    report_.details["sonar"] = "none: the log has neither DISTANCE_SENSOR nor RANGEFINDER";
  }
}

}  // namespace

bool looks_like_telemetry_log(Bytes head) {
  constexpr int kFrames = 3;
  int good = 0;
  for (Bytes rest = head; good < kFrames && rest.size() > kStampBytes;) {
    const Framing found = stamped_frame_at(rest);
    if (found.kind != Framing::Kind::kFrame) break;  // a log begins with a frame
    const auto frame = mavlink_frame(rest.subspan(kStampBytes, found.bytes - kStampBytes));
    good += frame.checksum == MavlinkFrame::Checksum::kRight ? 1 : 0;
    rest = rest.subspan(found.bytes);
  }
  return good > 0;
}

std::unique_ptr<Source> open_telemetry_log(ByteWindow input, const InputConfig& config) {
  return std::make_unique<TelemetryLog>(std::move(input), config);
}

}  // namespace isobath
