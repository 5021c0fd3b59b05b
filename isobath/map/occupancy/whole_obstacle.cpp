#include <algorithm>
#include <isobath/map/occupancy/whole_obstacle.hpp>

namespace isobath {
namespace {

double extent_of(std::span<const Obstacle> pieces, int number) {
  std::vector<Eigen::Vector2d> corners;
  for (const Obstacle& o : pieces) {
    if (o.number == number) corners.insert(corners.end(), o.outline.begin(), o.outline.end());
  }
  const Polygon hull = convex_hull(std::move(corners));
  double extent = 0;
  for (const Eigen::Vector2d& a : hull) {
    for (const Eigen::Vector2d& b : hull) extent = std::max(extent, (a - b).norm());
  }
  return extent;
}

}  // namespace

std::vector<WholeObstacle> whole_obstacles(std::span<const Obstacle> pieces) {
  std::vector<WholeObstacle> all;
  for (const Obstacle& o : pieces) {
    auto whole = std::find_if(all.begin(), all.end(), [&](const WholeObstacle& w) { return w.number == o.number; });
    if (whole == all.end()) {
      all.push_back({.number = o.number, .nearest = &o, .behind = true, .possible_multiple = true});
      whole = all.end() - 1;
      whole->extent_m = extent_of(pieces, o.number);
    }
    ++whole->pieces;
    if (o.range_m < whole->nearest->range_m) whole->nearest = &o;
    whole->existence = std::max(whole->existence, o.existence);
    whole->hits += o.hits;
    whole->behind = whole->behind && o.behind;
    whole->possible_multiple = whole->possible_multiple && o.possible_multiple;
  }
  std::sort(all.begin(), all.end(), [](const WholeObstacle& a, const WholeObstacle& b) { return a.number < b.number; });
  return all;
}

}  // namespace isobath
