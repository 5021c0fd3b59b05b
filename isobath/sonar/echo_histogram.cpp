#include <algorithm>
#include <bit>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/echo_histogram.hpp>

namespace isobath {
namespace {

constexpr int kOctaves = 17;
constexpr int kPerOctave = 64;
constexpr int kMantissaShift = 17;  // keeps 6 of the 23 bits of a float's mantissa: 64 steps per octave

}  // namespace

EchoLevels::EchoLevels(SampleType type, float full_scale) {
  if (type == SampleType::kU8) return;
  ISOBATH_ASSERT(std::isfinite(full_scale) && full_scale > 0);
  discrete_ = false;
  count_ = 1 + kOctaves * kPerOctave;
  unit_ = full_scale * 0x1p-16f;
}

int EchoLevels::level(float value) const {
  if (discrete_) return std::clamp(static_cast<int>(std::lround(value)), 0, 255);
  const float ratio = value / unit_;
  if (!(ratio >= 1)) return 0;
  const auto steps =
      static_cast<int>((std::bit_cast<std::uint32_t>(ratio) - std::bit_cast<std::uint32_t>(1.0f)) >> kMantissaShift);
  return std::min(1 + steps, count_ - 1);
}

double EchoLevels::edge(int level) const {
  if (discrete_) return level - 0.5;
  if (level == 0) return 0;
  const int steps = level - 1;
  return std::ldexp(unit_ * (1 + static_cast<double>(steps % kPerOctave) / kPerOctave), steps / kPerOctave);
}

std::vector<double> EchoLevels::edges() const {
  std::vector<double> all(count_ + 1);
  for (int i = 0; i <= count_; ++i) all[i] = edge(i);
  return all;
}

EchoHistogram::EchoHistogram(EchoLevels levels, int bins)
    : levels_(levels), bins_(bins), counts_(std::size_t(bins) * std::size_t(levels.count()), 0) {}

void EchoHistogram::add(const EchoHistogram& other) {
  ISOBATH_ASSERT(other.bins_ == bins_ && other.levels_ == levels_);
  for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
}

void EchoHistogram::halve() {
  for (auto& c : counts_) c /= 2;
}

std::vector<std::uint64_t> EchoHistogram::pooled(int first, int last) const {
  std::vector<std::uint64_t> sum(levels_.count(), 0);
  for (int bin = std::max(first, 0); bin < std::min(last, bins_); ++bin) {
    const std::uint32_t* from = row(bin);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += from[i];
  }
  return sum;
}

EchoDistribution::EchoDistribution(const EchoLevels& levels, const std::vector<std::uint64_t>& counts)
    : levels_(levels), cumulative_(counts.size() + 1, 0) {
  ISOBATH_ASSERT(static_cast<int>(counts.size()) == levels.count());
  for (std::size_t i = 0; i < counts.size(); ++i) cumulative_[i + 1] = cumulative_[i] + static_cast<double>(counts[i]);
}

EchoDistribution::EchoDistribution(const EchoHistogram& histogram, int first, int last)
    : EchoDistribution(histogram.levels(), histogram.pooled(first, last)) {}

double EchoDistribution::moment(double about, int power) const {
  double sum = 0;
  for (int i = 0; i < levels_.count(); ++i) {
    const double weight = cumulative_[i + 1] - cumulative_[i];
    if (weight > 0) sum += weight * std::pow(0.5 * (levels_.edge(i) + levels_.edge(i + 1)) - about, power);
  }
  return samples() > 0 ? sum / samples() : 0;
}

double EchoDistribution::mean() const { return moment(0, 1); }
double EchoDistribution::deviation() const { return std::sqrt(moment(mean(), 2)); }

double EchoDistribution::rate_at_or_above(double threshold) const {
  if (samples() <= 0 || threshold >= levels_.edge(levels_.count())) return 0;
  if (threshold <= levels_.edge(0)) return 1;
  if (levels_.discrete()) {  // whole-number samples and any threshold: the edge below the next whole number
    const double level = threshold + 0.5;
    const int below = static_cast<int>(level);
    const double share = level - below;
    return 1 - std::lerp(cumulative_[below], cumulative_[below + 1], share) / samples();
  }
  const int level = levels_.level(static_cast<float>(threshold));
  const double low = levels_.edge(level);
  const double share = std::clamp((threshold - low) / (levels_.edge(level + 1) - low), 0.0, 1.0);
  return 1 - std::lerp(cumulative_[level], cumulative_[level + 1], share) / samples();
}

double EchoDistribution::quantile(double p) const {
  const double wanted = p * samples();
  const auto above = std::upper_bound(cumulative_.begin(), cumulative_.end(), wanted);
  if (above == cumulative_.end()) {  // p = 1: the end of the last level that holds samples
    const auto last = std::lower_bound(cumulative_.begin(), cumulative_.end(), samples());
    return levels_.edge(static_cast<int>(last - cumulative_.begin()));
  }
  if (above == cumulative_.begin()) return levels_.edge(0);
  const int level = static_cast<int>(above - cumulative_.begin()) - 1;
  const double share = (wanted - cumulative_[level]) / (*above - cumulative_[level]);
  return std::lerp(levels_.edge(level), levels_.edge(level + 1), share);
}

double EchoDistribution::threshold(double false_alarm) const {
  const double exact = quantile(1 - false_alarm);
  return levels_.discrete() ? std::ceil(exact + 0.5 - 1e-9) : exact;
}

}  // namespace isobath
