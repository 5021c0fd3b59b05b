#include <array>
#include <cmath>
#include <isobath/io/formats/tritech/tritech_protocol.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMaxFrame = 4096;
constexpr std::size_t kFrameOverhead = 14;  // around the payload
constexpr std::size_t kPayload = 13;        // offset of the payload
constexpr std::size_t kLengthsEnd = 7;      // offset after both lengths
constexpr std::uint16_t kMinLength = 8;     // L of an empty payload
constexpr std::uint8_t kSinglePacket = 0x80;

/// The value of four upper-case hexadecimal digits; -1 for anything else.
int hex_length(Bytes digits) {
  int value = 0;
  for (const std::byte b : digits) {
    const int c = std::to_integer<int>(b);
    const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
    if (digit < 0) return -1;
    value = value * 16 + digit;
  }
  return value;
}

/// Checks the length of the message types with a known length.
bool length_fits(Bytes frame) {
  const auto id = std::to_integer<std::uint8_t>(frame[10]);
  const bool single = std::to_integer<std::uint8_t>(frame[11]) == kSinglePacket;
  if (id == tritech::kAlive) return frame.size() == 22;
  if (id == tritech::kVersionData) return frame.size() == 25;
  if (id == tritech::kHeadData && single)
    return ByteCursor(frame, kPayload).little<std::uint16_t>() + kFrameOverhead == frame.size();
  return true;
}

}  // namespace

Framing tritech_frame_at(Bytes bytes) {
  if (bytes.empty()) return {Framing::Kind::kIncomplete, kFrameOverhead};
  if (bytes[0] != std::byte{'@'}) return noise_until(bytes, '@');
  if (bytes.size() < kLengthsEnd) return {Framing::Kind::kIncomplete, kFrameOverhead};
  const int length = hex_length(bytes.subspan(1, 4));
  if (length < kMinLength || length != ByteCursor(bytes, 5).little<std::uint16_t>()) return noise_until(bytes, '@');
  const std::size_t total = static_cast<std::size_t>(length) + 6;
  if (total > kMaxFrame) return noise_until(bytes, '@');
  if (bytes.size() < total) return {Framing::Kind::kIncomplete, total};
  if (bytes[total - 1] != std::byte{'\n'} || !length_fits(bytes.first(total))) return noise_until(bytes, '@');
  return {Framing::Kind::kFrame, total};
}

TritechFrame tritech_frame(Bytes frame) {
  ISOBATH_ASSERT(frame.size() >= kFrameOverhead);
  TritechFrame result;
  result.source = std::to_integer<std::uint8_t>(frame[7]);
  result.id = std::to_integer<std::uint8_t>(frame[10]);
  result.sequence = std::to_integer<std::uint8_t>(frame[11] & std::byte{0x7f});
  result.last = (frame[11] & std::byte{0x80}) != std::byte{0};
  result.payload = frame.subspan(kPayload, frame.size() - kFrameOverhead);
  return result;
}

std::uint16_t tritech::sixteenths(Angle bearing) {
  const long value = std::lround(bearing.radians() * kAhead / std::numbers::pi) + kAhead;
  return static_cast<std::uint16_t>((value % kTurn + kTurn) % kTurn);
}

double tritech::range_scale_m(std::uint16_t range_scale) {
  constexpr std::array<double, 4> kUnit{1, 0.3048, 1.8288, 0.9144};
  return (range_scale & 0x3fff) * 0.1 * kUnit[range_scale >> 14];
}

double TritechLine::bin_m(double sound_speed) const {
  if (bin_time > 0) return sound_speed * bin_time * tritech::kBinTimeUnit_s / 2;
  return tritech::range_scale_m(range_scale) / bins();
}

Result<TritechLine, MessageFault> tritech_line(Bytes payload) {
  ByteCursor cursor(payload, 3);  // after count and device type
  TritechLine line;
  line.head_status = cursor.little<std::uint8_t>();
  line.sweep_code = cursor.little<std::uint8_t>();
  line.head_control = cursor.little<std::uint16_t>();
  line.range_scale = cursor.little<std::uint16_t>();
  cursor.skip(4);  // TXN
  line.gain = cursor.little<std::uint8_t>();
  cursor.skip(2);  // slope
  line.db_span = cursor.little<std::uint8_t>();
  line.db_low = cursor.little<std::uint8_t>();
  cursor.skip(2);  // heading offset
  line.bin_time = cursor.little<std::uint16_t>();
  cursor.skip(5);  // limits of the sector, step
  line.bearing = cursor.little<std::uint16_t>();
  line.samples = cursor.take(cursor.little<std::uint16_t>());
  if (!cursor.ok()) return tl::unexpected(MessageFault::kShort);
  if (line.samples.empty()) return tl::unexpected(MessageFault::kNoSamples);
  if (line.bearing > 6399) return tl::unexpected(MessageFault::kBadBearing);
  if (!(line.bin_m(1500) > 0)) return tl::unexpected(MessageFault::kBadRange);
  return line;
}

void unpack_nibbles(Bytes packed, bool high_first, std::byte* out) {
  for (const std::byte b : packed) {
    const std::byte high = b >> 4, low = b & std::byte{0x0f};
    *out++ = high_first ? high : low;
    *out++ = high_first ? low : high;
  }
}

}  // namespace isobath
