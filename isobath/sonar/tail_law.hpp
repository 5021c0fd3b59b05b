// TailLaw: how often the background of a sonar exceeds its own level, learnt from the data.
//
// Takes ratios u = power / background of cells without a target, and gives the threshold that a share f of them
// reaches. With at least 60 exceedances no law is assumed: the threshold is the empirical quantile. With fewer, the
// tail is extrapolated from the two highest known quantiles: by an exponential law, the tail of a mean of speckle, or
// by a Weibull law if that is heavier, as for K-distributed clutter and clipped receivers (ledger S6-64). So thresholds
// are rough after one ping and exact after some, and the false-alarm rate is then the requested one.
//
// Histogram of 32 steps per octave (2.2 %), u from 2^-6 to 2^14. All counts are halved after every kMemory values.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

namespace isobath {

class TailLaw {
 public:
  void add(float u) {
    ++counts_[step_of(u)];
    if (++total_ >= kMemory) halve();
  }
  /// Infinite with fewer than 100 values.
  [[nodiscard]] float threshold(double false_alarm) const;
  /// The same from the middle of the law alone (a Weibull law through its median and its 90 % quantile), which targets
  /// in up to a few percent of the values do not affect.
  [[nodiscard]] float robust_threshold(double false_alarm) const;
  [[nodiscard]] std::uint32_t total() const { return total_; }
  /// Replaces the counts by those of another law, with a weight of 1 / 2^`halvings`.
  void take_over(const TailLaw& other, int halvings);

  /// Share of the values above u; 0 without values.
  [[nodiscard]] double exceeding(float u) const;
  /// Adds the values of another law.
  void merge(const TailLaw& other);
  /// The histogram by step, for storage; `of_counts` is its inverse. At most kSteps counts, kMaxCounted in total.
  [[nodiscard]] std::span<const std::uint32_t> counts() const { return counts_; }
  static TailLaw of_counts(std::span<const std::uint32_t> counts);
  static constexpr int kStepBits = 5, kOctaves = 20;
  static constexpr std::size_t kSteps = std::size_t{kOctaves} << kStepBits;
  static constexpr std::uint32_t kMaxCounted = 100'000'000;

 private:
  static constexpr int kLowest = -6;
  static constexpr std::uint32_t kMemory = 4'000'000;
  static std::size_t step_of(float u) {
    constexpr int kFirst = (127 + kLowest) << kStepBits;
    const int step = static_cast<int>(std::bit_cast<std::uint32_t>(u) >> (23 - kStepBits)) - kFirst;
    return static_cast<std::size_t>(step < 0 ? 0 : step >= static_cast<int>(kSteps) ? kSteps - 1 : step);
  }
  static double value_at(double step);
  /// The value that a share of all exceeds.
  [[nodiscard]] double quantile(double exceeding) const;
  /// The value exceeded with probability `to`, by the Weibull law with quantiles u (exceeded by p) and v (by q > p).
  static double extended(double u, double p, double v, double q, double to);
  void halve();

  std::array<std::uint32_t, kSteps> counts_{};
  std::uint32_t total_ = 0;
};

}  // namespace isobath
