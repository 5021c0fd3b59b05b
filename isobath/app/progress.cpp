#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <isobath/app/progress.hpp>
#include <unistd.h>

namespace isobath::app {

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) != 0) {}

void ProgressLine::show(std::uint64_t done, std::uint64_t total, std::uint64_t readings, const char* what) {
  const auto now = Clock::now();
  if (!terminal_ || now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  shown_ = true;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double rate = static_cast<double>(readings) / elapsed;
  std::string line = fmt::format("{} {}, {:.{}f} per second", readings, what, rate, rate < 10 ? 2 : 0);
  if (total > 0 && done > 0) {
    const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
    line = fmt::format("{:5.1f} %  {}, {:.0f} s left", 100 * share, line, elapsed * (1 - share) / share);
  }
  std::fprintf(stderr, "\r\033[K%s", line.c_str());
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (shown_) std::fprintf(stderr, "\r\033[K");
  shown_ = false;
}

}  // namespace isobath::app
