#include <algorithm>
#include <cmath>
#include <isobath/map/depth/fill_polygons.hpp>

namespace isobath {

using Eigen::Vector2d;

void fill_polygons(const std::vector<Polygon>& rings, const PixelGrid& grid, const PixelWindow& window,
                   const std::function<void(Pixel)>& visit) {
  double north = -1e300, south = 1e300;
  for (const Polygon& ring : rings) {
    for (const Vector2d& p : ring) {
      north = std::max(north, p.x());
      south = std::min(south, p.x());
    }
  }
  const auto within = [](double at, std::int32_t first, std::int32_t count) {
    return static_cast<std::int32_t>(std::clamp(std::ceil(at - 0.5), 1.0 * first, 1.0 * first + count));
  };
  const auto row_of = [&](double at) {  // the first row whose centre is not north of `at`
    return within((grid.corner_m.x() - at) / grid.pixel_m, window.row, window.height);
  };
  const auto column_of = [&](double at) {
    return within((at - grid.corner_m.y()) / grid.pixel_m, window.column, window.width);
  };
  std::vector<double> crossings;
  for (std::int32_t row = row_of(north), end = row_of(south); row < end; ++row) {
    const double x = grid.centre({0, row}).x();
    crossings.clear();
    for (const Polygon& ring : rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
        if ((a.x() <= x) == (b.x() <= x)) continue;
        crossings.push_back(a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y()));
      }
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      for (std::int32_t c = column_of(crossings[i]), last = column_of(crossings[i + 1]); c < last; ++c) visit({c, row});
    }
  }
}

}  // namespace isobath
