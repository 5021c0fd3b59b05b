// SurveyFolder: the logs of one survey in one folder, read as one log.
//
// Read are the files of the folder itself (no subfolders) that are logs of one known format: of several formats the one
// with the most files, of equally many the first by name. InputConfig::survey.only and .without choose among them by
// name. They are read one after the other in the order of their first event's time, then of their names. Logs without a
// date (times in the first ten years of the epoch) follow each other instead, by name, ten seconds apart.
//
// All fixes are on one local plane, that of the first file: fixes of the others go through latitude and longitude, and
// are turned by the convergence of the meridians (41 arc seconds a kilometre east at 52 degrees north); covariances
// and velocities likewise. A file whose fixes have no place on the globe cannot join one whose fixes have one: it is
// left out. So are files that cannot be opened or hold no event; the report's details name them, and every other file
// of the folder, with the reason. Each damage begins with its file's name, its offset is in that file.
//
// One file is open at a time, besides a look at each one's beginning. Throws Error: no file is left, bad patterns.
// Files that overlap in time are read after each other nevertheless, and the details say so.
#pragma once

#include <filesystem>
#include <isobath/io/event.hpp>
#include <isobath/io/input_config.hpp>
#include <memory>
#include <string>
#include <string_view>

namespace isobath {

/// How the logs of the folder are told and opened: the functions of open.hpp.
struct LogFiles {
  std::string (*format_of)(const std::filesystem::path& file, const InputConfig& config);
  std::filesystem::path (*log_of_water_column)(const std::filesystem::path& file, const InputConfig& config);
  std::unique_ptr<Source> (*open)(const std::filesystem::path& file, const InputConfig& config);
};

/// Whether it holds a log of a known format, chosen or not.
bool looks_like_survey_folder(const std::filesystem::path& folder, const InputConfig& config, const LogFiles& logs);
std::unique_ptr<Source> open_survey_folder(const std::filesystem::path& folder, const InputConfig& config,
                                           const LogFiles& logs);

/// The same fix in another plane. The planes' origins lie within 1000 km of the fix and not at a pole.
Navigation in_plane(const Navigation& fix, const LocalPlane& from, const LocalPlane& to);

/// Whether a name fits one of some patterns, separated by commas, in which * stands for any text and ? for one letter.
bool fits(std::string_view name, std::string_view patterns);

}  // namespace isobath
