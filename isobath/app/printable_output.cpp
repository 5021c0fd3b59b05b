#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <isobath/app/printable_output.hpp>
#include <isobath/base/printable_text.hpp>
#include <string>
#include <string_view>
#include <unistd.h>

namespace isobath::app {
namespace {

/// The bytes of a character whose end is still to come.
std::string& unfinished() {
  static std::string bytes;
  return bytes;
}

std::size_t unfinished_bytes(std::string_view text) {
  for (std::size_t length = std::min<std::size_t>(3, text.size()); length > 0; --length) {
    if (first_character(text.substr(text.size() - length)).cut) return length;
  }
  return 0;
}

bool write_all(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

ssize_t pass_on(void* /*cookie*/, const char* bytes, std::size_t count) {
  std::string text = unfinished();
  text.append(bytes, count);
  const std::size_t left = unfinished_bytes(text);
  unfinished() = text.substr(text.size() - left);
  text.resize(text.size() - left);
  return write_all(printable_lines(text)) ? static_cast<ssize_t>(count) : 0;  // 0: failed, and errno says why
}

int finish(void* /*cookie*/) { return write_all(printable_lines(unfinished())) ? 0 : EOF; }

}  // namespace

void make_output_printable() {
  std::FILE* const printable =
      ::fopencookie(nullptr, "w", {.read = nullptr, .write = pass_on, .seek = nullptr, .close = finish});
  if (printable == nullptr) return;
  std::setvbuf(printable, nullptr, ::isatty(STDOUT_FILENO) != 0 ? _IOLBF : _IOFBF, 1 << 16);
  std::fflush(stdout);
  stdout = printable;
}

}  // namespace isobath::app
