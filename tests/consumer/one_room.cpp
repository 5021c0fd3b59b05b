// A user who wants poses only.
#include <cmath>
#include <isobath/geometry/pose.hpp>

int main() {
  const isobath::Pose X_WB{isobath::Rotation::from_heading(isobath::Angle::degrees(90)), {1, 2, 3}};
  const Eigen::Vector3d p_W = X_WB * Eigen::Vector3d(10, 0, 0);  // 10 m ahead of a vehicle that heads east
  return std::abs(p_W.y() - 12) < 1e-12 ? 0 : 1;
}
