// Patterns of names, as settings list them: of the files of a folder, of the topics of a log.
#pragma once

#include <string_view>

namespace isobath {

/// Whether a name matches one of the patterns, separated by commas. * matches any text, ? one character.
bool fits(std::string_view name, std::string_view patterns);

}  // namespace isobath
