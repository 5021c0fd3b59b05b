// What a calibration learns of intensities pixel by pixel (histogram_model.hpp), and what it is worth on frames that it
// has not seen (ledger S5-18 to S5-21, S5-23, S5-D02, S5-D03).
//
// Width of the levels, unless configured: the last, open one begins where 99.9 % of the background has ended, so that
// the others divide the range in which false alarms are decided; whole counts for whole samples. 25 even parts of the
// full scale, as the paper has them of its sonar, would hold all noise of an 8-bit sonar in the first two.
//
// Worth: cross-validation over the same folds as the thresholds' (calibration.hpp), at the false-alarm rates measured
// there; between two ratios the rate is linear (a threshold drawn at random between both).
#pragma once

#include <isobath/io/marked_frames.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/sonar/calibration.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct HistogramCalibration {
  struct Worth {
    double false_alarm = 0;  ///< measured on held-out background, the same as of the thresholds
    Rate detected;           ///< of held-out marked pixels
  };
  HistogramModel model;
  std::vector<Worth> worth;  ///< in the order of the comparisons; empty: not known
};

/// Throws Error: frames of several sizes or settings, no background.
HistogramCalibration learn_histograms(std::span<const MarkedFrame> frames, const Configuration& configuration,
                                      std::span<const ThresholdComparison> comparisons, const std::string& source);

/// PNG: the noise of some pixels (S5-D02): abeam of each other at the far end, and ahead at four ranges.
std::string noise_histogram_chart(const HistogramModel& model);
/// PNG: the objects beside the noise of all pixels (S5-D03).
std::string object_histogram_chart(const HistogramModel& model);

}  // namespace isobath
