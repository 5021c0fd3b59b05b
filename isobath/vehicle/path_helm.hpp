// PathHelm: along a path in space by set-points of heading, depth and speed, for vehicles whose protocol takes no pitch
// rate (Horner et al. c. 2009, 6; ledger S5-53, S5-54).
//
// Horizontal and vertical motion are decoupled. A virtual target moves along the path as in S5-51. The heading is that
// of the path at the target, plus the approach angle asin(-y / (|y| + approach_m)) for a vehicle y to starboard of it,
// plus what the lag of the heading loop makes of the path's turning, less the crab angle of a steady drift (Drift).
// What the approach angle's own rate would add is left out: with the sway of a real hull in it the loop is not stable.
//
// Depth. A depth loop comes after what it is asked for: about asked = z + lag z' + lag2 z''. So the depth asked for is
// not the path's, but that expression with the path's depth and its derivatives at the speed of the target: the inverse
// of the loop. identify_depth_loop finds lag and lag2 from a record of depths asked for and depths made good, by least
// squares over both sides after one and the same low-pass filter, so that no noisy depth is ever differentiated; what a
// trim adds stays out of it. Where the inverse asks for more than the vehicle can climb, it climbs as fast as it can.
//
// SI, W north-east-down. One thread at a time; `step` allocates nothing. The path must outlive the helm.
#pragma once

#include <isobath/geometry/space_path.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <span>

namespace isobath {

/// asked = z + lag_s z' + lag2_s2 z''.
struct DepthLoop {
  double lag_s = 0;
  double lag2_s2 = 0;
};

/// From samples `dt` s apart, at least ten. `filter_s`: time constant of the filter; about the loop's own. Throws Error
/// where the record does not move enough to tell.
DepthLoop identify_depth_loop(std::span<const double> asked_m, std::span<const double> depth_m, double dt,
                              double filter_s = 2);

/// Of a vehicle under way in still water, from four waves of the period at which it will be asked to go up and down.
DepthLoop measured_depth_loop(const VehicleModel& model, double speed, double period_s);

struct PathHelmConfig {
  double along_gain = 0.5;   ///< 1/s, K1 of S5-51
  double approach_m = 3;     ///< beside the path, where it is met at 30 degrees
  double heading_lag_s = 1;  ///< of the heading loop
  double drift_time_s = 8;   ///< of the filter on the drift across the hull; 0: not used
  bool shape_depth = true;   ///< ask for the inverse of the depth loop
};

std::vector<Field> fields(PathHelmConfig& config);

class PathHelm {
 public:
  /// From the start of the path.
  PathHelm(const SpacePath& path, const PathHelmConfig& config, const DepthLoop& loop, double speed);

  Setpoint step(const VehicleState& state, double dt);
  /// Onto another path, from arc length `s` of it on.
  void follow(const SpacePath& path, double s);

  [[nodiscard]] double s() const { return s_; }
  [[nodiscard]] bool finished() const { return s_ >= path_->length(); }
  /// Where the vehicle should be.
  [[nodiscard]] const PathFrame& target() const { return target_; }

 private:
  const SpacePath* path_;
  PathHelmConfig config_;
  DepthLoop loop_;
  double speed_;
  double s_ = 0;
  Drift drift_;
  PathFrame target_;
};

}  // namespace isobath
