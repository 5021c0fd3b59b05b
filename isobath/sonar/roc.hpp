// Receiver operating characteristic: the detection rate of a threshold against its false-alarm rate.
//
// Source: Ganesan 2015, 3.1 and 4.3 (table 3.1, equations 3.1, 3.2); ledger S6-04, S6-05, S6-E20. Intervals of
// proportions are Wilson's (1927). All numbers are probabilities (1); intensities are in counts of the sonar. p is
// P(intensity >= threshold | target), never P(target | intensity >= threshold) (S6-E20).
#pragma once

#include <cstdint>
#include <vector>

namespace isobath {

/// Table 3.1: decisions against the truth.
struct EchoCounts {
  std::uint64_t hits = 0;                ///< A: S = 1, target
  std::uint64_t false_alarms = 0;        ///< B: S = 1, no target
  std::uint64_t misses = 0;              ///< C: S = 0, target
  std::uint64_t correct_rejections = 0;  ///< D: S = 0, no target
};

struct Interval {
  double low = 0;
  double high = 1;
};

/// Wilson's interval of a proportion; z = 1.96 covers 95 %. `successes` may be fractional (a rate between two levels).
/// [0, 1] without trials.
Interval wilson_interval(double successes, double trials, double z = 1.959963984540054);

/// Q(x): probability that a standard normal exceeds x.
double normal_tail(double x);
/// x with Q(x) = probability, in (0, 1); to 1e-12.
double normal_threshold(double probability);
/// Equation 4.1: detection rate at a false-alarm rate in (0, 1) of an echo of constant amplitude A in Gaussian noise of
/// deviation sigma; snr = A^2 / sigma^2, linear (S6-07).
double theoretical_detection(double false_alarm, double snr);

struct RocPoint {
  double threshold = 0;
  double f = 0;
  double p = 0;
  bool operator==(const RocPoint&) const = default;
};

/// p against f for decreasing thresholds, from (0, 0) to (1, 1); f and p never decrease. Linear between points (a
/// threshold drawn at random between two neighbours reaches each point of the line).
class RocCurve {
 public:
  /// From counts per level: noise[i] and target[i] samples have intensities from edges[i] to edges[i + 1]. Both must
  /// have samples; edges has one more entry than the counts.
  RocCurve(const std::vector<double>& edges, const std::vector<std::uint64_t>& noise,
           const std::vector<std::uint64_t>& target);

  [[nodiscard]] const std::vector<RocPoint>& points() const { return points_; }
  [[nodiscard]] double area() const;
  /// The operating point at the false-alarm rate f; where the curve is vertical, the largest p.
  [[nodiscard]] RocPoint at_false_alarm(double f) const;
  [[nodiscard]] std::uint64_t noise_samples() const { return noise_samples_; }
  [[nodiscard]] std::uint64_t target_samples() const { return target_samples_; }

 private:
  std::vector<RocPoint> points_;
  std::uint64_t noise_samples_ = 0;
  std::uint64_t target_samples_ = 0;
};

}  // namespace isobath
