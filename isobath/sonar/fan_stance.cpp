#include <cmath>
#include <isobath/sonar/fan_stance.hpp>

namespace isobath {

bool lies_flat(const Ping& ping) {
  constexpr double kStraightDown = 0.966;  // within 15 degrees: only sounders are tilted so far, no imaging sonar is
  const Eigen::Vector3d ahead = ping.X_BS.rotation * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d across = ping.X_BS.rotation * Eigen::Vector3d::UnitY();
  return std::abs(across.z()) < std::sqrt(0.5) && std::abs(ahead.z()) < kStraightDown;
}

bool looks_down(const Ping& ping) {
  const Eigen::Vector3d down = ping.X_BS.rotation.inverse() * Eigen::Vector3d::UnitZ();
  const BeamFan& fan = *ping.fan;
  const Angle aside = Angle::radians(std::atan2(down.y(), down.x()));
  return fan.beams() > 1 && std::abs(down.z()) < std::sqrt(0.5) && aside >= fan.azimuth.front() &&
         aside <= fan.azimuth.back();
}

}  // namespace isobath
