#include <fmt/format.h>
#include <isobath/app/json_output.hpp>
#include <nlohmann/json.hpp>

namespace isobath::app {

void print_json(const nlohmann::ordered_json& json) {
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void add_files(nlohmann::ordered_json& json, const std::filesystem::path& folder,
               const std::vector<std::filesystem::path>& files) {
  for (const auto& file : files) json["files"].push_back((folder / file).string());
}

}  // namespace isobath::app
