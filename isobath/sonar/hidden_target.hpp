// Hidden target: detection probability of a target in a background that is louder than the water for which p_D holds
// (ledger S6-69).
#pragma once

#include <cmath>

namespace isobath {

/// p_D of a fluctuating target (Swerling 1) in a background that is louder by `power_ratio`, given its detection
/// probability p in quiet water and the false-alarm rate f: f^(1 / (1 + s)), s its signal-to-noise ratio over this
/// ratio.
inline double hidden_p_detect(double power_ratio, double p, double f) {
  const double snr = std::log(f) / std::log(p) - 1;
  return std::pow(f, 1 / (1 + snr / power_ratio));
}

}  // namespace isobath
