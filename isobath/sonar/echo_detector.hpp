// EchoDetector: decides for each bin of a ping whether it holds an echo. Ledger S6-03, S6-06, S6-09, S6-62, S6-64,
// S6-70.
//
// Methods. `model`: thresholds per range bin from a calibration (SensorModel). `global`: one threshold for all bins.
// `ca_cfar`, `os_cfar`: thresholds from the neighbouring bins of the same beam (cfar.hpp). `auto`, for a sonar that was
// never calibrated: `cells` for a fan of at least 8 beams, `learnt` for a scanning head; with a sensor model, `auto` is
// `model`. `cells`: one decision per resolution cell, by the background across the fan (fan_detector.hpp). `learnt`:
// thresholds learnt from all pings so far, including the present one (noise_tracker.hpp), and a rule for pulse skirts.
// `histogram`: the likelihood ratio of the pixel's intensity from a HistogramModel, at its operating point for
// false_alarm; each echo carries its ratio (EchoDecisions::ratios), and `auto` is `histogram` if there is such a model.
//
// Skirt rule (`learnt` only). The pulse and the beam's height smear a strong echo in range, so plain thresholds place a
// wall too near. A hit is dropped if, within skirt_m behind it, the intensity rises above its own divided by
// skirt_share, without first dipping below its own times skirt_share: it is the foot of that echo. Two targets closer
// than skirt_m with no dip between them are reported at the stronger one.
//
// False alarms of short bins (`auto`, a scanning head). A cell of the map holds many bins of a head with short ones,
// and each may report a false echo: false_alarm holds for a bin of false_alarm_m, the bins of a Micron at 50 m, and a
// shorter one gets its share. Measured on a simulated Ping360 (bins of 0.02 m, cells of 1 m) in a reservoir without
// buoys, three seeds: 10, 11 and 19 false obstacles with the whole rate in each bin, 5, 1 and 3 with its share.
//
// Warm-up (`learnt`): until warmup_profiles beams have been received, all bins are unusable: unknown, neither free nor
// occupied. The default is a quarter turn of a Micron, or four pings of a multibeam sonar (the detector learns from 16
// beams of each ping). If the pings already exist, as in a log, the detector can learn from at least 100 beams before
// its first decision (`listen`). It then also knows the level of each beam of a fan relative to the others, from the 80
// % quantile of sample over threshold in the first ping. The threshold of a beam that is louder by more than 5 % is
// raised by this ratio.
//
// Measured with the whole rate in each bin (false_alarm_m = 0): in a tank of 4.5 m (Micron, 20 turns) the first hit is
// 0.00 to 0.05 m before each wall, without the skirt rule 0.03 to 0.11 m. On the background of a DIDSON, clipped at
// zero, 3 % of the bins hit at f = 0.02. Not promised: an echo that fills half of the bearings and more than an eighth
// of the range window during the whole memory is learnt as noise.
//
// If the water column is known, echoes of bottom and surface are separated from targets (boundary_echoes.hpp). This
// applies to all methods but `cells`, which has its own background.
//
// Bins that a beam has not sampled (Ping::sampled) have no information: they are dim with p_D 0 and no reference for
// CFAR. The detector does not learn from a beam with such bins.
//
// Bins nearer than blanking_m, or than the blind zone that the ping states, are not usable. `detect` allocates only at
// the first ping of a geometry and throws nothing. Not thread-safe: one detector per sonar. Deterministic. Measured on
// one core, 512 beams x 500 bins of 8 bits, G bins/s: thresholds 2.3 (samples in beam order) and 1.6 (in bin order),
// `auto` 0.7, `ca_cfar` 0.07, `os_cfar` 0.03.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/sonar/bin_thresholds.hpp>
#include <isobath/sonar/boundary_echoes.hpp>
#include <isobath/sonar/cfar.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/fan_detector.hpp>
#include <isobath/sonar/histogram_model.hpp>
#include <isobath/sonar/noise_tracker.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/sensor_model.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

enum class DetectionMethod : std::uint8_t {
  kAutomatic,
  kLearnt,
  kCells,
  kModel,
  kGlobal,
  kCellAveraging,
  kOrderedStatistic,
  kHistogram
};

struct EchoDetectorConfig {
  DetectionMethod method = DetectionMethod::kAutomatic;
  double false_alarm = 0.02;      ///< f; a sensor model has its own
  double false_alarm_m = 0.1;     ///< length of a bin for which false_alarm holds, in method auto; 0: any
  double p_detect = 0.8;          ///< p_D; a model has its own
  double blanking_m = 0.6;        ///< nearer bins are not usable
  double global_threshold = 0.5;  ///< share of full scale
  double skirt_share = 0.7;       ///< 0: no skirt rule
  double skirt_m = 0.2;
  NoiseTrackerConfig noise = {};
  CfarConfig cfar = {};
  BoundaryConfig boundary = {};
  FanDetectorConfig fan = {};
};
std::vector<Field> fields(EchoDetectorConfig& config);

/// Whether a detector can decide; in all states but kReady all bins are unusable.
enum class DetectorState : std::uint8_t {
  kReady,
  kWarmingUp,
  kNoModel,
  kModelFullScale,
  kModelRange,
  kModelBinLength,
  kHistogramOfOther  ///< the ping does not match the sonar and settings of the histogram model
};
const char* to_text(DetectorState state);

class EchoDetector {
 public:
  /// `fan_model`: start of the method `cells`; the first ping throws Error if it is of another sonar. Throws Error for
  /// a method `model` or `histogram` without its model. With a model and method `auto`, the model is used, a histogram
  /// model before a sensor model.
  explicit EchoDetector(EchoDetectorConfig config = {}, std::optional<SensorModel> model = std::nullopt,
                        std::shared_ptr<const LikelihoodRatios> ratios = nullptr,
                        std::shared_ptr<const FanModel> fan_model = nullptr);

  /// The ping must pass `check`.
  void detect(const Ping& ping, EchoDecisions& out, const WaterColumn& water = {});

  /// Learns from a recorded ping before the first `detect`, in method `auto`, from all of its beams and without a
  /// decision. Returns whether the detector has learnt enough to decide; the other methods always have.
  bool listen(const Ping& ping);
  /// Ends the listening: from now on the detector decides by what it has learnt, if it has learnt from at least 16
  /// beams.
  void end_learning();

  /// The looks at resolution cells of the last ping, which maps use instead of the samples, if the ping was decided by
  /// cells. Null: each sample is a look of its own.
  [[nodiscard]] const FanLooks* looks() const { return by_cells_ ? &looks_ : nullptr; }
  [[nodiscard]] FanLooks* looks() { return by_cells_ ? &looks_ : nullptr; }
  /// Departure of the pings from the fan model; empty: no model, or no ping was decided by it.
  [[nodiscard]] std::optional<FanDeparture> departure() const { return fan_detector_.departure(); }
  /// State at the last ping.
  [[nodiscard]] DetectorState state() const { return state_; }
  /// Thresholds at the last ping, by range bin (infinite: none); empty for CFAR and histograms, whose thresholds are
  /// per sample.
  [[nodiscard]] const std::vector<float>& thresholds() const { return thresholds_; }
  [[nodiscard]] double false_alarm() const;
  [[nodiscard]] DetectionMethod method() const { return config_.method; }

  /// The method for this ping: resolves `auto`.
  [[nodiscard]] DetectionMethod method_for(const Ping& ping) const;

 private:
  void decide(const Ping& ping, EchoDecisions& out);
  void prepare_for(const Ping& ping);
  void prepare(const Ping& ping);
  void prepare_model(const Ping& ping);
  void prepare_histogram(const Ping& ping);
  void learn(const Ping& ping);
  void take_thresholds();
  void describe(EchoDecisions& out) const;
  void decide_by_cfar(const Ping& ping, EchoDecisions& out);
  void decide_by_ratios(const Ping& ping, EchoDecisions& out);
  void weigh_beams(const Ping& ping);
  void raise_noisy_beams(const Ping& ping, const std::vector<double>& gains, EchoDecisions& out);
  void drop_skirts(const Ping& ping, EchoDecisions& out);

  EchoDetectorConfig config_;
  std::optional<SensorModel> model_;
  std::shared_ptr<const LikelihoodRatios> ratios_;
  DetectorState state_ = DetectorState::kWarmingUp;

  // State of the present geometry: window, full scale, sample type.
  RangeWindow window_;
  double blanking_m_ = 0;  ///< as the ping states
  float full_scale_ = 0;
  SampleType type_ = SampleType::kU8;
  double share_ = 1;   ///< of false_alarm that a bin of this window gets
  int first_bin_ = 0;  ///< first bin beyond the blind zone
  std::vector<float> thresholds_;
  BinThresholds bin_thresholds_;
  std::vector<float> p_detect_;  ///< 0: not usable
  std::vector<float> beam_;      ///< one beam as floats
  NoiseTracker tracker_;
  bool listened_ = false;
  std::vector<double> gains_;  ///< by beam, if the detector has listened; else empty
  Cfar cfar_;
  std::shared_ptr<const BeamFan> fan_;  ///< fan that was compared with the histogram model
  LikelihoodRatios::OperatingPoint point_;
  std::vector<std::int16_t> looked_up_;  ///< beams x bins
  BoundaryEchoes boundary_;
  FanDetector fan_detector_;
  std::shared_ptr<const FanModel> unchecked_fan_;  ///< the fan model, until the first ping; null: none
  FanLooks looks_;
  bool by_cells_ = false;  ///< whether the last ping was decided by cells
  int listened_fans_ = 0;  ///< number of pings listened to
  int next_beam_ = 0;      ///< beam at which learning continues in a multibeam ping
};

}  // namespace isobath
