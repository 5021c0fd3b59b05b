// ProgressLine: one line on the terminal that shows the progress of long work. It prints nothing into a pipe.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace isobath::app {

class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine() { clear(); }
  /// Shows done of total bytes (total 0: unknown) and the readings so far, at most five times a second.
  void show(std::uint64_t done, std::uint64_t total, std::uint64_t readings, const char* what = "readings");
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_ = start_;
};

}  // namespace isobath::app
