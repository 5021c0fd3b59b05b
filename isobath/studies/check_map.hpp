// check_map: compares a depth map with independent soundings, as hydrographers check a survey with cross lines.
//
// Each depth sounding of a log is placed with its pose and compared with the pixels within its footprint, widened by
// the position uncertainty: with their mean, weighted by confidence. Readings that are not compared are counted by
// reason: echoes of obstacle sonars, echoes in the water column, depths that no neighbour supports (the same quarantine
// as when mapping), and places that the map does not know, or knows only as clear down to a depth.
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/configuration/configuration.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/studies/crosscheck.hpp>
#include <string>
#include <vector>

namespace isobath {

struct CheckRequest {
  std::filesystem::path map;
  std::filesystem::path input;  ///< log, folder of logs, or scene (.toml)
  std::filesystem::path out;    ///< folder for the report; empty: none
  Configuration configuration;
  std::function<void(const SourceReport&, const PipelineCounts&)> progress;
};

struct CheckOutcome {
  CrosscheckResult result;
  std::vector<MapDamage> damages;
  std::vector<std::filesystem::path> files;  ///< written, relative to the folder
};

/// Throws Error if the map or the log cannot be opened, or if their frames cannot be related.
CheckOutcome check_map(const CheckRequest& request);

}  // namespace isobath
