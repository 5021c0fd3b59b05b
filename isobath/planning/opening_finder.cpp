#include <algorithm>
#include <cmath>
#include <isobath/planning/opening_finder.hpp>
#include <map>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kColumns = 20;           // m of the way
constexpr std::size_t kLeastColumns = 5;  // that must be measured

/// x along the way, y to starboard of it.
struct Body {
  int number = 0;
  Eigen::AlignedBox2d box;
};

std::vector<Body> bodies_beside(std::span<const Hazard> hazards, const Vector2d& from, const Vector2d& along,
                                const OpeningSearch& search) {
  const Vector2d aside(-along.y(), along.x());
  std::map<int, Body> numbered;
  std::vector<Body> bodies;
  for (const Hazard& hazard : hazards) {
    Body single;
    Body& body = hazard.obstacle > 0 ? numbered[hazard.obstacle] : single;
    body.number = hazard.obstacle;
    for (const Vector2d& p : hazard.outline) {
      body.box.extend(Vector2d((p - from).dot(along), (p - from).dot(aside)));
    }
    if (hazard.obstacle == 0) bodies.push_back(std::move(single));
  }
  for (auto& [number, body] : numbered) bodies.push_back(std::move(body));
  std::erase_if(bodies, [&](const Body& b) {
    return b.box.isEmpty() || b.box.sizes().maxCoeff() > search.max_side_m || b.box.min().x() <= 0 ||
           b.box.min().x() > search.farthest_m;
  });
  return bodies;
}

struct Gap {
  Vector2d port, starboard;
  [[nodiscard]] double width() const { return starboard.y() - port.y(); }
  [[nodiscard]] double ahead() const { return 0.5 * (port.x() + starboard.x()); }
};

/// The echoes of a body spread along the line of sight: its middle says how far it is.
Gap gap_of(const Body& port, const Body& starboard) {
  return {{port.box.center().x(), port.box.max().y()}, {starboard.box.center().x(), starboard.box.min().y()}};
}

/// How far the water of a column was measured to be clear from `depth_m` on, downwards (+1) or upwards (-1). Empty
/// where not even that depth was measured.
std::optional<double> clear_to(const OccupancySnapshot& map, const Vector2d& at, double depth_m, int step) {
  const VoxelIndex v = floor_of(Vector3d(at.x(), at.y(), depth_m) / map.voxel_m());
  const auto column = map.column(v.x(), v.y());
  const int first = v.z() - map.least().z(), size = static_cast<int>(column.size());
  int z = first;
  while (z >= 0 && z < size && column[static_cast<std::size_t>(z)] == SpaceCell::kMeasured) z += step;
  if (z == first) return {};
  return (map.least().z() + z + (step > 0 ? 0 : 1)) * map.voxel_m();
}

std::optional<double> median(std::vector<double> values) {
  if (values.size() < kLeastColumns) return {};
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// From the measured water nearest to the opening on the way there: a grazing beam hears the bed of a far one late.
void measure_height(FoundOpening& found, const Vector2d& from, const OpeningSearch& search,
                    const OccupancySnapshot& map) {
  const Vector2d middle = found.opening.X_WO.translation.head<2>();
  const double way_m = (middle - from).norm(), step_m = map.voxel_m();
  std::vector<double> beds, ceilings;
  for (double back_m = 0; back_m < way_m && static_cast<double>(beds.size()) * step_m < kColumns; back_m += step_m) {
    const Vector2d at = middle + (from - middle) * (back_m / way_m);
    if (const auto bed = clear_to(map, at, search.depth_m, 1)) beds.push_back(*bed);
    if (const auto top = clear_to(map, at, search.depth_m, -1)) ceilings.push_back(-*top);
  }
  const auto bed = median(std::move(beds)), ceiling = median(std::move(ceilings));
  found.bed_known = bed.has_value();
  found.bed_m = bed.value_or(search.depth_m + 0.5 * search.least_height_m);
  found.top_m = std::max(0.0, ceiling ? -*ceiling : search.depth_m - 0.5 * search.least_height_m);
  found.opening.height_m = 2 * std::max(0.0, std::min(search.depth_m - found.top_m, found.bed_m - search.depth_m));
}

}  // namespace

std::optional<FoundOpening> find_opening(std::span<const Hazard> hazards, const Vector2d& from, const Vector2d& to,
                                         const OpeningSearch& search, const OccupancySnapshot& map) {
  if (!((to - from).norm() > 0)) return {};
  const Vector2d along = (to - from).normalized(), aside(-along.y(), along.x());
  const std::vector<Body> bodies = bodies_beside(hazards, from, along, search);
  std::optional<Gap> nearest;
  const Body *port = nullptr, *starboard = nullptr;
  for (const Body& p : bodies) {
    if (p.box.max().y() >= 0) continue;
    for (const Body& s : bodies) {
      if (s.box.min().y() <= 0) continue;
      const Gap gap = gap_of(p, s);
      if (gap.width() < search.min_width_m || gap.width() > search.max_width_m) continue;
      if (std::abs(gap.starboard.x() - gap.port.x()) > 0.5 * gap.width() || gap.ahead() > (to - from).norm()) continue;
      // Two pairs of one row of pylons are as far as each other; the narrow one is the opening.
      const double farther = nearest ? gap.ahead() - nearest->ahead() : -INFINITY;
      const double apart = nearest ? 0.5 * std::min(gap.width(), nearest->width()) : 0;
      if (farther > apart || (farther > -apart && gap.width() >= nearest->width())) continue;
      nearest = gap;
      port = &p;
      starboard = &s;
    }
  }
  if (!nearest) return {};
  const auto to_world = [&](const Vector2d& place) -> Vector2d { return from + place.x() * along + place.y() * aside; };
  FoundOpening found;
  found.port = to_world(nearest->port);
  found.starboard = to_world(nearest->starboard);
  found.port_number = port->number;
  found.starboard_number = starboard->number;
  const Vector2d across = found.starboard - found.port;
  // Across points to starboard of the passage: a quarter turn clockwise of it.
  const Angle heading = Angle::radians(std::atan2(-across.x(), across.y()));
  found.opening.width_m = across.norm();
  found.opening.X_WO.rotation = Rotation::from_heading(heading);
  found.opening.X_WO.translation << 0.5 * (found.port + found.starboard), search.depth_m;
  measure_height(found, from, search, map);
  return found;
}

double free_share(const FoundOpening& found, double margin_m, const OccupancySnapshot& map) {
  const double voxel_m = map.voxel_m(), top_m = found.top_m + margin_m;
  const double width_m = found.opening.width_m - 2 * margin_m, height_m = found.bed_m - margin_m - top_m;
  if (!(width_m > 0 && height_m > 0)) return 0;
  const int columns = static_cast<int>(std::ceil(width_m / voxel_m)),
            rows = static_cast<int>(std::ceil(height_m / voxel_m));
  const Vector2d aside = (found.starboard - found.port) / found.opening.width_m;
  int free = 0;
  for (int i = 0; i < columns; ++i) {
    const Vector2d at = found.port + (margin_m + (i + 0.5) / columns * width_m) * aside;
    for (int k = 0; k < rows; ++k) {
      free += map.is_measured({at.x(), at.y(), top_m + (k + 0.5) / rows * height_m}, 0);
    }
  }
  return static_cast<double>(free) / (static_cast<double>(columns) * rows);
}

}  // namespace isobath
