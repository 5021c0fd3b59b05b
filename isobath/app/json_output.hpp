// Output of --json: one JSON object on standard output. Bytes that are not UTF-8 (in file names, in texts of a log) are
// replaced. docs/json-output.md lists the fields of every command.
#pragma once

#include <filesystem>
#include <isobath/base/time.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace isobath {
struct MapDamage;
}

namespace isobath::app {

/// Adds the option --json to a command.
void add_json_flag(CLI::App& command, bool& json);

/// `indent`: spaces a level; -1: on one line.
std::string json_text(const nlohmann::ordered_json& json, int indent = 2);
void print_json(const nlohmann::ordered_json& json);
/// On one line, for a command that prints one object after the other, and flushed.
void print_json_line(const nlohmann::ordered_json& json);
/// A damaged block of a depth map.
nlohmann::ordered_json map_damage_json(const MapDamage& damage);
/// `name` with the time as text, and `name`_ns with its nanoseconds.
void add_time(nlohmann::ordered_json& json, const std::string& name, Time time);
/// Adds the paths of the result files in `folder` as "files".
void add_files(nlohmann::ordered_json& json, const std::filesystem::path& folder,
               const std::vector<std::filesystem::path>& files);

}  // namespace isobath::app
