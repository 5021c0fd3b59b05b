// HistogramCalibration: learns a histogram of intensities for each pixel (histogram_model.hpp), and measures its worth
// on frames that it has not seen (ledger S5-18 to S5-21, S5-23, S5-D02, S5-D03).
//
// Width of the levels, unless configured: the last, open level begins where 99.9 % of the background has ended, so that
// the others divide the range in which false alarms are decided; integer samples get whole counts. With 25 even parts
// of the full scale, as in the paper for its sonar, the first two would hold all noise of an 8-bit sonar.
//
// Worth: cross-validation over the folds of the thresholds (calibration.hpp), at the false-alarm rates measured there;
// between two ratios the rate is linear (a threshold drawn at random between both).
#pragma once

#include <isobath/configuration/configuration.hpp>
#include <isobath/io/frames/marked_frames.hpp>
#include <isobath/sonar/calibration.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct HistogramCalibration {
  struct Worth {
    double false_alarm = 0;  ///< measured on held-out background, as for the thresholds
    Rate detected;           ///< of held-out marked pixels
  };
  HistogramModel model;
  std::vector<Worth> worth;  ///< in the order of the comparisons; empty: unknown
};

/// Throws Error if frames differ in size or setting, or if there is no background.
HistogramCalibration learn_histograms(std::span<const MarkedFrame> frames, const Configuration& configuration,
                                      std::span<const ThresholdComparison> comparisons, const std::string& source);

/// PNG: the noise of some pixels (S5-D02): ahead at three ranges, and at the far end at three other bearings.
std::string noise_histogram_chart(const HistogramModel& model);
/// PNG: the objects beside the noise of all pixels (S5-D03).
std::string object_histogram_chart(const HistogramModel& model);

}  // namespace isobath
