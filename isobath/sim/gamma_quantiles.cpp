#include <algorithm>
#include <cmath>
#include <isobath/base/log_gamma.hpp>
#include <isobath/sim/gamma_quantiles.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kMax = 6;  // standard deviations
constexpr int kSteps = 1200;

/// P(X <= x) and P(X > x) for the Gamma law of scale 1, each to its own relative precision.
struct Tails {
  double below, above;
};
Tails tails(double shape, double x) {
  if (x <= 0) return {0, 1};
  const double front = std::exp(shape * std::log(x) - x - log_gamma(shape));
  if (x < shape + 1) {
    double term = 1 / shape, sum = term;
    for (int n = 1; n < 1000 && term > 1e-15 * sum; ++n) sum += term *= x / (shape + n);
    return {front * sum, 1 - front * sum};
  }
  double b = x + 1 - shape, c = 1e300, d = 1 / b, fraction = d;  // Lentz's method
  for (int i = 1; i < 1000; ++i) {
    const double a = -i * (i - shape);
    b += 2;
    d = 1 / (a * d + b);
    c = b + a / c;
    fraction *= c * d;
    if (std::abs(c * d - 1) < 1e-14) break;
  }
  return {1 - front * fraction, front * fraction};
}

}  // namespace

std::vector<float> gamma_quantiles(double shape) {
  std::vector<float> table;
  double lowest = -700;  // logarithms: small shapes have very small quantiles
  for (int i = 0; i <= kSteps; ++i) {
    const double g = kMax * (2.0 * i / kSteps - 1);
    const double wanted = 0.5 * std::erfc(std::abs(g) / std::numbers::sqrt2);
    double low = lowest, high = std::log(shape + 60 + 20 * std::sqrt(shape));
    for (int k = 0; k < 48; ++k) {
      const double middle = 0.5 * (low + high);
      const Tails t = tails(shape, std::exp(middle));
      ((g < 0 ? t.below < wanted : t.above > wanted) ? low : high) = middle;
    }
    lowest = low;
    table.push_back(static_cast<float>(std::exp(low) / shape));
  }
  return table;
}

float gamma_quantile(const std::vector<float>& table, double normal) {
  const double at = (std::clamp(normal, -kMax, kMax) / kMax + 1) * 0.5 * kSteps;
  const auto i = std::min(static_cast<std::size_t>(at), table.size() - 2);
  const auto share = static_cast<float>(at - static_cast<double>(i));
  return table[i] + share * (table[i + 1] - table[i]);
}

}  // namespace isobath
