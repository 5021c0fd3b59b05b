#include <algorithm>
#include <cmath>
#include <isobath/vehicle/current_estimate.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kNoise = 0.2;    // m/s in one second: waves, and the errors of a fix
constexpr double kSlip = 0.03;    // rad/s: at this yaw rate the hull's slip is as large as the noise
constexpr double kChange = 0.02;  // m/s in one second, of the current

}  // namespace

void CurrentEstimate::update(Angle heading, const Eigen::Vector3d& v_W, double yaw_rate, double dt) {
  if (!v_W.allFinite() || !std::isfinite(heading.radians()) || !std::isfinite(yaw_rate) || !(dt > 0)) return;
  const double held = std::min(dt, 10.0);
  covariance_W_ += kChange * kChange * held * Eigen::Matrix2d::Identity();
  const Vector2d across(-sin(heading), cos(heading));
  const double turning = yaw_rate / kSlip;
  const double noise = kNoise * kNoise * (1 + turning * turning) / held;
  const Vector2d gain = covariance_W_ * across / (across.dot(covariance_W_ * across) + noise);
  velocity_W_ += gain * (across.dot(v_W.head<2>()) - across.dot(velocity_W_));
  covariance_W_ -= gain * (across.transpose() * covariance_W_);
  covariance_W_ = (0.5 * (covariance_W_ + covariance_W_.transpose())).eval();
}

double CurrentEstimate::sigma_along(Angle heading) const {
  const Vector2d ahead(cos(heading), sin(heading));
  return std::sqrt(std::max(0.0, ahead.dot(covariance_W_ * ahead)));
}

}  // namespace isobath
