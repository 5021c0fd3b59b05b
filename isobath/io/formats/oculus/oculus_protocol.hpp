// Messages of Blueprint Subsea's Oculus multibeam sonars: framing and the simple ping result, versions 1 and 2.
//
// Source: the open readers liboculus, oculus_driver and hydroformats; version 1 was checked on recorded pings. Packed,
// little-endian: u16 0x4F53, u16 source, u16 destination, u16 message id, u16 version, u32 payload bytes, u16 spare,
// payload. There is no checksum. Instead, all sizes of a ping result must agree, and it must not contain the start of
// another ping result, since that means that bytes are missing. Image: one row per range, nearest first, each with an
// optional 4-byte gain in front.
#pragma once

#include <isobath/io/bytes/framing.hpp>

namespace isobath {

Framing oculus_message_at(Bytes bytes);
/// Whether a ping result starts here, judged by the bytes that are there: at least a header, and all sizes if they are
/// there.
bool starts_oculus_ping(Bytes bytes);
/// The payload size that the header of a ping result states; 0 if no ping result starts here.
std::uint32_t oculus_payload_promised(Bytes bytes);
constexpr std::uint32_t kOculusMaxPayload = 32u << 20;

namespace oculus {
constexpr std::uint16_t kSimplePingResult = 0x23;
}

struct OculusPing {
  int version = 1;
  std::uint8_t mode = 0;  ///< 1 low, 2 high frequency
  std::uint8_t rate = 0;  ///< 0 10 Hz, 1 15 Hz, 2 40 Hz, 3 5 Hz, 4 2 Hz, 5 standby
  std::uint8_t gamma = 0;
  std::uint8_t flags = 0;
  double range_setting = 0;  ///< m or %, by the flags
  double gain_percent = 0;
  std::uint32_t ping_id = 0;
  double frequency_hz = 0;
  double sound_speed = 0;    ///< m/s, used by the sonar
  double start_time = 0;     ///< s since power-up; version 2 only
  int bytes_per_sample = 1;  ///< 1..4
  double range_step_m = 0;
  int ranges = 0;
  int beams = 0;
  bool gain_per_row = false;
  Bytes bearings;  ///< i16 hundredths of a degree each, starboard positive
  Bytes image;     ///< ranges x row_bytes()

  [[nodiscard]] std::size_t row_gain_bytes() const { return gain_per_row ? 4 : 0; }
  [[nodiscard]] std::size_t row_bytes() const {
    return row_gain_bytes() + static_cast<std::size_t>(beams) * static_cast<std::size_t>(bytes_per_sample);
  }
};
/// The ping result in a message from oculus_message_at; empty for other messages.
std::optional<OculusPing> oculus_ping(Bytes message);

}  // namespace isobath
