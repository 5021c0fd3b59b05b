// make_map_of_prior: makes a depth map from a chart alone, so that a mission can start before any sonar survey.
#pragma once

#include <filesystem>
#include <isobath/configuration/configuration.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <map>
#include <optional>
#include <string>

namespace isobath {

struct PriorMapOutcome {
  MapFacts facts;
  std::map<std::string, std::uint64_t> read, left_out;
  std::map<std::string, std::string> details;
  std::size_t features = 0;
  std::uint64_t known_pixels = 0;
};

/// Makes a map in `folder` from this prior, around `origin` or else around the middle of the prior. Throws Error if the
/// file cannot be used, if its middle is not georeferenced and `origin` is empty, or if the folder already holds a map.
PriorMapOutcome make_map_of_prior(const std::filesystem::path& prior, const std::filesystem::path& folder,
                                  const Configuration& configuration, std::optional<GeoOrigin> origin);

}  // namespace isobath
