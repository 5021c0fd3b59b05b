// Opens any input that Isobath can read. The format is recognised by the content, never by the name.
#pragma once

#include <filesystem>
#include <isobath/event/event.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>
#include <string>

namespace isobath {

/// Throws Error if the input does not exist, is empty, has no known format, or has an impossible header. Later damage
/// is reported, not thrown.
std::unique_ptr<Source> open_source(const std::filesystem::path& input, const InputConfig& config = {});

/// The fixes of the file that InputConfig::navigation names: a table of poses, or another log. Throws Error.
std::unique_ptr<Source> open_navigation(const InputConfig& config);

/// Poses to compare with those of the log: of the file that InputConfig::reference names, else of the log's other
/// track; null: there are none.
std::unique_ptr<Source> open_reference(const std::filesystem::path& input, const InputConfig& config);

/// The log that open_source reads together with a water column file (.kmall for .kmwcd, .all for .wcd, with the same
/// stem); empty: none.
std::filesystem::path log_of_water_column(const std::filesystem::path& file, const InputConfig& config);

/// The format that open_source would read a file as; empty: unknown, or the file cannot be read.
std::string format_of_file(const std::filesystem::path& file, const InputConfig& config);

}  // namespace isobath
