// Echo profiles for tests: background of a known law, targets of constant amplitude, pings made of them (ledger S6-02).
//
// Made from normals and exponentials only, so that it shares nothing with the fits and thresholds that it tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <isobath/base/random.hpp>
#include <isobath/sonar/ping.hpp>
#include <memory>
#include <vector>

namespace isobath::test {

/// One sample of background.
using Background = std::function<double(Random&)>;

inline Background gaussian(double mean, double sigma) {
  return [=](Random& r) { return mean + sigma * r.normal(); };
}

/// Amplitude of a complex normal: E[x^2] = 2 sigma^2.
inline Background rayleigh(double sigma) {
  return [=](Random& r) { return sigma * std::hypot(r.normal(), r.normal()); };
}

/// A power: mean `mean`.
inline Background exponential(double mean) {
  return [=](Random& r) { return -mean * std::log(1 - r.uniform()); };
}

/// K-distributed amplitude of whole shape: a Rayleigh whose power is a mean of `shape` exponentials. E[x^2] = 2
/// sigma^2.
inline Background k_law(int shape, double sigma) {
  return [=](Random& r) {
    double power = 0;
    for (int i = 0; i < shape; ++i) power -= std::log(1 - r.uniform());
    return sigma * std::sqrt(power / shape) * std::hypot(r.normal(), r.normal());
  };
}

/// Rough ground: mostly weak Rayleigh, sometimes a strong steady reflector.
inline Background sea_mixture(double sigma) {
  return [=](Random& r) {
    return r.uniform() < 0.7 ? sigma * std::hypot(r.normal(), r.normal()) : 5 * sigma + sigma * r.normal();
  };
}

inline std::shared_ptr<const BeamFan> fan_of(int beams, Angle first = {}, Angle step = Angle::degrees(1)) {
  auto fan = std::make_shared<BeamFan>();
  for (int b = 0; b < beams; ++b) fan->azimuth.push_back(first + step * b);
  fan->width.assign(beams, step);
  fan->height = Angle::degrees(20);
  return fan;
}

/// A ping that owns its samples, beam after beam; value(beam, bin) is rounded and clipped for whole samples.
template <class Sample, class Value>
Ping ping_of(std::shared_ptr<const BeamFan> fan, RangeWindow window, Value value, float full_scale = 255) {
  auto samples = std::make_shared<std::vector<Sample>>();
  for (int b = 0; b < fan->beams(); ++b) {
    for (int k = 0; k < window.bins; ++k) {
      const double z = value(b, k);
      samples->push_back(std::is_integral_v<Sample>
                             ? static_cast<Sample>(std::clamp(std::round(z), 0.0, static_cast<double>(full_scale)))
                             : static_cast<Sample>(z));
    }
  }
  constexpr SampleType kType = sizeof(Sample) == 1   ? SampleType::kU8
                               : sizeof(Sample) == 2 ? SampleType::kU16
                                                     : SampleType::kF32;
  Ping ping;
  ping.window = window;
  ping.intensity = Intensities(samples->data(), kType, fan->beams(), window.bins,
                               static_cast<std::ptrdiff_t>(sizeof(Sample)) * window.bins, sizeof(Sample));
  ping.fan = std::move(fan);
  ping.storage = std::move(samples);
  ping.full_scale = full_scale;
  return ping;
}

}  // namespace isobath::test
