// SensorModel: calibration of one sonar at one range window: threshold and probabilities per range bin.
//
// Source: Ganesan 2015, 3.1 and 4.3 (figures 4.7, 4.8); ledger S6-06, S6-09, S6-E05, S6-D03. Intensities in counts of
// the sonar, ranges in m. A bin in the blind zone, or with p_D <= f, carries no information: neither its 1 nor its 0
// may be used. The printed form (p_k = 0 and t_k = 0 in the blind zone) is refused, since each reading would count as a
// hit there.
//
// A model is valid for the range window of its calibration. For another window inside the same ranges, `for_window`
// interpolates over range, if the bins are at most twice as long or short (bins of another length average the noise
// differently, for which the thresholds do not account).
#pragma once

#include <isobath/base/error.hpp>
#include <isobath/sonar/ping.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

struct SensorModel {
  struct Bin {
    double threshold = 0;  ///< S = 1 at or above it
    double p_detect = 0;   ///< P(S = 1 | target)
    double noise_mean = 0;
    double noise_deviation = 0;
    bool blind = false;
    bool operator==(const Bin&) const = default;
  };

  std::string source;  ///< description of the recording and the sonar
  RangeWindow window;
  double full_scale = 255;    ///< full scale of the calibrated pings
  double false_alarm = 0.02;  ///< f, the same for all bins that are not blind
  std::vector<Bin> bins;      ///< window.bins elements
  /// Noise of each beam of a fan relative to the median beam; detectors multiply thresholds by it if it is above 1.
  /// Empty: not known.
  std::vector<double> beam_gains;

  /// Throws Error for sizes that disagree, values out of range, or p_D <= f in a bin that is not blind (S6-09).
  void check(const std::string& file = {}) const;
  bool operator==(const SensorModel&) const = default;
};

/// The reason why a model does not fit a ping.
enum class ModelMismatch : std::uint8_t { kFullScale, kRange, kBinLength };
const char* to_text(ModelMismatch mismatch);

/// The model's bins, resampled to another window.
Result<std::vector<SensorModel::Bin>, ModelMismatch> for_window(const SensorModel& model, const RangeWindow& window,
                                                                double full_scale);

/// JSON, version 1. Reading is strict: an unknown or missing key, a wrong type or size, or another version throw Error.
std::string write_sensor_model(const SensorModel& model);
SensorModel read_sensor_model(std::string_view text, const std::string& file);

}  // namespace isobath
