// BottomBelow: how deep the water is where the vehicle is, from its sensors that look down (ledger S6-69).
//
// The median of the last three readings, so that one fish is no bottom, or the newest while there are fewer; a reading
// without an echo says nothing. Each counts for kFresh. A cone that holds the vertical hears a level bottom straight
// below, another one under its steeper edge (BeamCone). Depths below the datum of W, positive down, m. Allocates
// nothing. One thread.
#pragma once

#include <array>
#include <isobath/geometry/pose.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <optional>

namespace isobath {

class BottomBelow {
 public:
  static constexpr Duration kFresh = std::chrono::seconds(5);

  /// The pose is that of the reading's time.
  void hear(const RangeReading& reading, const Pose& X_WB);
  /// Empty: nobody has heard the bottom lately.
  [[nodiscard]] std::optional<double> depth(Time now) const;

 private:
  struct Heard {
    Time time = Time::min();
    double depth_m = 0;
  };
  std::array<Heard, 3> last_;
  std::size_t next_ = 0;
};

}  // namespace isobath
