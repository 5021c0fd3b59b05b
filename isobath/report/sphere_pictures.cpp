#include <algorithm>
#include <cairo/cairo.h>
#include <cmath>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <isobath/report/sphere_pictures.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSpherePixels = 720;
constexpr double kMinDrawn = 0.05;  // probability
constexpr Colour kNotSeen{0.87, 0.91, 0.95, 1}, kClearWater{1, 1, 1, 1}, kTrueWalls{0.84, 0.37, 0.0, 0.55};
constexpr Colour kReference{0.0, 0.45, 0.7, 0.55};

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

/// The range of the farthest cell that is more likely occupied than not; 5 m at least.
double reach_of(const SphericalGrid& grid, const std::vector<DrawnCell>& cells) {
  double reach = 5;
  for (const DrawnCell& cell : cells) {
    if (cell.probability >= 0.5) reach = std::max(reach, grid.layers().outer(cell.place.layer));
  }
  return reach;
}

/// A step of some rings: 1, 2, 5, 10 ... m.
double ring_step(double reach_m) { return reach_m <= 12 ? 2 : reach_m <= 60 ? 10 : 20; }

}  // namespace

PlanExtent with_margin(const Eigen::AlignedBox2d& box) {
  const double margin = 0.04 * box.sizes().maxCoeff();
  return {box.min().x() - margin, box.max().x() + margin, box.min().y() - margin, box.max().y() + margin};
}

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

std::string sphere_above_picture(const SphereView& view) {
  const SphericalGrid& grid = view.grid;
  std::vector<DrawnCell> cells = drawn_cells(grid);
  if (view.band_m > 0) {
    std::erase_if(cells, [&](const DrawnCell& cell) {
      const auto near = corners_at(grid, cell.place.direction, grid.layers().middle(cell.place.layer));
      return near[0].z() > view.band_m || near[3].z() < -view.band_m;
    });
  }
  const double reach = reach_of(grid, cells);
  Eigen::AlignedBox2d box = view.shown;
  if (box.isEmpty()) box = Eigen::AlignedBox2d(Vector2d::Constant(-reach), Vector2d::Constant(reach));
  const std::string up = view.course_up ? "ahead of the vehicle (m)" : "north of the vehicle (m)";
  const std::string right = view.course_up ? "starboard of the vehicle (m)" : "east of the vehicle (m)";
  PlanPicture picture(with_margin(box), kSpherePixels, {view.title, up, right});
  picture.raster([&](double north, double east) { return grid.was_clear({east, north, 0}) ? kClearWater : kNotSeen; });
  const auto plan = [](const Vector3d& p_G) { return Vector2d(p_G.y(), p_G.x()); };
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
  for (const auto& wall : view.walls) picture.polyline(wall, {kTrueWalls, 1.2, false});
  for (const Vector3d& end : reference_lines(1.5 * box.sizes().maxCoeff())) {
    const std::array<Vector2d, 2> line{Vector2d::Zero(), plan(end)};
    picture.polyline(line, {kReference, 0.9, true});
  }
  picture.range_rings(Vector2d::Zero(), ring_step(reach));
  picture.vehicle(Vector2d::Zero(), view.course.radians());
  std::vector<PlanPicture::LegendEntry> legend{{state_colour(1), "occupied"},
                                               {state_colour(0.5), "probability 0.5"},
                                               {kClearWater, "observed clear"},
                                               {kNotSeen, "not observed"}};
  if (!view.walls.empty()) legend.push_back({kTrueWalls, "true walls"});
  picture.finish(legend);
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

std::string sphere_solid_picture(const SphereView& view, const SphericalCamera& camera) {
  const SphericalGrid& grid = view.grid;
  std::vector<DrawnCell> cells = drawn_cells(grid);
  const double reach = reach_of(grid, cells), step = ring_step(reach);
  SolidPicture picture(camera, reach);
  for (double r = step; r <= reach; r += step) {
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
    const char* word = view.course_up ? nullptr : bearing_word(bearing);
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
  picture.way(view.path, {palette::kTrack, 2, false});
  for (const auto& [p, number] : view.scans) {
    picture.dot(p, 3.5, palette::kTrack);
    picture.words(p + Vector3d(0, 0, 0.03 * reach), number, palette::kInk);
  }
  if (view.scans.empty()) {
    picture.dot(Vector3d::Zero(), 3.5, palette::kVehicle);
    const std::array<Vector3d, 2> bow{Vector3d::Zero(), 0.08 * reach * Vector3d(sin(view.course), cos(view.course), 0)};
    picture.way(bow, {palette::kVehicle, 2.5, false});
  }
  picture.caption(20, 26,
                  fmt::format("{}, looking towards {:03.0f} degrees from {:.0f} degrees above", view.title,
                              camera.looking.degrees(), camera.down.degrees()),
                  14);
  picture.swatch(20, 622, state_colour(1), "occupied");
  picture.swatch(150, 622, state_colour(0.5), "probability 0.5");
  picture.swatch(290, 622, state_colour(0.1), "0.1");
  if (view.scans.empty()) {
    picture.swatch(370, 622, palette::kVehicle, "vehicle");
  } else {
    picture.swatch(370, 622, palette::kTrack, "path and scans");
  }
  picture.swatch(490, 622, kReference, "every 30 degrees, at the vehicle's depth");
  return picture.png();
}

}  // namespace isobath
