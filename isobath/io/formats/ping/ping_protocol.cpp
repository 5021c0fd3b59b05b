#include <isobath/io/formats/ping/ping_protocol.hpp>

namespace isobath {
namespace {

constexpr std::size_t kHeader = 8;
constexpr std::size_t kFrameOverhead = 10;
constexpr std::size_t kMaxPayload = 10240;  // longer than any message; noise may state up to 65535

/// The `count` samples that a message states; later bytes are ignored.
Result<Bytes, MessageFault> samples(ByteCursor& cursor, std::size_t count) {
  const Bytes data = cursor.take(count);
  if (!cursor.ok()) return tl::unexpected(MessageFault::kShort);
  if (count == 0) return tl::unexpected(MessageFault::kNoSamples);
  return data;
}

}  // namespace

std::uint16_t ping_checksum(Bytes bytes) {
  std::uint32_t sum = 0;
  for (const std::byte b : bytes) sum += std::to_integer<std::uint32_t>(b);
  return static_cast<std::uint16_t>(sum);
}

Framing ping_frame_at(Bytes bytes) {
  const auto is = [&](std::size_t i, char c) { return bytes[i] == static_cast<std::byte>(c); };
  if (bytes.empty()) return {Framing::Kind::kIncomplete, kFrameOverhead};
  if (!is(0, 'B') || (bytes.size() > 1 && !is(1, 'R'))) return noise_until(bytes, 'B');
  if (bytes.size() < kFrameOverhead) return {Framing::Kind::kIncomplete, kFrameOverhead};
  const std::size_t payload = ByteCursor(bytes, 2).little<std::uint16_t>();
  if (payload > kMaxPayload) return noise_until(bytes, 'B');
  const std::size_t total = payload + kFrameOverhead;
  if (bytes.size() < total) return {Framing::Kind::kIncomplete, total};
  const auto checksum = ByteCursor(bytes, total - 2).little<std::uint16_t>();
  if (checksum != ping_checksum(bytes.first(total - 2))) return noise_until(bytes, 'B');
  return {Framing::Kind::kFrame, total};
}

PingFrame ping_frame(Bytes frame) {
  ISOBATH_ASSERT(frame.size() >= kFrameOverhead);
  ByteCursor cursor(frame, 4);
  PingFrame result;
  result.id = cursor.little<std::uint16_t>();
  result.source = cursor.little<std::uint8_t>();
  result.payload = frame.subspan(kHeader, frame.size() - kFrameOverhead);
  return result;
}

Result<Ping360Line, MessageFault> ping360_line(const PingFrame& frame) {
  ByteCursor cursor(frame.payload, 1);  // after the mode
  Ping360Line line;
  line.gain = cursor.little<std::uint8_t>();
  line.angle_grad = cursor.little<std::uint16_t>();
  line.pulse_us = cursor.little<std::uint16_t>();
  line.sample_period = cursor.little<std::uint16_t>();
  line.frequency_khz = cursor.little<std::uint16_t>();
  if (frame.id == ping_message::kAutoDeviceData) {
    cursor.skip(5);  // sector and step
    line.delay_ms = cursor.little<std::uint8_t>();
  }
  cursor.skip(2);  // number_of_samples: the requested number, not the delivered one
  const auto data = samples(cursor, cursor.little<std::uint16_t>());
  if (!data) return tl::unexpected(data.error());
  if (line.angle_grad >= 400) return tl::unexpected(MessageFault::kBadBearing);
  if (line.sample_period == 0) return tl::unexpected(MessageFault::kBadRange);
  line.samples = *data;
  return line;
}

Result<Ping1DReading, MessageFault> ping1d_reading(const PingFrame& frame) {
  ByteCursor cursor(frame.payload);
  Ping1DReading reading;
  reading.distance_mm = cursor.little<std::uint32_t>();
  if (frame.id == ping_message::kDistanceSimple) {
    reading.confidence_percent = cursor.little<std::uint8_t>();
    reading.length_mm = reading.distance_mm;  // the scanned range beyond the echo is not known
  } else {
    reading.confidence_percent = cursor.little<std::uint16_t>();
    cursor.skip(6);  // transmit duration, ping number
    reading.start_mm = cursor.little<std::uint32_t>();
    reading.length_mm = cursor.little<std::uint32_t>();
    reading.gain = cursor.little<std::uint32_t>();
  }
  if (frame.id == ping_message::kProfile) {
    const auto data = samples(cursor, cursor.little<std::uint16_t>());
    if (!data) return tl::unexpected(data.error());
    reading.samples = *data;
  }
  if (!cursor.ok()) return tl::unexpected(MessageFault::kShort);
  if (reading.length_mm == 0) return tl::unexpected(MessageFault::kBadRange);
  return reading;
}

}  // namespace isobath
