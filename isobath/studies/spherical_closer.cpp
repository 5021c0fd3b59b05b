#include <algorithm>
#include <cmath>
#include <isobath/studies/spherical_closer.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

/// Where the vehicle believes to be at the last scan: the origin of the grid.
Vector3d last_position(const SphericalSurvey& survey) {
  const Eigen::Vector2d& last = survey.navigation.believed.back();
  return {last.x(), last.y(), survey.path.scans.back().at.z()};
}

SphericalGridConfig finer_config(SphericalGridConfig config, int finer) {
  config.bucket = config.bucket / finer;
  config.min_layer_m /= finer;
  config.prior = 1 - std::pow(1 - config.prior, 1 / std::pow(finer, 3));  // as many objects in the same volume
  config.lock_echoes = 0;
  return config;
}

/// The beam by which an echo enters a grid at the last position.
SphericalLook look_at(const Vector3d& p_G, const SurveyEcho& echo, const SectionSonarConfig& sonar) {
  const double range = p_G.norm(), along = std::max(sonar.sigma_m, sonar.sigma_share * echo.range_m);
  const double across = std::max(along, echo.range_m * sonar.sigma.radians());
  return {.axis = p_G / range,
          .width = Angle::radians(2.355 * std::atan2(across, range)),
          .range_m = range,
          .max_range_m = range,
          .told = {range, 0}};
}

/// The probability of a cell with half the expected number of objects of the likeliest one.
double half_of_peak(const SphericalGrid& grid) {
  double largest = grid.prior_log_odds();
  grid.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) largest = std::max(largest, static_cast<double>(cell.log_odds));
  });
  return -std::expm1(-0.5 * std::log1p(std::exp(largest)));
}

}  // namespace

Vector3d point_in_world(const SphericalSurvey& survey, const Vector3d& p_G) {
  return last_position(survey) + world_from_grid_axes(p_G);
}

std::vector<CloserLook> closer_looks(const SphericalSurvey& survey, const SphericalSurveyConfig& config, int finer,
                                     std::size_t min_echoes) {
  constexpr int kMaxCells = 10'000;
  SphericalMapperConfig mapping = config.mapper;
  mapping.rule = SphericalMapperConfig::Rule::kLogOdds;
  mapping.max_cells = kMaxCells;
  mapping.tau_s = 0;
  const Vector3d at = last_position(survey);
  std::vector<CloserLook> looks;
  for (std::size_t i = 0; i < survey.features.targets.size(); ++i) {
    const auto& target = survey.features.targets[i];
    if (target.score.echoes < min_echoes) continue;
    std::vector<SphericalPlace> cells = target.cluster.cells;
    std::sort(cells.begin(), cells.end());
    CloserLook look{i, std::make_unique<SphericalGrid>(finer_config(config.grid, finer)), {}};
    SphericalMapper mapper(mapping, *look.grid);
    int scan = 0;
    for (const SurveyEcho& echo : survey.stored) {
      const Vector3d p_G = grid_axes_from_world(echo.at_W - at);
      const auto place = survey.grid->place_at(survey.grid->to_table(p_G));
      if (!place || !std::binary_search(cells.begin(), cells.end(), *place)) continue;
      if (std::exchange(scan, echo.scan) != echo.scan) mapper.begin_scan();
      mapper.add(look_at(p_G, echo, config.sonar));
    }
    if (look.grid->cells().size() > 0) look.peaks = clusters(*look.grid, half_of_peak(*look.grid));
    looks.push_back(std::move(look));
  }
  return looks;
}

}  // namespace isobath
