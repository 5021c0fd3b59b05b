// Crosscheck: checks a depth map against independent soundings, which are not part of it.
//
// A difference is the sounding minus the map: negative where the bottom is shoaler than the map says, which is what
// runs a vehicle aground. Statistics of the differences are the median; the robust standard deviation, 1.4826 times the
// median absolute deviation from the median; and the 95 % quantile of their magnitude (quantiles by linear
// interpolation between order statistics, Hyndman and Fan 1996, type 7). The same statistics are given by classes of
// sounded depth and of the map's confidence.
//
// S-44: the share of the soundings within the total vertical uncertainty that each order of survey allows at 95 %,
// TVU(d) = sqrt(a^2 + (b d)^2) at the sounded depth d (IHO S-44, edition 6, 3.2.3 and table 1). The differences include
// the errors of the soundings, so the check is stricter on the map than the order. The map meets an order in this
// respect if at least 95 % of the soundings lie within.
//
// Calibration of the confidence: for every confidence c of the map, the share of the soundings that agree with it
// within max(floor, share of depth), the margin within which a reading affirms a pixel, against the share that the map
// promises: that of its own revisits (RevisitRecord), else 5 % a step (Oskard 1990, IV-A; ledger S1-45, S1-76). The
// 95 % interval is Wilson's over the soundings that share no footprint. It does not hold what all soundings of a log
// share, such as an offset of its positions; beside it stands the share that would agree without that offset.
//
// Uncertainty: the share of these soundings within the total vertical uncertainty (95 %) that the map states for its
// depths, by slope of the bottom.
//
// Metres, days. Statistics without a sounding are NaN, null in JSON. No state, any thread; 30000 samples in 10 ms.
// Errors: none; samples that are not `comparable` are left out and counted.
#pragma once

#include <array>
#include <cstdint>
#include <isobath/map/depth/revisit_record.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/sonar/roc.hpp>
#include <isobath/studies/difference_statistics.hpp>
#include <isobath/studies/position_offset.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace isobath {

struct CrosscheckSample {
  float observed_m = 0;   ///< the sounding
  float predicted_m = 0;  ///< the map there
  std::uint8_t confidence = 0;
  std::uint8_t flags = 0;                        ///< PixelFlag
  float age_days = 0;                            ///< of the pixel when the sounding was made
  std::optional<Eigen::Vector2d> gradient = {};  ///< of the map's depth (north, east); empty: not known
  bool independent = true;                       ///< shares no footprint with a recent sounding (IndependentSoundings)
};

/// Whether a map can hold both depths (within 1e7 m), and the confidence is valid.
bool comparable(const CrosscheckSample& sample);
/// The sounding minus the map, m.
inline double difference(const CrosscheckSample& s) {
  return static_cast<double>(s.observed_m) - static_cast<double>(s.predicted_m);
}

struct CrosscheckInput {
  std::string map, log;  ///< names, for the page
  std::vector<CrosscheckSample> samples;
  std::uint64_t offered = 0;  ///< soundings in the log; at least as many as samples
  /// Soundings that were not used, by reason: "no depth in the map", "position unknown", ...
  std::vector<std::pair<std::string, std::uint64_t>> left_out;
  double margin_floor_m = 0.5;
  double margin_share = 0.02;  ///< of the sounded depth
  RevisitRecord revisits;      ///< of the map
};

struct CrosscheckResult {
  DifferenceStatistics all;
  std::uint64_t offered = 0;
  double covered = 0;  ///< share of the offered soundings that were used
  double shoaler = 0;  ///< share that found the bottom shoaler than the map by more than the margin
  std::vector<std::pair<std::string, std::uint64_t>> left_out;

  struct DepthClass {
    double from_m, to_m;  ///< from <= depth < to
    DifferenceStatistics differences;
  };
  std::vector<DepthClass> by_depth;  ///< only those with soundings

  struct ConfidenceClass {
    int low, high;
    DifferenceStatistics differences;
  };
  std::vector<ConfidenceClass> by_confidence;  ///< 0-4, 5-9, 10-14, 15-19, 20: all five

  struct Order {
    const char* name;
    double a_m, b;
    std::uint64_t within;
    double share;
    bool met;
  };
  std::vector<Order> s44;  ///< strictest first

  struct Promise {
    int confidence;
    std::uint64_t n, agreeing;
    std::uint64_t independent;  ///< of the n, those that share no footprint
    double share, promised;
    double aligned;  ///< share that agrees once the log is moved by its offset; NaN: no offset is known
    bool learnt;     ///< promised by the map's revisits
    Interval interval;
  };
  std::vector<Promise> calibration;  ///< only the confidences that occur

  struct Within {
    double low, high;  ///< slope of the bottom; NaN: not known
    std::uint64_t n, within;
    Interval interval;
  };
  std::optional<RevisitRecord::Uncertainty> uncertainty;  ///< that the map states
  std::vector<Within> within;                             ///< its uncertainty, by slope; the last: all
  std::optional<PositionOffset> offset;                   ///< of the log from the map, if the bottom is uneven enough
  /// Mean |share - promised| over the soundings.
  double calibration_error = std::numeric_limits<double>::quiet_NaN();
};

CrosscheckResult crosscheck(const CrosscheckInput& input);

/// Keys n, covered, median_m, robust_sd_m, p95_m, ..., by_depth, by_confidence, s44, calibration.
std::string to_json(const CrosscheckResult& result);
/// Tables for a terminal.
std::string to_text(const CrosscheckResult& result);
/// The tables with a histogram of the differences, the differences against depth, and the calibration.
HtmlReport crosscheck_page(const CrosscheckInput& input, const CrosscheckResult& result);

/// "0.05 to 0.1", "not known", "all".
std::string slope_class(const CrosscheckResult::Within& row);

/// IHO S-44, edition 6: the largest total vertical uncertainty at 95 %.
double total_vertical_uncertainty(double a_m, double b, double depth_m);

}  // namespace isobath
