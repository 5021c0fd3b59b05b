#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/roc.hpp>
#include <numbers>
#include <numeric>

namespace isobath {

Interval wilson_interval(double successes, double trials, double z) {
  ISOBATH_ASSERT(successes >= 0 && successes <= trials);
  if (trials <= 0) return {0, 1};
  const double p = successes / trials;
  const double zz = z * z / trials;
  const double centre = (p + zz / 2) / (1 + zz);
  const double half = z / (1 + zz) * std::sqrt(p * (1 - p) / trials + zz / (4 * trials));
  return {successes > 0 ? std::max(0.0, centre - half) : 0.0, successes < trials ? std::min(1.0, centre + half) : 1.0};
}

double normal_tail(double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); }

double normal_threshold(double probability) {
  ISOBATH_ASSERT(probability > 0 && probability < 1);
  double low = -40, high = 40;
  for (int i = 0; i < 70; ++i) {
    const double middle = std::midpoint(low, high);
    (normal_tail(middle) > probability ? low : high) = middle;
  }
  return low;
}

double theoretical_detection(double false_alarm, double snr) {
  return normal_tail(normal_threshold(false_alarm) - std::sqrt(snr));
}

RocCurve::RocCurve(const std::vector<double>& edges, const std::vector<std::uint64_t>& noise,
                   const std::vector<std::uint64_t>& target) {
  ISOBATH_ASSERT(noise.size() == target.size() && edges.size() == noise.size() + 1);
  noise_samples_ = std::accumulate(noise.begin(), noise.end(), std::uint64_t{0});
  target_samples_ = std::accumulate(target.begin(), target.end(), std::uint64_t{0});
  ISOBATH_ASSERT(noise_samples_ > 0 && target_samples_ > 0);
  points_.push_back({edges.back(), 0, 0});
  std::uint64_t alarms = 0;
  std::uint64_t hits = 0;
  for (std::size_t i = noise.size(); i-- > 0;) {
    if (noise[i] == 0 && target[i] == 0) continue;  // an empty level changes neither rate
    points_.back().threshold = edges[i + 1];
    alarms += noise[i];
    hits += target[i];
    points_.push_back({edges[i], static_cast<double>(alarms) / static_cast<double>(noise_samples_),
                       static_cast<double>(hits) / static_cast<double>(target_samples_)});
  }
}

double RocCurve::area() const {
  double sum = 0;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    sum += 0.5 * (points_[i].f - points_[i - 1].f) * (points_[i].p + points_[i - 1].p);
  }
  return sum;
}

RocPoint RocCurve::at_false_alarm(double f) const {
  ISOBATH_ASSERT(f >= 0 && f <= 1);
  const auto above =
      std::upper_bound(points_.begin(), points_.end(), f, [](double x, const RocPoint& q) { return x < q.f; });
  if (above == points_.end()) return points_.back();
  const RocPoint& a = *(above - 1);  // points_ begins at f = 0
  const double share = (f - a.f) / (above->f - a.f);
  return {std::lerp(a.threshold, above->threshold, share), f, std::lerp(a.p, above->p, share)};
}

}  // namespace isobath
