// Round numbers for cells and voxels.
#pragma once

#include <cmath>
#include <initializer_list>

namespace isobath {

/// The least of `steps` (ascending, in [1, 10)) and 10, times a power of ten, that is not below a positive value by
/// more than a thousandth.
inline double round_step(double value, std::initializer_list<double> steps) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  for (const double step : steps) {
    if (value <= step * decade * 1.001) return step * decade;
  }
  return 10 * decade;
}

}  // namespace isobath
