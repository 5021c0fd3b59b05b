// PlanFrame: the level frame of one instant in the plane, in which ways are planned (Ganesan 2015, equations 5.1 to 5.3,
// corrected; ledger S6-45, S6-46). x forward, y to starboard, m; way there and back go by the same pose, so that its
// error cancels.
#pragma once

#include <isobath/geometry/polygon.hpp>
#include <isobath/geometry/pose.hpp>

namespace isobath {

class PlanFrame {
 public:
  PlanFrame() = default;
  explicit PlanFrame(const Pose& X_WL)
      : origin_(X_WL.translation.head<2>()), psi_(X_WL.rotation.heading()), cos_(cos(psi_)), sin_(sin(psi_)) {}

  /// Of a place (north, east).
  [[nodiscard]] Eigen::Vector2d to_local(const Eigen::Vector2d& p_W) const {
    const Eigen::Vector2d d = p_W - origin_;
    return {cos_ * d.x() + sin_ * d.y(), cos_ * d.y() - sin_ * d.x()};
  }
  [[nodiscard]] Eigen::Vector2d to_world(const Eigen::Vector2d& p_L) const {
    return origin_ + Eigen::Vector2d(cos_ * p_L.x() - sin_ * p_L.y(), sin_ * p_L.x() + cos_ * p_L.y());
  }
  [[nodiscard]] Polygon to_local(Polygon outline) const {
    for (Eigen::Vector2d& p : outline) p = to_local(p);
    return outline;
  }
  [[nodiscard]] Angle heading() const { return psi_; }

 private:
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  Angle psi_;
  double cos_ = 1;
  double sin_ = 0;
};

}  // namespace isobath
