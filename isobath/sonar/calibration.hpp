// Calibration: computes a SensorModel, noise fits and ROC curves from recordings of background and of marked targets.
//
// Source: Ganesan 2015, 3.1, 4.2, 4.3; ledger S6-04 to S6-09, S6-D01 to S6-D03. Intensities in counts, ranges in m.
//
// Thresholds: t_k is the 1 - f quantile of the noise of bin k and `pool_bins` neighbours on each side (more if samples
// are few). Whole-number samples get the next whole threshold with at most the rate f. With background only, p_D is the
// configured one. Targets are exactly the cells marked in frames with truth, without tolerance around them. p_D(k) is
// the share of marked cells at or above their thresholds in the nearest `min_targets` cells (in range), with half a
// hit and half a miss added, so that it is never 0 or 1. Unmarked cells of marked frames count neither as noise nor as
// target: an annotation marks the surface of a target, and the echoes behind and beside it are no false alarms. Bins
// with p_D <= f, or whose noise saturates, are blind.
//
// Beams: if some beams of a fan are noisier than the median beam (a streak, a taper), the model stores the ratio of
// their mean background, and detectors raise their thresholds by it; p_D is that of the whole fan.
//
// Comparison: k-fold cross-validation over frames (background in blocks of 4 neighbouring frames). It compares
// thresholds per bin with one threshold for all bins. Both come from the background of the other folds and are
// evaluated on the held-out frames at the same measured false-alarm rate: the global threshold is moved until its rate
// equals that of the per-bin thresholds. Rates between two whole thresholds are interpolated linearly (a threshold
// drawn at random between both).
//
// A noise fit uses one bin per range group, the middle one, with all beams together.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/sonar/echo_histogram.hpp>
#include <isobath/sonar/noise_fit.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/roc.hpp>
#include <isobath/sonar/sensor_model.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct CalibrationConfig {
  double false_alarm = 0.02;
  double p_detect = 0.8;    ///< if no target is marked
  double blanking_m = 0.6;  ///< nearer bins are blind
  int pool_bins = -1;       ///< on each side; -1: 1/64 of the window
  int min_targets = 30;     ///< minimum number of marked cells for a p_D
  int range_groups = 8;
  int folds = 4;
  NoiseFitConfig noise;
};
std::vector<Field> fields(CalibrationConfig& config);

/// A measured share of `trials`; the interval is Wilson's, 95 %.
struct Rate {
  double value = 0;
  Interval interval;
  double trials = 0;
};

struct RangeGroup {
  int first = 0;  ///< bins first .. last - 1
  int last = 0;
  double near_m = 0;
  double far_m = 0;
  int fitted_bin = 0;
  std::vector<NoiseFit> fits;   ///< one per law
  EchoCounts counts;            ///< at the thresholds of the model, without blind bins
  std::optional<RocCurve> roc;  ///< if there are marked cells
  double snr = 0;               ///< of the marked cells, A^2 / sigma^2, for theoretical_detection; if there are any
};

/// Detection on frames not used for the thresholds, at one false-alarm rate.
struct ThresholdComparison {
  double nominal_false_alarm = 0;
  Rate false_alarm;  ///< measured on held-out background, the same for both
  Rate per_bin;      ///< p of the per-bin thresholds
  Rate global;       ///< p of one threshold for all bins
};

struct CalibrationResult {
  SensorModel model;
  int background_pings = 0;
  int marked_pings = 0;
  std::uint64_t marked_cells = 0;  ///< without bins nearer than blanking_m
  std::vector<RangeGroup> groups;
  std::vector<ThresholdComparison> comparison;  ///< at f = 0.01, 0.02, 0.03, 0.05; empty without marks
};

class Calibration {
 public:
  explicit Calibration(const CalibrationConfig& config);

  /// The ping must pass `check`. Throws Error if its window, full scale or sample type differs from the first ping's.
  void add_background(const Ping& ping);
  /// `marked`: beams x bins, beam by beam; nonzero if the cell holds a target.
  void add_marked(const Ping& ping, std::span<const std::uint8_t> marked);

  /// Throws Error if there is too little background for the false-alarm rate.
  [[nodiscard]] CalibrationResult finish(const std::string& source) const;

 private:
  struct Fold {
    EchoHistogram noise;
    EchoHistogram target;
  };
  void prepare(const Ping& ping);
  [[nodiscard]] int reach() const;
  [[nodiscard]] Fold all() const;
  [[nodiscard]] std::vector<EchoDistribution> pooled_noise(const EchoHistogram& noise, double false_alarm) const;
  void set_detection(SensorModel& model, const Fold& all) const;
  [[nodiscard]] std::vector<double> beam_gains() const;
  [[nodiscard]] RangeGroup group(int first, int last, const SensorModel& model, const Fold& all) const;
  [[nodiscard]] std::vector<ThresholdComparison> compare() const;

  CalibrationConfig config_;
  RangeWindow window_;
  float full_scale_ = 0;
  SampleType type_ = SampleType::kU8;
  int first_bin_ = 0;
  int background_pings_ = 0;
  int marked_pings_ = 0;
  std::vector<Fold> folds_;
  std::vector<double> beam_sums_;  ///< sums of background samples, by beam
};

/// The whole result except the model, which has its own file (write_sensor_model).
std::string to_json(const CalibrationResult& result);

}  // namespace isobath
