// The files that the program brings along: suites, with the scenes and vehicles that they name. Made at build time from
// the repository's own.
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
