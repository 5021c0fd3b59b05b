#include <algorithm>
#include <Eigen/SVD>
#include <isobath/base/error.hpp>
#include <isobath/geometry/pose.hpp>

namespace isobath {

Rotation Rotation::from_heading_pitch_roll(Angle heading, Angle pitch, Angle roll) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return Rotation(AngleAxisd(heading.radians(), Vector3d::UnitZ()) * AngleAxisd(pitch.radians(), Vector3d::UnitY()) *
                  AngleAxisd(roll.radians(), Vector3d::UnitX()));
}

bool Rotation::valid(const Eigen::Matrix3d& m) {
  return m.allFinite() && (m.transpose() * m - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 2e-3 &&
         m.determinant() > 0;
}

Rotation Rotation::from_matrix(const Eigen::Matrix3d& matrix) {
  ISOBATH_ASSERT(valid(matrix));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Rotation(Eigen::Quaterniond(svd.matrixU() * svd.matrixV().transpose()).normalized());
}

Rotation Rotation::from_quaternion(const Eigen::Quaterniond& q) {
  ISOBATH_ASSERT(q.norm() > 1e-6);
  return Rotation(q.normalized());
}

Rotation Rotation::exp(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const double half = angle / 2;
  const double scale = angle < 1e-8 ? 0.5 - angle * angle / 48 : std::sin(half) / angle;
  return Rotation(Eigen::Quaterniond(std::cos(half), scale * w.x(), scale * w.y(), scale * w.z()).normalized());
}

Eigen::Vector3d Rotation::log() const {
  const double sign = q_.w() < 0 ? -1 : 1;  // q and -q are the same rotation: take the shorter one
  const double sine = q_.vec().norm();
  const double angle = 2 * std::atan2(sine, sign * q_.w());
  const double scale = sine < 1e-9 ? 2 : angle / sine;
  return sign * scale * q_.vec();
}

Angle Rotation::heading() const {
  const Eigen::Matrix3d m = matrix();
  return Angle::radians(std::atan2(m(1, 0), m(0, 0)));
}
Angle Rotation::pitch() const { return Angle::radians(std::asin(std::clamp(-matrix()(2, 0), -1.0, 1.0))); }
Angle Rotation::roll() const {
  const Eigen::Matrix3d m = matrix();
  return Angle::radians(std::atan2(m(2, 1), m(2, 2)));
}

Rotation Rotation::operator*(const Rotation& other) const { return Rotation((q_ * other.q_).normalized()); }

Pose Pose::inverse() const {
  const Rotation r = rotation.inverse();
  return {r, -(r * translation)};
}
Pose Pose::operator*(const Pose& other) const {
  return {rotation * other.rotation, rotation * other.translation + translation};
}
bool Pose::is_finite() const { return translation.allFinite() && rotation.quaternion().coeffs().allFinite(); }

Pose level(const Pose& X_WB) { return {Rotation::from_heading(X_WB.rotation.heading()), X_WB.translation}; }

Pose interpolate(const Pose& a, const Pose& b, double share) {
  const Eigen::Vector3d turn = (a.rotation.inverse() * b.rotation).log();
  return {a.rotation * Rotation::exp(share * turn), a.translation + share * (b.translation - a.translation)};
}

}  // namespace isobath
