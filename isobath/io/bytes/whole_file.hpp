// Reads a complete file, for formats with small files. Throws Error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace isobath {

/// Refuses files over `max_bytes` before any allocation.
std::vector<std::uint8_t> read_whole_file(const std::filesystem::path& file, std::uint64_t max_bytes);

}  // namespace isobath
