// EchoDetector: decides for each bin of a ping whether it holds an echo. Ledger S6-03, S6-06, S6-09, S6-62, S6-64,
// S6-70.
//
// Methods. `model`: thresholds a range bin from a calibration (SensorModel). `global`: one threshold for all bins.
// `ca_cfar`, `os_cfar`: threshold from the neighbouring bins of the same beam (cfar.hpp). `auto`, for a sonar that was
// never calibrated: `cells` for a fan of 8 beams and more, `learnt` for a scanning head; with a sensor model, `auto` is
// `model`. `cells`: one decision a resolution cell, by the background across the fan (fan_detector.hpp). `learnt`:
// thresholds learnt from the pings so far (noise_tracker.hpp), current one included, and a rule for pulse skirts.
// `histogram`: the likelihood ratio of the pixel's intensity by a HistogramModel, at its operating point for
// false_alarm; each echo carries its ratio (EchoDecisions::ratios), and `auto` is `histogram` where there is such a
// model.
//
// Skirt rule (`learnt` only). A strong echo is smeared in range by its pulse and by the beam's height, so that plain
// thresholds see a wall too near. A hit is dropped where, within skirt_m behind it, the intensity rises above its own
// divided by skirt_share, without first dipping below its own times skirt_share: it is the foot of that echo. Two
// targets closer than skirt_m with no dip between them are reported at the stronger one.
//
// Warm-up (`learnt`): until warmup_profiles beams have been seen, all bins are unusable: unknown, neither free nor
// taken. The default is half a turn of a Micron, or seven pings of a multibeam sonar (16 beams a ping are learnt from).
// Where the pings are there already, as in a log, the detector can listen to them before it decides the first
// (`listen`). It then knows, too, how loud each beam of a fan is beside the others, by the 80 % quantile of sample over
// threshold in the first ping; the threshold of a beam louder by 5 % and more is raised by as much.
//
// Measured with the defaults: in a tank of 4.5 m (Micron, 20 turns) the first hit stands 0.00 to 0.05 m before each
// wall, without the skirt rule 0.03 to 0.11 m. On a DIDSON's background, clipped at zero, 3 % of the bins hit at f
// = 0.02. Not promised: an echo that fills half of the bearings and more than an eighth of the range window for the
// whole memory is learnt as noise.
//
// Where the water column is known, echoes of bottom and surface are no echoes of targets (boundary_echoes.hpp); this is
// added to every method but `cells`, which has its own background.
//
// Bins that a beam has not sampled (Ping::sampled) tell nothing: they are dim with p_D 0, no reference for CFAR, and a
// beam that lacks some is not learnt from.
//
// Bins nearer than blind_m, or than the blind zone that the ping states, are not usable. `detect` allocates only at the
// first ping of a geometry and throws nothing. Not thread-safe: one detector a sonar. Deterministic. Measured on one
// core, 512 beams x 500 bins of 8 bits, G bins/s: thresholds 2.3 (beam after beam) and 1.6 (bin after bin), `auto` 0.7,
// `ca_cfar` 0.07, `os_cfar` 0.03.
#pragma once

#include <isobath/base/config.hpp>
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
  double false_alarm = 0.02;      ///< f; of the model where there is one
  double p_detect = 0.8;          ///< p_D of all methods but the model
  double blind_m = 0.6;           ///< nearer bins are not usable
  double global_threshold = 0.5;  ///< share of full scale
  double skirt_share = 0.7;       ///< 0: no skirt rule
  double skirt_m = 0.2;
  NoiseTrackerConfig noise;
  CfarConfig cfar;
  BoundaryConfig boundary;
  FanDetectorConfig fan;
};
std::vector<Field> fields(EchoDetectorConfig& config);

/// What keeps a detector from deciding; all bins are unusable meanwhile.
enum class DetectorState : std::uint8_t {
  kReady,
  kWarmingUp,
  kNoModel,
  kModelFullScale,
  kModelRange,
  kModelBinLength,
  kHistogramOfOther  ///< the ping is not of the sonar and the settings of the histogram model
};
const char* to_text(DetectorState state);

class EchoDetector {
 public:
  /// `fan_model`: what pings that are decided by cells start from. A first one of another sonar throws Error.
  /// A method `model` or `histogram` without its model throws Error. With a model and method `auto`, the model is used,
  /// histograms before thresholds.
  explicit EchoDetector(EchoDetectorConfig config, std::optional<SensorModel> model = std::nullopt,
                        std::shared_ptr<const LikelihoodRatios> ratios = nullptr,
                        std::shared_ptr<const FanModel> fan_model = nullptr);

  /// The ping must pass `check`.
  void detect(const Ping& ping, EchoDecisions& out, const WaterColumn& water = {});

  /// Before the first `detect`, where the pings are there already: method `auto` learns from all beams of the ping and
  /// decides nothing. Whether that is enough to decide, as it always is by the other methods.
  bool listen(const Ping& ping);
  /// No more pings will be listened to: what was heard is enough to decide by, if it is 16 beams or more.
  void heard_all();

  /// The last ping as looks at resolution cells, where it was decided by cells: what a map takes instead of the
  /// samples. Null: each sample is a look of its own.
  [[nodiscard]] const FanLooks* looks() const { return by_cells_ ? &looks_ : nullptr; }
  /// How far the pings depart from the fan model; empty: none, or no ping was decided by it.
  [[nodiscard]] std::optional<FanDeparture> departure() const { return fan_detector_.departure(); }
  /// Of the last ping.
  [[nodiscard]] DetectorState state() const { return state_; }
  /// In force for the last ping, a range bin (infinite: none); empty for CFAR and histograms, which have one a sample.
  [[nodiscard]] const std::vector<float>& thresholds() const { return thresholds_; }
  [[nodiscard]] double false_alarm() const;
  [[nodiscard]] DetectionMethod method() const { return config_.method; }

  /// What `auto` stands for, for this ping.
  [[nodiscard]] DetectionMethod method_for(const Ping& ping) const;

 private:
  void decide(const Ping& ping, EchoDecisions& out);
  void prepare_for(const Ping& ping);
  void prepare(const Ping& ping);
  void prepare_model(const Ping& ping);
  void prepare_histogram(const Ping& ping);
  void set_thresholds();
  void learn(const Ping& ping);
  void take_thresholds();
  void describe(EchoDecisions& out) const;
  void decide_by_thresholds(const Ping& ping, EchoDecisions& out) const;
  void decide_by_cfar(const Ping& ping, EchoDecisions& out);
  void decide_by_ratios(const Ping& ping, EchoDecisions& out);
  void weigh_beams(const Ping& ping);
  void raise_noisy_beams(const Ping& ping, const std::vector<double>& gains, EchoDecisions& out);
  void drop_skirts(const Ping& ping, EchoDecisions& out);

  EchoDetectorConfig config_;
  std::optional<SensorModel> model_;
  std::shared_ptr<const LikelihoodRatios> ratios_;
  DetectorState state_ = DetectorState::kWarmingUp;

  // Of the geometry at hand: window, full scale, sample type.
  RangeWindow window_;
  double blind_m_ = 0;  ///< as the ping says
  float full_scale_ = 0;
  SampleType type_ = SampleType::kU8;
  int first_bin_ = 0;  ///< behind the blind zone
  std::vector<float> thresholds_;
  std::vector<std::uint8_t> thresholds_u8_;
  std::vector<std::uint64_t> reachable_;  ///< bins whose threshold an 8-bit sample can reach
  std::vector<float> p_detect_;           ///< 0: not usable
  std::vector<float> beam_;               ///< one beam as floats
  NoiseTracker tracker_;
  bool listened_ = false;
  std::vector<double> gains_;  ///< of the beams, where the detector has listened; else empty
  Cfar cfar_;
  std::shared_ptr<const BeamFan> fan_;  ///< that the histograms were compared with
  LikelihoodRatios::OperatingPoint point_;
  std::vector<std::int16_t> looked_up_;  ///< beams x bins
  BoundaryEchoes boundary_;
  FanDetector fan_detector_;
  std::shared_ptr<const FanModel> unchecked_fan_;  ///< the fan model, until the first ping; null: none
  FanLooks looks_;
  bool by_cells_ = false;  ///< the last ping was
  int listened_fans_ = 0;  ///< pings
  int next_beam_ = 0;      ///< where learning goes on in a multibeam ping
};

}  // namespace isobath
