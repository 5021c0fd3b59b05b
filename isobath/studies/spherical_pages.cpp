#include <algorithm>
#include <cairo/cairo.h>
#include <cmath>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <isobath/studies/spherical_pages.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSidePixels = 720;
constexpr double kMinDrawn = 0.05;  // probability
constexpr Colour kNotSeen{0.87, 0.91, 0.95, 1}, kClearWater{1, 1, 1, 1}, kWalls{0.84, 0.37, 0.0, 0.55};
constexpr Colour kReference{0.0, 0.45, 0.7, 0.55};
constexpr Colour kTold{0.0, 0.25, 0.5, 1}, kAlone{0.8, 0.0, 0.5, 1}, kOpen{0.95, 0.75, 0.1, 1};

struct DrawnCell {
  SphericalPlace place;
  double probability;
};
/// In increasing order of probability, so that the most probable cells are drawn on top.
std::vector<DrawnCell> drawn_cells(const SphericalGrid& grid) {
  std::vector<DrawnCell> all;
  grid.cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      const double p = SphericalGrid::probability(cell);
      if (p >= kMinDrawn) all.push_back({{d, cell.layer}, p});
    }
  });
  std::stable_sort(all.begin(), all.end(),
                   [](const DrawnCell& a, const DrawnCell& b) { return a.probability < b.probability; });
  return all;
}

/// Corners at a radius: low left, low right, high right, high left; azimuth grows to the right.
std::array<Vector3d, 4> corners_at(const SphericalGrid& grid, const SphericalDirection& d, double radius) {
  const DirectionBuckets& buckets = grid.buckets();
  const double a0 = buckets.azimuth_edge(d.azimuth).radians() + grid.remainder().radians();
  const double a1 = a0 + buckets.step().radians();
  const double e0 = buckets.elevation_edge(d.elevation).radians(), e1 = e0 + buckets.step().radians();
  const auto at = [&](double a, double e) {
    return Vector3d(radius * std::cos(e) * std::cos(a), radius * std::cos(e) * std::sin(a), radius * std::sin(e));
  };
  return {at(a0, e0), at(a1, e0), at(a1, e1), at(a0, e1)};
}

std::vector<Vector2d> arc_outline(const SectionArc& arc) {
  std::vector<Vector2d> points;
  const int parts = std::max(8, static_cast<int>(arc.sweep.degrees() / 3));
  for (int i = 0; i <= parts; ++i) {
    const Angle a = arc.first + arc.sweep * (static_cast<double>(i) / parts);
    points.emplace_back(arc.centre + arc.radius * Vector2d(cos(a), sin(a)));
  }
  return points;
}
void draw_walls(PlanPicture& picture, const PlaneSection& section, const Vector2d& from, const Stroke& stroke) {
  for (const SectionLine& line : section.lines()) {
    const std::array<Vector2d, 2> ends{line.a - from, line.b - from};
    picture.polyline(ends, stroke);
  }
  for (const SectionArc& arc : section.arcs()) {
    std::vector<Vector2d> points = arc_outline(arc);
    for (Vector2d& p : points) p -= from;
    picture.polyline(points, stroke);
  }
}

Eigen::AlignedBox2d box_of_section(const PlaneSection& section) {
  Eigen::AlignedBox2d box;
  for (const SectionLine& line : section.lines()) box.extend(line.a).extend(line.b);
  for (const SectionArc& arc : section.arcs()) {
    for (const Vector2d& p : arc_outline(arc)) box.extend(p);
  }
  return box;
}
PlanExtent with_margin(const Eigen::AlignedBox2d& box) {
  const double margin = 0.04 * box.sizes().maxCoeff();
  return {box.min().x() - margin, box.max().x() + margin, box.min().y() - margin, box.max().y() + margin};
}

}  // namespace

Colour state_colour(double probability) {
  const double grey = 0.92 * (1 - std::clamp(probability, 0.0, 1.0));
  return {grey, grey, grey, 1};
}

std::array<Vector3d, 4> corner_points(const SphericalGrid& grid, const SphericalPlace& place) {
  return corners_at(grid, place.direction, grid.layers().outer(place.layer));
}

std::vector<Vector3d> reference_lines(double length_m) {
  std::vector<Vector3d> ends;
  for (int i = 0; i < 12; ++i) {
    const double a = i * std::numbers::pi / 6;
    ends.emplace_back(length_m * std::cos(a), length_m * std::sin(a), 0);
  }
  return ends;
}

std::string spherical_plan_picture(const Scene& scene, const SphericalSurvey& survey) {
  const PlaneSection section(scene, survey.path.scans.front().at.z());
  PlanPicture picture(
      with_margin(box_of_section(section)), kSidePixels,
      {fmt::format("{}: the path and {} scans", scene.about.title, survey.path.scans.size()), "north (m)", "east (m)"});
  draw_walls(picture, section, Vector2d::Zero(), {palette::kInk, 2.2, false});
  std::vector<Vector2d> path;
  for (const Vector3d& p : survey.path.path) path.emplace_back(p.head<2>());
  picture.polyline(path, {palette::kTrack, 1.8, false});
  for (const ScanPosition& scan : survey.path.scans) {
    picture.dot(scan.at.head<2>(), 4, palette::kTrack);
    picture.label(scan.at.head<2>(), fmt::format("{} ({:.1f} m)", scan.number, scan.at.z()));
  }
  picture.vehicle(survey.path.scans.back().at.head<2>(), survey.path.scans.back().course.radians());
  picture.finish({{palette::kInk, "walls"},
                  {palette::kTrack, "path; scans by number and (depth)"},
                  {palette::kVehicle, "vehicle at the last scan"}});
  return picture.png();
}

std::string spherical_above_picture(const Scene& scene, const SphericalSurvey& survey) {
  const SphericalGrid& grid = *survey.grid;
  const ScanPosition& place = survey.path.scans.back();
  const PlaneSection section(scene, place.at.z());
  Eigen::AlignedBox2d box = box_of_section(section);
  box.translate(Vector2d(-place.at.head<2>()));
  const PlanExtent extent = with_margin(box);
  PlanPicture picture(extent, kSidePixels,
                      {fmt::format("The grid at position {}, from above", place.number), "north of the vehicle (m)",
                       "east of the vehicle (m)"});
  picture.raster([&](double north, double east) { return grid.was_clear({east, north, 0}) ? kClearWater : kNotSeen; });
  const auto plan = [](const Vector3d& p_G) { return Vector2d(p_G.y(), p_G.x()); };
  const std::vector<DrawnCell> cells = drawn_cells(grid);
  for (const DrawnCell& cell : cells) {
    const auto near = corners_at(grid, cell.place.direction, grid.layers().inner(cell.place.layer));
    const auto far = corner_points(grid, cell.place);
    const std::array<Vector2d, 4> outline{plan(near[0]), plan(near[1]), plan(far[1]), plan(far[0])};
    const Colour colour = state_colour(cell.probability);
    picture.polygon(outline, {colour, 0.6, false}, colour);
  }
  for (const DrawnCell& cell : cells) {
    for (const Vector3d& p : corner_points(grid, cell.place)) {
      if (cell.probability >= 0.5) picture.dot(plan(p), 0.7, palette::kInk);
    }
  }
  draw_walls(picture, section, place.at.head<2>(), {kWalls, 1.2, false});
  for (const Vector3d& end : reference_lines(1.5 * box.sizes().maxCoeff())) {
    const std::array<Vector2d, 2> line{Vector2d::Zero(), plan(end)};
    picture.polyline(line, {kReference, 0.9, true});
  }
  picture.range_rings(Vector2d::Zero(), 10);
  picture.vehicle(Vector2d::Zero(), place.course.radians());
  picture.finish({{state_colour(1), "occupied"},
                  {state_colour(0.5), "probability 0.5"},
                  {kClearWater, "observed clear"},
                  {kNotSeen, "not observed"},
                  {kWalls, "true walls"}});
  return picture.png();
}

std::string spherical_features_picture(const Scene& scene, const SphericalSurvey& survey) {
  const PlaneSection section(scene, survey.path.scans.back().at.z());
  const SurveyFeatures& features = survey.features;
  PlanPicture picture(with_margin(box_of_section(section)), kSidePixels,
                      {"Edges, arcs and corners found in the scans", "north (m)", "east (m)"});
  draw_walls(picture, section, Vector2d::Zero(), {kWalls, 5, false});
  for (const Vector2d& p : features.accounted) picture.dot(p, 0.9, palette::kFaint);
  for (const SurveyArc& seen : features.arcs) {
    const SectionArc arc{seen.arc.centre, seen.arc.radius, seen.arc.first, seen.arc.sweep, 0};
    picture.polyline(arc_outline(arc), {kTold, 1.6, false});
  }
  for (const SeenEdge& edge : features.evidence.edges()) {
    const std::array<Vector2d, 2> ends{edge.line.at(edge.line.begin_m), edge.line.at(edge.line.end_m)};
    picture.polyline(ends, {kTold, 1.6, false});
  }
  for (const Vector2d& p : features.unaccounted) picture.dot(p, 2.2, kAlone);
  for (const ScanPosition& scan : survey.path.scans) {
    picture.dot(scan.at.head<2>(), 3, palette::kTrack);
    picture.label(scan.at.head<2>(), fmt::format("{}", scan.number), palette::kTrack);
  }
  for (const SeenCorner& corner : features.evidence.corners()) {
    if (!corner.corner.convex) continue;
    const bool confirmed = corner.confirmed > 0;
    picture.dot(corner.corner.at, 5.5, confirmed ? palette::kTruth : kOpen);
    picture.label(corner.corner.at, confirmed ? fmt::format("seen {}, conf. {}", corner.hypothesised, corner.confirmed)
                                              : fmt::format("seen {}", corner.hypothesised));
  }
  picture.finish({{kTold, "edges and arcs"},
                  {kWalls, "true walls"},
                  {palette::kTruth, "confirmed corner, with scan numbers"},
                  {kOpen, "hypothesised corner"},
                  {kAlone, "other echoes"}});
  return picture.png();
}

namespace {

/// The grid in orthographic projection: far cells are as large as near ones, so that lengths can be compared.
class SolidPicture : public Canvas {
 public:
  SolidPicture(const SphericalCamera& camera, double reach_m) : Canvas(900, 640), scale_(camera.zoom * 430 / reach_m) {
    const double b = camera.looking.radians(), d = camera.down.radians();
    right_ = {std::cos(b), -std::sin(b), 0};
    ahead_ = {std::cos(d) * std::sin(b), std::cos(d) * std::cos(b), -std::sin(d)};
    up_ = right_.cross(ahead_);
  }
  [[nodiscard]] Vector2d to_px(const Vector3d& p_G) const {
    return {450 + scale_ * right_.dot(p_G), 320 - scale_ * up_.dot(p_G)};
  }
  [[nodiscard]] double depth(const Vector3d& p_G) const { return ahead_.dot(p_G); }
  void face(const std::array<Vector3d, 4>& corners, Colour colour) {
    trace(corners, true);
    fill(colour);
    set({{0, 0, 0, 0.25}, 0.5, false});
    cairo_stroke(cairo_.get());
  }
  void way(std::span<const Vector3d> points, const Stroke& stroke, bool closed = false) {
    trace(points, closed);
    set(stroke);
    cairo_stroke(cairo_.get());
  }
  void dot(const Vector3d& at, double radius_px, Colour colour) {
    const Vector2d p = to_px(at);
    cairo_new_path(cairo_.get());
    cairo_arc(cairo_.get(), p.x(), p.y(), radius_px, 0, 2 * std::numbers::pi);
    fill(colour);
    cairo_new_path(cairo_.get());
  }
  void words(const Vector3d& at, const std::string& what, Colour colour, double align = 0.5) {
    const Vector2d p = to_px(at);
    text(p.x(), p.y(), what, 11, colour, align, true);
  }
  void caption(double x, double y, const std::string& what, double size) { text(x, y, what, size, palette::kInk); }
  void swatch(double x, double y, Colour colour, const std::string& what) {
    cairo_new_path(cairo_.get());
    cairo_rectangle(cairo_.get(), x, y - 10, 14, 11);
    fill(colour);
    set({palette::kFaint, 0.7, false});
    cairo_stroke(cairo_.get());
    text(x + 19, y, what, 11, palette::kInk);
  }

 private:
  void trace(std::span<const Vector3d> points, bool closed) {
    cairo_new_path(cairo_.get());
    for (const Vector3d& p : points) {
      const Vector2d at = to_px(p);
      cairo_line_to(cairo_.get(), at.x(), at.y());
    }
    if (closed) cairo_close_path(cairo_.get());
  }
  double scale_;
  Vector3d right_, up_, ahead_;
};

const char* bearing_word(int degrees) {
  switch (degrees) {
    case 0: return "N";
    case 90: return "E";
    case 180: return "S";
    case 270: return "W";
    default: return nullptr;
  }
}

}  // namespace

std::string spherical_solid_picture(const SphericalSurvey& survey, const SphericalCamera& camera) {
  const SphericalGrid& grid = *survey.grid;
  const ScanPosition& place = survey.path.scans.back();
  std::vector<DrawnCell> cells = drawn_cells(grid);
  double reach = 5;
  for (const DrawnCell& cell : cells) {
    if (cell.probability >= 0.5) reach = std::max(reach, grid.layers().outer(cell.place.layer));
  }
  SolidPicture picture(camera, reach);
  for (double r = 10; r <= reach; r += 10) {
    std::vector<Vector3d> ring;
    for (int i = 0; i < 120; ++i) {
      const double a = i * std::numbers::pi / 60;
      ring.emplace_back(r * std::cos(a), r * std::sin(a), 0);
    }
    picture.way(ring, {palette::kFaint, 0.7, true}, true);
    picture.words({0.7 * r, 0.7 * r, 0}, fmt::format("{:g} m", r), palette::kFaint);
  }
  for (const Vector3d& end : reference_lines(reach)) {
    const std::array<Vector3d, 2> line{Vector3d::Zero(), end};
    picture.way(line, {kReference, 0.9, true});
    const int bearing =
        (450 - static_cast<int>(std::lround(std::atan2(end.y(), end.x()) * 180 / std::numbers::pi))) % 360;
    const char* word = bearing_word(bearing);
    picture.words(1.04 * end, word ? word : fmt::format("{:03d}", bearing), kReference);
  }
  std::stable_sort(cells.begin(), cells.end(), [&](const DrawnCell& a, const DrawnCell& b) {
    const auto depth = [&](const DrawnCell& c) { return picture.depth(corner_points(grid, c.place)[0]); };
    return depth(a) > depth(b);
  });
  for (const DrawnCell& cell : cells) {
    const auto corners = corner_points(grid, cell.place);
    picture.face(corners, state_colour(cell.probability));
    for (const Vector3d& p : corners) picture.dot(p, 0.8, palette::kInk);
  }
  std::vector<Vector3d> path;
  for (const Vector3d& p : survey.path.path) path.push_back(grid_axes_from_world(p - place.at));
  picture.way(path, {palette::kTrack, 2, false});
  for (const ScanPosition& scan : survey.path.scans) {
    const Vector3d p = grid_axes_from_world(scan.at - place.at);
    picture.dot(p, 3.5, palette::kTrack);
    picture.words(p + Vector3d(0, 0, 0.03 * reach), fmt::format("{}", scan.number), palette::kInk);
  }
  picture.caption(20, 26,
                  fmt::format("The grid at position {}, looking towards {:03.0f} degrees from {:.0f} degrees above",
                              place.number, camera.looking.degrees(), camera.down.degrees()),
                  14);
  picture.swatch(20, 622, state_colour(1), "occupied");
  picture.swatch(150, 622, state_colour(0.5), "probability 0.5");
  picture.swatch(290, 622, state_colour(0.1), "0.1");
  picture.swatch(370, 622, palette::kTrack, "path and scans");
  picture.swatch(490, 622, kReference, "every 30 degrees, at the vehicle's depth");
  return picture.png();
}

}  // namespace isobath
