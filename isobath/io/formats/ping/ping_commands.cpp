#include <algorithm>
#include <cmath>
#include <isobath/io/formats/ping/ping_commands.hpp>

namespace isobath {
namespace {

constexpr std::uint8_t kHost = 0, kHead = 2, kSounder = 1;
constexpr int kLeastPeriod = 80, kMostPeriod = 40000, kTurn = 400;

/// Numbers one after the other, little-endian.
class Payload {
 public:
  template <class T>
  Payload& put(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes_.push_back(static_cast<std::byte>(value >> (8 * i)));
    return *this;
  }
  Payload& put(Bytes bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  [[nodiscard]] Bytes bytes() const { return bytes_; }

 private:
  PingBytes bytes_;
};

constexpr std::uint8_t kMode = 1;  // of every Ping360 message

std::uint16_t gradians(Angle angle) {
  const long grad = std::lround(angle.degrees() / 0.9) % kTurn;
  return static_cast<std::uint16_t>((grad + kTurn) % kTurn);
}

}  // namespace

PingBytes ping_bytes(std::uint16_t id, std::uint8_t source, std::uint8_t destination, Bytes payload) {
  Payload out;
  out.put(std::uint8_t{'B'}).put(std::uint8_t{'R'}).put(static_cast<std::uint16_t>(payload.size())).put(id);
  out.put(source).put(destination).put(payload);
  out.put(ping_checksum(out.bytes()));
  return {out.bytes().begin(), out.bytes().end()};
}

Ping360Settings ping360_settings(const Ping360Scan& scan) {
  Ping360Settings s;
  s.gain = static_cast<std::uint8_t>(std::clamp(scan.gain, 0, 2));
  s.frequency_khz = static_cast<std::uint16_t>(scan.frequency_khz);
  const double travel_s = 2 * scan.range_m / scan.sound_speed;
  const double period = travel_s / (scan.samples * kPing360Tick_s);
  s.sample_period = static_cast<std::uint16_t>(std::clamp(std::lround(period), long{kLeastPeriod}, long{kMostPeriod}));
  s.samples = static_cast<std::uint16_t>(
      std::clamp(std::lround(travel_s / (s.sample_period * kPing360Tick_s)), 1L, static_cast<long>(scan.samples)));
  const double sample_us = s.sample_period * kPing360Tick_s * 1e6;
  const double pulse = std::max(8000 * scan.range_m / scan.sound_speed, 2.5 * sample_us);
  s.pulse_us = static_cast<std::uint16_t>(std::clamp(pulse, 5.0, std::min(500.0, 64 * sample_us)));
  s.step_grad = static_cast<std::uint8_t>(std::clamp(std::lround(scan.step.degrees() / 0.9), 1L, 10L));
  if (scan.sector.degrees() < 359) {
    s.start_grad = gradians(scan.middle - scan.sector / 2);
    s.stop_grad = gradians(scan.middle + scan.sector / 2);
  }
  return s;
}

PingBytes ping_request(std::uint16_t id) {
  return ping_bytes(ping_message::kGeneralRequest, kHost, kHost, Payload().put(id).bytes());
}

PingBytes ping_set_sound_speed(double m_s) {
  return ping_bytes(ping_message::kSetSpeedOfSound, kHost, kHost,
                    Payload().put(static_cast<std::uint32_t>(std::lround(m_s * 1000))).bytes());
}

PingBytes ping360_auto_transmit(const Ping360Settings& s) {
  Payload out;
  out.put(kMode).put(s.gain).put(s.pulse_us).put(s.sample_period).put(s.frequency_khz).put(s.samples);
  out.put(s.start_grad).put(s.stop_grad).put(s.step_grad).put(std::uint8_t{0});
  return ping_bytes(ping_message::kAutoTransmit, kHost, kHead, out.bytes());
}

PingBytes ping360_transducer(const Ping360Settings& s, int angle_grad) {
  Payload out;
  out.put(kMode).put(s.gain).put(static_cast<std::uint16_t>(angle_grad)).put(s.pulse_us).put(s.sample_period);
  out.put(s.frequency_khz).put(s.samples).put(std::uint8_t{1}).put(std::uint8_t{0});
  return ping_bytes(ping_message::kTransducer, kHost, kHead, out.bytes());
}

std::optional<Ping360Request> ping360_request(const PingFrame& frame) {
  const bool sweeps = frame.id == ping_message::kAutoTransmit;
  if (!sweeps && frame.id != ping_message::kTransducer) return std::nullopt;
  ByteCursor in(frame.payload);
  Ping360Request request;
  Ping360Settings& s = request.settings;
  in.skip(1);
  s.gain = in.little<std::uint8_t>();
  if (!sweeps) request.angle_grad = in.little<std::uint16_t>();
  s.pulse_us = in.little<std::uint16_t>();
  s.sample_period = in.little<std::uint16_t>();
  s.frequency_khz = in.little<std::uint16_t>();
  s.samples = in.little<std::uint16_t>();
  request.sweeps = sweeps;
  if (sweeps) {
    s.start_grad = in.little<std::uint16_t>();
    s.stop_grad = in.little<std::uint16_t>();
    s.step_grad = in.little<std::uint8_t>();
  }
  const bool right = in.ok() && s.start_grad < kTurn && s.stop_grad < kTurn && request.angle_grad < kTurn &&
                     s.sample_period >= kLeastPeriod && s.sample_period <= kMostPeriod && s.samples > 0 &&
                     s.step_grad > 0;
  return right ? std::optional(request) : std::nullopt;
}

PingBytes ping360_line_bytes(const Ping360Settings& s, int angle_grad, bool sweeps, Bytes samples) {
  const auto count = static_cast<std::uint16_t>(samples.size());
  Payload out;
  out.put(kMode).put(s.gain).put(static_cast<std::uint16_t>(angle_grad)).put(s.pulse_us).put(s.sample_period);
  if (!sweeps) {
    out.put(s.frequency_khz).put(s.samples).put(count).put(samples);
    return ping_bytes(ping_message::kDeviceData, kHead, kHost, out.bytes());
  }
  out.put(s.frequency_khz).put(s.start_grad).put(s.stop_grad).put(s.step_grad).put(std::uint8_t{0});
  out.put(s.samples).put(count).put(samples);
  return ping_bytes(ping_message::kAutoDeviceData, kHead, kHost, out.bytes());
}

PingBytes ping_device_information(PingDeviceType type) {
  constexpr std::uint8_t kRevision = 1, kFirmware = 3;
  Payload out;
  out.put(static_cast<std::uint8_t>(type)).put(kRevision).put(kFirmware).put(std::uint8_t{0}).put(std::uint16_t{0});
  return ping_bytes(ping_message::kDeviceInformation, type == PingDeviceType::kPing360 ? kHead : kSounder, kHost,
                    out.bytes());
}

PingBytes ping1d_distance_bytes(double range_m, int confidence_percent, double longest_m) {
  constexpr std::uint16_t kPulse = 100;
  Payload out;
  out.put(static_cast<std::uint32_t>(std::lround(range_m * 1000))).put(static_cast<std::uint16_t>(confidence_percent));
  out.put(kPulse).put(std::uint32_t{0}).put(std::uint32_t{0});
  out.put(static_cast<std::uint32_t>(std::lround(longest_m * 1000))).put(std::uint32_t{3});
  return ping_bytes(ping_message::kDistance, kSounder, kHost, out.bytes());
}

}  // namespace isobath
