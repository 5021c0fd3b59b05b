#include <algorithm>
#include <fmt/format.h>
#include <isobath/io/formats/ping/ping_device.hpp>

namespace isobath {
namespace {

constexpr BeamSize kPing360Beam{Angle::degrees(2), Angle::degrees(25)};
constexpr BeamSize kPing1DBeam{Angle::degrees(25), Angle::degrees(25)};
constexpr double kPing360Blind = 0.75;   // m: pulse and ring-down, in practice
constexpr double kStepTime = 0.020;      // s: a turn of 400 lines takes 9 s at 2 m and 35 s at 50 m
constexpr double kSounderPause = 0.050;  // s: approximate pause of a Ping1D between two pings
constexpr std::array<const char*, 3> kGains = {"low", "normal", "high"};

}  // namespace

PingDevice::PingDevice(const InputConfig& config, SourceReport& report)
    : report_(report), scanner_(config, kPing360Beam), sounder_(config, kPing1DBeam) {}

std::optional<Event> PingDevice::event(Bytes bytes, Time time, const std::shared_ptr<const void>& owner) {
  const PingFrame frame = ping_frame(bytes);
  ByteCursor payload(frame.payload);
  switch (frame.id) {
    case ping_message::kDeviceInformation:
      if (!frame.payload.empty()) type_ = static_cast<PingDeviceType>(payload.little<std::uint8_t>());
      return {};
    case ping_message::kSpeedOfSound:
      if (const auto mm_s = payload.little<std::uint32_t>(); mm_s > 0) device_sound_speed_ = mm_s / 1000.0;
      return {};
    case ping_message::kDeviceData:
    case ping_message::kAutoDeviceData: return line(frame, time, owner);
    case ping_message::kDistanceSimple:
    case ping_message::kDistance:
    case ping_message::kProfile: return reading(frame, time, owner);
    default: return {};
  }
}

std::optional<Event> PingDevice::reject(MessageFault fault) {
  ++report_.rejected[to_text(fault)];
  return {};
}

std::optional<Event> PingDevice::line(const PingFrame& frame, Time time, const std::shared_ptr<const void>& owner) {
  if (type_ == PingDeviceType::kPing1D) return reject(MessageFault::kOtherDevice);
  const auto line = ping360_line(frame);
  if (!line) return reject(line.error());
  const std::uint32_t bins = static_cast<std::uint32_t>(line->samples.size());
  if (described_.change({line->gain, line->pulse_us, line->sample_period, line->frequency_khz, bins})) describe(*line);
  const RangeWindow window{0, line->bin_m(scanner_.sound_speed()), static_cast<int>(bins)};
  Ping ping = scanner_.ping(Angle::gradians(line->angle_grad), window, line->samples.data(), owner);
  ping.time = time;
  ping.blanking_m = std::max(kPing360Blind, 0.5 * scanner_.sound_speed() * line->pulse_us * 1e-6);
  interval_ = seconds(line->sample_period * kPing360Tick_s * window.bins + kStepTime + line->delay_ms * 1e-3);
  return ping;
}

std::optional<Event> PingDevice::reading(const PingFrame& frame, Time time, const std::shared_ptr<const void>& owner) {
  if (type_ == PingDeviceType::kPing360) return reject(MessageFault::kOtherDevice);
  const auto reading = ping1d_reading(frame);
  if (!reading) return reject(reading.error());
  if (described_.change({reading->gain, reading->start_mm, reading->length_mm, 0, 0})) describe(*reading);
  const double start = reading->start_mm * 1e-3, length = reading->length_mm * 1e-3;
  interval_ = seconds(2 * (start + length) / 1500 + kSounderPause);
  if (!reading->samples.empty()) {
    const int bins = static_cast<int>(reading->samples.size());
    Ping ping = sounder_.ping({}, {start, length / bins, bins}, reading->samples.data(), owner);
    ping.time = time;
    ping.sound_speed = device_sound_speed_;
    return ping;
  }
  RangeReading result;
  result.time = time;
  if (reading->detected()) result.range_m = reading->distance_mm * 1e-3;
  result.max_range_m = start + length;
  result.width = sounder_.beam().width;
  result.X_BS = sounder_.X_BS();
  result.confidence = reading->detected() ? static_cast<float>(reading->confidence_percent) / 100 : 0;
  return result;
}

void PingDevice::describe(const Ping360Line& line) {
  const double c = scanner_.sound_speed();
  const auto bins = static_cast<double>(line.samples.size());
  report_.details["sonar"] = fmt::format("Ping360, beam {:g} x {:g} degrees", scanner_.beam().width.degrees(),
                                         scanner_.beam().height.degrees());
  report_.note_setting("frequency", fmt::format("{} kHz", line.frequency_khz));
  report_.note_setting("gain", line.gain < kGains.size() ? fmt::format("{} ({})", line.gain, kGains[line.gain])
                                                         : fmt::format("{}", line.gain));
  report_.note_setting("range", fmt::format("{:.4g} m in {} bins of {:.4g} mm, pulse {} us", line.bin_m(c) * bins, bins,
                                            line.bin_m(c) * 1e3, line.pulse_us));
  report_.details["sound speed"] = fmt::format("{:g} m/s, as configured: the log does not state it", c);
}

void PingDevice::describe(const Ping1DReading& reading) {
  report_.details["sonar"] = fmt::format("Ping1D, beam {:g} degrees", sounder_.beam().width.degrees());
  report_.note_setting("gain", fmt::format("{}", reading.gain));
  report_.note_setting("range", fmt::format("{:g} .. {:g} m", reading.start_mm * 1e-3,
                                            reading.start_mm * 1e-3 + reading.length_mm * 1e-3));
  report_.details["sound speed"] = fmt::format("{:g} m/s, as set in the device", device_sound_speed_);
}

}  // namespace isobath
