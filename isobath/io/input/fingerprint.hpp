// fingerprint_of: tells whether two inputs hold the same bytes, whatever they are called, so that a map knows the logs
// that it holds. Not a protection against forgery: 64 bits of two checksums and the size.
#pragma once

#include <filesystem>
#include <string>

namespace isobath {

/// Of a file: its content. Of a folder: the names and contents of all files in it, sub-folders included. Throws Error
/// if it cannot be read. Cost: that of reading the input once.
std::string fingerprint_of(const std::filesystem::path& input);

}  // namespace isobath
