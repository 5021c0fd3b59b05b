// PlanFrame: the level frame P in which avoidance plans: its position in the world and the direction of its x axis
// (Ganesan 2015, equations 5.1 to 5.3, corrected; ledger S6-45, S6-46).
//
// World W: x north, y east. With the vehicle's position and heading, P is its level body frame L: x forward, y
// starboard, heading clockwise from north. As printed, the matrix translates by the vehicle's position where it must
// translate by -R^T of it (S6-E06), and leaves axes and bearing open (S6-E07). An error of this frame does not affect a
// path that is planned in P from obstacles in P, as long as the same frame leads there and back.
#pragma once

#include <cmath>
#include <isobath/geometry/pose.hpp>

namespace isobath {

struct PlanFrame {
  Eigen::Vector2d p_WP = Eigen::Vector2d::Zero();  ///< m
  Angle heading;                                   ///< of the x axis, from north towards east

  static PlanFrame of(const Pose& X_WP) { return {X_WP.translation.head<2>(), X_WP.rotation.heading()}; }

  [[nodiscard]] Eigen::Vector2d to_local(const Eigen::Vector2d& p_W) const {
    const double c = std::cos(heading.radians()), s = std::sin(heading.radians());
    const Eigen::Vector2d d = p_W - p_WP;
    return {c * d.x() + s * d.y(), -s * d.x() + c * d.y()};
  }
  [[nodiscard]] Eigen::Vector2d to_world(const Eigen::Vector2d& p_P) const {
    const double c = std::cos(heading.radians()), s = std::sin(heading.radians());
    return {p_WP.x() + c * p_P.x() - s * p_P.y(), p_WP.y() + s * p_P.x() + c * p_P.y()};
  }
};

}  // namespace isobath
