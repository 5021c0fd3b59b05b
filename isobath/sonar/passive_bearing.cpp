#include <cmath>
#include <Eigen/Core>
#include <isobath/sonar/passive_bearing.hpp>

namespace isobath {

std::optional<Angle> bearing_in_world(const PassiveBearing& heard, const Pose& X_WS) {
  constexpr double kVertical = 1e-6;
  const Eigen::Vector3d flat_W = X_WS.rotation * Eigen::Vector3d(cos(heard.bearing), sin(heard.bearing), 0);
  const Eigen::Vector3d down_W = X_WS.rotation * Eigen::Vector3d::UnitZ();
  Eigen::Vector3d u_W;
  if (heard.elevation) {
    u_W = cos(*heard.elevation) * flat_W - sin(*heard.elevation) * down_W;
  } else {
    if (std::abs(down_W.z()) < kVertical) return std::nullopt;
    u_W = flat_W - flat_W.z() / down_W.z() * down_W;  // level, in the half plane of this bearing
  }
  if (u_W.head<2>().norm() < kVertical) return std::nullopt;
  return Angle::radians(std::atan2(u_W.y(), u_W.x())).wrapped_positive();
}

}  // namespace isobath
