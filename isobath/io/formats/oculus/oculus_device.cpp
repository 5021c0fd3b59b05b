#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <isobath/io/formats/oculus/oculus_device.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMaxFans = 16;  // a sonar alternates between a few bearing tables
constexpr Angle kHeight = Angle::degrees(20);

struct Model {
  const char* name;
  double low_khz, high_khz;  ///< band that only this model has
  BeamSize beam;
};
// From the maker's data sheets, without the bands that two models share (1.2 MHz).
constexpr std::array<Model, 4> kModels{{
    {"Oculus M370s", 300, 450, {Angle::degrees(2), Angle::degrees(20)}},
    {"Oculus M750d, low frequency", 650, 850, {Angle::degrees(1), Angle::degrees(20)}},
    {"Oculus M1200d, high frequency", 1900, 2300, {Angle::degrees(0.4), Angle::degrees(12)}},
    {"Oculus M3000d, high frequency", 2800, 3200, {Angle::degrees(0.4), Angle::degrees(20)}},
}};

const Model* model_of(double frequency_hz) {
  const auto found = std::ranges::find_if(
      kModels, [&](const Model& m) { return frequency_hz >= m.low_khz * 1e3 && frequency_hz <= m.high_khz * 1e3; });
  return found == kModels.end() ? nullptr : &*found;
}

Angle median_spacing(const std::vector<Angle>& azimuth) {
  if (azimuth.size() < 2) return kHeight;
  std::vector<double> steps;
  for (std::size_t i = 1; i < azimuth.size(); ++i) steps.push_back((azimuth[i] - azimuth[i - 1]).radians());
  std::nth_element(steps.begin(), steps.begin() + std::ptrdiff_t(steps.size() / 2), steps.end());
  return Angle::radians(steps[steps.size() / 2]);
}

std::vector<Angle> azimuths(Bytes bearings) {
  std::vector<Angle> result(bearings.size() / 2);
  ByteCursor cursor(bearings);
  for (Angle& a : result) a = Angle::degrees(cursor.little<std::int16_t>() / 100.0);
  return result;
}

double ping_interval(const OculusPing& ping) {
  constexpr std::array<double, 5> kRates{10, 15, 40, 5, 2};
  const double rate = ping.rate < kRates.size() ? kRates[ping.rate] : kRates[0];
  return std::max(1 / rate, 2 * ping.range_step_m * ping.ranges / 1500);
}

/// Converts the 24-bit or 32-bit samples of one row, without its gain, to floats.
void widen(Bytes row, int bytes_per_sample, float* out) {
  ByteCursor cursor(row);
  const auto count = row.size() / static_cast<std::size_t>(bytes_per_sample);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t low = cursor.little<std::uint16_t>();
    const std::uint32_t high = bytes_per_sample == 4 ? cursor.little<std::uint16_t>() : cursor.little<std::uint8_t>();
    out[i] = static_cast<float>(low | high << 16);
  }
}

}  // namespace

OculusDevice::OculusDevice(const InputConfig& config, SourceReport& report)
    : config_(config), report_(report), X_BS_(mounted(config)) {}

std::optional<Event> OculusDevice::event(Bytes message, std::optional<Time> time,
                                         const std::shared_ptr<const void>& owner) {
  const auto result = oculus_ping(message);
  if (!result) return {};
  if (!(result->range_step_m > 1e-6 && result->range_step_m < 10)) {
    ++report_.rejected[to_text(MessageFault::kBadRange)];
    return {};
  }
  const auto cached = fan(*result);
  if (!cached) {
    ++report_.rejected[to_text(cached.error())];
    return {};
  }
  describe(*result);
  Ping ping;
  ping.time = time ? *time : made_time(*result);
  ping.fan = (*cached)->fan;
  ping.window = {0, result->range_step_m, result->ranges};
  ping.intensity = samples(*result, (*cached)->mirrored, owner, ping);
  ping.X_BS = X_BS_;
  const bool stated = result->sound_speed > 1000 && result->sound_speed < 2000;
  ping.sound_speed = stated ? result->sound_speed : config_.sound_speed;
  return ping;
}

Result<const OculusDevice::CachedFan*, MessageFault> OculusDevice::fan(const OculusPing& ping) {
  const auto frequency = std::bit_cast<std::uint64_t>(ping.frequency_hz);
  for (const CachedFan& f : fans_) {
    if (f.frequency_bits == frequency && std::ranges::equal(f.bearings, ping.bearings)) return &f;
  }
  CachedFan made{{ping.bearings.begin(), ping.bearings.end()}, frequency, nullptr, false};
  std::vector<Angle> azimuth = azimuths(ping.bearings);
  if (azimuth.size() > 1 && azimuth.front() > azimuth.back()) {
    std::ranges::reverse(azimuth);
    made.mirrored = true;
  }
  if (std::ranges::adjacent_find(azimuth, std::greater_equal<>()) != azimuth.end()) {
    return tl::unexpected(MessageFault::kOutOfOrder);
  }
  if (azimuth.front().degrees() < -180 || azimuth.back().degrees() > 180) {
    return tl::unexpected(MessageFault::kBadBearing);
  }
  const Model* const model = model_of(ping.frequency_hz);
  const BeamSize beam = beam_size(config_, model ? model->beam : BeamSize{median_spacing(azimuth), kHeight});
  const std::vector<Angle> width(azimuth.size(), beam.width);
  made.fan = std::make_shared<const BeamFan>(BeamFan{std::move(azimuth), width, beam.height});
  if (fans_.size() >= kMaxFans) fans_.erase(fans_.begin());
  return &fans_.emplace_back(std::move(made));
}

// Lost pings leave a gap, since the ping numbers go on counting.
Time OculusDevice::made_time(const OculusPing& ping) {
  if (ping.version == 2 && ping.start_time > 0 && representable_seconds(ping.start_time)) {
    return Time{seconds(ping.start_time)};
  }
  const std::uint32_t passed = last_id_ ? ping.ping_id - *last_id_ : 0;
  const std::uint32_t steps = passed >= 1 && passed <= 100 ? passed : last_id_ ? 1 : 0;
  last_id_ = ping.ping_id;
  last_time_ += seconds(ping_interval(ping)) * steps;
  return last_time_;
}

Intensities OculusDevice::samples(const OculusPing& ping, bool mirrored, const std::shared_ptr<const void>& owner,
                                  Ping& out) {
  const auto view = [&](const std::byte* first, SampleType type, std::size_t sample, std::size_t row) {
    const auto stride = std::ptrdiff_t(sample);
    if (mirrored) first += stride * (ping.beams - 1);
    return Intensities(first, type, ping.beams, ping.ranges, mirrored ? -stride : stride, std::ptrdiff_t(row));
  };
  const std::size_t row = ping.row_bytes(), gain = ping.row_gain_bytes();
  out.full_scale = std::ldexp(1.0f, 8 * ping.bytes_per_sample) - 1;
  if (ping.bytes_per_sample <= 2) {
    out.storage = owner;
    const SampleType type = ping.bytes_per_sample == 1 ? SampleType::kU8 : SampleType::kU16;
    return view(ping.image.data() + gain, type, static_cast<std::size_t>(ping.bytes_per_sample), row);
  }
  const std::size_t wide_row = static_cast<std::size_t>(ping.beams) * sizeof(float);
  std::byte* const wide = arena_.take(wide_row * static_cast<std::size_t>(ping.ranges));
  std::vector<float> line(static_cast<std::size_t>(ping.beams));
  for (int r = 0; r < ping.ranges; ++r) {
    widen(ping.image.subspan(static_cast<std::size_t>(r) * row + gain, row - gain), ping.bytes_per_sample, line.data());
    std::memcpy(wide + static_cast<std::size_t>(r) * wide_row, line.data(), wide_row);
  }
  out.storage = arena_.owner();
  return view(wide, SampleType::kF32, sizeof(float), wide_row);
}

void OculusDevice::describe(const OculusPing& ping) {
  const std::array<double, 6> setting{ping.frequency_hz, ping.gain_percent,   double(ping.gamma) + 256.0 * ping.flags,
                                      ping.range_step_m, double(ping.ranges), double(ping.beams)};
  if (described_ == setting) return;
  described_ = setting;
  const Model* const model = model_of(ping.frequency_hz);
  report_.details["sonar"] = fmt::format("{}, {} beams", model ? model->name : "Oculus", ping.beams);
  report_.note_setting("frequency", fmt::format("{:.4g} kHz", ping.frequency_hz / 1e3));
  report_.note_setting("gain",
                       fmt::format("{:.3g} %{}", ping.gain_percent, ping.gain_per_row ? ", per row, not removed" : ""));
  report_.note_setting("gamma",
                       ping.gamma == 0 || ping.gamma == 0xff ? "1" : fmt::format("{} of 255, not removed", ping.gamma));
  report_.note_setting(
      "range", fmt::format("{:.4g} m in {} bins of {:.4g} mm, {} bits", ping.range_step_m * ping.ranges, ping.ranges,
                           ping.range_step_m * 1e3, 8 * ping.bytes_per_sample));
  report_.details["sound speed"] = fmt::format("{:.6g} m/s, as set in the device", ping.sound_speed);
}

}  // namespace isobath
