// The messages that a host sends to Blue Robotics devices, and those that a stand-in of a device sends: whole frames
// (ping_protocol.hpp).
#pragma once

#include <isobath/base/angle.hpp>
#include <isobath/io/formats/ping/ping_protocol.hpp>
#include <vector>

namespace isobath {

using PingBytes = std::vector<std::byte>;

/// A frame around a payload.
PingBytes ping_bytes(std::uint16_t id, std::uint8_t source, std::uint8_t destination, Bytes payload);

/// What a Ping360 is to do, in the units of a host.
struct Ping360Scan {
  Angle middle, sector, step;  ///< from the head's forward mark, in its sense of rotation
  double range_m = 20;
  int samples = 500, frequency_khz = 750, gain = 1;
  double sound_speed = 1500;
};
/// The same in the units of the device.
struct Ping360Settings {
  std::uint8_t gain = 1;
  std::uint16_t pulse_us = 0;
  std::uint16_t sample_period = 80;  ///< ticks of 25 ns
  std::uint16_t frequency_khz = 750, samples = 500;
  std::uint16_t start_grad = 0, stop_grad = 399;
  std::uint8_t step_grad = 1;
};
/// A range that takes shorter samples than the device has is reached with fewer samples. The pulse is that of the
/// maker's viewer: 8000 us times range over the speed of sound, at least 2.5 samples, 5 to 500 us.
Ping360Settings ping360_settings(const Ping360Scan& scan);

PingBytes ping_request(std::uint16_t id);
PingBytes ping_set_sound_speed(double m_s);
PingBytes ping360_auto_transmit(const Ping360Settings& settings);
PingBytes ping360_transducer(const Ping360Settings& settings, int angle_grad);
/// The settings that a host asks for; empty: not such a message.
struct Ping360Request {
  Ping360Settings settings;
  bool sweeps = false;  ///< auto_transmit
  int angle_grad = 0;   ///< of a single line
};
std::optional<Ping360Request> ping360_request(const PingFrame& frame);

/// A line as a head that sweeps by itself sends it.
PingBytes ping360_line_bytes(const Ping360Settings& settings, int angle_grad, bool sweeps, Bytes samples);
/// What a device is.
PingBytes ping_device_information(PingDeviceType type);
/// A distance of a Ping1D; confidence 0: no target.
PingBytes ping1d_distance_bytes(double range_m, int confidence_percent, double longest_m);

}  // namespace isobath
