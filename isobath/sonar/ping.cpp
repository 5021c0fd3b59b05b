#include <cmath>
#include <cstring>
#include <isobath/sonar/ping.hpp>

namespace isobath {
namespace {

template <class Sample>
float load(const std::byte* at) {
  Sample value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<float>(value);
}

template <class Sample>
void copy_strided(const std::byte* at, std::ptrdiff_t stride, int bins, float* out) {
  for (int k = 0; k < bins; ++k, at += stride) out[k] = load<Sample>(at);
}

bool fan_valid(const BeamFan& fan) {
  if (fan.azimuth.empty() || fan.width.size() != fan.azimuth.size()) return false;
  const auto wide = [](Angle a) { return a.radians() > 0 && a.degrees() <= 360; };
  for (std::size_t i = 0; i < fan.azimuth.size(); ++i) {
    if (!std::isfinite(fan.azimuth[i].radians()) || !wide(fan.width[i])) return false;
    if (i > 0 && !(fan.azimuth[i] > fan.azimuth[i - 1])) return false;
  }
  return wide(fan.height);
}

bool spans_fit(const Ping& ping) {
  if (!ping.sampled) return true;
  if (static_cast<int>(ping.sampled->size()) != ping.fan->beams()) return false;
  for (const BinSpan& span : *ping.sampled) {
    if (span.first < 0 || span.first > span.end || span.end > ping.window.bins) return false;
  }
  return true;
}

}  // namespace

std::shared_ptr<const BeamFan> even_fan(int beams, Angle sector, Angle width, Angle height) {
  BeamFan fan{{}, std::vector<Angle>(static_cast<std::size_t>(beams), width), height};
  const Angle step = beams > 1 ? sector / (beams - 1) : Angle{};
  for (int b = 0; b < beams; ++b) fan.azimuth.push_back(step * (b - 0.5 * (beams - 1)));
  return std::make_shared<const BeamFan>(std::move(fan));
}

Ping make_ping(Time time, std::shared_ptr<const BeamFan> fan, const RangeWindow& window,
               std::vector<std::uint8_t> samples) {
  const auto owner = std::make_shared<const std::vector<std::uint8_t>>(std::move(samples));
  const int beams = fan->beams();
  const bool fits = window.bins >= 0 && owner->size() == static_cast<std::size_t>(beams) * window.bins;
  Ping ping;
  ping.time = time;
  ping.fan = std::move(fan);
  ping.window = window;
  ping.intensity = {owner->data(), SampleType::kU8, beams, fits ? window.bins : 0, window.bins, 1};
  ping.storage = owner;
  return ping;
}

BinSpan sampled_bins(const Ping& ping, int beam) {
  return ping.sampled ? (*ping.sampled)[static_cast<std::size_t>(beam)] : BinSpan{0, ping.window.bins};
}

float Intensities::operator()(int beam, int bin) const {
  const std::byte* at = data_ + beam * beam_stride_ + bin * bin_stride_;
  switch (type_) {
    case SampleType::kU8: return load<std::uint8_t>(at);
    case SampleType::kU16: return load<std::uint16_t>(at);
    case SampleType::kF32: return load<float>(at);
  }
  return 0;
}

void Intensities::copy_beam(int beam, float* out) const {
  const std::byte* at = data_ + beam * beam_stride_;
  switch (type_) {
    case SampleType::kU8: return copy_strided<std::uint8_t>(at, bin_stride_, bins_, out);
    case SampleType::kU16: return copy_strided<std::uint16_t>(at, bin_stride_, bins_, out);
    case SampleType::kF32: return copy_strided<float>(at, bin_stride_, bins_, out);
  }
}

PingFault check(const Ping& ping) {
  if (!ping.fan) return PingFault::kNoFan;
  if (!fan_valid(*ping.fan)) return PingFault::kBadFan;
  // The first and last beam of a whole turn differ.
  if ((ping.fan->azimuth.back() - ping.fan->azimuth.front()).degrees() > 360) return PingFault::kTooWide;
  const RangeWindow& w = ping.window;
  if (!(w.bin_m > 0) || !std::isfinite(w.end_m()) || !(w.start_m >= 0) || w.bins <= 0) return PingFault::kBadWindow;
  if (w.bin_m < 1e-5 || w.end_m() > 1e6 || ping.X_BS.translation.norm() > 1e4) return PingFault::kBadScale;
  if (!ping.intensity.data() || ping.intensity.beams() != ping.fan->beams() || ping.intensity.bins() != w.bins) {
    return PingFault::kSizeMismatch;
  }
  if (!spans_fit(ping)) return PingFault::kSizeMismatch;
  if (!ping.X_BS.is_finite() || !std::isfinite(ping.sound_speed) || !(ping.blanking_m >= 0)) {
    return PingFault::kNotFinite;
  }
  if (ping.intensity.type() == SampleType::kF32) {
    for (int b = 0; b < ping.intensity.beams(); ++b) {
      for (int k = 0; k < ping.intensity.bins(); ++k) {
        if (!std::isfinite(ping.intensity(b, k))) return PingFault::kNotFinite;
      }
    }
  }
  return PingFault::kNone;
}

const char* to_text(PingFault fault) {
  switch (fault) {
    case PingFault::kNone: return "none";
    case PingFault::kNoFan: return "no beams";
    case PingFault::kBadFan: return "beams out of order or without width";
    case PingFault::kTooWide: return "beams round more than a whole turn";
    case PingFault::kBadWindow: return "no usable range window";
    case PingFault::kBadScale: return "bins, range or mount of a size that no sonar has";
    case PingFault::kSizeMismatch: return "samples do not match beams and bins";
    case PingFault::kNotFinite: return "value not finite";
  }
  return "unknown";
}

}  // namespace isobath
