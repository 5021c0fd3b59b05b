#include <cmath>
#include <Eigen/LU>
#include <isobath/onboard/drift_estimate.hpp>

namespace isobath {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::Vector2d;

void DriftEstimate::begin(const Matrix2d& covariance) {
  state_.setZero();
  covariance_.setZero();
  covariance_.topLeftCorner<2, 2>() = covariance;
  covariance_.bottomRightCorner<2, 2>() = share_ * share_ * Matrix2d::Identity();
}

void DriftEstimate::advance(double way_m) {
  const double kept = std::exp(-way_m / length_m_);
  Matrix4d step = Matrix4d::Identity();
  step.topRightCorner<2, 2>() = way_m * Matrix2d::Identity();
  step.bottomRightCorner<2, 2>() = kept * Matrix2d::Identity();
  state_ = (step * state_).eval();
  covariance_ = (step * covariance_ * step.transpose()).eval();
  covariance_.bottomRightCorner<2, 2>() += share_ * share_ * (1 - kept * kept) * Matrix2d::Identity();
}

void DriftEstimate::scale_to(double variance) {
  if (!(this->variance() > 0)) return;
  const double times = std::sqrt(variance / this->variance());
  covariance_.topRows<2>() *= times;
  covariance_.leftCols<2>() *= times;
}

Vector2d DriftEstimate::correct(const Vector2d& offset, const Matrix2d& covariance) {
  const Vector2d before = this->offset();
  const Eigen::Matrix<double, 4, 2> gain = covariance_.leftCols<2>() * (this->covariance() + covariance).inverse();
  state_ += gain * (offset - before);
  covariance_ = (covariance_ - gain * covariance_.topRows<2>()).eval();
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  return this->offset() - before;
}

}  // namespace isobath
