// text_of_file: the contents of a text file: configuration, scene, mission, vehicle, model, token.
#pragma once

#include <cstddef>
#include <string>

namespace isobath {

constexpr std::size_t kMaxTextFileMib = 16;  ///< a larger file is refused before it fills the memory

/// Throws Error where the file cannot be read, with the reason, where it has more than `max_mib`, and for a pipe that
/// no program writes to. A pipe with a writer is read to its end: `--config <(...)`.
std::string text_of_file(const std::string& file, std::size_t max_mib = kMaxTextFileMib);

}  // namespace isobath
