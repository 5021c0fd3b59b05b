#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <isobath/base/error.hpp>

namespace isobath {
namespace {

std::string one_line(const std::string& problem, const Place& where, const std::string& allowed,
                     const std::string& advice) {
  std::string text = where.text();
  if (!text.empty()) text += ": ";
  text += problem;
  if (!allowed.empty()) text += "; allowed: " + allowed;
  if (!advice.empty()) text += "; " + advice;
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';  // untrusted names must not break the line
  }
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
