// The calibration job: recordings of background, and of targets that somebody marked, in; a sensor model, noise fits,
// ROC curves with intervals, and a report out (Ganesan 2015, chapters 3.1 and 4; ledger S6-04 to S6-09, S6-D01 to
// S6-D03). Of a fan without marks, a fan model as well (fan_calibration.hpp). Where there are marks, or objects of
// another model, a histogram model as well (histogram_calibration.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/fan_calibration.hpp>
#include <isobath/runtime/histogram_calibration.hpp>
#include <isobath/sonar/calibration.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct CalibrateRequest {
  std::filesystem::path input;
  std::filesystem::path out;  ///< made if absent
  Configuration configuration;
  /// Without marks: pings whose strongest sample behind the blind zone is below this (counts) are background, the
  /// others are left out. Empty: a folder of frames is read with its marks, every ping of another log is background.
  std::optional<double> background_below;
  /// A histogram model whose objects are taken besides those that are marked: a log, which has no marks, can then teach
  /// the noise of another range setting. Its levels are used. Empty: none.
  std::filesystem::path objects;
  std::function<void(const SourceReport&, std::uint64_t pings)> progress;
};

struct CalibrateOutcome {
  CalibrationResult result;
  std::optional<HistogramCalibration> histograms;  ///< where objects are known
  std::optional<FanCalibration> fan;               ///< of a fan without marks
  std::string no_fan;                              ///< why there is none, of a fan without marks; else empty
  int left_out = 0;                                ///< pings that were neither background nor marked
  std::vector<std::filesystem::path> files;        ///< written, relative to the folder
};

/// Throws Error: nothing to calibrate from, too little background, a folder that cannot be written.
CalibrateOutcome calibrate(const CalibrateRequest& request);

}  // namespace isobath
