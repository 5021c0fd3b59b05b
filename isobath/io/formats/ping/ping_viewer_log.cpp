#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/sample_arena.hpp>
#include <isobath/io/formats/ping/ping_device.hpp>
#include <isobath/io/formats/ping/ping_logs.hpp>

namespace isobath {
namespace {

constexpr std::string_view kMagic = "PingViewer sensor log file";
constexpr std::string_view kClock = "00:00:00.000";  // the shape of a time stamp: 0 stands for a digit
constexpr std::uint32_t kNull = 0xffffffff;
constexpr std::uint32_t kMaxText = 4096;
constexpr std::size_t kMaxLogHeader = 7 * (kMaxText + 4) + 16;
constexpr std::size_t kMaxRecord = 1 << 16;  // bytes received at once; the viewer's own buffer is a sixth of this

/// Encoding of the texts: UTF-16BE as written by Qt, or UTF-8 as written by others.
class TextCoding {
 public:
  TextCoding() = default;
  explicit TextCoding(bool wide) : unit_(wide ? 2 : 1) {}

  [[nodiscard]] std::size_t stamp_bytes() const { return 4 + kClock.size() * unit_; }
  [[nodiscard]] std::size_t unit() const { return unit_; }
  /// The low byte of each character.
  [[nodiscard]] char at(Bytes text, std::size_t i) const { return static_cast<char>(text[i * unit_ + unit_ - 1]); }
  [[nodiscard]] bool matches(Bytes text, std::string_view expected) const {
    if (text.size() < expected.size() * unit_) return false;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      if (at(text, i) != expected[i] || (unit_ == 2 && text[2 * i] != std::byte{0})) return false;
    }
    return true;
  }

 private:
  std::size_t unit_ = 2;
};

/// The time of day of a stamp that begins at the first byte; empty: none.
std::optional<Duration> stamp(Bytes bytes, TextCoding coding) {
  if (bytes.size() < coding.stamp_bytes()) return {};
  if (ByteCursor(bytes).big<std::uint32_t>() != kClock.size() * coding.unit()) return {};
  const Bytes text = bytes.subspan(4, kClock.size() * coding.unit());
  std::array<int, 4> part{};  // hours, minutes, seconds, milliseconds
  std::size_t p = 0;
  for (std::size_t i = 0; i < kClock.size(); ++i) {
    const char c = coding.at(text, i);
    if (coding.unit() == 2 && text[2 * i] != std::byte{0}) return {};
    if (kClock[i] != '0') {
      if (c != kClock[i]) return {};
      ++p;
    } else if (c >= '0' && c <= '9') {
      part[p] = part[p] * 10 + (c - '0');
    } else {
      return {};
    }
  }
  if (part[0] > 23 || part[1] > 59 || part[2] > 59) return {};
  return std::chrono::hours(part[0]) + std::chrono::minutes(part[1]) + std::chrono::seconds(part[2]) +
         std::chrono::milliseconds(part[3]);
}

/// Start of the first stamp at or after `from`; bytes.size() if there is none.
std::size_t find_stamp(Bytes bytes, std::size_t from, TextCoding coding) {
  const char size = static_cast<char>(kClock.size() * coding.unit());
  const std::array<char, 4> prefix{0, 0, 0, size};
  const std::string_view text = text_of(bytes);
  for (std::size_t at = from;; ++at) {
    at = text.find(std::string_view(prefix.data(), prefix.size()), at);
    if (at == std::string_view::npos) return bytes.size();
    if (stamp(bytes.subspan(at), coding)) return at;
  }
}

class PingViewerLog final : public LogSource {
 public:
  PingViewerLog(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "Ping Viewer log"), device_(config, report_), carried_(ping_frame_at) {
    read_header();
    report_.details["time"] = "since the start of the log, which has no date";
  }

 private:
  std::optional<Event> read() override {
    for (;;) {
      if (auto event = from_carried()) return event;
      if (auto event = from_record()) return event;
      if (!next_record() && !finish()) return {};
    }
  }

  void read_header();
  std::string text(ByteCursor& cursor, const char* key);
  std::optional<Event> from_record();
  std::optional<Event> from_carried();
  bool next_record();
  bool finish();
  std::size_t record_end(Bytes view, std::size_t content, std::uint32_t promised) const;

  PingDevice device_;
  TextCoding coding_;
  DayClock clock_;
  Time time_{};               ///< time of the record
  Bytes record_;              ///< unread rest of the record
  std::uint64_t offset_ = 0;  ///< position of record_ in the input
  std::shared_ptr<const void> owner_;
  FrameStream carried_;  ///< frames that are spread over several records
  SampleArena arena_;
  bool finished_ = false;
};

std::string PingViewerLog::text(ByteCursor& cursor, const char* key) {
  const std::uint64_t at = cursor.position();
  const auto size = cursor.big<std::uint32_t>();
  if (size == kNull) return {};
  if (size > kMaxText) {
    throw Error(fmt::format("a text of {} bytes in the header", size), {input_.name(), at, {}, {}, key},
                fmt::format("up to {} bytes", kMaxText), "the log is damaged from its start");
  }
  const Bytes raw = cursor.take(size);
  std::string result;
  for (std::size_t i = 0; i < raw.size() / coding_.unit(); ++i) {
    const char c = coding_.at(raw, i);
    result += c >= 0x20 && c < 0x7f ? c : '?';
  }
  return result;
}

void PingViewerLog::read_header() {
  const Bytes head = input_.want(kMaxLogHeader);
  ByteCursor cursor(head);
  coding_ = TextCoding(head.size() > 4 && head[4] == std::byte{0});
  text(cursor, "magic");
  const auto version = cursor.big<std::uint32_t>();
  std::array<std::string, 5> texts;
  constexpr std::array<const char*, 5> kKeys{"git hash", "build date", "tag", "system", "system version"};
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i] = text(cursor, kKeys[i]);
  const auto family = cursor.big<std::int32_t>();
  const auto type = cursor.big<std::int32_t>();
  if (!cursor.ok()) throw Error("ends within its header", {input_.name(), head.size()}, {}, "the log was cut off");
  if (version != 1) report_.details["version"] = fmt::format("{}, read as version 1", version);
  report_.details["recorder"] = fmt::format("Ping Viewer {} ({}) on {} {}", texts[2], texts[0], texts[3], texts[4]);
  if (family <= 1 && (type == 1 || type == 2)) device_.set_type(static_cast<PingDeviceType>(type));
  input_.advance(cursor.position());
  if (input_.want(1).empty()) {
    throw Error("ends after its header: nothing was recorded", {input_.name(), input_.position()});
  }
}

// A record is a stamp, a length, and that many bytes. The length is used if the next stamp follows; otherwise the
// record ends at the next stamp.
bool PingViewerLog::next_record() {
  const Bytes view = input_.want(kMaxRecord);
  if (view.empty()) return false;
  const auto time = stamp(view, coding_);
  if (!time) {
    const std::size_t skipped = find_stamp(view, 1, coding_);
    // A stamp may begin in the last bytes of the view.
    const std::size_t sure = view.size() >= kMaxRecord ? view.size() - coding_.stamp_bytes() : view.size();
    report_.add_damage(input_.position(), std::min(skipped, sure), "no record starts here");
    input_.advance(std::min(skipped, sure));
    return true;
  }
  const std::size_t content = coding_.stamp_bytes() + 4;
  if (view.size() < content) {
    report_.add_damage(input_.position(), view.size(), "record cut off");
    input_.advance(view.size());
    return true;
  }
  const auto promised = ByteCursor(view, coding_.stamp_bytes()).big<std::uint32_t>();
  const std::size_t end = promised == kNull ? content : record_end(view, content, promised);
  if (end < content || (end == content && promised != kNull && promised > 0)) {
    report_.add_damage(input_.position(), end, "record shorter than its stated length");
    input_.advance(end);
    return true;
  }
  time_ = clock_.at(*time);
  record_ = view.subspan(content, end - content);
  offset_ = input_.position() + content;
  owner_ = input_.owner();
  input_.advance(end);
  return true;
}

std::size_t PingViewerLog::record_end(Bytes view, std::size_t content, std::uint32_t promised) const {
  const std::size_t end = content + std::size_t{promised};
  if (end == view.size() || (end < view.size() && stamp(view.subspan(end), coding_))) return end;
  const std::size_t reach = std::min(end + coding_.stamp_bytes() - 1, view.size());  // a stamp may begin before the end
  return std::min({end, view.size(), find_stamp(view.first(reach), coding_.stamp_bytes(), coding_)});
}

/// Complete frames at the start of the record are viewed in place; the rest waits for the next record.
std::optional<Event> PingViewerLog::from_record() {
  while (!record_.empty()) {
    const Framing found = ping_frame_at(record_);
    const bool whole = found.kind == Framing::Kind::kFrame;
    if (whole && carried_.waiting() > 0) {  // a record that begins with a frame does not continue the bytes that wait
      carried_.finish();
      if (auto event = from_carried()) return event;
    }
    if (!whole) {
      carried_.push(record_, time_, offset_);
      record_ = {};
      return from_carried();
    }
    const Bytes frame = record_.first(found.bytes);
    record_ = record_.subspan(found.bytes);
    offset_ += found.bytes;
    if (auto event = device_.event(frame, time_, owner_)) return event;
  }
  return {};
}

std::optional<Event> PingViewerLog::from_carried() {
  while (const auto found = carried_.next(report_)) {
    std::byte* copy = arena_.take(found->frame.size());
    std::copy(found->frame.begin(), found->frame.end(), copy);
    if (auto event = device_.event({copy, found->frame.size()}, found->time, arena_.owner())) return event;
  }
  return {};
}

bool PingViewerLog::finish() {
  const bool more = !finished_;
  finished_ = true;
  carried_.finish();
  return more;
}

}  // namespace

bool looks_like_ping_viewer_log(Bytes head) {
  if (head.size() < 8) return false;
  const TextCoding coding(head[4] == std::byte{0});
  return ByteCursor(head).big<std::uint32_t>() == kMagic.size() * coding.unit() &&
         coding.matches(head.subspan(4), kMagic);
}

std::unique_ptr<Source> open_ping_viewer_log(ByteWindow input, const InputConfig& config) {
  return std::make_unique<PingViewerLog>(std::move(input), config);
}

}  // namespace isobath
