// fingerprint_of: tells whether two inputs hold the same bytes, whatever they are called, so that a map knows the logs
// that it holds. Not a protection against forgery: 64 bits of two checksums and the size.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace isobath {

/// A file counts by its content; a folder by the names and contents of all its files, those of its sub-folders too,
/// less those that are `left_out`. Throws Error if the input cannot be read. Cost: that of reading it once.
std::string fingerprint_of(const std::filesystem::path& input,
                           const std::function<bool(const std::filesystem::path&)>& left_out = {});

}  // namespace isobath
