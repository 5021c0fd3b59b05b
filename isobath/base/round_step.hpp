// round_step: round sizes for cells and voxels.
#pragma once

#include <cmath>
#include <initializer_list>

namespace isobath {

/// The smallest of `steps` (ascending, in [1, 10)) and 10, times a power of ten, that reaches a positive value or falls
/// short of it by at most a thousandth.
inline double round_step(double value, std::initializer_list<double> steps) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  for (const double step : steps) {
    if (value <= step * decade * 1.001) return step * decade;
  }
  return 10 * decade;
}

}  // namespace isobath
