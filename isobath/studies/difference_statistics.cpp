#include <algorithm>
#include <cmath>
#include <isobath/studies/difference_statistics.hpp>

namespace isobath {
namespace {

constexpr double kNormalMad = 1.4826;  // standard deviations of a normal law in one median absolute deviation

/// Type 7 of the sorted values; they are not empty.
double sorted_quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(std::floor(at));
  const std::size_t high = std::min(low + 1, sorted.size() - 1);
  return sorted[low] + (at - static_cast<double>(low)) * (sorted[high] - sorted[low]);
}

}  // namespace

DifferenceStatistics difference_statistics(std::vector<double> differences) {
  DifferenceStatistics s;
  s.n = differences.size();
  if (differences.empty()) return s;
  std::sort(differences.begin(), differences.end());
  s.median_m = sorted_quantile(differences, 0.5);
  std::vector<double> distance(differences.size());
  const auto sorted_distance_from = [&](double centre) -> const std::vector<double>& {
    std::transform(differences.begin(), differences.end(), distance.begin(),
                   [centre](double d) { return std::abs(d - centre); });
    std::sort(distance.begin(), distance.end());
    return distance;
  };
  s.robust_sd_m = kNormalMad * sorted_quantile(sorted_distance_from(s.median_m), 0.5);
  s.p95_m = sorted_quantile(sorted_distance_from(0), 0.95);
  return s;
}

}  // namespace isobath
