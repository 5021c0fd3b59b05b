// calibrate: turns recordings of background, and of targets that were marked by hand, into a sensor model, noise fits,
// ROC curves with intervals, and a report (Ganesan 2015, chapters 3.1 and 4; ledger S6-04 to S6-09, S6-D01 to S6-D03).
// From a fan without marks it also makes a fan model (fan_calibration.hpp); with marks, or with the objects of another
// model, a histogram model (histogram_calibration.hpp).
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/configuration/configuration.hpp>
#include <isobath/report/fan_calibration.hpp>
#include <isobath/sonar/calibration.hpp>
#include <isobath/studies/histogram_calibration.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct CalibrateRequest {
  std::filesystem::path input;
  std::filesystem::path out;  ///< made if absent
  Configuration configuration;
  /// Without marks: pings whose strongest sample beyond the blind zone is below this (counts) are background, the
  /// others are left out. Empty: a folder of frames is read with its marks; in any other log every ping is background.
  std::optional<double> background_below;
  /// A histogram model whose objects are added to the marked ones, so that a log, which has no marks, can provide the
  /// noise at another range setting. Its levels are used. Empty: none.
  std::filesystem::path objects;
  /// Takes the marks from the ground truth of a simulated log (truth_marks.hpp); of this sonar, or of the first if
  /// empty.
  bool truth = false;
  std::string sonar;
  std::function<void(const SourceReport&, std::uint64_t pings)> progress;
};

struct CalibrateOutcome {
  CalibrationResult result;
  std::optional<HistogramCalibration> histograms;  ///< if objects are known
  std::optional<FanCalibration> fan;               ///< of a fan without marks
  std::string no_fan;                              ///< why a fan without marks got no model; else empty
  int left_out = 0;                                ///< pings that are neither background nor marked
  std::vector<std::filesystem::path> files;        ///< written, relative to the folder
};

/// Throws Error if there is nothing to calibrate from or too little background, or if the folder cannot be written.
CalibrateOutcome calibrate(const CalibrateRequest& request);

}  // namespace isobath
