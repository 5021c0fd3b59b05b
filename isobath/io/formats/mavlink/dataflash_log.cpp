#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/formats/mavlink/dataflash_log.hpp>
#include <isobath/io/input/navigation_parts.hpp>
#include <isobath/io/input/scanning_head.hpp>
#include <map>

namespace isobath {
namespace {

constexpr std::byte kHead1{0xA3}, kHead2{0x95}, kFormatType{128};
constexpr std::size_t kHeadBytes = 3, kFormatBytes = 89;
constexpr Angle kRangefinderBeam = Angle::degrees(25);  // of a Ping1D

/// A field of a record: its place and the letter of its format.
struct LogField {
  std::size_t offset = 0;
  char kind = 0;
};

/// Bytes of a format letter (ArduPilot, LogStructure.h); 0: unknown.
std::size_t field_bytes(char kind) {
  switch (kind) {
    case 'b':
    case 'B':
    case 'M': return 1;
    case 'h':
    case 'H':
    case 'c':
    case 'C':
    case 'g': return 2;
    case 'i':
    case 'I':
    case 'e':
    case 'E':
    case 'L':
    case 'f':
    case 'n': return 4;
    case 'd':
    case 'q':
    case 'Q': return 8;
    case 'N': return 16;
    case 'Z':
    case 'a': return 64;
    default: return 0;
  }
}

struct RecordFormat {
  std::size_t bytes = 0;  ///< of the whole record
  std::string name;
  std::map<std::string, LogField, std::less<>> fields;
};

/// A text in a field of fixed size.
std::string_view fixed_text(Bytes bytes) {
  const std::string_view text = text_of(bytes);
  return text.substr(0, text.find('\0'));
}

/// Empty: an impossible format.
std::optional<RecordFormat> read_format(Bytes record) {
  RecordFormat format;
  format.bytes = std::to_integer<std::size_t>(record[4]);
  format.name = fixed_text(record.subspan(5, 4));
  std::size_t offset = kHeadBytes;
  TextRow labels(fixed_text(record.subspan(25, 64)), ',');
  for (const char kind : fixed_text(record.subspan(9, 16))) {
    std::string_view label;
    if (field_bytes(kind) == 0) return {};
    if (labels.next(label)) format.fields.emplace(label, LogField{offset, kind});
    offset += field_bytes(kind);
  }
  if (offset != format.bytes || format.name.empty()) return {};
  return format;
}

/// The fields of one record by label.
class LogRecord {
 public:
  LogRecord(const RecordFormat& format, Bytes bytes) : format_(format), view_(bytes) {}

  [[nodiscard]] bool has(std::string_view label) const { return format_.fields.contains(label); }
  /// In the unit of the log's documentation; not a number if the record lacks the field.
  [[nodiscard]] double operator[](std::string_view label) const {
    constexpr double kHundredth = 0.01, kDegree = 1e-7;
    const auto found = format_.fields.find(label);
    if (found == format_.fields.end()) return std::nan("");
    const std::size_t at = found->second.offset;
    switch (found->second.kind) {
      case 'b': return view_.at<std::int8_t>(at);
      case 'B':
      case 'M': return view_.at<std::uint8_t>(at);
      case 'h': return view_.at<std::int16_t>(at);
      case 'H': return view_.at<std::uint16_t>(at);
      case 'c': return view_.at<std::int16_t>(at) * kHundredth;
      case 'C': return view_.at<std::uint16_t>(at) * kHundredth;
      case 'i': return view_.at<std::int32_t>(at);
      case 'I': return view_.at<std::uint32_t>(at);
      case 'e': return view_.at<std::int32_t>(at) * kHundredth;
      case 'E': return view_.at<std::uint32_t>(at) * kHundredth;
      case 'L': return view_.at<std::int32_t>(at) * kDegree;
      case 'f': return static_cast<double>(view_.at<float>(at));
      case 'd': return view_.at<double>(at);
      case 'q': return static_cast<double>(view_.at<std::int64_t>(at));
      case 'Q': return static_cast<double>(view_.at<std::uint64_t>(at));
      default: return std::nan("");
    }
  }

 private:
  const RecordFormat& format_;
  RecordView view_;
};

class DataflashLog final : public LogSource {
 public:
  DataflashLog(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "ArduPilot DataFlash log"), config_(config), parts_(config_.survey, report_) {}

 private:
  std::optional<Event> read() override {
    for (Bytes record = next_record(); !record.empty(); record = next_record()) {
      if (record[2] == kFormatType) {
        learn(record);
        continue;
      }
      const auto known = formats_.find(std::to_integer<std::uint8_t>(record[2]));
      ++counts_[known->second.name];
      if (auto event = take(known->second.name, LogRecord(known->second, record))) return event;
    }
    tell_counts();
    return {};
  }

  Bytes next_record();
  void learn(Bytes record);
  std::optional<Event> take(const std::string& name, const LogRecord& r);
  std::optional<Event> range(Time time, const LogRecord& r);
  void tell_counts();
  std::optional<Event> refused(const char* reason) {
    reject(reason);
    return {};
  }

  InputConfig config_;
  NavigationParts parts_;
  std::map<std::uint8_t, RecordFormat> formats_;
  std::map<std::string, std::uint64_t> counts_;
  bool has_filter_ = false;
};

/// The next record of a known type; empty at the end.
Bytes DataflashLog::next_record() {
  constexpr std::size_t kLook = 4096;
  for (;;) {
    const Bytes view = input_.want(kLook);
    if (view.empty()) return {};
    std::size_t length = 0;
    if (view.size() >= kHeadBytes && view[0] == kHead1 && view[1] == kHead2) {
      const auto known = formats_.find(std::to_integer<std::uint8_t>(view[2]));
      length = view[2] == kFormatType ? kFormatBytes : known != formats_.end() ? known->second.bytes : 0;
    }
    if (length > 0 && length <= view.size()) {
      input_.advance(length);
      return view.first(length);
    }
    const std::size_t skipped = std::min(noise_until(view, static_cast<char>(0xA3)).bytes, view.size());
    report_.add_damage(input_.position(), skipped, length > 0 ? "record reaches beyond the end" : "no valid record");
    input_.advance(skipped);
  }
}

void DataflashLog::learn(Bytes record) {
  const auto type = std::to_integer<std::uint8_t>(record[3]);
  auto format = read_format(record);
  if (!format) {
    reject("format of a record that cannot be read");
    return;
  }
  has_filter_ = has_filter_ || format->name == "XKF1" || format->name == "NKF1";
  if (record[3] != kFormatType) formats_[type] = *std::move(format);
}

std::optional<Event> DataflashLog::take(const std::string& name, const LogRecord& r) {
  const double since_start = r["TimeUS"] * 1e-6;
  if (!representable_seconds(since_start)) return {};
  const Time time{seconds(since_start)};
  if (name == "ATT") {
    const double roll = r["Roll"], pitch = r["Pitch"], yaw = r["Yaw"];
    if (!std::isfinite(roll + pitch + yaw)) return refused("attitude that is not a number");
    return parts_.on_attitude(
        time, Rotation::from_heading_pitch_roll(Angle::degrees(yaw), Angle::degrees(pitch), Angle::degrees(roll)));
  }
  if ((name == "XKF1" || name == "NKF1") && (!r.has("C") || r["C"] == 0)) {
    parts_.on_depth(time, r["PD"]);
    return parts_.on_position(time, Eigen::Vector2d(r["PN"], r["PE"]), Eigen::Vector3d(r["VN"], r["VE"], r["VD"]));
  }
  if (name == "POS" && counts_["XKF1"] + counts_["NKF1"] == 0) {
    parts_.on_depth(time, -r["RelHomeAlt"]);
    return parts_.on_position(time, GeoPoint{r["Lat"], r["Lng"]}, {});
  }
  if (name == "ORGN") {
    const GeoPoint origin{r["Lat"], r["Lng"]};
    if (has_filter_ && valid(origin) && origin != GeoPoint{}) report_.origin = origin;
  }
  return name == "RFND" ? range(time, r) : std::nullopt;
}

std::optional<Event> DataflashLog::range(Time time, const LogRecord& r) {
  constexpr double kGood = 4, kDown = 25, kUp = 24;
  const bool numbered = r.has("Dist1");
  const double distance = r[numbered ? "Dist1" : "Dist"], orientation = r[numbered ? "Orient1" : "Orient"];
  const double status = r[numbered ? "Stat1" : "Stat"];
  if (std::isfinite(status) && status != kGood) return refused("distance that the sensor calls invalid");
  if (!std::isfinite(distance) || distance <= 0) return refused("distance of 0: no echo");
  RangeReading reading;
  reading.time = time;
  reading.range_m = distance;
  reading.max_range_m = kAnyDepth;
  reading.width = beam_size(config_, {kRangefinderBeam, {}}).width;
  const Angle pitch = Angle::degrees(orientation == kUp ? 90 : -90);
  if (orientation >= 0 && orientation < 8) {
    reading.X_BS.rotation = Rotation::from_heading(Angle::degrees(45 * orientation));
  } else if (orientation == kDown || orientation == kUp || !std::isfinite(orientation)) {
    reading.X_BS.rotation = Rotation::from_heading_pitch_roll({}, pitch, {});
  } else {
    return refused("distance without a direction");
  }
  reading.X_BS.translation = Eigen::Vector3d(config_.mount_m[0], config_.mount_m[1], config_.mount_m[2]);
  return reading;
}

void DataflashLog::tell_counts() {
  const auto used = [&](const std::string& name) {
    if (name == "ATT") return ", used as attitudes";
    if (name == "XKF1" || name == "NKF1") return ", used as positions";
    if (name == "POS" && !counts_.contains("XKF1") && !counts_.contains("NKF1")) return ", used as positions";
    if (name == "ORGN") return ", used as the origin";
    return name == "RFND" ? ", used as ranges" : ", not used";
  };
  for (const auto& [name, count] : counts_) {
    if (count > 0) report_.details[name] = fmt::format("{}{}", count, used(name));
  }
  if (counts_["RFND"] == 0) report_.details["sonar"] = "none: the log has no RFND";
}

}  // namespace

bool looks_like_dataflash_log(Bytes head) {
  return head.size() >= kFormatBytes && head[0] == kHead1 && head[1] == kHead2 && head[2] == kFormatType &&
         read_format(head.first(kFormatBytes)).has_value();
}

std::unique_ptr<Source> open_dataflash_log(ByteWindow input, const InputConfig& config) {
  return std::make_unique<DataflashLog>(std::move(input), config);
}

}  // namespace isobath
