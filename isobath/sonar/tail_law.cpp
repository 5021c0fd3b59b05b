#include <algorithm>
#include <cmath>
#include <isobath/sonar/tail_law.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr double kEnough = 60;       // exceedances, which give the quantile to 13 %
constexpr std::uint32_t kFew = 100;  // values: fewer are not enough for a threshold
constexpr double kFirstKnown = 0.02, kBelow = 10, kLowestKnown = 0.3, kHighShare = 0.1;

}  // namespace

double TailLaw::value_at(double step) {
  const double whole = std::floor(step);
  const int index = static_cast<int>(whole) + ((127 + kLowest) << kStepBits);
  const auto edge = [](int i) {
    return double{std::bit_cast<float>(static_cast<std::uint32_t>(i) << (23 - kStepBits))};
  };
  return std::lerp(edge(index), edge(index + 1), step - whole);
}

double TailLaw::quantile(double exceeding) const {
  const double wanted = exceeding * total_;
  double above = 0;
  for (std::size_t i = kSteps; i-- > 0;) {
    const double here = counts_[i];
    if (above + here < wanted) {
      above += here;
      continue;
    }
    // Within a step the logarithm of the share is interpolated linearly.
    const double low = std::log(above + here), high = std::log(std::max(above, 0.5));
    const double share = low > high ? (low - std::log(wanted)) / (low - high) : 0;
    return value_at(static_cast<double>(i) + std::clamp(share, 0.0, 1.0));
  }
  return value_at(0);
}

float TailLaw::threshold(double false_alarm) const {
  if (total_ < kFew) return std::numeric_limits<float>::infinity();
  const double known = std::clamp(kEnough / total_, false_alarm, std::max(false_alarm, kFirstKnown));
  const double u = quantile(known);
  if (known <= false_alarm) return static_cast<float>(u);
  const double below = std::min(kBelow * known, kLowestKnown);
  const double v = quantile(below);
  const double heavy = extended(u, known, v, below, false_alarm);
  const double straight = u + (u - v) * std::log(known / false_alarm) / std::log(below / known);
  return static_cast<float>(std::max(heavy, straight));
}

float TailLaw::robust_threshold(double false_alarm) const {
  if (total_ < kFew) return std::numeric_limits<float>::infinity();
  return static_cast<float>(extended(quantile(kHighShare), kHighShare, quantile(0.5), 0.5, false_alarm));
}

double TailLaw::extended(double u, double p, double v, double q, double to) {
  if (!(u > v)) return 2 * u;
  // P(exceeding) = exp(-(u / s)^k): through both quantiles.
  const double shape = std::log(std::log(p) / std::log(q)) / std::log(u / v);
  return u * std::pow(std::log(to) / std::log(p), 1 / shape);
}

void TailLaw::take_over(const TailLaw& other, int halvings) {
  total_ = 0;
  for (std::size_t i = 0; i < kSteps; ++i) total_ += counts_[i] = other.counts_[i] >> halvings;
}

double TailLaw::exceeding(float u) const {
  if (total_ == 0) return 0;
  const std::size_t step = step_of(u);
  double above = 0;
  for (std::size_t i = step + 1; i < kSteps; ++i) above += counts_[i];
  constexpr std::uint32_t kWithin = (1u << (23 - kStepBits)) - 1;
  const double within = double(std::bit_cast<std::uint32_t>(u) & kWithin) / kWithin;
  return (above + (1 - within) * counts_[step]) / total_;
}

void TailLaw::merge(const TailLaw& other) {
  for (std::size_t i = 0; i < kSteps; ++i) counts_[i] += other.counts_[i];
  total_ += other.total_;
}

TailLaw TailLaw::of_counts(std::span<const std::uint32_t> counts) {
  TailLaw law;
  for (std::size_t i = 0; i < std::min(kSteps, counts.size()); ++i) law.total_ += law.counts_[i] = counts[i];
  return law;
}

void TailLaw::halve() {
  total_ = 0;
  for (std::uint32_t& n : counts_) total_ += n = (n + 1) / 2;
}

}  // namespace isobath
