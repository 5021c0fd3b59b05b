// Gamma quantiles: maps standard normal numbers to numbers of the Gamma law of mean 1, in the same order. It turns a
// Gaussian field that is smooth in space and time into a Gamma field that is smooth in the same way.
#pragma once

#include <vector>

namespace isobath {

/// Table of the Gamma law of shape > 0 and mean 1 by normal deviate, from its incomplete integral (Abramowitz and
/// Stegun 6.5.29 and 6.5.31). Relative accuracy 1e-3.
std::vector<float> gamma_quantiles(double shape);
/// `normal` is clamped to 6 standard deviations.
float gamma_quantile(const std::vector<float>& table, double normal);

}  // namespace isobath
