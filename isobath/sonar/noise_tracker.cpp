#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/noise_tracker.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr double kLow = 0.1;
constexpr double kMiddle = 0.3;
constexpr double kHigh = 0.5;
constexpr double kHeaviest = 0.8;  // Weibull shapes: heavier than exponential ...
constexpr double kLightest = 3.6;  // ... to nearly Gaussian
constexpr double kShapePercentile = 0.7;
constexpr int kShapeGroups = 24;       // groups of bins: large enough for a shape, many enough to find clean ones
constexpr double kPeakShare = 0.7;     // maximum threshold in median peaks, if the sonar cuts weak samples
constexpr int kWindowShare = 16;       // the moving median extends 1/16 of the window to each side
constexpr int kSettled = 100;          // beams: with fewer, thresholds lie higher, and only loud echoes count
constexpr std::uint32_t kWeight = 64;  // weight of a sample, so that halving counts loses little

/// p-quantile of the Weibull law of scale 1.
double weibull(double p, double shape) { return std::pow(-std::log1p(-p), 1 / shape); }

/// (q50 - q30) / (q30 - q10): falls from 1.6 to 0.69 as the shape rises.
double lower_skew(double shape) {
  return (weibull(kHigh, shape) - weibull(kMiddle, shape)) / (weibull(kMiddle, shape) - weibull(kLow, shape));
}

double shape_of_skew(double skew) {
  double low = kHeaviest;
  double high = kLightest;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (lower_skew(middle) > skew ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

std::vector<Field> fields(NoiseTrackerConfig& c) {
  return {Field::real("contrast", &c.contrast, {0, 1}, "1",
                      "Minimum of automatic thresholds, as a share of the median strongest sample of a beam."),
          Field::integer("warmup_profiles", &c.warmup_profiles, {1, 1'000'000}, "beams",
                         "Number of beams to learn from before automatic thresholds are used."),
          Field::integer("memory_profiles", &c.memory_profiles, {2, 1'000'000}, "beams",
                         "Maximum number of beams that automatic thresholds remember.")};
}

NoiseTracker::NoiseTracker(EchoLevels levels, int bins, int first_bin, double false_alarm,
                           const NoiseTrackerConfig& config)
    : levels_(levels),
      config_(config),
      false_alarm_(false_alarm),
      first_bin_(first_bin),
      noise_(levels, bins),
      peaks_(levels, 1),
      due_(config.warmup_profiles),
      thresholds_(bins, std::numeric_limits<float>::infinity()),
      edges_(levels.edges()),
      quantiles_(bins),
      raw_(bins),
      window_(bins) {}

void NoiseTracker::learn(const float* beam) {
  float peak = 0;
  for (int k = first_bin_; k < noise_.bins(); ++k) {
    noise_.add(k, beam[k], kWeight);
    peak = std::max(peak, beam[k]);
  }
  peaks_.add(0, peak, kWeight);
  ++profiles_;
  if (++remembered_ >= config_.memory_profiles) {
    noise_.halve();
    peaks_.halve();
    remembered_ /= 2;
  }
}

bool NoiseTracker::update(bool at_once) {
  if (profiles_ < due_ && !at_once) return false;
  due_ = profiles_ + std::clamp(profiles_ / 8, 1, 128);
  const Quantiles peaks = quantiles(peaks_.row(0));
  const double peak = peaks.zeros > 0.5 ? 0 : peaks.high;
  floor_ = config_.contrast * peak;
  for (int k = first_bin_; k < noise_.bins(); ++k) quantiles_[k] = quantiles(noise_.row(k));
  fit_shape();
  const double unsettled = std::max(0.0, 1 - static_cast<double>(profiles_) / kSettled);
  for (int k = first_bin_; k < noise_.bins(); ++k) {
    const double settled = threshold(quantiles_[k], peak);
    raw_[k] = settled + unsettled * std::max(0.0, settled - quantiles_[k].middle);
  }
  smooth();
  return true;
}

NoiseTracker::Quantiles NoiseTracker::quantiles(const std::uint32_t* row) const {
  double total = 0;
  for (int i = 0; i < levels_.count(); ++i) total += row[i];
  const double zeros = row[0] / total;
  // Quantiles of the nonzero samples if the bin is mostly 0, else of all samples.
  const bool cut = zeros > 0.5;
  const double rest = 1 - zeros;
  const double wanted[] = {cut ? zeros + 0.25 * rest : kLow, cut ? zeros + 0.5 * rest : kMiddle, cut ? 1.0 : kHigh};
  double found[] = {0, 0, 0};
  double below = row[0];
  int next = 0;
  while (next < 3 && wanted[next] * total < below) ++next;  // quantiles among the zeros stay 0
  for (int i = 1; i < levels_.count() && next < 3; ++i) {
    const double upto = below + row[i];
    while (next < 3 && wanted[next] * total < upto) {
      found[next] = std::lerp(edges_[i], edges_[i + 1], (wanted[next] * total - below) / row[i]);
      ++next;
    }
    below = upto;
  }
  return {zeros, found[0], found[1], found[2]};
}

void NoiseTracker::fit_shape() {
  const double step = levels_.discrete() ? 0.75 : 0;  // smaller steps are within a level and show no shape
  const int group = std::max(4, noise_.bins() / kShapeGroups);
  int count = 0;
  for (int from = first_bin_; from + group <= noise_.bins(); from += group) {
    double lower = 0;
    double upper = 0;
    for (int k = from; k < from + group; ++k) {
      const Quantiles& q = quantiles_[k];
      if (q.zeros > 0.5 || !(q.low > 0) || q.middle - q.low <= step) continue;
      lower += q.middle - q.low;
      upper += q.high - q.middle;
    }
    if (lower > 0) window_[count++] = shape_of_skew(upper / lower);
  }
  shape_ = 2;
  if (count < 4) return;
  const auto at = window_.begin() + static_cast<int>(kShapePercentile * (count - 1));
  std::nth_element(window_.begin(), at, window_.begin() + count);
  shape_ = *at;
}

double NoiseTracker::threshold(const Quantiles& q, double peak) const {
  if (q.zeros <= 0.5) {
    const double scale = (q.middle - q.low) / (weibull(kMiddle, shape_) - weibull(kLow, shape_));
    return q.middle + scale * (weibull(1 - false_alarm_, shape_) - weibull(kMiddle, shape_));
  }
  const double rest = 1 - q.zeros;
  if (rest <= false_alarm_ || !(q.middle > q.low) || !(q.low > 0)) return 0;
  const double shape = std::clamp(std::log(std::log(2) / -std::log(0.75)) / std::log(q.middle / q.low), 1.0, kLightest);
  const double wanted = q.middle * std::pow(std::log(rest / false_alarm_) / std::log(2), 1 / shape);
  return std::min(wanted, kPeakShare * peak);
}

void NoiseTracker::smooth() {
  const int bins = noise_.bins();
  const int reach = bins / kWindowShare;
  for (int k = first_bin_; k < bins; ++k) {
    const int from = std::max(first_bin_, k - reach);
    const int upto = std::min(bins, k + reach + 1);
    std::copy(raw_.begin() + from, raw_.begin() + upto, window_.begin());
    const auto middle = window_.begin() + (upto - from) / 2;
    std::nth_element(window_.begin(), middle, window_.begin() + (upto - from));
    double t = std::max(*middle, floor_);
    // Whole-number samples: round up; 0 is never an echo.
    if (levels_.discrete()) t = std::max(1.0, std::ceil(t));
    thresholds_[k] = std::max(static_cast<float>(t), std::numeric_limits<float>::min());
  }
}

}  // namespace isobath
