// EchoDetector: decides for each bin of a ping whether it holds an echo (ledger S6-03, S6-06, S6-09, S6-62, S6-64,
// S6-70).
//
// Methods. `model`: thresholds a range bin from a calibration (SensorModel). `global`: one threshold for all bins.
// `ca_cfar`, `os_cfar`: threshold from the neighbouring bins of the same beam (cfar.hpp). `automatic`, for a sonar that
// was never calibrated: thresholds learnt from the pings so far (noise_tracker.hpp), current one included, and a rule
// for pulse skirts.
//
// The skirt rule (`automatic` only). A strong echo is smeared in range by its pulse and by the beam's height, so plain
// thresholds see the wall too near. A hit is dropped where, within skirt_m behind it, the intensity rises above its own
// / skirt_share without first dipping below skirt_share times its own: it is the foot of that echo, not an echo of its
// own. Two targets closer than skirt_m with no dip between them are reported at the stronger one.
//
// Warm-up (`automatic`): until warmup_profiles beams have been seen, all bins are unusable: unknown, neither free nor
// taken. 100 profiles are half a turn of a Micron and about seven pings of a multibeam sonar (16 beams a ping are
// learnt from).
//
// Measured, with the defaults, by a trial on recordings: in a tank of 4.5 m (Micron, 28 turns) the first hit stands
// 0.00 to 0.05 m before each wall; without the skirt rule 0.03 to 0.11 m. On simulated frames with noise
// (HoloOcean) 2.1 % of the bins of target-less frames hit at f = 0.02; on a DIDSON's background, clipped at zero, 2.5
// to 3 %. What it does not promise: an echo that fills half of the bearings and more than an eighth of the range window
// for the whole memory is learnt as noise.
//
// Bins nearer than blind_m are not usable. `detect` allocates only at the first ping of a geometry and throws nothing.
// Not thread-safe: one detector a sonar. Deterministic. The sample layouts beam-major (8-bit) and range-major (8-bit)
// have fast paths: measured 3 to 5 G bins/s and about 1 G bins/s with thresholds given.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/sonar/cfar.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <isobath/sonar/noise_tracker.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/sensor_model.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

enum class DetectionMethod : std::uint8_t { kAutomatic, kModel, kGlobal, kCellAveraging, kOrderedStatistic };

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
};
std::vector<Field> fields(EchoDetectorConfig& config);

/// What keeps a detector from deciding; all bins are unusable meanwhile.
enum class DetectorState : std::uint8_t { kReady, kWarmingUp, kNoModel, kModelFullScale, kModelRange, kModelBinLength };
const char* to_text(DetectorState state);

class EchoDetector {
 public:
  /// A method `model` without a model throws Error. With a model and method `automatic`, the model is used.
  explicit EchoDetector(EchoDetectorConfig config, std::optional<SensorModel> model = std::nullopt);

  /// The ping must pass `check`.
  void detect(const Ping& ping, EchoDecisions& out);

  /// Of the last ping.
  [[nodiscard]] DetectorState state() const { return state_; }
  /// In force for the last ping, a range bin (infinite: none); empty for CFAR, which has one a sample.
  [[nodiscard]] const std::vector<float>& thresholds() const { return thresholds_; }
  [[nodiscard]] double false_alarm() const;
  [[nodiscard]] DetectionMethod method() const { return config_.method; }

 private:
  void prepare(const Ping& ping);
  void prepare_model(const Ping& ping);
  void set_thresholds();
  void learn(const Ping& ping);
  void describe(EchoDecisions& out) const;
  void decide_by_thresholds(const Ping& ping, EchoDecisions& out) const;
  void decide_by_cfar(const Ping& ping, EchoDecisions& out);
  void drop_skirts(const Ping& ping, EchoDecisions& out);

  EchoDetectorConfig config_;
  std::optional<SensorModel> model_;
  DetectorState state_ = DetectorState::kWarmingUp;

  // Of the geometry at hand: window, full scale, sample type.
  RangeWindow window_;
  float full_scale_ = 0;
  SampleType type_ = SampleType::kU8;
  int first_bin_ = 0;  ///< behind the blind zone
  std::vector<float> thresholds_;
  std::vector<std::uint8_t> thresholds_u8_;
  std::vector<std::uint64_t> reachable_;  ///< bins whose threshold an 8-bit sample can reach
  std::vector<float> p_detect_;           ///< 0: not usable
  std::vector<float> beam_;               ///< one beam as floats
  NoiseTracker tracker_;
  Cfar cfar_;
  int next_beam_ = 0;  ///< where learning goes on in a multibeam ping
};

}  // namespace isobath
