// log_gamma: the natural logarithm of |Gamma(x)|. Any number of threads may call it; std::lgamma writes the sign to a
// variable that all threads share.
#pragma once

#include <math.h>

namespace isobath {

/// ln |Gamma(x)|, safe on any number of threads; std::lgamma writes the sign to a variable that all threads share.
inline double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

}  // namespace isobath
