// AltitudeEstimator: the depth of the bottom below the vehicle, from its sensors that look down (ledger S6-69).
//
// It is the median of the last three readings, so that one fish is not taken for the bottom, or the newest reading
// while there are fewer. Readings without an echo are ignored. A reading counts for kFresh. A cone that contains the
// vertical measures a level bottom straight below; any other cone measures it under its steeper edge (BeamCone). Depths
// are below the datum of W, positive down, m. Allocates nothing. One thread.
#pragma once

#include <array>
#include <isobath/geometry/pose.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <optional>

namespace isobath {

class AltitudeEstimator {
 public:
  static constexpr Duration kFresh = std::chrono::seconds(5);

  /// `X_WB`: at the time of the reading.
  void update(const RangeReading& reading, const Pose& X_WB);
  /// Empty if the newest reading is older than kFresh.
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
