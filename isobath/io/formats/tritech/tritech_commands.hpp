// The messages that a host sends to a Tritech imaging head, and those that a stand-in of one sends back: whole frames
// (tritech_protocol.hpp). Source of the fields: the same open drivers; no head was at hand.
//
// A host reboots the head or asks for its version, sends the head command, and then asks for one line at a time
// (mtSendData); the head steps by itself after each line. A head that waits to be asked says mtAlive once a second.
#pragma once

#include <isobath/base/angle.hpp>
#include <isobath/io/formats/tritech/tritech_protocol.hpp>
#include <optional>
#include <vector>

namespace isobath {

using TritechBytes = std::vector<std::byte>;

/// What a head is to do, in the units of a host.
struct TritechScan {
  Angle middle, sector, step;  ///< from the transducer's boss, clockwise seen from above an upright head
  double range_m = 20;
  int samples = 500;
  int gain_percent = 50;
  double sound_speed = 1500;  ///< m/s
};
/// The same in the units of the device.
struct TritechSettings {
  std::uint16_t range_scale = 0;                     ///< label, 0.1 m
  std::uint16_t left_limit = 0, right_limit = 6399;  ///< 1/16 gradian
  bool full_circle = true;
  std::uint8_t gain = 105;                 ///< 0..210
  std::uint8_t step = 16;                  ///< 1/16 gradian
  std::uint16_t bin_time = 1, bins = 500;  ///< of 640 ns
};
/// The bins are as long as the device's unit of time allows (0.48 mm at 1500 m/s): a short range has fewer bins.
TritechSettings tritech_settings(const TritechScan& scan);

TritechBytes tritech_send_version();
TritechBytes tritech_head_command(const TritechSettings& settings);
TritechBytes tritech_send_data();

/// What a host asks of a head. `settings`: of a head command.
struct TritechRequest {
  enum class Kind : std::uint8_t { kSendVersion, kReboot, kHeadCommand, kSendData };
  Kind kind = Kind::kSendVersion;
  TritechSettings settings;
};
/// Empty: another message, or one whose settings are out of range.
std::optional<TritechRequest> tritech_request(const TritechFrame& frame);

/// What a head says of itself once a second.
struct TritechAlive {
  bool has_no_settings = false;
};
std::optional<TritechAlive> tritech_alive(const TritechFrame& frame);

TritechBytes tritech_alive_bytes(const TritechAlive& alive);
TritechBytes tritech_version_bytes(std::uint16_t serial_number);
/// `bearing`: 1/16 gradian; samples of 8 bits, at most 3000.
TritechBytes tritech_line_bytes(const TritechSettings& settings, int bearing, Bytes samples);

}  // namespace isobath
