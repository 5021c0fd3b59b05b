#include <isobath/base/error.hpp>
#include <isobath/run/map_from_prior.hpp>
#include <isobath/world/map_features.hpp>

namespace isobath {

PriorMapOutcome make_map_of_prior(const std::filesystem::path& prior, const std::filesystem::path& folder,
                                  const Configuration& configuration, std::optional<GeoOrigin> origin) {
  if (looks_like_map(folder)) {
    throw Error("already holds a map, and the prior of a map cannot be changed", {folder.string()}, {},
                "name another folder");
  }
  if (!origin) origin = centre_of_prior(prior, configuration.prior.reading);
  if (!origin) {
    throw Error("has no georeference, so the map has no origin", {prior.string()}, {}, "give --origin LAT,LON");
  }
  PriorMapOutcome outcome;
  MapFacts& facts = outcome.facts;
  facts.origin = origin;
  facts.area = area_of(configuration.depth_map);
  facts.datum = configuration.prior.datum;
  const DepthPrior read =
      read_depth_prior({prior.string()}, configuration.prior, configuration.depth, facts.area, origin);
  facts.priors = read.sources;
  facts.configuration = to_toml(configuration, false);
  MapFolder stored(folder);
  std::filesystem::remove(stored.objects_file());  // left over from a map that was never committed
  ObjectStore objects(stored.objects_file());
  outcome.features = store_features(objects, read.files, facts.epoch);
  const DepthTrees trees = read.trees(facts.area.levels);
  stored.commit(facts, trees);
  for (const Prior& file : read.files) {
    outcome.read.insert(file.read.begin(), file.read.end());
    outcome.left_out.insert(file.left_out.begin(), file.left_out.end());
    outcome.details.insert(file.details.begin(), file.details.end());
  }
  trees.prior().for_each_leaf(trees.extent(), [&](std::uint32_t word, const PixelWindow& leaf) {
    if (word == DepthPixel::kUnknownDepth) return;
    outcome.known_pixels += static_cast<std::uint64_t>(leaf.width) * static_cast<std::uint64_t>(leaf.height);
  });
  return outcome;
}

}  // namespace isobath
