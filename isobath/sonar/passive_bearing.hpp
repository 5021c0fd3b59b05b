// PassiveBearing: the direction from which an array of hydrophones receives one frequency line, such as the hum of a
// machine (Auran, Silven 1995, 3.1; ledger S4-54). A passive array measures no range.
#pragma once

#include <isobath/base/angle.hpp>
#include <isobath/base/time.hpp>
#include <isobath/geometry/pose.hpp>
#include <optional>

namespace isobath {

struct PassiveBearing {
  Time time;
  Angle bearing;                        ///< about z of S, clockwise from its x seen from above
  Angle sigma;                          ///< standard deviation of the bearing, with the bias of the array; above 0
  std::optional<Angle> elevation = {};  ///< above the x-y plane of S, -90 to 90 degrees; empty: not resolved
  double frequency_hz = 0;              ///< of the line; above 0
  double resolution_hz = 1;             ///< width of the array's frequency cells; above 0
  double snr_db = 0;                    ///< of the line in its cell, after the gain of the array
  Pose X_BS = {};                       ///< the array in B; tells arrays apart
};

/// Direction in the plane of W, clockwise from north, in which the sound arrives at an array at X_WS. Where elevation
/// is not resolved, the sound counts as level with the array. Empty if the direction is vertical.
std::optional<Angle> bearing_in_world(const PassiveBearing& heard, const Pose& X_WS);

}  // namespace isobath
