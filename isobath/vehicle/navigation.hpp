// Navigation: one fix of the vehicle's own position estimate. PoseTimeline: the poses of many.
#pragma once

#include <Eigen/Core>
#include <isobath/base/time.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/geometry/pose.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

struct Navigation {
  Time time;
  Pose X_WB;                                 ///< body in world: north-east-down, m
  std::optional<Eigen::Vector3d> v_WB = {};  ///< velocity of B in W, components in W, m/s
  /// Of (position in W, rotation vector in B), m2, m rad, rad2.
  std::optional<Eigen::Matrix<double, 6, 6>> covariance = {};
  std::optional<double> v_sigma = {};  ///< standard deviation of v_WB in the plane, along its longer axis, m/s
};

/// Standard deviation of the position in the plane, an axis; empty: the fix does not state it.
std::optional<double> sigma_m_of(const Navigation& fix);

/// All poses of a recorded track by time, interpolated over gaps of at most 5 s. PoseBuffer is its counterpart for
/// fixes that still arrive.
class PoseTimeline {
 public:
  PoseTimeline() = default;
  explicit PoseTimeline(std::span<const Navigation> fixes);

  /// Leaves out a fix that goes back in time or is not finite.
  void add(const Navigation& fix);
  [[nodiscard]] std::optional<Pose> at(Time time) const;
  [[nodiscard]] bool empty() const { return times_.empty(); }

 private:
  std::vector<Time> times_;
  std::vector<Pose> poses_;
};

}  // namespace isobath
