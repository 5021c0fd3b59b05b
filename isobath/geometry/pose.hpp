// Rotation and Pose: rotations SO(3) and poses SE(3), in monogram notation.
//
// R_WB turns components in B into components in W: v_W = R_WB v_B. X_WB is the pose of B in W: p_W = X_WB p_B. Poses
// chain where the inner letters agree: X_WS = X_WB X_BS. World W is north-east-down, body B forward-starboard-down
// (ledger: Frames). Angles follow R_WB = Rz(psi) Ry(theta) Rx(phi): heading psi clockwise from north, pitch theta nose
// up, roll phi starboard down. Accuracy: exp and log are inverse to 1e-14 rad up to a rotation of pi.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <isobath/base/angle.hpp>

namespace isobath {

class Rotation {
 public:
  Rotation() = default;
  static Rotation from_heading_pitch_roll(Angle heading, Angle pitch, Angle roll);
  /// A rotation about the down axis: a turn to starboard.
  static Rotation from_heading(Angle heading) { return from_heading_pitch_roll(heading, {}, {}); }
  /// From any matrix within 1e-3 of a rotation (text files round their entries); keeps the nearest rotation. `valid`
  /// tells whether a matrix is that close.
  static Rotation from_matrix(const Eigen::Matrix3d& matrix);
  static bool valid(const Eigen::Matrix3d& matrix);
  static Rotation from_quaternion(const Eigen::Quaterniond& q);
  /// Keeps q bit for bit, for logs that must read back exactly as written. The caller guarantees |q| = 1.
  static Rotation from_unit_quaternion(const Eigen::Quaterniond& q) { return Rotation(q); }
  /// The rotation by |w| about w (radians).
  static Rotation exp(const Eigen::Vector3d& w);

  /// Rotation vector, |w| <= pi.
  [[nodiscard]] Eigen::Vector3d log() const;
  [[nodiscard]] Eigen::Matrix3d matrix() const { return q_.toRotationMatrix(); }
  [[nodiscard]] const Eigen::Quaterniond& quaternion() const { return q_; }
  [[nodiscard]] Angle heading() const;
  [[nodiscard]] Angle pitch() const;
  [[nodiscard]] Angle roll() const;
  [[nodiscard]] Rotation inverse() const { return Rotation(q_.conjugate()); }

  Rotation operator*(const Rotation& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& v) const { return q_ * v; }

 private:
  explicit Rotation(const Eigen::Quaterniond& q) : q_(q) {}
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
};

struct Pose {
  Rotation rotation;                                      ///< R_XY of X_XY
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< p_XY: origin of Y in X, m

  [[nodiscard]] Pose inverse() const;
  Pose operator*(const Pose& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + translation; }
  [[nodiscard]] bool is_finite() const;
};

/// X_WL of X_WB: the same position and heading with roll and pitch removed (frame L of the ledger).
Pose level(const Pose& X_WB);

/// From a (share 0) to b (share 1): translation on the straight line, rotation on the shortest arc.
Pose interpolate(const Pose& a, const Pose& b, double share);

}  // namespace isobath
