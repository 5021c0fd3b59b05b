#include <algorithm>
#include <Eigen/LU>
#include <isobath/cameras/camera_navigation.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr Duration kFreshFix = std::chrono::milliseconds(500);
constexpr double kStartSpeedSigma = 0.3;          // m/s, where a fix states none
constexpr double kLeastVariance = 0.003 * 0.003;  // m2, of a position by one pair: mounting, exposure
constexpr double kSurer = 4;  // of variances: dead reckoning replaces what pictures have told only if it is much surer
constexpr double kFarFromKey = 0.4;  // of the range: from here on a new key is taken

/// Turns right, down, forward into forward, starboard, down.
Eigen::Matrix3d body_axes() { return (Eigen::Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished(); }

double variance_of(const Navigation& fix) {
  return fix.covariance ? fix.covariance->topLeftCorner<2, 2>().trace() / 2 : 0;
}

}  // namespace

std::vector<Field> fields(CameraNavigationConfig& c) {
  std::vector<Field> all = {
      Field::flag("navigation", &c.on,
                  "Whether the motion between pairs carries the position while the vehicle's own fixes are less sure."),
      Field::real("acceleration", &c.acceleration, {1e-3, 10}, "m/s/sqrt(s)",
                  "Random walk of the velocity between pairs: standard deviation after one second."),
      Field::degrees("rotation_sigma_deg", &c.rotation_sigma, {0, 90},
                     "Standard deviation of the turn between two pairs as the fixes state it; 0: it is not used."),
      Field::real("min_seen_share", &c.min_seen_share, {0, 1}, "1",
                  "Share of the key's points below which a new key is taken."),
  };
  for (Field& field : fields(c.motion)) all.push_back(std::move(field));
  return all;
}

double CameraNavigation::variance() const { return anchor_variance_ + P_.topLeftCorner<2, 2>().trace() / 2; }

void CameraNavigation::predict(Time to) {
  const double dt = to_seconds(to - time_);
  time_ = to;
  if (!(dt > 0)) return;
  Matrix4 F = Matrix4::Identity();
  F.topRightCorner<2, 2>() = dt * Eigen::Matrix2d::Identity();
  x_ = F * x_;
  P_ = (F * P_ * F.transpose()).eval();
  const double q = config_.acceleration * config_.acceleration;
  for (int k = 0; k < 2; ++k) {
    P_(k, k) += q * dt * dt * dt / 3;
    P_(k, k + 2) += q * dt * dt / 2;
    P_(k + 2, k) += q * dt * dt / 2;
    P_(k + 2, k + 2) += q * dt;
  }
}

/// The vehicle is where a new fix says. What the key shows is as far from it as before.
void CameraNavigation::follow(const Navigation& fix, double variance) {
  const Vector2d place = fix.X_WB.translation.head<2>();
  X_WK_.translation.head<2>() += place - x_.head<2>();
  x_.head<2>() = place;
  if (fix.v_WB) x_.tail<2>() = fix.v_WB->head<2>();
  P_.setZero();
  anchor_variance_ = variance;
  const double speed_sigma = fix.v_sigma.value_or(fix.v_WB ? 0 : kStartSpeedSigma);
  P_(2, 2) = P_(3, 3) = speed_sigma * speed_sigma;
}

void CameraNavigation::correct(Navigation& fix) {
  if (!config_.on) return;
  const double before = fix_ ? variance_of(*fix_) : 0, stated = variance_of(fix);
  if (!fix_) time_ = fix.time;
  fix_ = fix;
  predict(fix.time);
  const bool reckoned = key_ && stated > before && stated > anchor_variance_;  // no new fix: it only grows less sure
  if (!key_ || (!reckoned && stated <= variance())) return follow(fix, stated);
  if (reckoned && kSurer * stated <= variance()) {
    x_.head<2>() = fix.X_WB.translation.head<2>();
    P_.topRows<2>().setZero();
    P_.leftCols<2>().setZero();
    P_(0, 0) = P_(1, 1) = stated - anchor_variance_;  // what dead reckoning has added since the key
    return;
  }
  ++counts_.carried;
  fix.X_WB.translation.head<2>() = x_.head<2>();
  if (!fix.v_WB) fix.v_WB.emplace(Vector3d::Zero());
  fix.v_WB->head<2>() = x_.tail<2>();
  auto& C = *fix.covariance;  // it states one, else it would be exact
  C.topRows<2>().setZero();
  C.leftCols<2>().setZero();
  C.topLeftCorner<2, 2>() = P_.topLeftCorner<2, 2>() + anchor_variance_ * Eigen::Matrix2d::Identity();
  fix.v_sigma = std::sqrt(std::max(P_(2, 2), P_(3, 3)));
}

Pose CameraNavigation::X_WV_now(const PairRanger& ranger) const {
  Pose X_WB = fix_->X_WB;
  X_WB.translation.head<2>() = x_.head<2>();
  const Pose X_WF = X_WB * ranger.X_BV();
  return {X_WF.rotation * Rotation::from_matrix(body_axes()), X_WF.translation};
}

void CameraNavigation::take_key(const PairRanger& ranger) {
  MotionKey key(grey_of(ranger.left()), ranger.map(), ranger.geometry(), config_.motion);
  if (static_cast<int>(key.points().size()) < config_.motion.min_inliers) return;
  anchor_variance_ = variance();
  P_.topRows<2>().setZero();
  P_.leftCols<2>().setZero();
  X_WK_ = X_WV_now(ranger);
  key_ = std::move(key);
  ++counts_.keys;
}

/// Returns whether the key is still of use.
bool CameraNavigation::compare(const PairRanger& ranger) {
  ++counts_.pairs;
  const Pose X_WV = X_WV_now(ranger);
  const MotionGuess guess{X_WK_.inverse() * X_WV, config_.rotation_sigma.radians()};
  const auto motion = pair_motion(*key_, grey_of(ranger.left()), ranger.map(), ranger.geometry(),
                                  ranger.config().matching.sigma_disparity, guess, config_.motion);
  if (!motion) return false;
  ++counts_.moved;
  const Vector3d step_W = X_WK_ * motion->X_KN.translation - X_WV.translation;
  const Eigen::Matrix3d R_WK = X_WK_.rotation.matrix();
  const Eigen::Matrix2d noise =
      (R_WK * motion->covariance.topLeftCorner<3, 3>() * R_WK.transpose()).topLeftCorner<2, 2>() +
      kLeastVariance * Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 4, 2> gain = P_.leftCols<2>() * (P_.topLeftCorner<2, 2>() + noise).inverse();
  x_ += gain * step_W.head<2>();
  P_ = (P_ - gain * P_.topRows<2>()).eval();
  P_ = (0.5 * (P_ + P_.transpose())).eval();
  const double seen = static_cast<double>(motion->inliers) / static_cast<double>(key_->points().size());
  return seen >= config_.min_seen_share && motion->X_KN.translation.norm() < kFarFromKey * key_->median_range_m();
}

void CameraNavigation::on_pair(const PairRanger& ranger, Time time) {
  if (!config_.on || !fix_ || time - fix_->time > kFreshFix || fix_->time - time > kFreshFix) return;
  predict(time);
  if (!key_ || !compare(ranger)) take_key(ranger);
}

}  // namespace isobath
