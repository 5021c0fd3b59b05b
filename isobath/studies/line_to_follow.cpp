#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/base/error.hpp>
#include <isobath/base/lower_case.hpp>
#include <isobath/geometry/contours.hpp>
#include <isobath/io/charts/drawn_lines.hpp>
#include <isobath/planning/feature_course.hpp>
#include <isobath/studies/line_to_follow.hpp>
#include <isobath/world/map_raster.hpp>
#include <set>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Line = std::vector<Vector2d>;

constexpr double kMaxCells = 1 << 24;

[[noreturn]] void refuse_feature(const MapFeatures& features, const std::string& wanted) {
  std::set<std::string> known;
  for (const MapFeatures::Line& line : features.lines) {
    known.insert(line.kind);
    if (!line.name.empty() && known.size() < 12) known.insert(line.name);
  }
  throw Error(fmt::format("the map has no line \"{}\"", wanted), {}, {},
              known.empty() ? "it has no lines at all; --contour follows a depth"
                            : fmt::format("it has: {}", fmt::join(known, ", ")));
}

/// The pieces of the nearest line of this kind or name.
std::vector<Line> pieces_of(const MapFeatures& features, const std::string& wanted, const Vector2d& start) {
  const MapFeatures::Line* nearest = nullptr;
  const std::string name = to_lower_case(wanted);
  if (name == "nearest") {
    if (const auto found = features.segments.nearest(start)) nearest = &features.lines[found->id >> 32U];
  } else {
    double least = INFINITY;
    for (const MapFeatures::Line& line : features.lines) {
      if (line.points.size() < 2 || (to_lower_case(line.kind) != name && to_lower_case(line.name) != name)) continue;
      const double away = distance_from_line(line.points, start);
      if (away >= least) continue;
      least = away;
      nearest = &line;
    }
  }
  if (nearest == nullptr) refuse_feature(features, wanted);
  std::vector<Line> pieces;
  for (const MapFeatures::Line& line : features.lines) {
    const bool same = line.kind == nearest->kind && line.name == nearest->name && line.depth_m == nearest->depth_m;
    if (same) pieces.push_back(line.points);
  }
  return pieces;
}

std::vector<Line> drawn_lines(const std::filesystem::path& file, const std::optional<GeoOrigin>& origin) {
  if (!origin) throw Error("the map has no geographic origin, so no file can be placed on it", {file.string()});
  return read_drawn_lines(file, LocalPlane(*origin));
}

Line contour_line(const DepthSnapshot& depths, const LineWanted& wanted, const Vector2d& start, const Vector2d& end) {
  const PixelWindow known = known_extent(depths.trees());
  const double pixel_m = depths.grid().pixel_m;
  const double least = std::sqrt(std::max(1.0, static_cast<double>(known.width) * known.height / kMaxCells));
  const double wide = std::clamp(wanted.cell_m / pixel_m, std::ceil(least), 1e4);
  const MapRaster raster = read_raster(depths, known, static_cast<int>(std::lround(wide)));
  const double cell = raster.grid.pixel_m;
  const GridFrame frame{raster.window.width,
                        raster.window.height,
                        raster.grid.centre({raster.window.column, raster.window.row}),
                        {0, cell},
                        {-cell, 0}};
  std::optional<Line> best;
  double nearest = INFINITY;
  for (ContourLine& contour : contour_lines(frame, raster.depth_m, std::vector{*wanted.contour_m})) {
    if (contour.closed) contour.points.push_back(contour.points.front());
    if (static_cast<double>(contour.points.size()) < 10) continue;  // a point lies on each edge of a cell
    const double away = distance_from_line(contour.points, start) + distance_from_line(contour.points, end);
    if (away >= nearest) continue;
    nearest = away;
    best = std::move(contour.points);
  }
  if (!best) {
    throw Error(fmt::format("the map has no contour of {} m", *wanted.contour_m), {}, {},
                "a depth that it holds, with known water on both sides");
  }
  return *best;
}

}  // namespace

std::vector<Vector2d> line_to_follow(const DepthSnapshot& depths, const MapFeatures& features, const LineWanted& wanted,
                                     const std::optional<GeoOrigin>& origin, const Vector2d& start,
                                     const std::optional<Vector2d>& end) {
  if (!wanted.contour_m) {
    const auto pieces =
        wanted.file.empty() ? pieces_of(features, wanted.feature, start) : drawn_lines(wanted.file, origin);
    return part_of_line(chain_lines(pieces, start, depths.grid().pixel_m), start, end);
  }
  const Line contour = contour_line(depths, wanted, start, end.value_or(start));
  return simplified(part_of_line(contour, start, end), wanted.cell_m / 2);
}

}  // namespace isobath
