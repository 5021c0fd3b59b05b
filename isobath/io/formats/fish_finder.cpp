#include <algorithm>
#include <cmath>
#include <deque>
#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/formats/fish_finder.hpp>
#include <isobath/io/input/scanning_head.hpp>
#include <isobath/io/input/survey_input.hpp>
#include <map>
#include <numbers>

namespace isobath {
namespace {

constexpr Angle kFishFinderBeam = Angle::degrees(20);  // of a transducer of 200 kHz
constexpr double kFoot = 0.3048, kKnot = 1852.0 / 3600;

/// What both devices state with each ping.
struct FishFinderPing {
  Time time;
  double easting = 0, northing = 0;
  GeoPoint point;
  Angle heading;
  double speed = 0;  ///< m/s
  double depth_m = 0;
};

/// Makes the events of pings.
class FishFinder : public LogSource {
 protected:
  FishFinder(ByteWindow input, const char* format, const InputConfig& config)
      : LogSource(std::move(input), format), config_(config), fixes_(config_.survey, report_) {}

  void add(const FishFinderPing& ping) {
    const bool moved = ping.easting != easting_ || ping.northing != northing_;
    if (moved) {
      easting_ = ping.easting;
      northing_ = ping.northing;
      auto fix = fixes_.fix(ping.time, ping.point, Rotation::from_heading(ping.heading));
      if (!fix) reject("position that is missing or impossible");
      if (fix && std::isfinite(ping.speed)) {
        fix->v_WB = Eigen::Vector3d(ping.speed * cos(ping.heading), ping.speed * sin(ping.heading), 0);
      }
      if (fix) ready_.emplace_back(*std::move(fix));
    }
    if (!(ping.depth_m > 0) || !(ping.depth_m < kAnyDepth)) {
      reject("depth of 0: no bottom");
      return;
    }
    RangeReading reading;
    reading.time = ping.time;
    reading.range_m = ping.depth_m;
    reading.max_range_m = kAnyDepth;
    reading.width = beam_size(config_, {kFishFinderBeam, {}}).width;
    reading.X_BS = looking_down(config_.survey.transducer_depth_m);
    ready_.emplace_back(reading);
  }

  InputConfig config_;
  std::deque<Event> ready_;

 private:
  std::optional<Event> read() override {
    while (ready_.empty() && advance()) {
    }
    if (ready_.empty()) return {};
    Event event = std::move(ready_.front());
    ready_.pop_front();
    return event;
  }
  /// Reads on; false at the end.
  virtual bool advance() = 0;

  BoatFixes fixes_;
  double easting_ = std::nan(""), northing_ = std::nan("");
};

// Lowrance.

constexpr std::size_t kSl2Head = 8, kSl2Frame = 144;

/// The head of a frame, at its offset in the file.
struct Sl2Frame {
  explicit Sl2Frame(Bytes bytes) : view(bytes) {}
  [[nodiscard]] bool valid(std::uint64_t offset) const {
    return view.size() >= kSl2Frame && view.at<std::uint32_t>(0) == static_cast<std::uint32_t>(offset) &&
           length() >= kSl2Frame && channel() < 16 && view.at<std::uint16_t>(34) <= length();
  }
  [[nodiscard]] std::size_t length() const { return view.at<std::uint16_t>(28); }
  [[nodiscard]] unsigned channel() const { return view.at<std::uint16_t>(32); }

  RecordView view;
};

Angle lowrance_heading(const RecordView& view) {
  const float heading = view.at<float>(128), track = view.at<float>(120);
  const float used = heading != 0 ? heading : track;
  return Angle::radians(std::isfinite(used) && std::abs(used) < 100 ? used : 0);
}

GeoPoint from_spherical_mercator(double easting, double northing) {
  constexpr double kRadius = 6356752.3142, kDegrees = 180 / std::numbers::pi;
  return {(2 * std::atan(std::exp(northing / kRadius)) - std::numbers::pi / 2) * kDegrees,
          easting / kRadius * kDegrees};
}

class Lowrance final : public FishFinder {
 public:
  Lowrance(ByteWindow input, const InputConfig& config) : FishFinder(std::move(input), "Lowrance .sl2", config) {
    constexpr std::size_t kLook = 1 << 18;
    const Bytes seen = input_.want(kLook), head = seen.first(std::min(seen.size(), kLook));
    std::optional<unsigned> first;
    for (std::size_t at = kSl2Head; at + kSl2Frame <= head.size();) {
      const Sl2Frame frame(head.subspan(at, kSl2Frame));
      if (!frame.valid(at)) break;
      if (!first) first = frame.channel();
      if (frame.channel() == 0) first = 0;
      at += frame.length();
    }
    channel_ = first.value_or(0);
    input_.advance(std::min(kSl2Head, head.size()));
  }

 private:
  bool advance() override {
    const Bytes view = input_.want(kSl2Frame);
    if (view.empty()) return tell_counts(), false;
    const std::uint64_t offset = input_.position();
    const Sl2Frame frame(view.first(std::min(view.size(), kSl2Frame)));
    if (!frame.valid(offset)) return skip_damage(offset), true;
    take(frame);
    const std::size_t here = input_.want(frame.length()).size();
    if (here < frame.length()) report_.details["cut off"] = "the file ends within the echoes of its last frame";
    input_.advance(std::min(here, frame.length()));
    return true;
  }

  void take(const Sl2Frame& frame) {
    ++counts_[frame.channel()];
    if (frame.channel() != channel_) return;
    const RecordView& view = frame.view;
    FishFinderPing ping;
    ping.time = Time{std::chrono::milliseconds(view.at<std::uint32_t>(140))};
    ping.easting = view.at<std::int32_t>(108);
    ping.northing = view.at<std::int32_t>(112);
    ping.point = from_spherical_mercator(ping.easting, ping.northing);
    ping.heading = lowrance_heading(view);
    ping.speed = view.at<float>(100) * kKnot;
    ping.depth_m = view.at<float>(64) * kFoot;
    add(ping);
  }

  /// Moves to the next position at which a frame states its own offset.
  void skip_damage(std::uint64_t offset) {
    const Bytes view = input_.want(1 << 16);
    std::size_t at = 1;
    while (at + kSl2Frame <= view.size() && !Sl2Frame(view.subspan(at, kSl2Frame)).valid(offset + at)) ++at;
    if (at + kSl2Frame > view.size() && view.size() < (1 << 16)) at = view.size();  // the end
    report_.add_damage(offset, at, "no valid frame");
    input_.advance(at);
  }

  void tell_counts() {
    for (const auto& [channel, count] : counts_) {
      const char* const name = channel == 0   ? "primary"
                               : channel == 1 ? "secondary"
                               : channel == 2 ? "downscan"
                               : channel == 5 ? "side scan"
                                              : "other";
      report_.details[fmt::format("channel {}", channel)] =
          fmt::format("{}, {} frames, {}", name, count, channel == channel_ ? "used for depths" : "not used");
    }
  }

  unsigned channel_ = 0;
  std::map<unsigned, std::uint64_t> counts_;
};

// Humminbird.

constexpr std::string_view kPingMark("\xC0\xDE\xAB\x21", 4);
constexpr std::size_t kMaxEchoes = 1 << 20, kMaxPingHead = 512;

struct HumminbirdHead {
  std::size_t head_bytes = 0, echoes = 0;
  std::map<std::uint8_t, std::uint32_t> values;  ///< by tag
};

/// Empty: not a head, or not complete in these bytes (`incomplete`).
std::optional<HumminbirdHead> humminbird_head(Bytes bytes, bool& incomplete) {
  constexpr std::uint8_t kEnd = 0x21, kEchoes = 0xA0, kFourBytes = 0x80, kOneByte = 0x40;
  HumminbirdHead head;
  ByteCursor cursor(bytes.first(std::min(bytes.size(), kMaxPingHead)), kPingMark.size());
  while (cursor.ok()) {
    const auto tag = cursor.little<std::uint8_t>();
    if (!cursor.ok()) break;
    if (tag == kEnd) {
      head.head_bytes = cursor.position();
      head.echoes = head.values[kEchoes];
      return head.echoes <= kMaxEchoes ? std::optional(std::move(head)) : std::nullopt;
    }
    if (tag < kOneByte) return {};
    head.values[tag] = tag >= kFourBytes ? cursor.big<std::uint32_t>() : cursor.big<std::uint8_t>();
  }
  incomplete = bytes.size() < kMaxPingHead;
  return {};
}

Framing humminbird_ping_at(Bytes bytes) {
  const std::string_view text = text_of(bytes);
  const std::size_t begun = std::min(text.size(), kPingMark.size());
  if (text.substr(0, begun) != kPingMark.substr(0, begun)) return noise_until(bytes, kPingMark[0]);
  if (begun < kPingMark.size()) return {Framing::Kind::kIncomplete, kPingMark.size()};
  bool incomplete = false;
  const auto head = humminbird_head(bytes, incomplete);
  if (!head) {
    return incomplete ? Framing{Framing::Kind::kIncomplete, kMaxPingHead} : noise_until(bytes, kPingMark[0]);
  }
  const std::size_t length = head->head_bytes + head->echoes;
  return {bytes.size() < length ? Framing::Kind::kIncomplete : Framing::Kind::kFrame, length};
}

GeoPoint from_humminbird(double easting, double northing) {
  constexpr double kRadius = 6378388, kFlattening = 1.0067642927, kDegrees = 180 / std::numbers::pi;
  const double spherical = 2 * std::atan(std::exp(northing / kRadius)) - std::numbers::pi / 2;
  return {std::atan(std::tan(spherical) * kFlattening) * kDegrees, easting / kRadius * kDegrees};
}

class Humminbird final : public FishFinder {
 public:
  Humminbird(ByteWindow input, const InputConfig& config, Time start)
      : FishFinder(std::move(input), "Humminbird .SON", config), start_(start) {}

 private:
  bool advance() override {
    const auto frame = next_frame(input_, humminbird_ping_at, report_);
    if (!frame) return false;
    bool incomplete = false;
    const auto head = humminbird_head(*frame, incomplete);
    if (head) take(*head);
    return true;
  }

  void take(const HumminbirdHead& head) {
    constexpr std::uint8_t kMilliseconds = 0x81, kEasting = 0x82, kNorthing = 0x83, kHeading = 0x84, kSpeed = 0x85,
                           kDepth = 0x87, kFrequency = 0x92;
    constexpr double kTenth = 0.1, kCentimetre = 0.01;
    const auto value = [&](std::uint8_t tag) {
      const auto found = head.values.find(tag);
      return found == head.values.end() ? 0U : found->second;
    };
    FishFinderPing ping;
    ping.time = start_ + std::chrono::milliseconds(value(kMilliseconds));
    ping.easting = static_cast<std::int32_t>(value(kEasting));
    ping.northing = static_cast<std::int32_t>(value(kNorthing));
    ping.point = from_humminbird(ping.easting, ping.northing);
    ping.heading = Angle::degrees((value(kHeading) & 0xFFFF) * kTenth);
    ping.speed = (value(kSpeed) & 0xFFFF) * kCentimetre;
    ping.depth_m = value(kDepth) * kTenth;
    report_.note_setting("sonar", fmt::format("{:g} kHz", value(kFrequency) / 1000.0));
    add(ping);
  }

  Time start_;
};

/// When the recording of a .SON began, by the only file of settings in its folder.
Time start_of(const std::filesystem::path& file) {
  constexpr std::uint64_t kSettingsBytes = 64;
  constexpr std::size_t kTimeAt = 20;
  std::error_code failed;
  std::vector<std::filesystem::path> found;
  for (const auto& entry :
       std::filesystem::directory_iterator(file.parent_path().empty() ? "." : file.parent_path(), failed)) {
    const std::string ending = entry.path().extension().string();
    if ((ending == ".DAT" || ending == ".dat") && entry.is_regular_file(failed) &&
        entry.file_size(failed) == kSettingsBytes) {
      found.push_back(entry.path());
    }
  }
  if (found.size() != 1) return {};
  const std::vector<std::uint8_t> bytes = read_whole_file(found[0], kSettingsBytes);
  ByteCursor cursor(std::as_bytes(std::span(bytes)), kTimeAt);
  return Time{std::chrono::seconds(cursor.big<std::uint32_t>())};
}

}  // namespace

bool looks_like_lowrance(Bytes head) {
  const RecordView view(head);
  if (head.size() < kSl2Head + kSl2Frame || view.at<std::uint16_t>(0) != 2 || view.at<std::uint16_t>(6) != 0)
    return false;
  return Sl2Frame(head.subspan(kSl2Head, kSl2Frame)).valid(kSl2Head);
}

std::unique_ptr<Source> open_lowrance(ByteWindow input, const InputConfig& config) {
  return std::make_unique<Lowrance>(std::move(input), config);
}

bool looks_like_humminbird(Bytes head) {
  return text_of(head).starts_with(kPingMark) && holds_frame(head, humminbird_ping_at);
}

std::unique_ptr<Source> open_humminbird(ByteWindow input, const InputConfig& config, Time start) {
  return std::make_unique<Humminbird>(std::move(input), config, start);
}

std::unique_ptr<Source> open_humminbird_file(const std::filesystem::path& file, const InputConfig& config) {
  return open_humminbird(ByteWindow::open(file), config, start_of(file));
}

}  // namespace isobath
