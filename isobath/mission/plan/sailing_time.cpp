#include <isobath/mission/plan/sailing_time.hpp>

namespace isobath {

double sailing_time_s(std::span<const MissionPoint> points, std::span<const std::size_t> order,
                      std::optional<Eigen::Vector2d> from, double speed) {
  double time_s = 0;
  for (const std::size_t i : order) {
    if (i >= points.size()) continue;
    const MissionPoint& point = points[i];
    if (from) time_s += (point.north_east - *from).norm() / (point.speed > 0 ? point.speed : speed);
    time_s += point.hold_s;
    from = point.north_east;
  }
  return time_s;
}

}  // namespace isobath
