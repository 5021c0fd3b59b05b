// PathHelm: follows a path in space by set-points of heading, depth and speed, for vehicles whose protocol accepts no
// pitch rate (Horner et al. c. 2009, 6; ledger S5-53, S5-54).
//
// Horizontal and vertical motion are decoupled. A virtual target moves along the path as in S5-51. The heading is that
// of the path at the target, plus the approach angle asin(-y / (|y| + approach_m)) for a vehicle y to starboard of it,
// plus the lag of the heading loop times the turn rate of the path, less the crab angle of a steady drift (Drift). The
// rate of the approach angle itself is left out: with the sway of a real hull in it the loop is not stable.
//
// Depth. A depth loop lags its set-point: about asked = z + lag z' + lag2 z''. So the set-point is not the path's depth
// but that expression with the path's depth and its derivatives at the speed of the target: the inverse of the loop.
// identify_depth_loop finds lag and lag2 from a record of depth set-points and measured depths, by least squares over
// both sides after the same low-pass filter, so that no noisy depth is ever differentiated; a steady offset by trim
// does not affect them. Where the inverse demands more than the vehicle can climb, it climbs as fast as it can.
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

/// From at least ten samples, `dt` s apart. `filter_s`: time constant of the filter, about that of the loop. Throws
/// Error if the record varies too little.
DepthLoop identify_depth_loop(std::span<const double> asked_m, std::span<const double> depth_m, double dt,
                              double filter_s = 2);

/// For a vehicle under way in still water, from four waves of the period at which it will have to change depth.
DepthLoop measured_depth_loop(const VehicleModel& model, double speed, double period_s);

struct PathHelmConfig {
  double along_gain = 0.5;   ///< 1/s, K1 of S5-51
  double approach_m = 3;     ///< lateral distance at which the approach angle is 30 degrees
  double heading_lag_s = 1;  ///< of the heading loop
  double drift_time_s = 8;   ///< of the filter on the drift across the hull; 0: not used
  bool shape_depth = true;   ///< use the inverse of the depth loop
};

std::vector<Field> fields(PathHelmConfig& config);

class PathHelm {
 public:
  /// Begins at the start of the path.
  PathHelm(const SpacePath& path, const PathHelmConfig& config, const DepthLoop& loop, double speed);

  Setpoint step(const VehicleState& state, double dt);
  /// Switches to another path, at arc length `s` of it.
  void follow(const SpacePath& path, double s);

  [[nodiscard]] double s() const { return s_; }
  [[nodiscard]] bool finished() const { return s_ >= path_->length(); }
  /// The frame of the virtual target.
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
