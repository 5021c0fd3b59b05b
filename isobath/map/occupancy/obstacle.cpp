#include <isobath/map/occupancy/obstacle.hpp>

namespace isobath {

Polygon world_outline(const Obstacle& obstacle, const Pose& X_WB) {
  const Pose X_WL = level(X_WB);
  Polygon outline_W;
  outline_W.reserve(obstacle.outline.size());
  for (const Eigen::Vector2d& p : obstacle.outline) {
    outline_W.emplace_back((X_WL * Eigen::Vector3d(p.x(), p.y(), 0)).head<2>());
  }
  return outline_W;
}

}  // namespace isobath
