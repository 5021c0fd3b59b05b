// NoiseTracker: the noise level of each range bin of an uncalibrated sonar, learnt from the beams so far.
//
// Method (our own; ledger S6-70 for the aim). Each bin has a histogram of the intensities of recent beams. Targets are
// in its upper part, noise in the lower. So only the quantiles q10, q30 and q50 are used: a shifted Weibull law is
// fitted to them, and the threshold is its 1 - f quantile. The shape (1: exponential, 2: Rayleigh, 3.6: nearly
// Gaussian) is common to all bins, the 70th percentile over the bins, since the law belongs to the sonar while targets
// bend single bins towards heavy tails. Location and scale belong to the bin. A moving median over 1/16 of the window
// to each side then removes echoes that are thin in range.
//
// If a sonar cuts weak samples to 0, so that a bin is 0 more than half the time, the law is fitted to q25 and q50 of
// the remaining samples. Its threshold is limited to 0.7 times the median peak of a beam (below); otherwise a wall that
// is the only echo would hide itself.
//
// Floor: no threshold is below `contrast` times the median, over recent beams, of a beam's strongest sample. If most
// bearings have strong echoes (a tank, a harbour), reverberation and side lobes scale with them. In open water few
// bearings have, so the median is that of the noise itself and the floor has no effect. The price: in a tank, targets
// weaker than the floor are not detected.
//
// Up to 100 beams the distance of the threshold from the median is greater, by half of it after 50 beams: the law is
// known badly then, and only loud echoes count.
//
// Intensities in counts. Causal and deterministic. Older beams fade: at memory_profiles all counts are halved.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/sonar/echo_histogram.hpp>
#include <vector>

namespace isobath {

struct NoiseTrackerConfig {
  double contrast = 0.5;
  int warmup_profiles = 50;    ///< a vehicle that cannot stop sails blind until then
  int memory_profiles = 4000;  ///< 2000 to 4000 beams are remembered
};
std::vector<Field> fields(NoiseTrackerConfig& config);

class NoiseTracker {
 public:
  NoiseTracker() = default;
  /// Bins before first_bin are ignored; their thresholds stay infinite.
  NoiseTracker(EchoLevels levels, int bins, int first_bin, double false_alarm, const NoiseTrackerConfig& config);

  void learn(const float* beam);
  /// Updates the thresholds if enough beams have been added (an eighth more, at most 128), or if `at_once`. Returns
  /// whether it has.
  bool update(bool at_once = false);

  /// Beams learnt from so far.
  [[nodiscard]] int profiles() const { return profiles_; }
  [[nodiscard]] bool warm() const { return profiles_ >= config_.warmup_profiles; }
  [[nodiscard]] const std::vector<float>& thresholds() const { return thresholds_; }
  /// Shape of the present Weibull law.
  [[nodiscard]] double shape() const { return shape_; }
  [[nodiscard]] double floor() const { return floor_; }

 private:
  struct Quantiles {
    double zeros;  ///< share of samples in level 0
    double low, middle, high;
  };
  [[nodiscard]] Quantiles quantiles(const std::uint32_t* row) const;
  void fit_shape();
  [[nodiscard]] double threshold(const Quantiles& q, double peak) const;
  void smooth();

  EchoLevels levels_;
  NoiseTrackerConfig config_;
  double false_alarm_ = 0.02;
  int first_bin_ = 0;
  EchoHistogram noise_;
  EchoHistogram peaks_;  ///< one bin: the strongest sample of each beam
  int profiles_ = 0;
  int remembered_ = 0;
  int due_ = 0;
  double shape_ = 2;
  double floor_ = 0;
  std::vector<float> thresholds_;
  std::vector<double> edges_;
  std::vector<Quantiles> quantiles_;
  std::vector<double> raw_;
  std::vector<double> window_;
};

}  // namespace isobath
