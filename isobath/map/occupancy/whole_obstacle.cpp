#include <algorithm>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <map>
#include <utility>

namespace isobath {

double extent_of(std::span<const Polygon> outlines) {
  std::vector<Eigen::Vector2d> corners;
  for (const Polygon& outline : outlines) corners.insert(corners.end(), outline.begin(), outline.end());
  const Polygon hull = convex_hull(std::move(corners));
  double extent = 0;
  for (const Eigen::Vector2d& a : hull) {
    for (const Eigen::Vector2d& b : hull) extent = std::max(extent, (a - b).norm());
  }
  return extent;
}

std::vector<WholeObstacle> whole_obstacles(std::span<const Obstacle> pieces) {
  std::vector<WholeObstacle> all;
  std::map<int, std::vector<Polygon>> outlines;  // by number
  for (const Obstacle& o : pieces) {
    auto whole = std::find_if(all.begin(), all.end(), [&](const WholeObstacle& w) { return w.number == o.number; });
    if (whole == all.end()) {
      all.push_back({.number = o.number, .nearest = &o, .behind = true, .possible_multiple = true});
      whole = all.end() - 1;
    }
    outlines[o.number].push_back(o.outline);
    ++whole->pieces;
    if (o.range_m < whole->nearest->range_m) whole->nearest = &o;
    whole->existence = std::max(whole->existence, o.existence);
    whole->hits += o.hits;
    whole->behind = whole->behind && o.behind;
    whole->possible_multiple = whole->possible_multiple && o.possible_multiple;
  }
  for (WholeObstacle& whole : all) whole.extent_m = extent_of(outlines[whole.number]);
  std::sort(all.begin(), all.end(), [](const WholeObstacle& a, const WholeObstacle& b) {
    return std::pair(a.nearest->range_m, a.number) < std::pair(b.nearest->range_m, b.number);
  });
  return all;
}

}  // namespace isobath
