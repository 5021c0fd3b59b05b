#include <isobath/io/formats/oculus/oculus_protocol.hpp>

namespace isobath {
namespace {

constexpr std::size_t kHeader = 16;
constexpr std::uint16_t kMagic = 0x4f53;  // bytes 'S' 'O'
constexpr std::uint32_t kMaxOtherPayload = 1u << 20;
constexpr std::uint16_t kFullPingResult = 0x22;
constexpr int kMaxBeams = 1024;
constexpr int kMaxRanges = 4096;
constexpr std::uint8_t kGainPerRow = 1 << 2;

struct Header {
  std::uint16_t magic = 0;
  std::uint16_t id = 0;
  std::uint16_t version = 0;
  std::uint32_t payload = 0;

  explicit Header(Bytes bytes) {
    ByteCursor cursor(bytes);
    magic = cursor.little<std::uint16_t>();
    cursor.skip(4);
    id = cursor.little<std::uint16_t>();
    version = cursor.little<std::uint16_t>();
    payload = cursor.little<std::uint32_t>();
  }
  [[nodiscard]] bool is_ping() const { return id == oculus::kSimplePingResult; }
  [[nodiscard]] std::uint64_t total() const { return kHeader + std::uint64_t{payload}; }
  /// Size of the fields up to the bearings.
  [[nodiscard]] std::size_t struct_bytes() const { return version == 2 ? 202 : 122; }
  [[nodiscard]] bool plausible() const {
    const bool large = is_ping() || id == kFullPingResult;
    return magic == kMagic && version <= 2 && payload <= (large ? kOculusMaxPayload : kMaxOtherPayload) &&
           (!is_ping() || total() > struct_bytes());
  }
};

/// Offsets and sizes of a ping result; reads its first struct_bytes().
struct Layout {
  OculusPing ping;
  std::uint32_t image_offset = 0;
  std::uint32_t image_bytes = 0;

  Layout(Bytes bytes, const Header& header) {
    ping.version = header.version == 2 ? 2 : 1;
    ByteCursor cursor(bytes, kHeader);
    read_settings(cursor);
    read_results(cursor);
  }
  /// Whether all sizes agree with each other and with the message.
  [[nodiscard]] bool consistent(const Header& header) const {
    if (ping.beams < 1 || ping.beams > kMaxBeams || ping.ranges < 1 || ping.ranges > kMaxRanges) return false;
    if (ping.bytes_per_sample < 1 || ping.bytes_per_sample > 4) return false;
    const std::size_t bearings_end = header.struct_bytes() + 2 * static_cast<std::size_t>(ping.beams);
    return image_offset >= bearings_end && std::uint64_t{image_offset} + image_bytes <= header.total() &&
           image_bytes == static_cast<std::size_t>(ping.ranges) * ping.row_bytes();
  }

 private:
  void read_settings(ByteCursor& cursor) {
    ping.mode = cursor.little<std::uint8_t>();
    ping.rate = cursor.little<std::uint8_t>();
    cursor.skip(1);  // network speed
    ping.gamma = cursor.little<std::uint8_t>();
    ping.flags = cursor.little<std::uint8_t>();
    ping.gain_per_row = ping.flags & kGainPerRow;
    ping.range_setting = cursor.little<double>();
    ping.gain_percent = cursor.little<double>();
    cursor.skip(16);                         // requested speed of sound and salinity
    if (ping.version == 2) cursor.skip(36);  // further flags
  }
  void read_results(ByteCursor& cursor) {
    ping.ping_id = cursor.little<std::uint32_t>();
    cursor.skip(4);  // status
    ping.frequency_hz = cursor.little<double>();
    cursor.skip(16);                         // temperature, pressure
    if (ping.version == 2) cursor.skip(24);  // heading, pitch, roll
    ping.sound_speed = cursor.little<double>();
    if (ping.version == 2) {
      ping.start_time = cursor.little<double>();
    } else {
      cursor.skip(4);  // ticks of an unknown unit
    }
    ping.bytes_per_sample = cursor.little<std::uint8_t>() + 1;
    ping.range_step_m = cursor.little<double>();
    ping.ranges = cursor.little<std::uint16_t>();
    ping.beams = cursor.little<std::uint16_t>();
    if (ping.version == 2) cursor.skip(16);  // spare
    image_offset = cursor.little<std::uint32_t>();
    image_bytes = cursor.little<std::uint32_t>();
  }
};

/// Where another ping result starts inside a message, which has therefore lost bytes; 0: nowhere. At the very end,
/// where no complete header fits, four to eight bytes that equal the message's own header are enough.
std::size_t next_ping_inside(Bytes message) {
  const std::string_view text = text_of(message);
  for (std::size_t at = text.find("SO", 1); at != std::string_view::npos; at = text.find("SO", at + 1)) {
    const Bytes rest = message.subspan(at);
    const bool cut = rest.size() >= 4 && rest.size() < kHeader && text.starts_with(text.substr(at).substr(0, 8));
    if (cut || starts_oculus_ping(rest)) return at;
  }
  return 0;
}

}  // namespace

std::uint32_t oculus_payload_promised(Bytes bytes) {
  const Header header(bytes);
  return bytes.size() >= kHeader && header.magic == kMagic && header.is_ping() && header.version <= 2 ? header.payload
                                                                                                      : 0;
}

bool starts_oculus_ping(Bytes bytes) {
  const Header header(bytes);
  if (bytes.size() < kHeader || !header.plausible() || !header.is_ping()) return false;
  return bytes.size() < header.struct_bytes() || Layout(bytes, header).consistent(header);
}

Framing oculus_message_at(Bytes bytes) {
  if (bytes.empty()) return {Framing::Kind::kIncomplete, kHeader};
  if (bytes[0] != std::byte{'S'} || (bytes.size() > 1 && bytes[1] != std::byte{'O'})) return noise_until(bytes, 'S');
  if (bytes.size() < kHeader) return {Framing::Kind::kIncomplete, kHeader};
  const Header header(bytes);
  if (!header.plausible()) return noise_until(bytes, 'S');
  if (header.is_ping()) {
    if (bytes.size() < header.struct_bytes()) return {Framing::Kind::kIncomplete, header.struct_bytes()};
    if (!Layout(bytes, header).consistent(header)) return noise_until(bytes, 'S');
  }
  const auto total = static_cast<std::size_t>(header.total());
  if (bytes.size() < total) return {Framing::Kind::kIncomplete, total};
  const std::size_t inside = next_ping_inside(bytes.first(total));
  if (inside > 0) return {Framing::Kind::kNoise, inside};
  return {Framing::Kind::kFrame, total};
}

std::optional<OculusPing> oculus_ping(Bytes message) {
  const Header header(message);
  if (!header.is_ping()) return {};
  const Layout layout(message, header);
  OculusPing ping = layout.ping;
  ping.bearings = message.subspan(header.struct_bytes(), 2 * static_cast<std::size_t>(ping.beams));
  ping.image = message.subspan(layout.image_offset, layout.image_bytes);
  return ping;
}

}  // namespace isobath
