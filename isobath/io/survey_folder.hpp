// SurveyFolder: the logs of one survey in one folder, read as one log.
//
// SurveyFolder reads the files of the folder itself (no subfolders) that are logs of one known format: the format with
// the most files, or of several such formats the first by name. InputConfig::survey.only and .without select files by
// name. The files are read one after the other, in the order of their first event's time, then by name. Logs without a
// date (times in the first ten years of the epoch) follow each other by name instead, ten seconds apart.
//
// All fixes are on one local plane, that of the first file. Fixes of the other files are converted through latitude and
// longitude and turned by the convergence of the meridians (41 arc seconds a kilometre east at 52 degrees north), as
// are covariances and velocities. A file whose fixes have no position on the globe cannot join a file whose fixes have
// one: its fixes are left out and counted. Files that cannot be opened or hold no event are left out. The report's
// details name them, and every other file of the folder, with the reason. Each damage begins with the name of its file;
// its offset is in that file.
//
// One file is open at a time, after a look at the beginning of each. Throws Error if no file is left. Files that
// overlap in time are still read one after the other, and the details report it.
#pragma once

#include <filesystem>
#include <isobath/event/event.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>
#include <string>

namespace isobath {

/// How the logs of the folder are recognised and opened: the functions of open_source.hpp.
struct LogFiles {
  std::string (*format_of)(const std::filesystem::path& file, const InputConfig& config);
  std::filesystem::path (*log_of_water_column)(const std::filesystem::path& file, const InputConfig& config);
  std::unique_ptr<Source> (*open)(const std::filesystem::path& file, const InputConfig& config);
};

/// Whether the folder holds a log of a known format, selected or not.
bool looks_like_survey_folder(const std::filesystem::path& folder, const InputConfig& config, const LogFiles& logs);
std::unique_ptr<Source> open_survey_folder(const std::filesystem::path& folder, const InputConfig& config,
                                           const LogFiles& logs);

/// The same fix in another plane. The planes' origins must be within 1000 km of the fix and not at a pole.
Navigation in_plane(const Navigation& fix, const LocalPlane& from, const LocalPlane& to);

}  // namespace isobath
