// DifferenceStatistics: statistics of the differences between soundings and a map, m: median; robust standard
// deviation, 1.4826 times the median absolute deviation from the median; 95 % quantile of the magnitude (Hyndman and
// Fan 1996, type 7).
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace isobath {

struct DifferenceStatistics {
  std::uint64_t n = 0;
  double median_m = std::numeric_limits<double>::quiet_NaN();
  double robust_sd_m = std::numeric_limits<double>::quiet_NaN();
  double p95_m = std::numeric_limits<double>::quiet_NaN();
};
/// All differences must be finite; their order does not matter.
DifferenceStatistics difference_statistics(std::vector<double> differences_m);

}  // namespace isobath
