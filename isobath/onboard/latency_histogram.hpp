// LatencyHistogram: the distribution of the times of one stage: median, 99th percentile, worst. It is a histogram with
// steps of 1 % from 1 us to 100 s, so its memory and the cost of a query do not grow with the run.
//
// Percentiles are accurate to 0.5 %; below 1 us, to 1 us. The worst time is exact.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace isobath {

/// Measured with a real clock, ms. No result depends on these times.
struct StageTime {
  std::uint64_t count = 0;
  double median_ms = 0, p99_ms = 0, worst_ms = 0;
};

class LatencyHistogram {
 public:
  void add(double milliseconds) {
    const double step = std::log(std::max(milliseconds, kMin_ms) / kMin_ms) / std::log(kRatio);
    ++counts_[std::min(static_cast<std::size_t>(step), kSteps - 1)];
    ++count_;
    worst_ms_ = std::max(worst_ms_, milliseconds);
  }
  /// The times of another histogram.
  void add(const LatencyHistogram& other) {
    for (std::size_t step = 0; step < kSteps; ++step) counts_[step] += other.counts_[step];
    count_ += other.count_;
    worst_ms_ = std::max(worst_ms_, other.worst_ms_);
  }
  [[nodiscard]] StageTime time() const {
    if (count_ == 0) return {};
    return {count_, at(count_ / 2), at(count_ * 99 / 100), worst_ms_};
  }

 private:
  static constexpr double kMin_ms = 1e-3, kRatio = 1.01;
  static constexpr std::size_t kSteps = 1852;

  /// The time at this position of the sorted times.
  [[nodiscard]] double at(std::uint64_t place) const {
    std::uint64_t before = 0;
    std::size_t step = 0;
    while (before + counts_[step] <= place) before += counts_[step++];
    return std::min(worst_ms_, kMin_ms * std::pow(kRatio, static_cast<double>(step) + 0.5));
  }

  std::array<std::uint64_t, kSteps> counts_{};
  std::uint64_t count_ = 0;
  double worst_ms_ = 0;
};

}  // namespace isobath
