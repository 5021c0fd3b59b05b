// EmbeddedFile: a file that is part of the program: suites, with the scenes and vehicles that they name. The build
// copies them from the repository.
#pragma once

#include <span>
#include <string_view>

namespace isobath {

struct EmbeddedFile {
  std::string_view name;  ///< its path in the repository: "suites/pandan.toml"
  std::string_view text;
};
std::span<const EmbeddedFile> embedded_files();

}  // namespace isobath
