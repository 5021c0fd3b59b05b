// LineStream: the lines of text that arrives in chunks, from a device that is not trusted. A line ends at CR or LF;
// empty lines are left out. A line that grows over `longest` characters is dropped to its end and counted.
#pragma once

#include <cstdint>
#include <isobath/io/bytes/bytes.hpp>
#include <string>
#include <string_view>

namespace isobath {

class LineStream {
 public:
  explicit LineStream(std::size_t longest) : longest_(longest) {}

  /// Calls on_line(std::string_view) for each line that this chunk completes. Returns how many lines were too long.
  template <class OnLine>
  std::uint64_t push(Bytes chunk, OnLine&& on_line) {
    std::uint64_t dropped = 0;
    for (const std::byte b : chunk) {
      const char c = static_cast<char>(b);
      if (c != '\n' && c != '\r') {
        if (line_.size() <= longest_) line_.push_back(c);
        continue;
      }
      if (line_.size() > longest_) {
        ++dropped;
      } else if (!line_.empty()) {
        on_line(std::string_view(line_));
      }
      line_.clear();
    }
    return dropped;
  }
  /// Forgets an incomplete line.
  void clear() { line_.clear(); }

 private:
  std::size_t longest_;
  std::string line_;
};

}  // namespace isobath
