// Gamma quantiles: numbers of the standard normal law made ones of the Gamma law of mean 1, in the same order. So a
// Gaussian field that is smooth in place and time becomes a Gamma field that is.
#pragma once

#include <vector>

namespace isobath {

/// Table by normal deviate of the Gamma law of shape > 0 and mean 1, by its incomplete integral (Abramowitz and Stegun
/// 6.5.29 and 6.5.31), good to 1e-3 of the value.
std::vector<float> gamma_quantiles(double shape);
/// `normal`: held within 6 standard deviations.
float gamma_quantile(const std::vector<float>& table, double normal);

}  // namespace isobath
