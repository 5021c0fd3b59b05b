// RangeReading: a single range with the cone in which it was measured (altimeter, obstacle sonar, rangefinder).
#pragma once

#include <cstdint>
#include <isobath/base/angle.hpp>
#include <isobath/base/time.hpp>
#include <isobath/geometry/pose.hpp>
#include <optional>

namespace isobath {

struct RangeReading {
  Time time;
  std::optional<double> range_m;  ///< empty: no echo within max_range_m, which also is evidence
  double max_range_m = 0;
  Angle width;           ///< full width of the cone
  Pose X_BS;             ///< x of S is the axis of the cone
  float confidence = 1;  ///< 0..1, as the device states it
};

}  // namespace isobath
