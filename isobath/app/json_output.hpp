// Output of --json: one JSON object on standard output. Bytes that are not UTF-8 (in file names, in texts of a log) are
// replaced.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace isobath::app {

void print_json(const nlohmann::ordered_json& json);
/// Adds the paths of the result files in `folder` as "files".
void add_files(nlohmann::ordered_json& json, const std::filesystem::path& folder,
               const std::vector<std::filesystem::path>& files);

}  // namespace isobath::app
