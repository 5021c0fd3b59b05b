// A map against soundings that it has not seen, as hydrographers check a survey with cross lines.
//
// Each depth sounding of a log is placed with its pose, and compared with what the map says of the pixels that it may
// have looked at (its footprint, widened by the doubt of place): their mean, weighed by confidence. Not compared, and
// counted by reason: echoes of obstacle sonars, echoes out of the water column, depths that nothing around them
// supports (the same quarantine as when mapping), places that the map does not know, or knows only as clear down to a
// depth.
#pragma once

#include <filesystem>
#include <functional>
#include <isobath/map/map_folder.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/crosscheck.hpp>
#include <isobath/runtime/pipeline.hpp>
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

/// Throws Error if the map or the log cannot be opened, or lie in frames that cannot be brought together.
CheckOutcome check_map(const CheckRequest& request);

}  // namespace isobath
