// SimulatedSonar: a sonar on a vehicle in a world. It turns the mean powers of EchoSynthesizer into the samples of a
// device: receiver gain, speckle, background noise, disturbances, ringing, quantisation. It also gives the truth of
// each sample.
//
// Sample = full scale x 10^((EL + TVG - saturation) / 20), EL = source level + 10 log10 of the power: linear amplitude,
// in counts. Speckle: the power of a rough surface is exponential (Goodman 1975). Background laws: Gaussian, added to
// the amplitude, as measured in the lake (Ganesan 2015, 4.2; S6-D01); Rayleigh, the envelope of a circular Gaussian
// that includes the echo (so a Rice law); K, the same with a Gamma texture (Jakeman and Pusey 1976; Ward, Tough, Watts
// 2006). Noise levels are counts after the receiver's gain, on a scale that saturates at 255 for all sample types (16
// bits: times 257; floats: not clipped). The device's own amplitude processing comes last: subtraction of a black
// level, compression to decibels (Tritech's heads: full scale over a span of dB above a threshold), a ceiling.
// Reverberation of a closed basin is the diffuse field of all paths that are not traced: Rayleigh, in addition. Ranges
// are picked before samples saturate.
//
// Samples of a fan are correlated where beams, pulses and pings share the same water (fan_fluctuations.hpp), so a ping
// depends on the pings before it. All other samples are independent. With `correlated` off, those of a fan are too, and
// a ping can be made without the pings before it. The distribution of each sample is the same.
//
// All random numbers follow from (seed, ping, beam): the samples do not depend on the number of threads, and the
// settings of one sonar do not disturb another. Sonars with the same seed have the same noise: give each its own.
#pragma once

#include <isobath/sim/echo_synthesizer.hpp>
#include <isobath/sim/fan_fluctuations.hpp>
#include <isobath/sim/random_at.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <memory>
#include <optional>
#include <vector>

namespace isobath {

/// Gamma of shape k > 0 and mean 1 (Marsaglia and Tsang 2000).
double unit_mean_gamma(Random& random, double shape);

class SimulatedSonar {
 public:
  struct Output {
    std::optional<Ping> ping;          ///< empty for a range sonar, or a lost ping
    std::vector<RangeReading> ranges;  ///< one per beam
    EchoTruth truth;
  };

  SimulatedSonar(const SonarConfig& config, const World& world, const Water& water, std::uint64_t seed, int threads);

  [[nodiscard]] const SonarConfig& config() const { return config_; }
  [[nodiscard]] Duration interval() const;
  /// Ping `number` (from 0; it sets the direction of a scanning head), transmitted at X_WB.
  Output ping(Time time, const Pose& X_WB, std::uint64_t number);
  /// Applies the command from the next ping on (S4-40); a scanning head restarts its sector with that ping. Throws
  /// Error for an invalid configuration, and then changes nothing.
  void command(const ScanCommand& command);
  /// Sample of an echo of unit power (relative to the source level) at the centre of a bin, before quantisation.
  [[nodiscard]] double gain(int bin) const { return gain_[static_cast<std::size_t>(bin)]; }
  /// Mean powers of the last ping, for checks of the physics.
  [[nodiscard]] const EchoImage& image() const { return image_; }

 private:
  struct Disturbances {
    int streak = -1, ring = -1, spurious_beam = -1, spurious_bin = -1;
    bool burst = false;
  };
  [[nodiscard]] Angle head_azimuth(std::uint64_t number) const;
  [[nodiscard]] Disturbances draw(Random random) const;
  /// `shared`: correlated random fields of the beam; null: only `random` and `speckle`. `amplitudes`: scratch space.
  void fill(int beam, Random random, Random speckle, const FanFluctuations::Row* shared, const Disturbances& now,
            std::vector<double>& amplitudes, float* samples, EchoLabel* labels) const;
  int fill_fast(int beam, const FanFluctuations::Row& shared, std::vector<double>& amplitudes, float* samples,
                EchoLabel* labels) const;
  void fill_bin(int beam, int k, Random& random, Random& speckle, const FanFluctuations::Row* shared,
                const Disturbances& now, float& sample_out, EchoLabel& label) const;
  [[nodiscard]] double sample(Random& random, double mean, double fluctuating, double steady) const;
  [[nodiscard]] double sample(const FanFluctuations::Row& shared, std::size_t bin, double mean, double fluctuating,
                              double steady) const;
  /// Converts linear amplitude in counts to the sample of the device.
  [[nodiscard]] double received(double amplitude) const;
  void pick_ranges(const Ping& ping, Output& out) const;

  SonarConfig config_;
  const World* world_;
  const Water* water_;
  EchoSynthesizer former_;
  std::uint64_t seed_;
  int threads_;
  double full_scale_;
  double audible_;  ///< amplitude below which the device gives 0, counts
  double k_root_ = 1;
  std::vector<double> gain_, power_gain_, noise_by_bin_, noise_by_beam_, reverberation_;
  std::vector<std::shared_ptr<const BeamFan>> fans_;  ///< fan: one; scanning head: one per step
  EchoImage image_;
  std::optional<FanFluctuations> fluctuations_;
  std::vector<float> samples_;
  bool restarts_ = false;           ///< whether the next ping restarts the sector
  std::uint64_t first_number_ = 0;  ///< number of the ping with which the head began its sector
};

}  // namespace isobath
