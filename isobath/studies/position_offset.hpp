// PositionOffset: the horizontal offset between a log and a map, estimated from depths where the bottom slopes.
//
// If a sounding is misplaced by (north, east) = -delta on a bottom of gradient g, its depth differs from the map by
// g . delta. Robust least squares (Cauchy weights, eight rounds) over all soundings gives delta and a depth bias. The
// result is a diagnosis for position errors of metres; nothing is corrected by it. Gradients in m/m, depth down.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

namespace isobath {

struct SlopeSample {
  double difference_m = 0;  ///< sounding minus map
  Eigen::Vector2d gradient{0, 0};
};

struct PositionOffset {
  std::uint64_t n = 0;
  Eigen::Vector2d offset_m{0, 0};  ///< north, east: the correction to add to the positions of the log
  Eigen::Vector2d sigma_m{0, 0};   ///< standard deviations as if soundings were independent, which they are not
  double bias_m = 0;               ///< of the depths
  double robust_sd_m = 0;          ///< of the differences as they are
  double robust_sd_left_m = 0;     ///< of the differences without offset and bias
};

/// Empty if there are fewer than 100 samples, or if the bottom is too flat.
std::optional<PositionOffset> position_offset(std::span<const SlopeSample> samples);

/// The offset as one sentence.
std::string to_text(const PositionOffset& offset);

}  // namespace isobath
