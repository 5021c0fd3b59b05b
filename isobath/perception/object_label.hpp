// Object labels: classifies objects by the history of their attributes (ledger S1-06).
//
//   moving    a straight track at constant speed through the positions has a speed that noise does not explain: with v
//             and its covariance C by least squares, v^T C^-1 v > `moving_gate`, and |v| at least `min_speed`
//   vanished  the last `misses` looks at its position found nothing; the passage of time alone never makes an object
//             vanish
//   static    neither, with at least three positions
//   unknown   fewer positions
//
// The noise of a position is the larger of `position_sigma` and the residual of the track. Positions in m, W. Pure.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/map/features/object_store.hpp>
#include <span>

namespace isobath {

enum class ObjectLabel : std::uint8_t { kUnknown, kStatic, kMoving, kVanished };
const char* to_text(ObjectLabel label);

struct ObjectLabelConfig {
  double position_sigma = 0.5;  ///< m, each axis
  double moving_gate = 16.3;    ///< 99.9 % of chi-square with three degrees of freedom
  double min_speed = 0.02;      ///< m/s
  int misses = 3;
};

/// `positions`: vectors; `looks`: numbers, 0 if a look at its position did not find it. Both in order of time, as
/// ObjectStore::history gives them; entries of another type are ignored.
ObjectLabel label_object(const ObjectLabelConfig& config, std::span<const AttributeEntry> positions,
                         std::span<const AttributeEntry> looks);

}  // namespace isobath
