// Reads and writes complete files, for formats with small files. Throws Error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace isobath {

/// Refuses files over `max_bytes` before any allocation.
std::vector<std::uint8_t> read_whole_file(const std::filesystem::path& file, std::uint64_t max_bytes);

/// The file takes its place when it is complete.
void write_whole_file(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);
void write_whole_file(const std::filesystem::path& file, std::string_view text);

}  // namespace isobath
