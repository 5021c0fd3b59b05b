// CurrentEstimate: the current, as far as the headings so far have shown it, and how much of it they have not. On one
// heading a vehicle that measures its speed over ground sees only what carries it across the hull: a current along the
// hull looks like its own way. Each new heading shows another part.
//
// Method: a Kalman filter of the two components in W, with the speed across the hull as measurement. In a turn the hull
// slips sideways, and the measurement counts little. The current is taken to be horizontal and to change slowly.
#pragma once

#include <Eigen/Core>
#include <isobath/base/angle.hpp>

namespace isobath {

class CurrentEstimate {
 public:
  /// `unknown`: standard deviation of each component before any measurement, m/s.
  explicit CurrentEstimate(double unknown) : covariance_W_(unknown * unknown * Eigen::Matrix2d::Identity()) {}

  /// Ignores values that are not finite. `v_W`: over ground, m/s; `yaw_rate` in rad/s; `dt` in s.
  void update(Angle heading, const Eigen::Vector3d& v_W, double yaw_rate, double dt);

  [[nodiscard]] const Eigen::Vector2d& velocity_W() const { return velocity_W_; }
  /// Standard deviation of the component along a heading, m/s.
  [[nodiscard]] double sigma_along(Angle heading) const;

 private:
  Eigen::Vector2d velocity_W_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_W_;
};

}  // namespace isobath
