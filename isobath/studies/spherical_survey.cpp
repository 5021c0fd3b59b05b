#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <isobath/base/error.hpp>
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
      if (cell.echoes == 0) continue;
      const Vector3d p = at + world_from_grid_axes(survey.grid->point_of(cell));
      errors.push_back(distance_to(PlaneSection(scene, p.z()), p.head<2>()));
    }
  });
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  survey.median_error_m = errors[errors.size() / 2];
  survey.worst_error_m = errors.back();
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

}  // namespace

double distance_to(const PlaneSection& section, const Vector2d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const SectionLine& line : section.lines()) {
    const Vector2d along = line.b - line.a;
    const double share = std::clamp((p - line.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (line.a + share * along - p).norm());
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

SphericalSurvey run_spherical_survey(const Scene& scene, const SphericalSurveyConfig& config) {
  Random random(static_cast<std::uint64_t>(config.seed >= 0 ? config.seed : scene.about.seed));
  Random path_random = random.fork();
  SphericalSurvey survey;
  survey.path = scan_path(scene, config.scans, path_random);
  survey.grid = std::make_unique<SphericalGrid>(config.grid);
  SphericalGrid& grid = *survey.grid;
  grid.on_dropped([&](const SphericalCell& cell, const Vector3d&) { survey.dropped_echoes += cell.echoes; });
  SphericalMapper mapper(config.mapper, grid);
  const double speed = scene.vehicle.speed > 0 ? scene.vehicle.speed : 1;
  double gone = 0;
  HeardEchoes heard;
  bool any = false;
  for (std::size_t i = 0; i < survey.path.scans.size(); ++i) {
    const ScanPosition& place = survey.path.scans[i];
    if (i > 0) gone += (place.at - survey.path.scans[i - 1].at).head<2>().norm();
    const Time time = Time{} + seconds(gone / speed);
    mapper.move_to({Rotation::from_heading(place.course), place.at}, time);
    mapper.begin_scan();
    const PlaneSection section(scene, place.at.z());
    PlaneScan told{
        place.at.head<2>(),      {}, BeamWidth(config.sonar.beam_width), config.sonar.sigma, config.sonar.sigma_m,
        config.sonar.sigma_share};
    any = any || !section.lines().empty() || !section.arcs().empty();
    const std::vector<SectionReading> readings = scan(section, place.at.head<2>(), config.sonar, random);
    for (const SectionReading& reading : readings) {
      if (reading.range_m) told.echoes.emplace_back(reading.bearing, *reading.range_m);
    }
    std::vector<bool> multiples(told.echoes.size());
    if (config.leave_out_false) multiples = multiples_in(told, grid, config.false_echoes);
    std::size_t echo = 0;
    for (const SectionReading& reading : readings) {
      const Vector3d u_W(cos(reading.bearing), sin(reading.bearing), 0);
      ++survey.beams;
      if (reading.range_m) {
        ++survey.echoes;
        heard.points_W.push_back(place.at + *reading.range_m * u_W);
        heard.truth.push_back(reading.is);
        heard.multiples.push_back(multiples[echo]);
        if (multiples[echo++]) continue;
      }
      mapper.add({Vector3d::Zero(), mapper.to_grid(u_W), config.sonar.beam_width, reading.range_m, config.sonar.range_m,
                  time});
    }
    told.sort();
    tell_scan(told, survey.features);
  }
  if (!any) {
    throw Error("no lines and arcs at the vehicle's depth", {scene.file}, "a scene with a [[prism]] around its path");
  }
  grid.on_dropped({});
  tell_grid(grid, config, survey.features);
  if (config.leave_out_false) tell_causes(heard, survey.path.scans.back().at, config, survey);
  judge_survey(scene, survey.path.scans.back().at, survey);
  return survey;
}

}  // namespace isobath
