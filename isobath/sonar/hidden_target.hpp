// How often a target is found where the background is louder than the water that its p_D holds for (ledger S6-69).
#pragma once

#include <cmath>

namespace isobath {

/// p_D of a fluctuating target (Swerling 1) that is found with p in quiet water, at the false-alarm rate f, where the
/// background is louder by `power_ratio`: f^(1 / (1 + s)), its signal to noise ratio s divided by that.
inline double hidden_p_detect(double power_ratio, double p, double f) {
  const double snr = std::log(f) / std::log(p) - 1;
  return std::pow(f, 1 / (1 + snr / power_ratio));
}

}  // namespace isobath
