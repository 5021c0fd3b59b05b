// A depth map made of a chart alone: what a mission may begin with before any sonar has been in the water.
#pragma once

#include <filesystem>
#include <isobath/map/map_folder.hpp>
#include <isobath/runtime/configuration.hpp>
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

/// Makes `folder` a map with this prior, around `origin` or the middle of what the file covers. Throws Error where the
/// file cannot be used, or the folder holds a map already.
PriorMapOutcome make_map_of_prior(const std::filesystem::path& prior, const std::filesystem::path& folder,
                                  const Configuration& configuration, std::optional<GeoOrigin> origin);

}  // namespace isobath
