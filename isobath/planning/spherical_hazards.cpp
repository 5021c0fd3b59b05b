#include <cmath>
#include <isobath/planning/spherical_hazards.hpp>

namespace isobath {

std::vector<Hazard> hazards_of(const SphericalGrid& grid, double half_height_m) {
  std::vector<Hazard> hazards;
  // distance that the vehicle may have gone since cells were filled
  const double stale_m = grid.config().rebin_at * grid.config().min_layer_m;
  grid.cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
    const Angle first = grid.buckets().azimuth_edge(d.azimuth) + grid.remainder();
    const Angle second = first + grid.buckets().step();
    const double level = grid.buckets().cos_elevation(d.elevation);
    for (const SphericalCell& cell : beam) {
      if (!grid.is_obstacle(cell)) continue;
      const double half_cell = grid.layers().thickness(cell.layer) / 2;
      if (std::abs(grid.point_of(cell).z()) > half_height_m + half_cell) continue;
      const double near = level * grid.layers().inner(cell.layer);
      const double far = level * grid.layers().outer(cell.layer) / cos(grid.buckets().step() / 2);  // outside its arc
      const auto corner = [](double radius, Angle azimuth) {
        return Eigen::Vector2d(radius * sin(azimuth), radius * cos(azimuth));
      };
      Hazard hazard;
      hazard.outline = {corner(near, first), corner(near, second), corner(far, second), corner(far, first)};
      hazard.margin_m = stale_m;
      hazards.push_back(std::move(hazard));
    }
  });
  return hazards;
}

}  // namespace isobath
