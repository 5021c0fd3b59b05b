#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/roc.hpp>
#include <numbers>
#include <numeric>

namespace isobath {
namespace {

std::optional<double> ratio(std::uint64_t part, std::uint64_t rest) {
  if (part + rest == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(part + rest);
}

/// x >= 0 with Q(x) = q, 0 < q <= 1/2: Abramowitz and Stegun 26.2.23 (4.5e-4), then Halley steps on log-accurate erfc.
double upper_quantile(double q) {
  const double t = std::sqrt(-2 * std::log(q));
  double x = t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  for (int i = 0; i < 3; ++i) {
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi);
    if (density <= 0) break;
    const double u = (normal_tail(x) - q) / density;
    x += u / (1 - 0.5 * x * u);
  }
  return x;
}

}  // namespace

void EchoCounts::add(bool decision, bool target) {
  ++(target ? (decision ? hits : misses) : (decision ? false_alarms : correct_rejections));
}

EchoCounts& EchoCounts::operator+=(const EchoCounts& other) {
  hits += other.hits;
  false_alarms += other.false_alarms;
  misses += other.misses;
  correct_rejections += other.correct_rejections;
  return *this;
}

std::optional<double> EchoCounts::p() const { return ratio(hits, misses); }
std::optional<double> EchoCounts::f() const { return ratio(false_alarms, correct_rejections); }

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

double normal_quantile(double p) {
  ISOBATH_ASSERT(p > 0 && p < 1);
  return p <= 0.5 ? -upper_quantile(p) : upper_quantile(1 - p);
}

double erfc_inverse(double y) {
  ISOBATH_ASSERT(y > 0 && y < 2);
  return y <= 1 ? upper_quantile(y / 2) / std::numbers::sqrt2 : -upper_quantile(1 - y / 2) / std::numbers::sqrt2;
}

double theoretical_detection(double false_alarm, double snr) {
  ISOBATH_ASSERT(snr >= 0);
  return 0.5 * std::erfc(erfc_inverse(2 * false_alarm) - std::sqrt(snr / 2));
}

double gaussian_threshold(double false_alarm, double sigma) {
  return sigma * std::numbers::sqrt2 * erfc_inverse(2 * false_alarm);
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
