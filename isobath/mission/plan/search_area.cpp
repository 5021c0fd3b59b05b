#include <algorithm>
#include <cmath>
#include <isobath/mission/plan/search_area.hpp>
#include <utility>

namespace isobath {

namespace {

/// The smallest number of equal parts that are not longer than this.
std::size_t parts_of(double length_m, double longest_m) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(length_m / longest_m - 1e-9)));
}

}  // namespace

std::size_t SearchArea::lanes() const { return parts_of(breadth_m, spacing_m); }
std::size_t SearchArea::stations() const { return parts_of(length_m, station_m) + (run_out_m > 0 ? 3 : 1); }

double SearchArea::share_of_station(std::size_t station) const {
  const std::size_t last = stations() - 1, inner = parts_of(length_m, station_m);
  if (station == 0 || station >= last) return station == 0 ? 0 : 1;
  const std::size_t before = run_out_m > 0 ? 1 : 0;
  const double along_m = run_out_m + length_m * static_cast<double>(station - before) / static_cast<double>(inner);
  return along_m / (length_m + 2 * run_out_m);
}

std::vector<Lane> lanes_of(const SearchArea& area) {
  std::vector<Lane> lanes;
  if (!area.on()) return lanes;
  const Eigen::Vector2d ahead(cos(area.heading), sin(area.heading)), aside(-ahead.y(), ahead.x());
  for (std::size_t k = 0; k < area.lanes(); ++k) {
    const Eigen::Vector2d from =
        area.corner + (static_cast<double>(k) + 0.5) * area.lane_breadth_m() * aside - area.run_out_m * ahead;
    lanes.push_back({from, from + (area.length_m + 2 * area.run_out_m) * ahead});
    if (k % 2 == 1) std::swap(lanes.back().from_W, lanes.back().to_W);
  }
  return lanes;
}

}  // namespace isobath
