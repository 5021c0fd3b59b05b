// to_lower_case: a copy of a text with ASCII letters in lower case. Independent of the locale.
#pragma once

#include <string>
#include <string_view>

namespace isobath {

inline std::string to_lower_case(std::string_view text) {
  std::string copy(text);
  for (char& c : copy) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return copy;
}

}  // namespace isobath
