#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/printable_text.hpp>

namespace isobath {
namespace {

std::string one_line(const std::string& problem, const Place& where, const std::string& allowed,
                     const std::string& advice) {
  // Each part may hold text of an input. What is wrong with it often stands at the end of the problem.
  constexpr std::size_t kMaxPart = 400, kMaxAllowed = 1000;
  Place shown = where;
  shown.file = printable_text(where.file, kMaxPart);
  shown.key = printable_text(where.key);
  std::string text = shown.text();
  if (!text.empty()) text += ": ";
  text += printable_text(problem, kMaxPart);
  if (!allowed.empty()) text += "; allowed: " + printable_text(allowed, kMaxAllowed);
  if (!advice.empty()) text += "; " + printable_text(advice, kMaxPart);
  return text;
}

}  // namespace

std::string Place::text() const {
  std::string text = file;
  if (line) text += fmt::format("{}{}", text.empty() ? "line " : ":", *line);
  if (line && column) text += fmt::format(":{}", *column);
  if (byte) text += fmt::format("{}byte {}", text.empty() ? "" : ": ", *byte);
  if (!key.empty()) text += fmt::format("{}{}", text.empty() ? "" : ": ", key);
  return text;
}

Error::Error(const std::string& problem, Place where, const std::string& allowed, const std::string& advice)
    : std::runtime_error(one_line(problem, where, allowed, advice)), where_(std::move(where)) {}

void assertion_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
  std::abort();
}

}  // namespace isobath
