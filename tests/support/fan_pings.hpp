// FanPings: pings of a fan for tests of detectors and mappers, with the truth of each sample.
//
// It shares nothing with isobath/sim: other random numbers (Mersenne twister), other geometry (a flat bottom and a flat
// surface in closed form, targets as points and arcs), other filters. What works on both does not work by an error that
// both have. In metres and radians; amplitudes in counts of a scale that is full at `full_scale`.
//
// Power of a sample, counts^2, after a receiver that makes good 30 log r and the absorption:
//   target   level^2 a(azimuth)                     in the bin of its range; steady, in any phase
//   ring     level^2 (10 m / r) sin^2 t / sin^2 t10 a(t)^2 / cos t   from r = h on, t = asin(h / r), t10 at 10 m:
//            Lambert's law over the cell r width bin / cos t, r^-4 r^3; speckled
//   noise    4 / pi mean^2; Rayleigh, or K with a texture over patches of kPatchBeams by kPatchBins
// a: main lobe exp2(-(2 x / width)^2), never below the side lobes. Speckle and noise are mixed over the beams that one
// beam overlaps, and speckle keeps `memory` of its field from ping to ping.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <isobath/sonar/ping.hpp>
#include <numbers>
#include <random>
#include <vector>

namespace isobath::test {

struct FanTarget {
  double range_m = 20, azimuth = 0;
  double level = 80;      ///< amplitude on the axis, counts
  double half_angle = 0;  ///< of an arc about the sonar; 0: a point
};

struct FanRing {
  double distance_m = 0;  ///< of the plane from the sonar, upright; 0: there is none
  double level = 40;      ///< counts at 10 m
};

struct FanSettings {
  int beams = 128, bins = 300;
  double sector = 1.5, width = 0.02, height = 0.35, bin_m = 0.1;
  double side_lobe_db = 25, full_scale = 255;
  double noise = 8;   ///< mean amplitude of the background without a texture, counts
  int k_shape = 0;    ///< of its texture; 0: none, a Rayleigh law
  double memory = 0;  ///< of speckle, 0 to 1
  FanRing bottom, surface;
  std::vector<FanTarget> targets;
  std::vector<int> dead;               ///< beams that give 0
  std::vector<double> stave_gains{1};  ///< of equal shares of the beams, from the first
  std::uint64_t seed = 1;
};

enum class FanSource : std::uint8_t { kNoise, kTarget, kSideLobe, kBottom, kSurface };

/// Beam by beam; mean powers before clipping, counts^2.
struct FanPing {
  Ping ping;
  std::vector<FanSource> source;  ///< of the strongest part; kNoise where that is below the noise
  std::vector<double> echo;       ///< mean power of all that is not noise
  std::vector<double> noise;      ///< mean power of the noise, its texture included
  [[nodiscard]] std::size_t at(int beam, int bin) const {
    return static_cast<std::size_t>(beam) * static_cast<std::size_t>(ping.window.bins) + static_cast<std::size_t>(bin);
  }
};

class FanPings {
 public:
  static constexpr int kPatchBeams = 4, kPatchBins = 8;

  explicit FanPings(FanSettings settings) : s_(std::move(settings)), twister_(s_.seed) {
    auto fan = std::make_shared<BeamFan>();
    for (int b = 0; b < s_.beams; ++b) fan->azimuth.push_back(Angle::radians(azimuth(b)));
    fan->width.assign(static_cast<std::size_t>(s_.beams), Angle::radians(s_.width));
    fan->height = Angle::radians(s_.height);
    fan_ = fan;
  }

  /// `gain`: a step of the receiver's, over the whole image.
  FanPing next(Time time = {}, double gain = 1) {
    FanPing out;
    const std::size_t size = static_cast<std::size_t>(s_.beams) * static_cast<std::size_t>(s_.bins);
    out.source.resize(size);
    out.echo.resize(size);
    out.noise.resize(size);
    describe(out.ping, time);
    const std::vector<std::complex<double>> fresh = mixed(white()), noise = mixed(white());
    const double kept = speckle_.empty() ? 0 : s_.memory;
    if (speckle_.empty()) speckle_.resize(size);
    for (std::size_t i = 0; i < size; ++i) speckle_[i] = kept * speckle_[i] + std::sqrt(1 - kept * kept) * fresh[i];
    const std::vector<double> textures = texture();
    auto samples = std::make_shared<std::vector<std::uint8_t>>(size);
    for (int b = 0; b < s_.beams; ++b) {
      const double g = gain * stave_gain(b);
      const bool dead = std::find(s_.dead.begin(), s_.dead.end(), b) != s_.dead.end();
      for (int k = 0; k < s_.bins; ++k) {
        const std::size_t i = out.at(b, k);
        const Parts parts = parts_at(b, k);
        out.noise[i] = g * g * 4 / std::numbers::pi * s_.noise * s_.noise * textures[i];
        out.echo[i] = g * g * (parts.steady + parts.bottom + parts.surface);
        out.source[i] = strongest(parts, out.noise[i] / (g * g));
        const std::complex<double> wave = std::polar(g * std::sqrt(parts.steady), phase()) +
                                          g * std::sqrt(parts.bottom + parts.surface) * speckle_[i] +
                                          std::sqrt(out.noise[i]) * noise[i];
        const double counts = dead ? 0 : std::min(std::round(std::abs(wave)), s_.full_scale);
        (*samples)[i] = static_cast<std::uint8_t>(counts);
      }
    }
    out.ping.intensity = Intensities(samples->data(), SampleType::kU8, s_.beams, s_.bins, s_.bins, 1);
    out.ping.storage = std::move(samples);
    return out;
  }

  [[nodiscard]] double azimuth(int beam) const { return s_.sector * ((beam + 0.5) / s_.beams - 0.5); }
  /// Two-way pattern, power.
  [[nodiscard]] double lobe(double off_axis, double width) const {
    return std::max(std::exp2(-std::pow(2 * off_axis / width, 2)), std::pow(10, -s_.side_lobe_db / 10));
  }
  /// Mean power of a ring at a range.
  [[nodiscard]] double ring(const FanRing& plane, double r) const {
    const double h = plane.distance_m;
    if (h <= 0 || r <= h) return 0;
    const double sine = h / r, at_ten = std::min(h / 10, 1.0), t = std::asin(sine);
    const double cosine = std::max(std::cos(t), 0.05);
    return plane.level * plane.level * (10 / r) * (sine * sine) / (at_ten * at_ten) * lobe(t, s_.height) / cosine;
  }

 private:
  struct Parts {
    double steady = 0, bottom = 0, surface = 0;
    bool main_lobe = false;  ///< whether a target is heard along the axis, not beside it
  };

  double uniform() { return (static_cast<double>(twister_() >> 11) + 0.5) * 0x1.0p-53; }
  double phase() { return 2 * std::numbers::pi * uniform(); }

  std::vector<std::complex<double>> white() {
    std::vector<std::complex<double>> all(static_cast<std::size_t>(s_.beams) * static_cast<std::size_t>(s_.bins));
    for (auto& z : all) z = std::polar(std::sqrt(-std::log(uniform())), phase());
    return all;
  }

  /// Each beam as the sum of its neighbours, by the amplitude of its pattern; unit mean power everywhere.
  [[nodiscard]] std::vector<std::complex<double>> mixed(const std::vector<std::complex<double>>& in) const {
    std::vector<std::complex<double>> out(in.size());
    const double spacing = s_.sector / s_.beams;
    const int reach = static_cast<int>(1.2 * s_.width / spacing);
    for (int b = 0; b < s_.beams; ++b) {
      double energy = 0;
      for (int j = std::max(0, b - reach); j <= std::min(s_.beams - 1, b + reach); ++j) {
        const double weight = std::exp2(-2 * std::pow((j - b) * spacing / s_.width, 2));
        energy += weight * weight;
        for (int k = 0; k < s_.bins; ++k) out[index(b, k)] += weight * in[index(j, k)];
      }
      for (int k = 0; k < s_.bins; ++k) out[index(b, k)] /= std::sqrt(energy);
    }
    return out;
  }

  /// Means of `k_shape` exponentials, one a patch.
  std::vector<double> texture() {
    std::vector<double> all(static_cast<std::size_t>(s_.beams) * static_cast<std::size_t>(s_.bins), 1);
    if (s_.k_shape == 0) return all;
    for (int b0 = 0; b0 < s_.beams; b0 += kPatchBeams) {
      for (int k0 = 0; k0 < s_.bins; k0 += kPatchBins) {
        double sum = 0;
        for (int i = 0; i < s_.k_shape; ++i) sum -= std::log(uniform());
        for (int b = b0; b < std::min(s_.beams, b0 + kPatchBeams); ++b)
          for (int k = k0; k < std::min(s_.bins, k0 + kPatchBins); ++k) all[index(b, k)] = sum / s_.k_shape;
      }
    }
    return all;
  }

  [[nodiscard]] Parts parts_at(int beam, int bin) const {
    Parts parts;
    const double near = bin * s_.bin_m, r = near + 0.5 * s_.bin_m;
    for (const FanTarget& target : s_.targets) {
      if (target.range_m < near || target.range_m >= near + s_.bin_m) continue;
      const double off = std::max(0.0, std::abs(azimuth(beam) - target.azimuth) - target.half_angle);
      const double heard = lobe(off, s_.width);
      parts.steady += target.level * target.level * heard;
      parts.main_lobe = parts.main_lobe || off <= s_.width;
    }
    parts.bottom = ring(s_.bottom, r);
    parts.surface = ring(s_.surface, r);
    return parts;
  }

  static FanSource strongest(const Parts& p, double noise) {
    const double most = std::max({p.steady, p.bottom, p.surface});
    if (most < noise) return FanSource::kNoise;
    if (most == p.steady) return p.main_lobe ? FanSource::kTarget : FanSource::kSideLobe;
    return most == p.bottom ? FanSource::kBottom : FanSource::kSurface;
  }

  [[nodiscard]] double stave_gain(int beam) const {
    const auto staves = s_.stave_gains.size();
    return s_.stave_gains[static_cast<std::size_t>(beam) * staves / static_cast<std::size_t>(s_.beams)];
  }
  [[nodiscard]] std::size_t index(int beam, int bin) const {
    return static_cast<std::size_t>(beam) * static_cast<std::size_t>(s_.bins) + static_cast<std::size_t>(bin);
  }

  void describe(Ping& ping, Time time) const {
    ping.time = time;
    ping.fan = fan_;
    ping.window = {0, s_.bin_m, s_.bins};
    ping.full_scale = static_cast<float>(s_.full_scale);
  }

  FanSettings s_;
  std::mt19937_64 twister_;
  std::shared_ptr<const BeamFan> fan_;
  std::vector<std::complex<double>> speckle_;
};

}  // namespace isobath::test
