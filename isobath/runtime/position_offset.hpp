// By how much a log lies beside a map, in the plane: what its depths say where the bottom slopes.
//
// A sounding that is placed off by (north, east) = -delta on a bottom of gradient g differs from the map by g . delta.
// Robust least squares (Cauchy weights, eight rounds) over all soundings gives delta and a depth bias. It is a
// diagnosis, for positions of metres: nothing is corrected by it. Gradients m/m, depth down.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

namespace isobath {

struct SlopeSample {
  double difference_m = 0;  ///< sounding less map
  Eigen::Vector2d gradient{0, 0};
};

struct PositionOffset {
  std::uint64_t n = 0;
  Eigen::Vector2d offset_m{0, 0};  ///< north, east: what must be added to the log's positions
  Eigen::Vector2d sigma_m{0, 0};   ///< standard deviations, as if soundings were independent: they are not
  double bias_m = 0;               ///< of the depths
  double robust_sd_m = 0;          ///< before
  double robust_sd_left_m = 0;     ///< with offset and bias taken out
};

/// Empty with fewer than 100 samples, or a bottom too even to tell.
std::optional<PositionOffset> position_offset(std::span<const SlopeSample> samples);

/// One sentence.
std::string to_text(const PositionOffset& offset);

}  // namespace isobath
