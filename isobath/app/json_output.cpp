#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <fmt/format.h>
#include <isobath/app/json_output.hpp>
#include <isobath/base/printable_text.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <nlohmann/json.hpp>

namespace isobath::app {

void add_json_flag(CLI::App& command, bool& json) {
  command.add_flag("--json", json, "One JSON object on standard output instead of text")->group("Output");
}

std::string json_text(const nlohmann::ordered_json& json, int indent) {
  const std::string text = json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string escaped;  // JSON allows DEL and the controls beyond ASCII, a terminal obeys them
  escaped.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Utf8Character c = first_character(std::string_view(text).substr(at));
    if (is_terminal_control(c.code) && text[at] != '\n') {
      escaped += fmt::format("\\u{:04x}", static_cast<std::uint32_t>(c.code));
    } else {
      escaped.append(text, at, c.bytes);
    }
    at += c.bytes;
  }
  return escaped;
}

void print_json(const nlohmann::ordered_json& json) { fmt::print("{}\n", json_text(json)); }

void print_json_line(const nlohmann::ordered_json& json) {
  fmt::print("{}\n", json_text(json, -1));
  std::fflush(stdout);
}

nlohmann::ordered_json map_damage_json(const MapDamage& damage) {
  return {{"file", damage.file},
          {"block", damage.block},
          {"byte", damage.byte},
          {"pixels_lost", damage.pixels_lost},
          {"reason", damage.reason}};
}

void add_time(nlohmann::ordered_json& json, const std::string& name, Time time) {
  json[name] = to_text(time);
  json[name + "_ns"] = time.time_since_epoch().count();
}

void add_files(nlohmann::ordered_json& json, const std::filesystem::path& folder,
               const std::vector<std::filesystem::path>& files) {
  json["files"] = nlohmann::ordered_json::array();
  for (const auto& file : files) json["files"].push_back((folder / file).string());
}

}  // namespace isobath::app
