#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <isobath/sonar/ping_quality.hpp>

namespace isobath {
namespace {

constexpr double kMinDeviation = 0.015;  // minimum deviation, as a share of full scale
constexpr double kSteep = 0.7071;        // sine of 45 degrees

struct BeamSums {
  double level = 0;
  double steps = 0;
  std::int64_t full = 0;
  std::int64_t zero = 0;
};

/// Four lanes, so that the multiplications are independent.
class Digest {
 public:
  void add(std::size_t at, std::uint64_t bits) {
    std::uint64_t& lane = lanes_[at % 4];
    lane = (lane ^ bits) * 0x9E3779B97F4A7C15ULL;
    lane ^= lane >> 29U;
  }
  [[nodiscard]] std::uint64_t value() const {
    std::uint64_t all = 0;
    for (const std::uint64_t lane : lanes_) all = (all ^ lane) * 0xD6E8FEB86659FD93ULL + 1;
    return all ^ all >> 32U;
  }

 private:
  std::array<std::uint64_t, 4> lanes_{1, 2, 3, 4};
};

template <class Sample>
BeamSums sum_beam(const Intensities& samples, int beam, float top, Digest& digest) {
  BeamSums sums;
  const std::byte* at = samples.data() + beam * samples.beam_stride();
  float before = 0;
  for (int k = 0; k < samples.bins(); ++k, at += samples.bin_stride()) {
    Sample sample;
    std::memcpy(&sample, at, sizeof sample);
    std::uint64_t bits = 0;
    std::memcpy(&bits, &sample, sizeof sample);
    digest.add(static_cast<std::size_t>(k), bits);
    const auto level = static_cast<float>(sample);
    sums.level += static_cast<double>(level);
    if (k > 0) sums.steps += static_cast<double>(std::abs(level - before));
    sums.full += static_cast<std::int64_t>(level >= top);
    sums.zero += static_cast<std::int64_t>(level <= 0);
    before = level;
  }
  return sums;
}

BeamSums sum_beam(const Intensities& samples, int beam, float top, Digest& digest) {
  switch (samples.type()) {
    case SampleType::kU8: return sum_beam<std::uint8_t>(samples, beam, top, digest);
    case SampleType::kU16: return sum_beam<std::uint16_t>(samples, beam, top, digest);
    case SampleType::kF32: return sum_beam<float>(samples, beam, top, digest);
  }
  return {};
}

/// Median of the values; reorders them.
float median(float* first, float* last) {
  float* middle = first + (last - first) / 2;
  std::nth_element(first, middle, last);
  return *middle;
}

/// Median and deviation of a beam. Long beams are subsampled, which is enough for a median.
struct BeamLevel {
  float middle = 0;
  double deviation = 0;
  /// Level above which an echo is clear.
  [[nodiscard]] float outstanding(double contrast) const { return middle + static_cast<float>(contrast * deviation); }
};

BeamLevel level_of(const Ping& ping, const EchoDecisions& decisions, int beam) {
  constexpr int kMax = 256;
  std::array<float, kMax> some{};
  const int stride = (decisions.bins() + kMax - 1) / kMax;
  float* last = some.data();
  for (int k = 0; k < decisions.bins(); k += stride) {
    if (decisions.usable(k)) *last++ = ping.intensity(beam, k);
  }
  if (last == some.data()) return {ping.full_scale, 0};
  const float middle = median(some.data(), last);
  for (float* value = some.data(); value != last; ++value) *value = std::abs(*value - middle);
  // The deviation of nearly constant samples is close to 0, so it has a minimum.
  const double least = kMinDeviation * static_cast<double>(ping.full_scale);
  return {middle, std::max(1.4826 * static_cast<double>(median(some.data(), last)), least)};
}

/// The nearest clear echo. `level` is that of the beam, found where there is a decision for an echo.
std::optional<int> nearest_clear(const Ping& ping, const EchoDecisions& decisions, int beam, double contrast,
                                 std::optional<BeamLevel>& level) {
  const std::uint64_t* hits = decisions.hits(beam);
  for (int word = 0; word < decisions.words(); ++word) {
    for (std::uint64_t left = hits[word] & decisions.usable()[word]; left != 0; left &= left - 1) {
      const int bin = word * 64 + std::countr_zero(left);
      if (!decisions.tells(beam, bin)) continue;
      if (!level) level = level_of(ping, decisions, beam);
      if (ping.intensity(beam, bin) >= level->outstanding(contrast)) return bin;
    }
  }
  return std::nullopt;
}

std::optional<int> nearer(const std::optional<int>& clear, const std::optional<int>& dense) {
  return dense && (!clear || *dense < *clear) ? dense : clear;
}

}  // namespace

std::optional<int> nearest_clear_echo(const Ping& ping, const EchoDecisions& decisions, int beam, double contrast) {
  std::optional<BeamLevel> level;
  return nearest_clear(ping, decisions, beam, contrast, level);
}

std::optional<int> nearest_dense_echo(const EchoDecisions& decisions, int beam) {
  constexpr double kFalse = 1e-3;  // of a beam
  const double sure = std::log(decisions.bins() / kFalse);
  const double f = decisions.false_alarm;
  double evidence = 0;
  int first = 0, last = -1;
  const std::uint64_t* hits = decisions.hits(beam);
  for (int word = 0; word < decisions.words(); ++word) {
    for (std::uint64_t left = hits[word] & decisions.usable()[word]; left != 0; left &= left - 1) {
      const int bin = word * 64 + std::countr_zero(left);
      if (!decisions.tells(beam, bin)) continue;
      const double p = std::min(0.999, static_cast<double>(decisions.p_of(beam, bin)));
      if (!(p > f)) continue;
      evidence += (bin - last - 1) * std::log((1 - p) / (1 - f));
      if (!(evidence > 0)) {
        evidence = 0;
        first = bin;
      }
      evidence += std::log(p / f);
      last = bin;
      if (evidence >= sure) return first;
    }
  }
  return std::nullopt;
}

std::optional<int> nearest_sure_echo(const Ping& ping, const EchoDecisions& decisions, int beam, double contrast) {
  return nearer(nearest_clear_echo(ping, decisions, beam, contrast), nearest_dense_echo(decisions, beam));
}

/// Raised contrast of a fan, for noise with Rayleigh-distributed amplitude.
double contrast_of_fan(double contrast, int beams) {
  constexpr double kMedian = 1.1774, kDeviation = 1.4826 * 0.4485;  // in units of the Rayleigh scale
  const double level = kMedian + contrast * kDeviation;
  return (std::sqrt(level * level + 2 * std::log(std::max(1, beams))) - kMedian) / kDeviation;
}

PingQuality quality_of(const Ping& ping) {
  PingQuality quality;
  Digest digest;
  BeamSums all;
  double port = 0, starboard = 0;
  int port_beams = 0, starboard_beams = 0;
  const int beams = ping.intensity.beams(), bins = ping.intensity.bins();
  for (int b = 0; b < beams; ++b) {
    const BeamSums sums = sum_beam(ping.intensity, b, ping.full_scale, digest);
    all.level += sums.level;
    all.steps += sums.steps;
    all.full += sums.full;
    all.zero += sums.zero;
    const double side = std::sin(ping.fan->azimuth[static_cast<std::size_t>(b)].radians());
    if (side < 0) {
      port += sums.level;
      ++port_beams;
    } else if (side > 0) {
      starboard += sums.level;
      ++starboard_beams;
    }
  }
  const double scale = static_cast<double>(ping.full_scale), samples = static_cast<double>(beams) * bins;
  quality.digest = digest.value();
  quality.mean = all.level / (samples * scale);
  quality.full_scale = static_cast<double>(all.full) / samples;
  quality.silent = static_cast<double>(all.zero) / samples;
  if (bins > 1) quality.roughness = all.steps / (static_cast<double>(beams) * (bins - 1) * scale);
  if (port_beams > 0) quality.port = port / (static_cast<double>(port_beams) * bins * scale);
  if (starboard_beams > 0) quality.starboard = starboard / (static_cast<double>(starboard_beams) * bins * scale);
  const Angle middle = (ping.fan->azimuth.front() + ping.fan->azimuth.back()) / 2;
  const Eigen::Vector3d aim_B =
      ping.X_BS.rotation * Eigen::Vector3d(std::cos(middle.radians()), std::sin(middle.radians()), 0);
  quality.bearing = Angle::radians(std::atan2(aim_B.y(), aim_B.x()));
  return quality;
}

void nearest_echoes(const Ping& ping, const EchoDecisions& decisions, const Rotation& R_LB, double contrast,
                    std::vector<Eigen::Vector2d>& out, std::vector<float>& silent_m) {
  out.clear();
  silent_m.clear();
  const Pose X_LS = Pose{R_LB, Eigen::Vector3d::Zero()} * ping.X_BS;
  const Eigen::Vector3d boresight_L = X_LS.rotation * Eigen::Vector3d::UnitX();
  if (!(std::abs(boresight_L.z()) < kSteep)) return;
  const double least = contrast_of_fan(contrast, decisions.beams());
  for (int b = 0; b < decisions.beams(); ++b) {
    std::optional<BeamLevel> level;
    const std::optional<int> clear = nearest_clear(ping, decisions, b, contrast, level);
    const std::optional<int> sure = nearer(clear, nearest_dense_echo(decisions, b));
    silent_m.push_back(static_cast<float>(sure ? ping.window.edge(*sure) : ping.window.end_m()));
    if (!clear) continue;  // then none has the higher contrast of the fan
    const std::optional<int> bin = nearest_clear(ping, decisions, b, least, level);
    if (!bin) continue;
    const double azimuth = ping.fan->azimuth[static_cast<std::size_t>(b)].radians();
    const Eigen::Vector3d p_S = ping.window.edge(*bin) * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0);
    out.emplace_back((X_LS * p_S).head<2>());
  }
}

}  // namespace isobath
