// The fire message that a host sends to an Oculus sonar, and the ping result that a stand-in of one sends back: whole
// messages, version 1 (oculus_protocol.hpp).
#pragma once

#include <cstdint>
#include <isobath/io/bytes/bytes.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct OculusFire {
  double range_m = 20;
  double gain_percent = 50;
  double sound_speed = 1500;  ///< m/s
  std::uint8_t mode = 1;      ///< 1 low, 2 high frequency
  std::uint8_t rate = 0;      ///< 0: up to 10 Hz
};
std::vector<std::byte> oculus_fire(const OculusFire& fire);
/// The fire message at the start of these bytes; empty: another message.
std::optional<OculusFire> oculus_fire_of(Bytes message);

/// One image of 8-bit samples, row by row, nearest first.
struct OculusImage {
  OculusFire fire;
  std::uint32_t number = 0;
  double frequency_hz = 1.2e6;
  double range_step_m = 0;
  std::vector<std::int16_t> bearings;  ///< hundredths of a degree, starboard positive
  std::vector<std::byte> samples;      ///< rows x bearings
};
std::vector<std::byte> oculus_ping_result(const OculusImage& image);

}  // namespace isobath
