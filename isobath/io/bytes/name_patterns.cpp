#include <isobath/io/bytes/name_patterns.hpp>
#include <isobath/io/bytes/text_lines.hpp>
#include <optional>
#include <utility>

namespace isobath {
namespace {

/// Matches a name against a pattern, in linear time for each star: only the last star is retried.
bool fits_one(std::string_view name, std::string_view pattern) {
  std::size_t n = 0, p = 0;
  std::optional<std::pair<std::size_t, std::size_t>> star;  // positions after the star, in pattern and in name
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = {++p, n};
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (star) {
      p = star->first;
      n = ++star->second;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

}  // namespace

bool fits(std::string_view name, std::string_view patterns) {
  std::string_view pattern;
  for (TextRow row(patterns, ','); row.next(pattern);) {
    if (!trimmed(pattern).empty() && fits_one(name, trimmed(pattern))) return true;
  }
  return false;
}

}  // namespace isobath
