#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/base/log_gamma.hpp>
#include <isobath/base/random.hpp>
#include <isobath/sonar/noise_fit.hpp>
#include <isobath/sonar/roc.hpp>
#include <limits>
#include <numeric>

namespace isobath {
namespace {

constexpr double kLargestShape = 50;  // beyond it K cannot be distinguished from Rayleigh by a histogram
constexpr double kSmallestShape = 0.1;
constexpr int kGroups = 128;  // maximum number of groups of levels over the span of the samples

/// Levels, or groups of neighbouring levels, around those with samples.
struct Grouped {
  std::vector<double> edges;  ///< one more than counts
  std::vector<double> middles;
  std::vector<double> counts;
  double samples = 0;
};

Grouped group(const EchoLevels& levels, const std::vector<std::uint64_t>& counts) {
  Grouped g;
  const auto filled = [](std::uint64_t c) { return c > 0; };
  const auto first = std::find_if(counts.begin(), counts.end(), filled);
  if (first == counts.end()) return g;
  const auto last = std::find_if(counts.rbegin(), counts.rend(), filled).base();
  // Adds a margin of empty levels on both sides, since bootstrap samples reach slightly farther, and limits the number
  // of groups.
  const int size = static_cast<int>(counts.size());
  const int span = static_cast<int>(last - first);
  const int from = std::max(0, static_cast<int>(first - counts.begin()) - span / 2);
  const int upto = std::min(size, static_cast<int>(last - counts.begin()) + span / 2);
  const int stride = (span + kGroups - 1) / kGroups;
  for (int i = from; i < upto; i += stride) {
    const int next = std::min(i + stride, upto);
    g.edges.push_back(levels.edge(i));
    const bool zero = i == 0 && next == 1 && levels.discrete();
    g.middles.push_back(zero ? 0 : 0.5 * (levels.edge(i) + levels.edge(next)));
    g.counts.push_back(std::accumulate(counts.begin() + i, counts.begin() + next, 0.0));
    g.samples += g.counts.back();
  }
  g.edges.push_back(levels.edge(upto));
  return g;
}

double raw_moment(const Grouped& g, const std::vector<double>& counts, int power) {
  double sum = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0) sum += counts[i] * std::pow(g.middles[i], power);
  }
  return sum / g.samples;
}

/// Estimates the parameters only.
NoiseFit estimate(const Grouped& g, const std::vector<double>& counts, NoiseLaw law) {
  NoiseFit fit;
  fit.law = law;
  const double m2 = raw_moment(g, counts, 2);
  switch (law) {
    case NoiseLaw::kGaussian: {
      fit.location = raw_moment(g, counts, 1);
      fit.scale = std::sqrt(std::max(m2 - fit.location * fit.location, 0.0));
      break;
    }
    case NoiseLaw::kRayleigh: fit.scale = std::sqrt(m2 / 2); break;
    case NoiseLaw::kK: {  // E[x^4] / E[x^2]^2 = 2 (1 + 1 / shape)
      const double excess = raw_moment(g, counts, 4) / (2 * m2 * m2) - 1;
      fit.shape = excess > 1 / kLargestShape ? std::max(1 / excess, kSmallestShape) : kLargestShape;
      fit.scale = std::sqrt(m2 / (4 * fit.shape));
      break;
    }
  }
  return fit;
}

/// 1 - 2 / Gamma(shape) (x / 2 scale)^shape K_shape(x / scale).
double k_cumulative(double x, double shape, double scale) {
  const double u = x / scale;
  // Nearer to 0 the Bessel function overflows; there the share is below 1e-5 (shape >= 1) or 1e-20 (shape >= 0.1).
  if (!(u > (shape >= 1 ? 1e-3 : 1e-100))) return 0;
  if (u > 600) return 1;
  const double log_factor = std::log(2.0) - log_gamma(shape) + shape * std::log(u / 2);
  return std::clamp(1 - std::exp(log_factor + std::log(std::cyl_bessel_k(shape, u))), 0.0, 1.0);
}

/// The law's cumulative share at each inner edge; all mass is in the levels between the first edge and the last.
std::vector<double> shares(const NoiseFit& fit, const Grouped& g) {
  std::vector<double> f(g.edges.size(), 0);
  f.back() = 1;
  for (std::size_t i = 1; i + 1 < f.size(); ++i) f[i] = std::max(f[i - 1], cumulative(fit, g.edges[i]));
  return f;
}

/// Sum over levels of (F_n - F)^2 / (F (1 - F)) times the law's mass of the level.
double anderson_darling(const std::vector<double>& counts, double samples, const std::vector<double>& law) {
  double below = 0;
  double sum = 0;
  for (std::size_t i = 0; i + 1 < counts.size(); ++i) {
    below += counts[i];
    const double f = law[i + 1];
    const double difference = below / samples - f;
    const double mass = f - law[i];
    if (f > 0 && f < 1) {
      sum += difference * difference / (f * (1 - f)) * mass;
    } else if (f >= 1 && difference < 0) {
      return std::numeric_limits<double>::infinity();  // samples where the law has no mass
    }
  }
  return samples * sum;
}

/// Draws as many samples of the law into the levels.
void draw(const std::vector<double>& law, double samples, Random& random, std::vector<double>& counts) {
  std::fill(counts.begin(), counts.end(), 0.0);
  for (double n = 0; n < samples; ++n) {
    const auto above = std::upper_bound(law.begin() + 1, law.end() - 1, random.uniform());
    counts[above - law.begin() - 1] += 1;
  }
}

}  // namespace

const char* to_text(NoiseLaw law) {
  switch (law) {
    case NoiseLaw::kGaussian: return "gaussian";
    case NoiseLaw::kRayleigh: return "rayleigh";
    case NoiseLaw::kK: return "k";
  }
  return "unknown";
}

double cumulative(const NoiseFit& fit, double x) {
  if (fit.law == NoiseLaw::kGaussian) return normal_tail((fit.location - x) / fit.scale);
  if (x <= 0) return 0;
  if (fit.law == NoiseLaw::kRayleigh) return -std::expm1(-0.5 * (x / fit.scale) * (x / fit.scale));
  return k_cumulative(x, fit.shape, fit.scale);
}

NoiseFit fit_noise(const EchoLevels& levels, const std::vector<std::uint64_t>& counts, NoiseLaw law,
                   const NoiseFitConfig& config) {
  ISOBATH_ASSERT(static_cast<int>(counts.size()) == levels.count());
  const Grouped g = group(levels, counts);
  const auto filled = std::count_if(g.counts.begin(), g.counts.end(), [](double c) { return c > 0; });
  NoiseFit fit;
  fit.law = law;
  fit.statistic = std::numeric_limits<double>::infinity();
  fit.samples = static_cast<std::uint64_t>(g.samples);
  if (g.samples < 8 || filled < 3) return fit;
  fit = estimate(g, g.counts, law);
  fit.samples = static_cast<std::uint64_t>(g.samples);
  const std::vector<double> fitted = shares(fit, g);
  fit.statistic = anderson_darling(g.counts, g.samples, fitted);
  Random random(config.seed);
  std::vector<double> again(g.counts.size());
  int as_bad = 0;
  for (int i = 0; i < config.bootstraps; ++i) {
    draw(fitted, g.samples, random, again);
    const NoiseFit refit = estimate(g, again, law);
    as_bad += anderson_darling(again, g.samples, shares(refit, g)) >= fit.statistic;
  }
  fit.p_value = (as_bad + 1.0) / (config.bootstraps + 1.0);
  return fit;
}

}  // namespace isobath
