#include <isobath/map/depth/map_folder.hpp>
#include <isobath/scenario/mission_chart.hpp>
#include <isobath/world/depth_prior.hpp>
#include <isobath/world/map_features.hpp>
#include <isobath/world/map_raster.hpp>

namespace isobath {
namespace {

WorldSnapshot chart(const StoredMap& map, std::vector<ChartObstacle> objects) {
  return {snapshot_of(map), std::make_shared<const std::vector<ChartObstacle>>(std::move(objects))};
}

std::optional<MapFeatures> features_of(const StoredMap& map, const std::filesystem::path& folder) {
  const std::filesystem::path objects = folder / "objects.sqlite";
  if (!std::filesystem::exists(objects)) return std::nullopt;
  return load_features(ObjectStore(objects), map.facts.area);
}

WorldSnapshot of_map(const std::filesystem::path& folder) {
  const StoredMap map = open_map(folder);
  const std::optional<MapFeatures> features = features_of(map, folder);
  if (!features) return chart(map, {});
  return chart(map, obstacles_near(*features, box_of(map.facts.area), 0));
}

DepthPrior prior_of(const std::vector<std::string>& priors, const Configuration& configuration, const DepthArea& area,
                    const GeoOrigin& origin) {
  return read_depth_prior(priors, configuration.prior, configuration.depth, area, origin);
}

}  // namespace

WorldSnapshot chart_of(const std::filesystem::path& map, const std::vector<std::string>& priors,
                       const Configuration& configuration, const std::optional<GeoOrigin>& origin) {
  if (!map.empty() && looks_like_map(map)) return of_map(map);
  if (priors.empty() || !origin) return {};
  MapFacts facts;
  facts.area = area_of(configuration.depth_map);
  const DepthPrior prior = prior_of(priors, configuration, facts.area, *origin);
  return chart({facts, prior.trees(facts.area.levels), {}}, obstacles_of(prior.files));
}

std::vector<ChartedCorner> charted_corners(const std::filesystem::path& map, const std::vector<std::string>& priors,
                                           const Configuration& configuration, const std::optional<GeoOrigin>& origin) {
  if (!configuration.corner_fix.on) return {};
  if (!map.empty() && looks_like_map(map)) {
    const std::optional<MapFeatures> features = features_of(open_map(map), map);
    return corners_of(features ? walls_of(*features) : std::vector<ChartedWall>{});
  }
  if (priors.empty() || !origin) return {};
  return corners_of(walls_of(prior_of(priors, configuration, area_of(configuration.depth_map), *origin).files));
}

WorldSnapshot chart_of(const Scenario& scenario, const Configuration& configuration) {
  const Configuration with_prior = scenario.with_prior(configuration);
  if (with_prior.prior.file.empty()) return {};
  return chart_of({}, {with_prior.prior.file}, with_prior, scenario.scene.origin());
}

MissionSetup setup_of(const Scenario& scenario, const Configuration& configuration) {
  return {scenario.mission, parameters_of(vehicle_model_of(scenario.scene)), chart_of(scenario, configuration)};
}

}  // namespace isobath
