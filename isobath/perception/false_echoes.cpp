#include <algorithm>
#include <cmath>
#include <isobath/perception/false_echoes.hpp>
#include <set>

namespace isobath {
namespace {

/// Whether the grid has an occupied cell along a level bearing between two ranges.
bool stands_between(const SphericalGrid& grid, Angle bearing, double from_m, double to_m) {
  const Eigen::Vector3d u_G(sin(bearing), cos(bearing), 0);
  for (double range = from_m; range <= to_m; range += grid.config().min_layer_m) {
    const auto place = grid.place_at(grid.to_table(range * u_G));
    if (place && grid.log_odds(*place) >= grid.occupied_log_odds()) return true;
  }
  return false;
}

bool is_multiple(const PlaneScan& scan, std::size_t of, const SphericalGrid& before, const FalseEchoConfig& config) {
  const PlaneEcho& echo = scan.echoes[of];
  for (int bounces = 2; bounces <= config.max_bounces; ++bounces) {
    const double range = echo.range_m / bounces, within = config.tolerance * scan.range_sigma(echo.range_m);
    int beside = 0;
    for (std::size_t i = 0; i < scan.echoes.size(); ++i) {
      const PlaneEcho& other = scan.echoes[i];
      const bool near = std::abs((other.bearing - echo.bearing).wrapped().radians()) <= config.neighbours.radians();
      beside += i != of && near && std::abs(other.range_m - range) <= within ? 1 : 0;
    }
    if (beside >= 2 || stands_between(before, echo.bearing, range - within, range + within)) return true;
  }
  return false;
}

}  // namespace

std::vector<bool> multiples_in(const PlaneScan& scan, const SphericalGrid& before, const FalseEchoConfig& config) {
  std::vector<bool> multiples(scan.echoes.size());
  for (std::size_t i = 0; i < multiples.size(); ++i) multiples[i] = is_multiple(scan, i, before, config);
  return multiples;
}

std::vector<SphericalCluster> standing_clusters(const SphericalGrid& grid, double probability,
                                                const FalseEchoConfig& config) {
  std::vector<SphericalCluster> standing = clusters(grid, probability);
  std::erase_if(standing, [&](const SphericalCluster& cluster) {
    return target_score(grid, cluster).value() < config.min_score;
  });
  return standing;
}

std::vector<EchoCause> causes_of(const SphericalGrid& grid, const std::vector<SphericalCluster>& standing,
                                 const std::vector<Eigen::Vector3d>& points_G, const std::vector<bool>& multiples) {
  std::set<SphericalPlace> things;
  for (const SphericalCluster& cluster : standing) things.insert(cluster.cells.begin(), cluster.cells.end());
  const int azimuths = grid.buckets().azimuths();
  const auto is_near_a_thing = [&](const SphericalPlace& place) {
    for (int i = 0; i < 27; ++i) {
      SphericalPlace beside = place;
      beside.direction.azimuth = (place.direction.azimuth + i % 3 - 1 + azimuths) % azimuths;
      beside.direction.elevation += i / 3 % 3 - 1;
      beside.layer += i / 9 - 1;
      if (things.contains(beside)) return true;
    }
    return false;
  };
  std::vector<EchoCause> labels(points_G.size(), EchoCause::kFalse);
  for (std::size_t i = 0; i < points_G.size(); ++i) {
    const auto place = grid.place_at(grid.to_table(points_G[i]));
    if (multiples[i]) {
      labels[i] = EchoCause::kMultiple;
    } else if (place && is_near_a_thing(*place)) {
      labels[i] = EchoCause::kDirect;
    }
  }
  return labels;
}

}  // namespace isobath
