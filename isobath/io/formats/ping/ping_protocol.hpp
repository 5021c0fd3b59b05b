// The ping protocol of Blue Robotics (Ping1D, Ping360): frames and the messages that carry echoes.
//
// Source: github.com/bluerobotics/ping-protocol, message definitions. All numbers little-endian, packed:
// 'B' 'R', u16 payload length, u16 message id, u8 source, u8 destination, payload, u16 sum of all bytes before it.
#pragma once

#include <isobath/base/error.hpp>
#include <isobath/io/bytes/framing.hpp>

namespace isobath {

Framing ping_frame_at(Bytes bytes);

struct PingFrame {
  std::uint16_t id = 0;
  std::uint8_t source = 0;
  Bytes payload;
};
/// The parts of a frame from ping_frame_at.
PingFrame ping_frame(Bytes frame);
/// The low 16 bits of the sum of all bytes.
std::uint16_t ping_checksum(Bytes bytes);

namespace ping_message {
constexpr std::uint16_t kNack = 2;
constexpr std::uint16_t kDeviceInformation = 4;
constexpr std::uint16_t kGeneralRequest = 6;
constexpr std::uint16_t kSetSpeedOfSound = 1002;
constexpr std::uint16_t kSpeedOfSound = 1203;
constexpr std::uint16_t kDistanceSimple = 1211;
constexpr std::uint16_t kDistance = 1212;
constexpr std::uint16_t kProfile = 1300;
constexpr std::uint16_t kDeviceData = 2300;
constexpr std::uint16_t kAutoDeviceData = 2301;
constexpr std::uint16_t kTransducer = 2601;
constexpr std::uint16_t kAutoTransmit = 2602;
}  // namespace ping_message

enum class PingDeviceType : std::uint8_t { kUnknown = 0, kPing1D = 1, kPing360 = 2 };

/// The unit of sample periods.
inline constexpr double kPing360Tick_s = 25e-9;

/// device_data (2300) and auto_device_data (2301): one line of a Ping360.
struct Ping360Line {
  std::uint8_t gain = 0;         ///< 0 low, 1 normal, 2 high
  std::uint16_t angle_grad = 0;  ///< 0..399
  std::uint16_t pulse_us = 0;
  std::uint16_t sample_period = 0;  ///< in ticks of 25 ns, two-way travel time
  std::uint16_t frequency_khz = 0;
  std::uint8_t delay_ms = 0;  ///< pause of the head between lines
  Bytes samples;              ///< nearest first

  /// Length of a bin: half the distance that sound travels in one sample period.
  [[nodiscard]] double bin_m(double sound_speed) const { return sound_speed * sample_period * kPing360Tick_s / 2; }
};
Result<Ping360Line, MessageFault> ping360_line(const PingFrame& frame);

/// distance (1212, 1211) and profile (1300) of a Ping1D.
struct Ping1DReading {
  std::uint32_t distance_mm = 0;
  std::uint16_t confidence_percent = 0;
  std::uint32_t start_mm = 0;
  std::uint32_t length_mm = 0;
  std::uint32_t gain = 0;
  Bytes samples;  ///< profile samples, nearest first; empty for a distance

  [[nodiscard]] bool detected() const { return confidence_percent > 0 && confidence_percent <= 100 && distance_mm > 0; }
};
Result<Ping1DReading, MessageFault> ping1d_reading(const PingFrame& frame);

}  // namespace isobath
