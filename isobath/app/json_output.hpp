// What --json prints: one JSON object on standard output. Text that is no UTF-8 (names of files, words of a log) is
// replaced, not refused.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace isobath::app {

void print_json(const nlohmann::ordered_json& json);
/// Adds the names of the files in `folder` to which results were written, as "files".
void add_files(nlohmann::ordered_json& json, const std::filesystem::path& folder,
               const std::vector<std::filesystem::path>& files);

}  // namespace isobath::app
