// The identity of a log that goes into a stored map: the same log is not added twice.
#pragma once

#include <filesystem>
#include <isobath/map/depth/map_record.hpp>
#include <isobath/run/run_request.hpp>
#include <optional>
#include <string>

namespace isobath {

/// The fingerprint of the log of a run, and of the settings that choose a part of it. Empty for a scene, and without a
/// stored map. What this run or an earlier one wrote into the folder of the logs does not count.
std::string fingerprint_of_log(const RunRequest& request);

/// The visit of a stored map that brought the log of this fingerprint, if there is one. Nothing for a damaged map: a
/// log may go into it again.
std::optional<MapVisit> visit_of(const std::filesystem::path& map, const std::string& fingerprint);

}  // namespace isobath
