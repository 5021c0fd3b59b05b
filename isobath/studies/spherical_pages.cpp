#include <algorithm>
#include <cmath>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <isobath/studies/spherical_pages.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSidePixels = 720;
constexpr Colour kWalls{0.84, 0.37, 0.0, 0.55};
constexpr Colour kTold{0.0, 0.25, 0.5, 1}, kAlone{0.8, 0.0, 0.5, 1}, kOpen{0.95, 0.75, 0.1, 1};

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
}  // namespace

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
    if (survey.path.scans.size() > 30) continue;
    picture.label(scan.at.head<2>(), fmt::format("{} ({:.1f} m)", scan.number, scan.at.z()));
  }
  const SurveyNavigation& navigation = survey.navigation;
  const bool drifts = navigation.dead_reckoning != navigation.believed;
  if (drifts) {
    picture.polyline(navigation.dead_reckoning, {palette::kFaint, 1.2, true});
    for (const Vector2d& p : navigation.believed) picture.dot(p, 3, kAlone);
  }
  picture.vehicle(survey.path.scans.back().at.head<2>(), survey.path.scans.back().course.radians());
  std::vector<PlanPicture::LegendEntry> legend{{palette::kInk, "walls"},
                                               {palette::kTrack, "path; scans by number and (depth)"},
                                               {palette::kVehicle, "vehicle at the last scan"}};
  if (drifts) {
    legend.push_back({palette::kFaint, "dead reckoning"});
    legend.push_back({kAlone, "position corrected by corners"});
  }
  picture.finish(legend);
  return picture.png();
}

namespace {

SphereView view_of(const SphericalSurvey& survey, const SphericalGrid& grid, const std::string& title) {
  const ScanPosition& place = survey.path.scans.back();
  SphereView view{grid, title, place.course, {}};
  for (const Vector3d& p : survey.path.path) view.path.push_back(grid_axes_from_world(p - place.at));
  for (const ScanPosition& scan : survey.path.scans) {
    view.scans.emplace_back(grid_axes_from_world(scan.at - place.at), fmt::format("{}", scan.number));
  }
  return view;
}

}  // namespace

std::string spherical_above_picture(const Scene& scene, const SphericalSurvey& survey) {
  const ScanPosition& place = survey.path.scans.back();
  const PlaneSection section(scene, place.at.z());
  SphereView view = view_of(survey, *survey.grid, fmt::format("The grid at position {}, from above", place.number));
  view.shown = box_of_section(section);
  view.shown.translate(Vector2d(-place.at.head<2>()));
  for (const SectionLine& line : section.lines()) view.walls.push_back({line.a, line.b});
  for (const SectionArc& arc : section.arcs()) view.walls.push_back(arc_outline(arc));
  for (auto& wall : view.walls) {
    for (Vector2d& p : wall) p -= place.at.head<2>();
  }
  return sphere_above_picture(view);
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

GridWalks walks_of(const SphericalGrid& grid) {
  const SphericalCells& cells = grid.cells();
  const auto layers = static_cast<std::size_t>(grid.layers().count());
  std::vector<std::size_t> by_ring(static_cast<std::size_t>(grid.buckets().elevations()));
  cells.each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
    by_ring[static_cast<std::size_t>(d.elevation)] += beam.size();
  });
  GridWalks walks;
  const auto fullest = std::max_element(by_ring.begin(), by_ring.end());
  walks.elevation = static_cast<int>(fullest - by_ring.begin());
  walks.ring_cells = *fullest;
  std::vector<std::size_t> by_layer(layers);
  cells.each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
    if (d.elevation != walks.elevation) return;
    ++walks.directions;
    for (const SphericalCell& cell : beam) ++by_layer[cell.layer];
    if (beam.size() <= walks.beam.size()) return;
    walks.azimuth = d.azimuth;
    walks.beam.clear();
    for (const SphericalCell& cell : beam) walks.beam.push_back(cell.layer);
  });
  walks.layer = static_cast<int>(std::max_element(by_layer.begin(), by_layer.end()) - by_layer.begin());
  cells.each_of_layer(walks.layer, [&](const SphericalDirection& d, const SphericalCell&) {
    if (d.elevation == walks.elevation) walks.of_layer.push_back(d.azimuth);
  });
  return walks;
}

std::string spherical_structure_picture(const SphericalSurvey& survey) {
  const SphericalGrid& grid = *survey.grid;
  const int azimuths = grid.buckets().azimuths(), layers = grid.layers().count();
  const GridWalks walks = walks_of(grid);
  PlanPicture picture(
      frame_around(Eigen::AlignedBox2d(Vector2d(0, 0), Vector2d(layers, azimuths))), kSidePixels,
      {fmt::format("One ring: {} cells stored of {} directions x {} layers", walks.ring_cells, azimuths, layers),
       "layer, from the vehicle outwards", "direction, bucket of azimuth"});
  grid.cells().each_beam([&](const SphericalDirection& d, std::span<const SphericalCell> beam) {
    if (d.elevation != walks.elevation) return;
    for (const SphericalCell& cell : beam) picture.dot(Vector2d(cell.layer, d.azimuth), 1.8, palette::kInk);
  });
  std::vector<Vector2d> along_beam, along_layer;
  for (const int layer : walks.beam) along_beam.emplace_back(layer, walks.azimuth);
  for (const int azimuth : walks.of_layer) along_layer.emplace_back(walks.layer, azimuth);
  picture.polyline(along_beam, {palette::kObstacle, 1.6, false});
  picture.polyline(along_layer, {palette::kTrack, 1.6, false});
  for (const Vector2d& cell : along_beam) picture.dot(cell, 3, palette::kObstacle);
  for (const Vector2d& cell : along_layer) picture.dot(cell, 3, palette::kTrack);
  picture.finish({{palette::kInk, fmt::format("stored cells, in {} directions", walks.directions)},
                  {palette::kObstacle, fmt::format("one direction: {} cells by range", along_beam.size())},
                  {palette::kTrack, fmt::format("one layer: {} cells by direction", along_layer.size())}});
  return picture.png();
}

std::string spherical_solid_picture(const SphericalSurvey& survey, const SphericalGrid& grid,
                                    const SphericalCamera& camera) {
  const std::string title = fmt::format("The grid at position {}, directions of {:g} degrees",
                                        survey.path.scans.back().number, grid.buckets().step().degrees());
  return sphere_solid_picture(view_of(survey, grid, title), camera);
}

}  // namespace isobath
