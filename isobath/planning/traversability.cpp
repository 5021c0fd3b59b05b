#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/planning/traversability.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

double weight_of(const DepthPixel& p) { return p.known() ? (1.0 + p.confidence()) / (1.0 + kFullConfidence) : 1.0; }

/// The charted obstacles within the half-width of the path; whether they reach up to the vehicle is checked pixel by
/// pixel.
std::vector<std::size_t> near_obstacles(std::span<const Eigen::Vector3d> path, std::span<const ChartObstacle> chart,
                                        double half_width) {
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < chart.size(); ++k) {
    for (std::size_t i = 0; i < std::max<std::size_t>(1, path.size() - 1); ++i) {
      const Vector2d from = path[i].head<2>(), to = path[std::min(i + 1, path.size() - 1)].head<2>();
      if (!within_reach_of_segment(from, to, chart[k].a, chart[k].b, chart[k].radius_m + half_width)) continue;
      near.push_back(k);
      break;
    }
  }
  return near;
}

bool covers(const ChartObstacle& o, const PixelGrid& grid, Pixel p) {
  const Vector2d half = Vector2d::Constant(grid.pixel_m / 2);
  return within_reach_of_box(o.a, o.b, grid.centre(p) - half, grid.centre(p) + half, o.radius_m).has_value();
}

/// Splits the pixels of each row into runs without gaps, so that a map is read in contiguous pieces.
template <class Act>
void for_each_run(const std::vector<SweptPixel>& swept, const Act& act) {
  for (std::size_t first = 0; first < swept.size();) {
    std::size_t end = first + 1;
    while (end < swept.size() && swept[end].pixel.row == swept[first].pixel.row &&
           swept[end].pixel.column == swept[end - 1].pixel.column + 1) {
      ++end;
    }
    act(first, end);
    first = end;
  }
}

struct Judge {
  const PassageConfig& passage;
  std::span<const ChartObstacle> chart;
  std::vector<std::size_t> near;
  Traversability& out;
  double clear_weight = 0;
  double weight = 0;

  void look(const SweptPixel& swept, const DepthPixel& pixel) {
    PassagePlace place;
    place.pixel = swept.pixel;
    place.leg = swept.leg;
    place.along_m = swept.along_m;
    place.vehicle_z = swept.vehicle_z;
    if (pixel.known()) place.depth_m = pixel.depth_m();
    place.confidence = pixel.confidence();
    for (const std::size_t k : near) {
      if (chart[k].top_m - swept.vehicle_z >= passage.clearance_m || !covers(chart[k], out.grid, swept.pixel)) continue;
      place.obstacle = k;
      break;
    }
    const bool deep = place.depth_m && *place.depth_m - swept.vehicle_z >= passage.clearance_m;
    const bool sure = pixel.confidence() >= passage.min_confidence;
    const bool clear = deep && sure && !place.obstacle;
    out.clear += clear;
    out.unsure += deep && !sure && !place.obstacle;
    out.unknown += !pixel.known();
    weight += weight_of(pixel);
    if (clear) clear_weight += weight_of(pixel);
    const auto keep_first = [&](std::optional<PassagePlace>& first) {
      if (!first || swept.along_m < first->along_m) first = place;
    };
    if (!clear) keep_first(out.blocking);
    if (!clear && (pixel.known() || place.obstacle)) keep_first(out.known_blocking);
    if (place.depth_m &&
        (!out.worst || *place.depth_m - place.vehicle_z < *out.worst->depth_m - out.worst->vehicle_z)) {
      out.worst = place;
    }
  }
};

std::string place_text(const PixelGrid& grid, Pixel p) {
  const Vector2d centre = grid.centre(p);
  return fmt::format("north {:.2f} m, east {:.2f} m", centre.x(), centre.y());
}

}  // namespace

std::vector<Field> fields(PassageConfig& c) {
  return {
      Field::real("half_width_m", &c.half_width_m, {0, 1000}, "m", "Half of the width that must be free."),
      Field::real("clearance_m", &c.clearance_m, {0, 1000}, "m", "Water required below the vehicle."),
      Field::integer("min_confidence", &c.min_confidence, {0, 20}, "",
                     "Least confidence of a depth that counts as water, 0 to 20."),
  };
}

std::string Traversability::reason() const {
  if (!blocking) {
    const double spare = worst ? *worst->depth_m - worst->vehicle_z - passage.clearance_m : 0;
    return fmt::format("clear: {} pixels, {:.2f} m to spare at {}", pixels, spare,
                       worst ? place_text(grid, worst->pixel) : "");
  }
  return fmt::format("leg {}: {}", blocking->leg + 1, reason_of(*blocking));
}

std::string Traversability::reason_of(const PassagePlace& at) const {
  const std::string place = place_text(grid, at.pixel);
  if (at.obstacle) return fmt::format("obstacle {} of the chart at {}", *at.obstacle, place);
  if (!at.depth_m) return fmt::format("unknown depth at {}", place);
  if (*at.depth_m - at.vehicle_z >= passage.clearance_m) {
    return fmt::format("a depth of {:.2f} m at {} that no measurement is sure of (confidence {} of {}, {} needed)",
                       *at.depth_m, place, at.confidence, kFullConfidence, passage.min_confidence);
  }
  return fmt::format("{:.2f} m of water at {}; {:.2f} m draught and {:.2f} m clearance needed", *at.depth_m, place,
                     at.vehicle_z, passage.clearance_m);
}

Result<Traversability, CorridorRefusal> traversability(const DepthField& map, std::span<const Eigen::Vector3d> path,
                                                       const PassageConfig& passage,
                                                       std::span<const ChartObstacle> chart) {
  const auto swept = sweep(map.grid(), path, passage.half_width_m);
  if (!swept) return tl::unexpected(swept.error());
  Traversability out;
  out.map_version = map.version();
  out.grid = map.grid();
  out.passage = passage;
  out.pixels = swept->size();
  Judge judge{passage, chart, near_obstacles(path, chart, passage.half_width_m), out};
  std::vector<DepthPixel> row;
  for_each_run(*swept, [&](std::size_t first, std::size_t end) {
    row.resize(end - first);
    const Pixel west = (*swept)[first].pixel;
    map.read({west.column, west.row, static_cast<std::int32_t>(end - first), 1}, row);
    for (std::size_t i = first; i < end; ++i) judge.look((*swept)[i], row[i - first]);
  });
  out.fraction = static_cast<double>(out.clear) / static_cast<double>(out.pixels);
  out.weighted = judge.clear_weight / judge.weight;
  return out;
}

}  // namespace isobath
