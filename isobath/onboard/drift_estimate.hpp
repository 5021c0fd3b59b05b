// DriftEstimate: how far a drifting navigation is off, and how fast that grows with the way (ledger S4-49).
//
// State per axis: offset o, m, which is added to the navigation, and its rate b, m per metre of way. The rate is a
// Gauss-Markov process of standard deviation `share` and correlation length L, so that after ds
//   o <- o + b ds,  b <- b exp(-ds / L),  var(b) -> share^2,
// and an error that keeps its direction (1 % of the way, say) is predicted between two fixes of the position. Kalman
// filter over both axes; a fix measures o.
//
// Units: m, W (north, east). One thread.
#pragma once

#include <Eigen/Core>

namespace isobath {

class DriftEstimate {
 public:
  DriftEstimate(double share, double length_m) : share_(share), length_m_(length_m) {}

  /// Offset and rate 0. `covariance`: of the position as the navigation states it.
  void begin(const Eigen::Matrix2d& covariance);
  void advance(double way_m);
  /// Makes the mean variance of the offset this, m2, and keeps its correlation with the rate.
  void scale_to(double variance);
  /// The navigation is off by `offset`, with this covariance. Returns by how much the offset changes.
  Eigen::Vector2d correct(const Eigen::Vector2d& offset, const Eigen::Matrix2d& covariance);

  [[nodiscard]] Eigen::Vector2d offset() const { return state_.head<2>(); }
  [[nodiscard]] Eigen::Matrix2d covariance() const { return covariance_.topLeftCorner<2, 2>(); }
  /// Variance of the offset, the mean over both axes, m2.
  [[nodiscard]] double variance() const { return covariance().trace() / 2; }

 private:
  double share_, length_m_;
  Eigen::Vector4d state_ = Eigen::Vector4d::Zero();  ///< offset north, east; rate north, east
  Eigen::Matrix4d covariance_ = Eigen::Matrix4d::Zero();
};

}  // namespace isobath
