// PathHelm: along a path in space by set-points of heading, depth and speed, for vehicles whose protocol takes no pitch
// rate (Horner et al. c. 2009, 6; ledger S5-53, S5-54).
//
// Horizontal and vertical motion are decoupled. A virtual target moves along the path as in S5-51. The heading is that
// of the path at the target, plus the approach angle asin(-y / (|y| + approach_m)) for a vehicle y to starboard of it,
// plus what its own rate of change makes of the lag of the heading loop, less the angle at which the water carries the
// hull aside.
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
#include <isobath/vehicle/autopilot.hpp>
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

/// Steps the depth loop of a vehicle under way in still water by half a metre up and down, and identifies it.
DepthLoop measured_depth_loop(const VehicleModel& model, double speed);

struct PathHelmConfig {
  double along_gain = 0.5;   ///< 1/s, K1 of S5-51
  double approach_m = 3;     ///< beside the path, where it is met at 30 degrees
  double heading_lag_s = 1;  ///< of the heading loop
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
  PathFrame target_;
};

}  // namespace isobath
