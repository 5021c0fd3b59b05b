#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <isobath/base/error.hpp>
#include <isobath/geometry/segment.hpp>
#include <isobath/perception/corner_fix.hpp>
#include <isobath/studies/spherical_survey.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

void judge_survey(const Scene& scene, const Vector3d& at, SphericalSurvey& survey) {
  std::vector<double> errors;
  survey.grid->cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      if (static_cast<double>(cell.log_odds) < survey.grid->occupied_log_odds()) continue;
      ++survey.occupied;
      if (cell.echoes == 0 && !cell.prior) continue;
      const Vector3d p = at + world_from_grid_axes(survey.grid->point_of(cell));
      const double error = distance_to(PlaneSection(scene, p.z()), p.head<2>());
      if (cell.echoes > 0) errors.push_back(error);
      if (!cell.prior) continue;
      ++survey.known;
      survey.known_error_m = std::max(survey.known_error_m, error);
    }
  });
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  survey.median_error_m = errors[errors.size() / 2];
  survey.worst_error_m = errors.back();
}

/// The lines of a section as upright walls, a metre above and below the vehicle.
void add_known_walls(const PlaneSection& section, const Vector3d& at, SphericalGrid& grid) {
  const auto corner = [&](const Vector2d& p, double down) {
    return grid_axes_from_world(Vector3d(p.x() - at.x(), p.y() - at.y(), down));
  };
  for (const SectionLine& wall : section.lines()) {
    add_known_triangle(grid, {corner(wall.a, -1), corner(wall.b, -1), corner(wall.b, 1)});
    add_known_triangle(grid, {corner(wall.a, -1), corner(wall.b, 1), corner(wall.a, 1)});
  }
}

/// The contents of a grid in directions and layers `times` as wide.
std::unique_ptr<SphericalGrid> coarser_grid(const SphericalGrid& grid, int times) {
  SphericalGridConfig config = grid.config();
  config.bucket = config.bucket * times;
  config.min_layer_m *= times;
  config.lock_echoes = 0;
  auto coarse = std::make_unique<SphericalGrid>(config);
  zoom(grid, ZoomRule::kAny, *coarse);
  return coarse;
}

/// Merges an arc into the known arc that it agrees with: centre and radius within four standard deviations, to which
/// half a metre is added.
void add_arc(const PlaneArc& seen, std::vector<SurveyArc>& arcs) {
  using Eigen::Matrix3d;
  for (SurveyArc& known : arcs) {
    const Vector3d off(seen.centre.x() - known.arc.centre.x(), seen.centre.y() - known.arc.centre.y(),
                       seen.radius - known.arc.radius);
    const Matrix3d both = seen.covariance + known.arc.covariance;
    if (seen.hollow != known.arc.hollow || off.dot((both + 0.25 * Matrix3d::Identity()).inverse() * off) > 16) continue;
    const Matrix3d gain = known.arc.covariance * both.inverse();
    const Vector3d step = gain * off;
    known.arc.centre += step.head<2>();
    known.arc.radius += step.z();
    known.arc.covariance = (Matrix3d::Identity() - gain) * known.arc.covariance;
    known.arc.support += seen.support;
    const Angle end = known.arc.first + known.arc.sweep, seen_end = seen.first + seen.sweep;
    // the union of the two sweeps, including a gap between them
    const Angle before = (known.arc.first - seen.first).wrapped(), behind = (seen_end - end).wrapped();
    known.arc.sweep += std::max(before, Angle{}) + std::max(behind, Angle{});
    known.arc.sweep = std::min(known.arc.sweep, Angle::degrees(360));
    if (before > Angle{}) known.arc.first = seen.first;
    ++known.scans;
    return;
  }
  arcs.push_back({seen, 1});
}

void tell_scan(const PlaneScan& scan, SurveyFeatures& features) {
  const ScanShapes told = shapes_of(scan);
  features.evidence.add(scan, told);
  features.runs += constant_range_runs(scan).size();
  for (const ScanShape& shape : told.shapes) {
    if (const PlaneArc* arc = shape.arc()) add_arc(*arc, features.arcs);
    for (const std::size_t i : shape.echoes) features.accounted.push_back(scan.point(scan.echoes[i]));
  }
  for (const std::size_t i : told.unassigned) features.unaccounted.push_back(scan.point(scan.echoes[i]));
}

constexpr double kSureTarget = 0.5;  // with a lower limit, bodies merge with the walls behind them

/// Finds planes and targets in the final grid. Walls are taken as vertical: the scans are level, at several depths.
void tell_grid(const SphericalGrid& grid, const SphericalSurveyConfig& survey, SurveyFeatures& features) {
  const std::vector<Vector3d> echoes = echoes_of(grid, grid.config().occupied);
  TangentialConfig config;
  config.vertical = true;
  features.planes = tangential_clusters(echoes, config);
  for (SphericalCluster& cluster : clusters(grid, kSureTarget)) {
    const TargetScore score = target_score(grid, cluster);
    if (survey.leave_out_false && score.value() < survey.false_echoes.min_score) continue;
    features.targets.push_back({std::move(cluster), score});
  }
}

/// The echoes of all scans, to be classified at the end, when the final grid is known.
struct HeardEchoes {
  std::vector<Vector3d> points_W;
  std::vector<SectionEcho> truth;
  std::vector<bool> multiples;
};

void tell_causes(const HeardEchoes& heard, const Vector3d& at, const SphericalSurveyConfig& config,
                 SphericalSurvey& survey) {
  std::vector<Vector3d> points_G;
  for (const Vector3d& p : heard.points_W) points_G.push_back(grid_axes_from_world(p - at));
  const auto standing = standing_clusters(*survey.grid, config.grid.occupied, config.false_echoes);
  const std::vector<EchoCause> told = causes_of(*survey.grid, standing, points_G, heard.multiples);
  for (std::size_t i = 0; i < told.size(); ++i) {
    ++survey.causes[static_cast<std::size_t>(heard.truth[i])][static_cast<std::size_t>(told[i])];
  }
}

/// Dead reckoning whose error grows by a share of the way in one direction, and the fixes that correct it.
class DriftingNavigation {
 public:
  /// `bearing` of the drift.
  DriftingNavigation(double share, Angle bearing, const Vector2d& start, SurveyNavigation& kept)
      : share_(share),
        drift_(share * plan_direction(bearing)),
        dead_reckoning_(start),
        believed_{start, {}},
        kept_(kept) {
    constexpr double kStart_m = 0.01;  // the standard deviation of the first position
    believed_.covariance = kStart_m * kStart_m * Eigen::Matrix2d::Identity();
  }

  void move(const Vector2d& step) {
    const double before = kept_.way_m;
    kept_.way_m += step.norm();
    const Vector2d measured = step + step.norm() * drift_;
    dead_reckoning_ += measured;
    believed_.at += measured;
    // An error that keeps its direction: after the whole way its standard deviation is the share of the way.
    const double grown = share_ * share_ * (kept_.way_m * kept_.way_m - before * before);
    believed_.covariance += grown * Eigen::Matrix2d::Identity();
  }
  /// Corrects the position by the corners of a scan that was made from it.
  void fix(const PlaneScan& scan, const std::vector<ChartedCorner>& charted) {
    std::vector<PlaneCorner> seen;
    for (const ScanCorner& corner : shapes_of(scan).corners) seen.push_back(corner);
    const auto fix = corner_fix(believed_, seen, charted);
    if (!fix) return;
    believed_ = fused(believed_, *fix);
    ++kept_.fixes;
    kept_.corners += fix->corners;
  }
  void keep() {
    kept_.dead_reckoning.push_back(dead_reckoning_);
    kept_.believed.push_back(believed_.at);
  }
  [[nodiscard]] const Vector2d& at() const { return believed_.at; }

 private:
  double share_;
  Vector2d drift_;  ///< m per metre of way
  Vector2d dead_reckoning_;
  PlanePosition believed_;
  SurveyNavigation& kept_;
};

/// The corners of the section's straight walls.
std::vector<ChartedCorner> charted_corners_of(const PlaneSection& section) {
  std::vector<ChartedWall> walls;
  for (const SectionLine& line : section.lines()) walls.push_back({line.a, line.b});
  return isobath::corners_of(walls);
}

/// The echoes of a scan in the order of its beams, as heard from a position.
PlaneScan echoes_from(const Vector2d& from, const std::vector<SectionReading>& readings,
                      const SectionSonarConfig& sonar) {
  PlaneScan scan{from, {}, BeamWidth(sonar.beam_width), sonar.sigma, sonar.sigma_m, sonar.sigma_share};
  for (const SectionReading& reading : readings) {
    if (reading.range_m) scan.echoes.emplace_back(reading.bearing, *reading.range_m);
  }
  return scan;
}
PlaneScan sorted(PlaneScan scan) {
  scan.sort();
  return scan;
}

/// The path of the scene, to and fro.
ScanPath passes_of(const Scene& scene, const SphericalSurveyConfig& config, Random& random) {
  Scene all = scene;
  const Vector3d& start = scene.vehicle.start;
  std::vector<WaypointConfig> back(scene.waypoints.rbegin(), scene.waypoints.rend());
  if (!back.empty()) back.erase(back.begin());
  back.push_back({.north = start.x(), .east = start.y(), .depth = start.z(), .speed = scene.vehicle.speed});
  for (int i = 1; i < config.passes; ++i) {
    const std::vector<WaypointConfig>& pass = i % 2 == 1 ? back : scene.waypoints;
    all.waypoints.insert(all.waypoints.end(), pass.begin(), pass.end());
  }
  return scan_path(all, config.passes * config.scans, random);
}

/// Adds the beams of a scan from `at` to the grid, but for multiples, and its echoes to `heard`. `multiples`: by echo.
void map_scan(const std::vector<SectionReading>& readings, const std::vector<bool>& multiples, const Vector3d& at,
              int number, Time time, const SectionSonarConfig& sonar, SphericalMapper& mapper, HeardEchoes& heard,
              std::vector<SurveyEcho>& stored) {
  std::size_t echo = 0;
  for (const SectionReading& reading : readings) {
    const Vector3d u_W(cos(reading.bearing), sin(reading.bearing), 0);
    if (reading.range_m) {
      heard.points_W.push_back(at + *reading.range_m * u_W);
      heard.truth.push_back(reading.is);
      heard.multiples.push_back(multiples[echo]);
      if (multiples[echo++]) continue;
      stored.push_back({heard.points_W.back(), *reading.range_m, number});
    }
    mapper.add({Vector3d::Zero(), mapper.to_grid(u_W), sonar.beam_width, reading.range_m, sonar.range_m, time});
  }
}

}  // namespace

PositionErrors errors_of(const std::vector<Vector2d>& positions, const ScanPath& path) {
  PositionErrors errors;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    errors.last_m = (positions[i] - path.scans[i].at.head<2>()).norm();
    errors.worst_m = std::max(errors.worst_m, errors.last_m);
  }
  return errors;
}

double distance_to(const PlaneSection& section, const Vector2d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const SectionLine& line : section.lines()) {
    least = std::min(least, (nearest_on_segment(line.a, line.b, p) - p).norm());
  }
  for (const SectionArc& arc : section.arcs()) {
    const Vector2d m = p - arc.centre;
    const double at = std::atan2(m.y(), m.x()) - arc.first.radians(), turn = 2 * std::numbers::pi;
    if (at - turn * std::floor(at / turn) <= arc.sweep.radians()) {
      least = std::min(least, std::abs(m.norm() - arc.radius));
      continue;
    }
    for (const double end : {arc.first.radians(), (arc.first + arc.sweep).radians()}) {
      least = std::min(least, (m - arc.radius * Vector2d(std::cos(end), std::sin(end))).norm());
    }
  }
  return least;
}

SphericalSurveyConfig survey_config(const Scene& scene) {
  SphericalSurveyConfig config;
  if (scene.sonars.empty()) return config;
  const SonarConfig& sonar = scene.sonars.front();
  config.sonar.range_m = sonar.range_m;
  config.sonar.beam_width = sonar.width;
  config.sonar.beams = static_cast<int>(std::lround(2 * std::numbers::pi / sonar.width.radians()));
  config.sonar.sigma = sonar.width / 2.355;
  config.grid.bucket =
      grid_for({sonar.name, sonar.range_m, config.grid.min_layer_m, sonar.width, sonar.width, 1}).bucket;
  config.grid.range_m = 1.5 * sonar.range_m;  // keeps echoes of earlier positions
  return config;
}

SphericalSurveyConfig survey_config(const SonarResolution& sonar) {
  SphericalSurveyConfig config;
  config.sonar.range_m = sonar.range_m;
  config.sonar.beam_width = sonar.beam_width;
  config.sonar.sector = sonar.sector();
  config.sonar.beams = static_cast<int>(std::lround(sonar.sector() / sonar.beam_spacing));
  config.sonar.sigma_m = sonar.resolution_m;
  config.sonar.sigma = sonar.beam_width / 2.355;
  config.grid = grid_for(sonar);
  config.grid.range_m *= 1.5;  // keeps echoes of earlier positions
  config.mapper.sigma_m = sonar.resolution_m;
  return config;
}

SphericalSurvey run_spherical_survey(const Scene& scene, const SphericalSurveyConfig& config) {
  Random random(static_cast<std::uint64_t>(config.seed >= 0 ? config.seed : scene.about.seed));
  Random path_random = random.fork();
  SphericalSurvey survey;
  survey.path = passes_of(scene, config, path_random);
  Random drift_random = path_random.fork();
  DriftingNavigation navigation(config.drift_share, Angle::radians(drift_random.uniform(0, 2 * std::numbers::pi)),
                                survey.path.scans.front().at.head<2>(), survey.navigation);
  survey.grid = std::make_unique<SphericalGrid>(config.grid);
  SphericalGrid& grid = *survey.grid;
  grid.on_dropped([&](const SphericalCell& cell, const Vector3d&) { survey.dropped_echoes += cell.echoes; });
  SphericalMapper mapper(config.mapper, grid);
  const double speed = scene.vehicle.speed > 0 ? scene.vehicle.speed : 1;
  SectionSonarConfig sonar = config.sonar;
  HeardEchoes heard;
  bool any = false;
  for (std::size_t i = 0; i < survey.path.scans.size(); ++i) {
    const ScanPosition& place = survey.path.scans[i];
    if (i > 0) {
      navigation.move((place.at - survey.path.scans[i - 1].at).head<2>());
    }
    const Time time = Time{} + seconds(survey.navigation.way_m / speed);
    const PlaneSection section(scene, place.at.z());
    any = any || !section.lines().empty() || !section.arcs().empty();
    sonar.middle = place.course;
    const std::vector<SectionReading> readings = scan(section, place.at.head<2>(), sonar, random);
    PlaneScan told = echoes_from(navigation.at(), readings, sonar);
    if (config.drift_share > 0) navigation.fix(sorted(told), charted_corners_of(section));
    navigation.keep();
    told.from = navigation.at();
    const Vector3d at(told.from.x(), told.from.y(), place.at.z());
    mapper.move_to({Rotation::from_heading(place.course), at}, time);
    if (i == 0 && config.known_walls) add_known_walls(section, at, grid);
    mapper.begin_scan();
    std::vector<bool> multiples(told.echoes.size());
    if (config.leave_out_false) multiples = multiples_in(told, grid, config.false_echoes);
    map_scan(readings, multiples, at, place.number, time, sonar, mapper, heard, survey.stored);
    survey.beams += readings.size();
    survey.echoes += told.echoes.size();
    tell_scan(sorted(std::move(told)), survey.features);
  }
  if (!any) {
    throw Error("no lines and arcs at the vehicle's depth", {scene.file}, "a scene with a [[prism]] around its path");
  }
  grid.on_dropped({});
  tell_grid(grid, config, survey.features);
  const Vector2d last = survey.navigation.believed.back();
  const Vector3d at(last.x(), last.y(), survey.path.scans.back().at.z());
  if (config.leave_out_false) tell_causes(heard, at, config, survey);
  judge_survey(scene, at, survey);
  if (config.coarser > 1) survey.coarse = coarser_grid(grid, config.coarser);
  return survey;
}

}  // namespace isobath
