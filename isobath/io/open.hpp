// Opens any input that Isobath knows, recognised by its content and never by its name.
#pragma once

#include <filesystem>
#include <isobath/io/event.hpp>
#include <isobath/io/input_config.hpp>
#include <memory>
#include <string>

namespace isobath {

/// Throws Error: not there, empty, no known format, a header that cannot be right. Damage further on is reported, not
/// thrown.
std::unique_ptr<Source> open_source(const std::filesystem::path& input, const InputConfig& config);

/// The log that open_source reads a file together with, which is a water column beside it (.kmwcd beside .kmall, .wcd
/// beside .all, with the same stem); empty: none.
std::filesystem::path log_of_water_column(const std::filesystem::path& file, const InputConfig& config);

/// The format of a file as open_source would take it; empty: none, or not a file that can be read.
std::string format_of_file(const std::filesystem::path& file, const InputConfig& config);

}  // namespace isobath
