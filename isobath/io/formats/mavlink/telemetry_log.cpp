#include <algorithm>
#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/mavlink/mavlink_frames.hpp>
#include <isobath/io/formats/mavlink/mavlink_vehicle.hpp>
#include <isobath/io/formats/mavlink/telemetry_log.hpp>
#include <map>

namespace isobath {
namespace {

constexpr std::size_t kStampBytes = 8;
constexpr std::uint64_t kFirstYear = 946'684'800'000'000, kLastYear = 4'102'444'800'000'000;  // 2000, 2100, us
constexpr std::uint64_t kDayOfMicroseconds = 86'400'000'000;

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

class TelemetryLog final : public LogSource {
 public:
  TelemetryLog(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "MAVLink telemetry log"), config_(config), vehicle_(config_, report_) {
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
      if (auto event = vehicle_.take(time, frame)) return event;
    }
    tell_counts();
    return {};
  }

  void look_ahead();
  void tell_counts();

  InputConfig config_;
  MavlinkVehicle vehicle_;
  std::map<std::pair<std::uint8_t, std::uint32_t>, std::uint64_t> counts_;  ///< by system and message
};

/// Finds out of the first bytes which messages of one kind the log has.
void TelemetryLog::look_ahead() {
  constexpr std::size_t kLook = 1 << 18;
  MavlinkHabits habits{.system = vehicle_.system()};
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
        if (states && !habits.system) habits.system = frame.system;
        const bool own = frame.system == habits.system;
        habits.local = habits.local || (id == MavlinkId::kLocalPositionNed && own);
        habits.pressure2 = habits.pressure2 || (id == MavlinkId::kScaledPressure2 && own);
        habits.distance = habits.distance || (id == MavlinkId::kDistanceSensor && own);
      }
    }
    bytes = bytes.subspan(found.bytes);
  }
  vehicle_.expect(habits);
}

void TelemetryLog::tell_counts() {
  constexpr const char* kNotUsed = ", not used";
  const auto used = [](std::uint32_t id) {
    switch (static_cast<MavlinkId>(id)) {
      case MavlinkId::kAttitude: return ", used as attitudes";
      case MavlinkId::kLocalPositionNed:
      case MavlinkId::kGlobalPositionInt:
      case MavlinkId::kOdometry: return ", used as positions";
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
    const bool own = system == vehicle_.system().value_or(system);
    const char* note = own && vehicle_.uses(static_cast<MavlinkId>(id)) ? used(id) : kNotUsed;
    report_.details[own ? name : fmt::format("{} of system {}", name, system)] = fmt::format("{}{}", count, note);
  }
  if (const auto system = vehicle_.system()) report_.details["vehicle"] = fmt::format("system {}", *system);
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
