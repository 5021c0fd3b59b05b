// SimulatedSonar: a sonar on a vehicle in a world. From the mean powers of EchoFormer to the samples that a device
// gives: receiver gain, speckle, background noise, disturbances, ringing, quantisation; and the truth of every sample.
//
// Sample = full scale x 10^((EL + TVG - saturation) / 20), EL = source level + 10 log10 of the power: linear amplitude,
// in counts. Speckle: the power of a rough surface is exponential (Goodman 1975). Background: Gaussian, added to the
// amplitude, as measured in the lake (Ganesan 2015, 4.2; S6-D01); Rayleigh, the envelope of a circular Gaussian with
// the echo in it (so a Rice law); K, the same with a Gamma texture (Jakeman and Pusey 1976; Ward, Tough, Watts 2006).
// Noise levels are counts after the receiver's gain, of a scale that saturates at 255 whatever the samples are (16
// bits: times 257; floats: not cut off). Last comes what the device does to the amplitude: a black level taken off,
// compression to decibels (Tritech's heads: full scale over a span of dB above a threshold), a ceiling. Reverberation
// of a closed basin is the diffuse field that is left of paths nobody follows: Rayleigh, in addition. Ranges are picked
// before samples saturate.
//
// Samples of a fan fluctuate together where beams, pulses and pings have water in common (fan_fluctuations.hpp): its
// pings follow from those before. All other samples are independent of each other, and so are a fan's where
// `correlated` is off; a ping can then be made without those before it. The law of each sample is the same.
//
// Every random number follows from (seed, ping, beam): the same samples on any number of
// threads, and other settings of one sonar do not disturb another. Sonars of one seed have the same noise: give each
// its own.
#pragma once

#include <isobath/sim/echo_former.hpp>
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
    std::optional<Ping> ping;          ///< empty for a sonar of ranges, or a ping that dropped out
    std::vector<RangeReading> ranges;  ///< one a beam
    EchoTruth truth;
  };

  SimulatedSonar(const SonarConfig& config, const World& world, const Water& water, std::uint64_t seed, int threads);

  [[nodiscard]] const SonarConfig& config() const { return config_; }
  [[nodiscard]] Duration interval() const;
  /// Ping `number` (from 0: it sets where a scanning head looks), transmitted at X_WB.
  Output ping(Time time, const Pose& X_WB, std::uint64_t number);
  /// The next ping obeys (S4-40); a scanning head begins its sector with it. Throws Error where no such sonar could be,
  /// and nothing has changed then.
  void command(const ScanCommand& command);
  /// Sample of an echo of unit power (relative to the source level) at the centre of a bin, before quantisation.
  [[nodiscard]] double gain(int bin) const { return gain_[static_cast<std::size_t>(bin)]; }
  /// Mean powers of the last ping: for those who check the physics.
  [[nodiscard]] const EchoImage& image() const { return image_; }

 private:
  struct Disturbances {
    int streak = -1, ring = -1, spurious_beam = -1, spurious_bin = -1;
    bool burst = false;
  };
  [[nodiscard]] Angle head_azimuth(std::uint64_t number) const;
  [[nodiscard]] Disturbances draw(Random random) const;
  /// `shared`: chance that samples have in common; null: `random` and `speckle` alone. `amplitudes`: room to work in.
  void fill(int beam, Random random, Random speckle, const FanFluctuations::Row* shared, const Disturbances& now,
            std::vector<double>& amplitudes, float* samples, EchoLabel* labels) const;
  int fill_fast(int beam, const FanFluctuations::Row& shared, std::vector<double>& amplitudes, float* samples,
                EchoLabel* labels) const;
  void fill_bin(int beam, int k, Random& random, Random& speckle, const FanFluctuations::Row* shared,
                const Disturbances& now, float& sample_out, EchoLabel& label) const;
  [[nodiscard]] double sample(Random& random, double mean, double fluctuating, double steady) const;
  [[nodiscard]] double sample(const FanFluctuations::Row& shared, std::size_t bin, double mean, double fluctuating,
                              double steady) const;
  /// Counts of linear amplitude to the sample that the device gives.
  [[nodiscard]] double received(double amplitude) const;
  void pick_ranges(const Ping& ping, Output& out) const;

  SonarConfig config_;
  const World* world_;
  const Water* water_;
  EchoFormer former_;
  std::uint64_t seed_;
  int threads_;
  double full_scale_;
  double audible_;  ///< amplitude below which the device is silent, counts
  double k_root_ = 1;
  std::vector<double> gain_, power_gain_, noise_by_bin_, noise_by_beam_, reverberation_;
  std::vector<std::shared_ptr<const BeamFan>> fans_;  ///< of a fan: one; of a scanning head: one a step
  EchoImage image_;
  std::optional<FanFluctuations> fluctuations_;
  std::vector<float> samples_;
  bool restarts_ = false;           ///< with the next ping
  std::uint64_t first_number_ = 0;  ///< of the ping that the head began its sector with
};

}  // namespace isobath
