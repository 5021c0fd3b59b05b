#include <algorithm>
#include <cmath>
#include <isobath/links/obstacle_ring.hpp>

namespace isobath {
namespace {

constexpr std::size_t kDirections = Surroundings::kDirections;
static_assert(kDirections == mavlink::ObstacleDistance::kDirections);
constexpr double kLeastRange_m = 0.3;

std::uint16_t centimetres(double metres) {
  return static_cast<std::uint16_t>(std::clamp(std::lround(metres * 100), 0L, 65000L));
}

std::size_t direction_of(Angle angle) {
  const long i = std::lround(angle.degrees() / 5);
  return static_cast<std::size_t>((i % long{kDirections} + long{kDirections}) % long{kDirections});
}

}  // namespace

std::vector<mavlink::ObstacleDistance3d> ring_points(const mavlink::ObstacleDistance& ring) {
  std::vector<mavlink::ObstacleDistance3d> points;
  for (std::size_t i = 0; i < ring.cm.size(); ++i) {
    if (ring.cm[i] > ring.max_cm) continue;  // nothing there, or unknown
    const Angle bearing = Angle::degrees(5.0 * static_cast<double>(i));
    const double range_m = ring.cm[i] / 100.0;
    points.push_back({.x = static_cast<float>(range_m * cos(bearing)),
                      .y = static_cast<float>(range_m * sin(bearing)),
                      .min_m = ring.min_cm / 100.0F,
                      .max_m = ring.max_cm / 100.0F,
                      .number = static_cast<std::uint16_t>(i)});
  }
  return points;
}

mavlink::ObstacleDistance obstacle_ring(const Surroundings& around, const Navigation& fix, Time now) {
  mavlink::ObstacleDistance ring;
  ring.time_us =
      static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch()).count());
  ring.min_cm = centimetres(kLeastRange_m);
  ring.max_cm = centimetres(around.reach_m);
  const Angle heading = fix.X_WB.rotation.heading();
  for (std::size_t i = 0; i < kDirections; ++i) {
    const Angle from_north = heading + Angle::degrees(5.0 * static_cast<double>(i));
    ring.cm[i] = around.clear[direction_of(from_north)] ? static_cast<std::uint16_t>(ring.max_cm + 1)
                                                        : mavlink::ObstacleDistance::kUnknown;
  }
  for (const Eigen::Vector2d& hit : around.hits) {
    const Eigen::Vector2d away = hit - fix.X_WB.translation.head<2>();
    std::uint16_t& cm = ring.cm[direction_of(Angle::radians(std::atan2(away.y(), away.x())) - heading)];
    const std::uint16_t here = std::min(centimetres(away.norm()), ring.max_cm);
    const bool seen = cm <= ring.max_cm;
    cm = seen ? std::min(cm, here) : here;
  }
  return ring;
}

double nearest_m(const Surroundings& around, const Navigation& fix) {
  double nearest = around.reach_m;
  for (const Eigen::Vector2d& hit : around.hits)
    nearest = std::min(nearest, (hit - fix.X_WB.translation.head<2>()).norm());
  return nearest;
}

}  // namespace isobath
