#include <algorithm>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/bytes/sample_arena.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <isobath/io/formats/ping/ping_device.hpp>
#include <isobath/io/formats/ping/ping_logs.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMaxPayload = 10240;
constexpr std::size_t kOverhead = 10;

/// Sizes of a message's fields in printed order; a list of bytes may follow them.
std::span<const std::uint8_t> field_sizes(std::uint16_t id) {
  static constexpr std::array<std::uint8_t, 8> kDeviceData{1, 1, 2, 2, 2, 2, 2, 2};
  static constexpr std::array<std::uint8_t, 12> kAutoDeviceData{1, 1, 2, 2, 2, 2, 2, 2, 1, 1, 2, 2};
  static constexpr std::array<std::uint8_t, 8> kProfile{4, 2, 2, 4, 4, 4, 4, 2};
  switch (id) {
    case ping_message::kDeviceData: return kDeviceData;
    case ping_message::kAutoDeviceData: return kAutoDeviceData;
    case ping_message::kDistance: return std::span(kProfile).first(7);
    case ping_message::kProfile: return kProfile;
    default: return {};
  }
}

/// The number after "name: " in a line.
bool value_of(std::string_view line, std::string_view name, std::uint32_t& value) {
  const std::size_t at = line.find(name);
  if (at == std::string_view::npos) return false;
  std::string_view rest = line.substr(at + name.size());
  return parse_number(rest.substr(0, rest.find(' ')), value);
}

/// A frame that is rebuilt as its text is read.
class FrameText {
 public:
  /// "Header: start_1: 66 start_2: 82 payload_length: 1214 message_id: 2300 src_device_id: 2 dst_device_id: 0"
  bool header(std::string_view line, SampleArena& arena) {
    std::array<std::uint32_t, 4> v{};
    const bool ok = value_of(line, "payload_length: ", v[0]) && value_of(line, "message_id: ", v[1]) &&
                    value_of(line, "src_device_id: ", v[2]) && value_of(line, "dst_device_id: ", v[3]);
    if (!ok || v[0] > kMaxPayload || v[1] > 0xffff || !fields_.empty()) return false;
    capacity_ = v[0] + kOverhead;
    frame_ = arena.take(capacity_);
    fields_ = field_sizes(static_cast<std::uint16_t>(v[1]));
    known_ = !fields_.empty();
    return put('B', 1) && put('R', 1) && put(v[0], 2) && put(v[1], 2) && put(v[2], 1) && put(v[3], 1);
  }
  /// A field, such as "  - angle: 150".
  bool field(std::string_view line) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string_view::npos) return false;
    const std::string_view value = line.substr(colon + 2);
    if (fields_.empty()) return bytes(value);
    std::uint32_t number = 0;
    const std::size_t size = fields_.front();
    fields_ = fields_.subspan(1);
    return parse_number(value, number) && put(number, size);
  }
  /// The end, such as "Checksum: 17245 check: 17245 pass: True".
  std::optional<Bytes> finish(std::string_view line) {
    std::uint32_t sum = 0;
    if (!value_of(line, "Checksum: ", sum) || !put(sum, 2) || size_ != capacity_) return {};
    const Bytes frame(frame_, size_);
    const Framing found = ping_frame_at(frame);
    if (found.kind != Framing::Kind::kFrame || found.bytes != size_) return {};
    return frame;
  }
  /// False for a message whose fields are not in the table; it is skipped.
  [[nodiscard]] bool known() const { return known_; }

 private:
  bool put(std::uint32_t value, std::size_t size) {
    if (size > capacity_ - size_ || (size < 4 && value >> (8 * size) != 0)) return false;
    for (std::size_t i = 0; i < size; ++i) frame_[size_++] = static_cast<std::byte>(value >> (8 * i));
    return true;
  }
  /// A list of bytes, such as ['0x4c', '0x98', ...].
  bool bytes(std::string_view list) {
    for (std::size_t at = list.find("0x"); at != std::string_view::npos; at = list.find("0x", at)) {
      std::uint8_t value = 0;
      at += 2;
      const char* const from = list.data() + at;
      const auto [end, failed] = std::from_chars(from, from + std::min<std::size_t>(2, list.size() - at), value, 16);
      if (failed != std::errc() || !put(value, 1)) return false;
      at += static_cast<std::size_t>(end - from);
    }
    return true;
  }

  std::byte* frame_ = nullptr;
  std::size_t capacity_ = 0;
  std::size_t size_ = 0;
  std::span<const std::uint8_t> fields_;
  bool known_ = true;
};

class PingMessages final : public LogSource {
 public:
  PingMessages(ByteWindow input, const InputConfig& config)
      : LogSource(std::move(input), "printed ping messages"), device_(config, report_) {
    report_.details["time"] = "estimated from the range setting: the text has no times";
  }

 private:
  std::optional<Event> read() override {
    while (const auto line = next_line(input_, report_)) {
      if (auto event = take(*line)) return clock_.stamped(std::move(*event), device_.interval());
    }
    abandon("message cut off");
    return {};
  }

  std::optional<Event> take(const TextLine& line) {
    const std::string_view text = trimmed(line.text);
    if (text.starts_with("ID: ")) {
      abandon("message without its end");
      message_.emplace();
      begin_ = line.offset;
      good_ = true;
    }
    if (!message_) {
      if (!decoration(text)) line.add_damage(report_, "line outside of a message");
      return {};
    }
    end_ = line.offset + line.bytes;
    if (text.starts_with("Header: ")) good_ = good_ && message_->header(text, arena_);
    if (text.starts_with("- ")) good_ = good_ && (message_->field(text) || !message_->known());
    return text.starts_with("Checksum: ") ? finish(text) : std::nullopt;
  }

  std::optional<Event> finish(std::string_view text) {
    std::optional<Event> event;
    if (message_->known()) {
      const auto frame = good_ ? message_->finish(text) : std::nullopt;
      if (!frame) {
        abandon("message that disagrees with its length or checksum");
        return {};
      }
      event = device_.event(*frame, {}, arena_.owner());
    }
    message_.reset();
    return event;
  }

  void abandon(const char* reason) {
    if (message_) report_.add_damage(begin_, end_ - begin_, reason);
    message_.reset();
  }
  static bool decoration(std::string_view text) {
    return text.find_first_not_of("-\"\r ") == std::string_view::npos || text.starts_with("\"<bound method");
  }

  PingDevice device_;
  SyntheticClock clock_;
  SampleArena arena_;
  std::optional<FrameText> message_;
  std::uint64_t begin_ = 0;  ///< position of message_ in the input
  std::uint64_t end_ = 0;
  bool good_ = true;
};

}  // namespace

bool looks_like_ping_messages(Bytes head) {
  if (!looks_like_text(head)) return false;
  const std::string_view text = text_of(head);
  const std::size_t id = text.find("ID: ");
  return id < 4096 && text.find("Header: start_1: 66 start_2: 82 payload_length: ", id) != std::string_view::npos;
}

std::unique_ptr<Source> open_ping_messages(ByteWindow input, const InputConfig& config) {
  return std::make_unique<PingMessages>(std::move(input), config);
}

}  // namespace isobath
