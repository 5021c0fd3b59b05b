#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/geometry/polygon_parts.hpp>
#include <limits>

namespace isobath {

Eigen::Vector2d nearest_point(std::span<const Polygon> parts, const Eigen::Vector2d& p) {
  ISOBATH_ASSERT(!parts.empty());
  Eigen::Vector2d nearest = nearest_point(parts.front(), p);
  for (const Polygon& part : parts.subspan(1)) {
    const Eigen::Vector2d q = nearest_point(part, p);
    if ((q - p).squaredNorm() < (nearest - p).squaredNorm()) nearest = q;
  }
  return nearest;
}

double distance_from(std::span<const Polygon> parts, const Eigen::Vector2d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Polygon& part : parts) least = std::min(least, distance_from(part, p));
  return least;
}

double gap_between(std::span<const Polygon> parts, const Polygon& outline) {
  double least = std::numeric_limits<double>::infinity();
  for (const Polygon& part : parts) least = std::min(least, gap_between(part, outline));
  return least;
}

}  // namespace isobath
